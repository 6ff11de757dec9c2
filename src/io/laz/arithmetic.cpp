#include "io/laz/arithmetic.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace pointskin::io {
namespace {

constexpr std::uint32_t kShortest = 1u << 24;  ///< of the interval
constexpr std::uint32_t kBitShift = 13;        ///< probabilities of bits are in 2^-13
constexpr std::uint32_t kSymbolShift = 15;     ///< those of symbols in 2^-15
constexpr std::uint32_t kHighBits = 8;         ///< of long differences that are modelled; the others are not
constexpr std::size_t kMostBeyond = 8;         ///< bytes that a decoder looks ahead

}  // namespace

void BitModel::update() {
  seen_ += cycle_;
  if (seen_ > 1u << kBitShift) {
    seen_ = (seen_ + 1) >> 1;
    zeros_ = (zeros_ + 1) >> 1;
    if (zeros_ == seen_) ++seen_;
  }
  zero_ = (zeros_ * (0x80000000u / seen_)) >> (31 - kBitShift);
  cycle_ = std::min((5 * cycle_) >> 2, 64u);
  left_ = cycle_;
}

SymbolModel::SymbolModel(std::uint32_t symbols)
    : symbols_(symbols), cycle_(symbols), begins_(symbols), counts_(symbols, 1) {
  if (symbols > 16) {
    std::uint32_t table_bits = 3;
    while (symbols > 1u << (table_bits + 2)) ++table_bits;
    table_.resize((std::size_t{1} << table_bits) + 2);
    table_shift_ = kSymbolShift - table_bits;
  }
  update();
  cycle_ = (symbols + 6) >> 1;
  left_ = cycle_;
}

void SymbolModel::update() {
  total_ += cycle_;
  if (total_ > 1u << kSymbolShift) {
    total_ = 0;
    for (std::uint32_t& count : counts_) {
      count = (count + 1) >> 1;
      total_ += count;
    }
  }
  const std::uint32_t scale = 0x80000000u / total_;
  std::uint32_t sum = 0;
  std::size_t filled = 0;
  for (std::uint32_t symbol = 0; symbol < symbols_; ++symbol) {
    begins_[symbol] = (scale * sum) >> (31 - kSymbolShift);
    sum += counts_[symbol];
    if (table_.empty()) continue;
    const std::size_t place = begins_[symbol] >> table_shift_;
    while (filled < place) table_[++filled] = symbol - 1;
  }
  if (!table_.empty()) {
    table_[0] = 0;
    while (filled + 1 < table_.size()) table_[++filled] = symbols_ - 1;
  }
  cycle_ = std::min((5 * cycle_) >> 2, (symbols_ + 6) << 3);
  left_ = cycle_;
}

std::pair<std::uint32_t, std::uint32_t> SymbolModel::near(std::uint32_t place) const {
  if (table_.empty()) return {0, symbols_};
  const std::size_t slot = std::min<std::size_t>(place >> table_shift_, table_.size() - 2);
  return {table_[slot], table_[slot + 1] + 1};
}

ArithmeticDecoder::ArithmeticDecoder(std::string_view bytes) : bytes_(bytes) {
  for (int i = 0; i < 4; ++i) value_ = value_ << 8 | next_byte();
}

std::uint32_t ArithmeticDecoder::next_byte() {
  if (at_ < bytes_.size()) return static_cast<unsigned char>(bytes_[at_++]);
  if (++at_ > bytes_.size() + kMostBeyond) throw GarbledLaz();
  return 0;
}

void ArithmeticDecoder::renormalise() {
  while (length_ < kShortest) {
    value_ = value_ << 8 | next_byte();
    length_ <<= 8;
    if (length_ == 0) throw GarbledLaz();
  }
}

std::uint32_t ArithmeticDecoder::bit(BitModel& model) {
  const std::uint32_t zero = model.zero() * (length_ >> kBitShift);
  const bool is_one = value_ >= zero;
  if (is_one) {
    value_ -= zero;
    length_ -= zero;
  } else {
    length_ = zero;
    model.saw_zero();
  }
  renormalise();
  model.count();
  return is_one ? 1 : 0;
}

std::uint32_t ArithmeticDecoder::symbol(SymbolModel& model) {
  const std::uint32_t whole = length_;
  length_ >>= kSymbolShift;
  const std::uint32_t place = value_ / length_;
  auto [symbol, end] = model.near(place);
  while (end > symbol + 1) {
    const std::uint32_t middle = (symbol + end) >> 1;
    (model.begin(middle) > place ? end : symbol) = middle;
  }
  const std::uint32_t begin = model.begin(symbol) * length_;
  length_ = (symbol + 1 < model.symbols() ? model.begin(symbol + 1) * length_ : whole) - begin;
  value_ -= begin;
  renormalise();
  model.count(symbol);
  return symbol;
}

std::uint32_t ArithmeticDecoder::bits(std::uint32_t count) {
  if (count > 19) {
    const std::uint32_t low = bits(16);
    return bits(count - 16) << 16 | low;
  }
  length_ >>= count;
  const std::uint32_t found = value_ / length_;
  if (found >> count != 0) throw GarbledLaz();
  value_ -= length_ * found;
  renormalise();
  return found;
}

IntegerDecoder::IntegerDecoder(std::uint32_t bits, std::uint32_t contexts)
    : bits_(bits), lengths_(contexts, SymbolModel(bits + 1)) {
  for (std::uint32_t i = 1; i <= bits; ++i) high_.emplace_back(1u << std::min(i, kHighBits));
}

std::int32_t IntegerDecoder::next(ArithmeticDecoder& from, std::int32_t predicted, std::uint32_t context) {
  const std::uint32_t k = from.symbol(lengths_[context]);
  difference_bits_ = k;
  std::uint32_t difference = 0;
  if (k == 0) {
    difference = from.bit(short_);
  } else if (k == 32) {
    difference = 0x80000000u;
  } else {
    difference = from.symbol(high_[k - 1]);
    if (k > kHighBits) difference = difference << (k - kHighBits) | from.bits(k - kHighBits);
    // The lower half of the values are negative.
    difference = difference >= 1u << (k - 1) ? difference + 1 : difference - ((1u << k) - 1);
  }
  const std::uint32_t sum = static_cast<std::uint32_t>(predicted) + difference;
  if (bits_ == 32) return static_cast<std::int32_t>(sum);
  const auto value = static_cast<std::int32_t>(sum);
  const std::int32_t range = 1 << bits_;
  return value < 0 ? value + range : value >= range ? value - range : value;
}

void StreamingMedian::add(std::int32_t value) {
  // Insertion into five sorted values; the largest falls out after a value above the middle was asked for, and so on.
  auto& v = values_;
  if (at_high_end_) {
    at_high_end_ = value < v[2];
    v[4] = value;
    for (std::size_t i = 4; i > 0 && v[i] < v[i - 1]; --i) std::swap(v[i], v[i - 1]);
  } else {
    at_high_end_ = value <= v[2];
    v[0] = value;
    for (std::size_t i = 0; i < 4 && v[i] > v[i + 1]; ++i) std::swap(v[i], v[i + 1]);
  }
}

}  // namespace pointskin::io
