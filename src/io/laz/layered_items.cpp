// Parts of points of the formats 6 to 10.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "io/laz/items.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

template <class T>
void store(char* to, T value) {
  std::memcpy(to, &value, sizeof(T));
}

constexpr std::size_t kChannels = 4;

/// By the number of returns (rows) and the return's number: which returns are alike.
constexpr std::array<std::array<std::uint8_t, 16>, 16> kKinds{{{0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5},
                                                               {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
                                                               {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3},
                                                               {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
                                                               {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
                                                               {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
                                                               {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4},
                                                               {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
                                                               {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4},
                                                               {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
                                                               {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4},
                                                               {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
                                                               {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4},
                                                               {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
                                                               {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5},
                                                               {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5}}};

/// A layer of a chunk; what has none stays what it is.
struct Layer {
  bool is_there = false;
  ArithmeticDecoder from;

  void begin(std::string_view bytes) {
    is_there = !bytes.empty();
    if (is_there) from = ArithmeticDecoder(bytes);
  }
};

// Where values are in a point.
constexpr std::size_t kIntensity = 12, kReturns = 14, kFlags = 15, kClass = 16, kUser = 17, kAngle = 18, kSource = 20,
                      kTime = 22, kPointBytes = 30;

/// What is learnt of the points of a scanner channel.
struct PointContext {
  explicit PointContext(const char* item) {
    std::memcpy(last.data(), item, kPointBytes);
    heights.fill(load<std::int32_t>(item + 8, false));
    intensities.fill(load<std::uint16_t>(item + kIntensity, false));
    times.begin(load<std::uint64_t>(item + kTime, false));
  }

  [[nodiscard]] std::uint32_t at(std::size_t place) const { return static_cast<unsigned char>(last[place]); }
  void put(std::size_t place, std::uint32_t value) { last[place] = static_cast<char>(value & 255); }

  std::array<char, kPointBytes> last{};
  bool time_changed = false;
  std::vector<SymbolModel> changed = std::vector<SymbolModel>(8, SymbolModel(128));
  SymbolModel channel{3}, number_same_time{13};
  LazyModels<16> returns{16}, numbers{16};
  LazyModels<64> classes{256}, flags{64}, user{256};
  IntegerDecoder x{32, 2}, y{32, 22}, z{32, 20}, intensity{16, 4}, angle{16, 2}, source{16, 1};
  std::array<std::array<StreamingMedian, 12>, 2> medians{};
  std::array<std::int32_t, 8> heights{};
  std::array<std::uint16_t, 8> intensities{};
  LazTimes times{false};
};

class Point final : public LazLayeredItem {
 public:
  explicit Point(bool tells_changes_alone) : tells_changes_alone_(tells_changes_alone) {}
  [[nodiscard]] std::size_t bytes() const override { return kPointBytes; }
  [[nodiscard]] std::size_t layers() const override { return 9; }

  void begin(const char* item, const std::vector<std::string_view>& layers, std::size_t channel) override {
    std::array<Layer*, 9> all{&place_, &height_, &class_, &flags_, &intensity_, &angle_, &user_, &source_, &time_};
    for (std::size_t i = 0; i < all.size(); ++i) all[i]->begin(layers[i]);
    for (std::unique_ptr<PointContext>& context : contexts_) context.reset();
    channel_ = channel;
    contexts_[channel] = std::make_unique<PointContext>(item);
  }

  void next(char* item, std::size_t& channel) override {
    const PointContext& before = *contexts_[channel_];
    const std::uint32_t number = before.at(kReturns) & 15, of = before.at(kReturns) >> 4;
    const std::size_t which = (number == 1 ? 1u : 0u) + (number >= of ? 2u : 0u) + (before.time_changed ? 4u : 0u);
    const std::uint32_t changed = place_.from.symbol(contexts_[channel_]->changed[which]);
    const bool switches = (changed >> 6 & 1) != 0;
    if (switches) switch_channel();
    channel = switches || !tells_changes_alone_ ? channel_ : 0;
    PointContext& now = *contexts_[channel_];
    const bool new_time = (changed >> 4 & 1) != 0;
    decode_returns(now, changed, new_time);
    decode_place(now, new_time);
    decode_values(now, changed, new_time);
    now.time_changed = new_time;
    std::memcpy(item, now.last.data(), kPointBytes);
  }

 private:
  void switch_channel() {
    const std::size_t to = (channel_ + place_.from.symbol(contexts_[channel_]->channel) + 1) % kChannels;
    if (!contexts_[to]) contexts_[to] = std::make_unique<PointContext>(contexts_[channel_]->last.data());
    channel_ = to;
    PointContext& now = *contexts_[to];
    now.put(kFlags, (now.at(kFlags) & ~0x30u) | static_cast<std::uint32_t>(to) << 4);
  }

  void decode_returns(PointContext& now, std::uint32_t changed, bool new_time) {
    const std::uint32_t last_number = now.at(kReturns) & 15, last_of = now.at(kReturns) >> 4;
    const std::uint32_t of = changed & 4 ? place_.from.symbol(now.returns[last_of]) : last_of;
    std::uint32_t number = last_number;
    switch (changed & 3) {
      case 1:
        number = (last_number + 1) & 15;
        break;
      case 2:
        number = (last_number + 15) & 15;
        break;
      case 3:
        number = new_time ? place_.from.symbol(now.numbers[last_number])
                          : (last_number + place_.from.symbol(now.number_same_time) + 2) & 15;
        break;
      default:
        break;
    }
    now.put(kReturns, number | of << 4);
  }

  void decode_place(PointContext& now, bool new_time) {
    const std::uint32_t number = now.at(kReturns) & 15, of = now.at(kReturns) >> 4, single = of == 1 ? 1 : 0;
    const std::size_t kind = 2u * kKinds[of][number] + (new_time ? 1u : 0u);
    const auto move = [&](std::size_t axis, IntegerDecoder& by, std::uint32_t context) {
      StreamingMedian& median = now.medians[axis][kind];
      const std::int32_t step = by.next(place_.from, median.get(), context);
      median.add(step);
      const auto last = load<std::uint32_t>(now.last.data() + 4 * axis, false);
      store(now.last.data() + 4 * axis, last + static_cast<std::uint32_t>(step));
    };
    move(0, now.x, single);
    const std::uint32_t x_bits = now.x.difference_bits();
    move(1, now.y, single + (x_bits < 20 ? x_bits & ~1u : 20));
    if (!height_.is_there) return;
    const std::uint32_t bits = (x_bits + now.y.difference_bits()) / 2;
    std::int32_t& height = now.heights[std::min(7u, of > number ? of - number : number - of)];
    height = now.z.next(height_.from, height, single + (bits < 18 ? bits & ~1u : 18));
    store(now.last.data() + 8, height);
  }

  void decode_values(PointContext& now, std::uint32_t changed, bool new_time) {
    const std::uint32_t number = now.at(kReturns) & 15, of = now.at(kReturns) >> 4;
    const std::uint32_t end = (number == 1 ? 2u : 0u) + (number >= of ? 1u : 0u);  // 3: the only return
    if (class_.is_there)
      now.put(kClass, class_.from.symbol(now.classes[(now.at(kClass) & 31) << 1 | (end == 3 ? 1 : 0)]));
    if (flags_.is_there) decode_flags(now);
    if (intensity_.is_there) {
      std::uint16_t& intensity = now.intensities[end << 1 | (new_time ? 1 : 0)];
      intensity = static_cast<std::uint16_t>(now.intensity.next(intensity_.from, intensity, end));
      store(now.last.data() + kIntensity, intensity);
    }
    if (angle_.is_there && (changed >> 3 & 1)) {
      const std::int32_t last = load<std::int16_t>(now.last.data() + kAngle, false);
      store(now.last.data() + kAngle, static_cast<std::uint16_t>(now.angle.next(angle_.from, last, new_time ? 1 : 0)));
    }
    if (user_.is_there) now.put(kUser, user_.from.symbol(now.user[now.at(kUser) / 4]));
    if (source_.is_there && (changed >> 5 & 1)) {
      const std::int32_t last = load<std::uint16_t>(now.last.data() + kSource, false);
      store(now.last.data() + kSource, static_cast<std::uint16_t>(now.source.next(source_.from, last)));
    }
    if (time_.is_there && new_time) store(now.last.data() + kTime, now.times.next(time_.from));
  }

  /// The point has them in another order: class flags, channel, direction, edge.
  void decode_flags(PointContext& now) {
    const std::uint32_t last = (now.at(kFlags) & 15) | (now.at(kFlags) >> 6 & 3) << 4;
    const std::uint32_t flags = flags_.from.symbol(now.flags[last]);
    now.put(kFlags, (flags & 15) | (now.at(kFlags) & 0x30u) | (flags >> 4 & 3) << 6);
  }

  bool tells_changes_alone_;
  Layer place_, height_, class_, flags_, intensity_, angle_, user_, source_, time_;
  std::array<std::unique_ptr<PointContext>, kChannels> contexts_;
  std::size_t channel_ = 0;
};

/// What a part other than the point keeps for every channel. New channels begin as the one before.
template <class Context>
class Contexts {
 public:
  explicit Contexts(bool keeps_old) : keeps_old_(keeps_old) {}

  void begin(std::size_t channel, std::unique_ptr<Context> first) {
    for (std::unique_ptr<Context>& context : all_) context.reset();
    channel_ = channel;
    all_[channel] = std::move(first);
  }

  /// @param made  of a channel that comes for the first time
  template <class Make>
  Context& at(std::size_t channel, const Make& made) {
    if (channel == channel_) return *all_[channel];
    Context& old = *all_[channel_];
    const bool is_new = !all_[channel];
    if (is_new) all_[channel] = made(old);
    channel_ = channel;
    values_of_ = is_new || !keeps_old_ ? nullptr : &old;
    return *all_[channel];
  }

  /// The context whose last values count: once after a change of the channel, in old versions, that of the one before.
  Context& values(Context& now) {
    Context& of = values_of_ != nullptr ? *values_of_ : now;
    values_of_ = nullptr;
    return of;
  }

 private:
  bool keeps_old_;
  std::size_t channel_ = 0;
  Context* values_of_ = nullptr;
  std::array<std::unique_ptr<Context>, kChannels> all_;
};

struct ColourContext {
  std::array<std::uint16_t, 3> last{};
  std::uint16_t infrared = 0;
  LazColours colours;
  SymbolModel infrared_changed{4};
  std::array<SymbolModel, 2> infrared_bytes{SymbolModel(256), SymbolModel(256)};
};

class Colour final : public LazLayeredItem {
 public:
  Colour(bool with_infrared, bool keeps_old) : with_infrared_(with_infrared), contexts_(keeps_old) {}
  [[nodiscard]] std::size_t bytes() const override { return with_infrared_ ? 8 : 6; }
  [[nodiscard]] std::size_t layers() const override { return with_infrared_ ? 2 : 1; }

  void begin(const char* item, const std::vector<std::string_view>& layers, std::size_t channel) override {
    colour_.begin(layers[0]);
    if (with_infrared_) infrared_.begin(layers[1]);
    auto first = std::make_unique<ColourContext>();
    std::memcpy(first->last.data(), item, 6);
    if (with_infrared_) first->infrared = load<std::uint16_t>(item + 6, false);
    contexts_.begin(channel, std::move(first));
  }

  void next(char* item, std::size_t& channel) override {
    ColourContext& now = contexts_.at(channel, [](const ColourContext& old) {
      auto made = std::make_unique<ColourContext>();
      made->last = old.last;
      made->infrared = old.infrared;
      return made;
    });
    ColourContext& values = contexts_.values(now);
    if (colour_.is_there) now.colours.next(colour_.from, values.last);
    std::memcpy(item, values.last.data(), 6);
    if (!with_infrared_) return;
    if (infrared_.is_there) {
      const std::uint32_t changed = infrared_.from.symbol(now.infrared_changed);
      std::uint32_t low = values.infrared & 255u, high = values.infrared >> 8u;
      if (changed & 1) low = (low + infrared_.from.symbol(now.infrared_bytes[0])) & 255;
      if (changed & 2) high = (high + infrared_.from.symbol(now.infrared_bytes[1])) & 255;
      values.infrared = static_cast<std::uint16_t>(low | high << 8);
    }
    store(item + 6, values.infrared);
  }

 private:
  bool with_infrared_;
  Layer colour_, infrared_;
  Contexts<ColourContext> contexts_;
};

struct BytesContext {
  explicit BytesContext(const std::vector<char>& first) : last(first), models(first.size(), SymbolModel(256)) {}
  std::vector<char> last;
  std::vector<SymbolModel> models;
};

class Bytes final : public LazLayeredItem {
 public:
  Bytes(std::size_t count, bool keeps_old) : layers_(count), contexts_(keeps_old) {}
  [[nodiscard]] std::size_t bytes() const override { return layers_.size(); }
  [[nodiscard]] std::size_t layers() const override { return layers_.size(); }

  void begin(const char* item, const std::vector<std::string_view>& layers, std::size_t channel) override {
    for (std::size_t i = 0; i < layers_.size(); ++i) layers_[i].begin(layers[i]);
    contexts_.begin(channel, std::make_unique<BytesContext>(std::vector<char>(item, item + layers_.size())));
  }

  void next(char* item, std::size_t& channel) override {
    BytesContext& now =
        contexts_.at(channel, [](const BytesContext& old) { return std::make_unique<BytesContext>(old.last); });
    std::vector<char>& last = contexts_.values(now).last;
    for (std::size_t i = 0; i < layers_.size(); ++i)
      if (layers_[i].is_there)
        last[i] = static_cast<char>(static_cast<unsigned char>(last[i]) + layers_[i].from.symbol(now.models[i]));
    std::memcpy(item, last.data(), last.size());
  }

 private:
  std::vector<Layer> layers_;
  Contexts<BytesContext> contexts_;
};

class Skipped final : public LazLayeredItem {
 public:
  explicit Skipped(std::size_t bytes) : first_(bytes) {}
  [[nodiscard]] std::size_t bytes() const override { return first_.size(); }
  [[nodiscard]] std::size_t layers() const override { return 1; }
  void begin(const char* item, const std::vector<std::string_view>& /*layers*/, std::size_t /*channel*/) override {
    std::memcpy(first_.data(), item, first_.size());
  }
  void next(char* item, std::size_t& /*channel*/) override { std::memcpy(item, first_.data(), first_.size()); }

 private:
  std::vector<char> first_;
};

}  // namespace

std::unique_ptr<LazLayeredItem> make_laz_point14(bool keeps_old_context) {
  return std::make_unique<Point>(keeps_old_context);
}
std::unique_ptr<LazLayeredItem> make_laz_colour14(bool with_infrared, bool keeps_old_context) {
  return std::make_unique<Colour>(with_infrared, keeps_old_context);
}
std::unique_ptr<LazLayeredItem> make_laz_bytes14(std::size_t count, bool keeps_old_context) {
  return std::make_unique<Bytes>(count, keeps_old_context);
}
std::unique_ptr<LazLayeredItem> make_laz_skipped14(std::size_t bytes) { return std::make_unique<Skipped>(bytes); }

}  // namespace pointskin::io
