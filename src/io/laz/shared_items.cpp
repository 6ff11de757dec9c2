// What the point-wise and the layered kind have in common: times and colours.
#include <algorithm>
#include <cstdint>

#include "io/laz/items.hpp"

namespace pointskin::io {
namespace {

constexpr std::int32_t kMostSteps = 500;   ///< a difference is at most so many times the usual one
constexpr std::int32_t kLeastSteps = -10;  ///< and at least so many
constexpr std::uint32_t kCodes = kMostSteps - kLeastSteps + 1;
constexpr int kMostSwitches = 8;  ///< of sequences before a time; encoders need one

std::int32_t wrapped(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) * static_cast<std::uint32_t>(b));
}

std::uint64_t moved(std::uint64_t time, std::int32_t by) { return time + static_cast<std::uint64_t>(std::int64_t{by}); }

}  // namespace

LazTimes::LazTimes(bool with_unchanged)
    : same_(with_unchanged ? 1 : 0), at_rest_(5 + same_), in_motion_(kCodes + 4 + same_), differences_(32, 9) {}

std::uint64_t LazTimes::next(ArithmeticDecoder& from) {
  for (int i = 0; i < kMostSwitches; ++i)
    if (steps_[last_] == 0 ? take_from_rest(from) : take_from_motion(from)) return times_[last_];
  throw GarbledLaz();
}

/// @returns false if another sequence goes on
bool LazTimes::take_from_rest(ArithmeticDecoder& from) {
  std::uint32_t code = from.symbol(at_rest_);
  if (same_ == 1 && code == 0) return true;
  code -= same_;
  if (code == 0) {
    steps_[last_] = differences_.next(from, 0, 0);
    times_[last_] = moved(times_[last_], steps_[last_]);
    extremes_[last_] = 0;
  } else if (code == 1) {
    jump(from);
  } else {
    last_ = (last_ + code - 1) & 3;
    return false;
  }
  return true;
}

bool LazTimes::take_from_motion(ArithmeticDecoder& from) {
  const std::uint32_t code = from.symbol(in_motion_);
  if (code == 1) {
    times_[last_] = moved(times_[last_], differences_.next(from, steps_[last_], 1));
    extremes_[last_] = 0;
  } else if (code < kCodes) {
    times_[last_] = moved(times_[last_], scaled_difference(from, static_cast<std::int32_t>(code)));
  } else if (same_ == 1 && code == kCodes) {
    return true;
  } else if (code == kCodes + same_) {
    jump(from);
  } else {
    last_ = (last_ + code - kCodes - same_) & 3;
    return false;
  }
  return true;
}

std::int32_t LazTimes::scaled_difference(ArithmeticDecoder& from, std::int32_t code) {
  if (code == 0) {
    const std::int32_t difference = differences_.next(from, 0, 7);
    count_extreme(difference);
    return difference;
  }
  if (code < kMostSteps) return differences_.next(from, wrapped(code, steps_[last_]), code < 10 ? 2 : 3);
  const std::int32_t steps = code == kMostSteps ? code : kMostSteps - code;
  if (steps < 0 && steps > kLeastSteps) return differences_.next(from, wrapped(steps, steps_[last_]), 5);
  const std::int32_t difference = differences_.next(from, wrapped(steps, steps_[last_]), steps > 0 ? 4 : 6);
  count_extreme(difference);
  return difference;
}

/// A difference that is far from the usual one, more than three times in a row, is the usual one.
void LazTimes::count_extreme(std::int32_t difference) {
  if (++extremes_[last_] <= 3) return;
  steps_[last_] = difference;
  extremes_[last_] = 0;
}

/// A time that is too far away for a difference of 32 bits begins another sequence.
void LazTimes::jump(ArithmeticDecoder& from) {
  newest_ = (newest_ + 1) & 3;
  const auto high =
      static_cast<std::uint32_t>(differences_.next(from, static_cast<std::int32_t>(times_[last_] >> 32), 8));
  const std::uint32_t low = from.bits(32);
  times_[newest_] = std::uint64_t{high} << 32 | low;
  last_ = newest_;
  steps_[last_] = 0;
  extremes_[last_] = 0;
}

LazColours::LazColours() : changed_(128), bytes_(6, SymbolModel(256)) {}

std::uint32_t LazColours::byte(ArithmeticDecoder& from, std::uint32_t changed, std::size_t which,
                               std::int32_t predicted, std::uint32_t last) {
  if ((changed >> which & 1) == 0) return last;
  return (static_cast<std::uint32_t>(std::clamp(predicted, 0, 255)) + from.symbol(bytes_[which])) & 255;
}

void LazColours::next(ArithmeticDecoder& from, std::array<std::uint16_t, 3>& last) {
  const std::uint32_t changed = from.symbol(changed_);
  std::array<std::uint32_t, 3> low{}, high{};
  const auto old_low = [&](std::size_t c) { return std::int32_t{last[c] & 255}; };
  const auto old_high = [&](std::size_t c) { return std::int32_t{last[c] >> 8}; };
  low[0] = byte(from, changed, 0, old_low(0), last[0] & 255u);
  high[0] = byte(from, changed, 1, old_high(0), last[0] >> 8u);
  if ((changed >> 6 & 1) == 0) {
    last.fill(static_cast<std::uint16_t>(low[0] | high[0] << 8));
    return;
  }
  // Green and blue move as red does, or as the mean of red and green.
  const auto rest = [&](std::array<std::uint32_t, 3>& to, std::size_t first, const auto& old) {
    const std::int32_t red = static_cast<std::int32_t>(to[0]) - old(0);
    to[1] = byte(from, changed, first, old(1) + red, static_cast<std::uint32_t>(old(1)));
    const std::int32_t mean = (red + static_cast<std::int32_t>(to[1]) - old(1)) / 2;
    to[2] = byte(from, changed, first + 2, old(2) + mean, static_cast<std::uint32_t>(old(2)));
  };
  rest(low, 2, old_low);
  rest(high, 3, old_high);
  for (std::size_t c = 0; c < 3; ++c) last[c] = static_cast<std::uint16_t>(low[c] | high[c] << 8);
}

}  // namespace pointskin::io
