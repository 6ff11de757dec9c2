// Parts of points of the formats 0 to 5.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "io/laz/items.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

template <class T>
void store(char* to, T value) {
  std::memcpy(to, &value, sizeof(T));
}

/// By the number of returns (rows) and the return's number: which returns are alike.
constexpr std::array<std::array<std::uint8_t, 8>, 8> kKinds{{{15, 14, 13, 12, 11, 10, 9, 8},
                                                             {14, 0, 1, 3, 6, 10, 10, 9},
                                                             {13, 1, 2, 4, 7, 11, 11, 10},
                                                             {12, 3, 4, 5, 8, 12, 12, 11},
                                                             {11, 6, 7, 8, 9, 13, 13, 12},
                                                             {10, 10, 11, 12, 13, 14, 14, 13},
                                                             {9, 10, 11, 12, 13, 14, 15, 14},
                                                             {8, 9, 10, 11, 12, 13, 14, 15}}};

/// Position, intensity, returns, class, angle, user data and source.
class Point final : public LazItem {
 public:
  [[nodiscard]] std::size_t bytes() const override { return last_.size(); }

  void begin(const char* item) override {
    std::memcpy(last_.data(), item, last_.size());
    store<std::uint16_t>(last_.data() + kIntensity, 0);
  }

  void next(ArithmeticDecoder& from, char* item) override {
    const std::uint32_t changed = from.symbol(changed_);
    if (changed & 32) put(kReturns, from.symbol(returns_[at(kReturns)]));
    const std::size_t number = at(kReturns) & 7, of = at(kReturns) >> 3 & 7;
    kind_ = kKinds[of][number];
    const std::size_t level = of > number ? of - number : number - of;
    decode_intensity(from, changed);
    if (changed & 8) put(kClass, from.symbol(classes_[at(kClass)]));
    if (changed & 4) put(kAngle, at(kAngle) + from.symbol(angles_[at(kReturns) >> 6 & 1]));
    if (changed & 2) put(kUser, from.symbol(user_[at(kUser)]));
    if (changed & 1) {
      const std::int32_t last = load<std::uint16_t>(last_.data() + kSource, false);
      store(last_.data() + kSource, static_cast<std::uint16_t>(sources_.next(from, last)));
    }
    decode_place(from, of == 1 ? 1 : 0, level);
    std::memcpy(item, last_.data(), last_.size());
  }

 private:
  static constexpr std::size_t kIntensity = 12, kReturns = 14, kClass = 15, kAngle = 16, kUser = 17, kSource = 18;

  [[nodiscard]] std::uint32_t at(std::size_t place) const { return static_cast<unsigned char>(last_[place]); }
  void put(std::size_t place, std::uint32_t value) { last_[place] = static_cast<char>(value & 255); }

  void decode_intensity(ArithmeticDecoder& from, std::uint32_t changed) {
    std::uint16_t& intensity = intensities_[kind_];
    if (changed & 16)
      intensity = static_cast<std::uint16_t>(
          brightness_.next(from, intensity, static_cast<std::uint32_t>(std::min<std::size_t>(kind_, 3))));
    store(last_.data() + kIntensity, intensity);
  }

  void decode_place(ArithmeticDecoder& from, std::uint32_t single, std::size_t level) {
    const auto move = [&](std::size_t axis, IntegerDecoder& by, std::uint32_t context) {
      StreamingMedian& median = medians_[axis][kind_];
      const std::int32_t step = by.next(from, median.get(), context);
      median.add(step);
      const auto last = load<std::uint32_t>(last_.data() + 4 * axis, false);
      store(last_.data() + 4 * axis, last + static_cast<std::uint32_t>(step));
    };
    move(0, x_, single);
    const std::uint32_t x_bits = x_.difference_bits();
    move(1, y_, single + (x_bits < 20 ? x_bits & ~1u : 20));
    const std::uint32_t bits = (x_bits + y_.difference_bits()) / 2;
    heights_[level] = z_.next(from, heights_[level], single + (bits < 18 ? bits & ~1u : 18));
    store(last_.data() + 8, heights_[level]);
  }

  std::array<char, 20> last_{};
  std::size_t kind_ = 0;
  SymbolModel changed_{64};
  LazyModels<256> returns_{256}, classes_{256}, user_{256};
  std::array<SymbolModel, 2> angles_{SymbolModel(256), SymbolModel(256)};
  IntegerDecoder brightness_{16, 4}, sources_{16, 1}, x_{32, 2}, y_{32, 22}, z_{32, 20};
  std::array<std::uint16_t, 16> intensities_{};
  std::array<std::array<StreamingMedian, 16>, 2> medians_{};
  std::array<std::int32_t, 8> heights_{};
};

class Time final : public LazItem {
 public:
  [[nodiscard]] std::size_t bytes() const override { return 8; }
  void begin(const char* item) override { times_.begin(load<std::uint64_t>(item, false)); }
  void next(ArithmeticDecoder& from, char* item) override { store(item, times_.next(from)); }

 private:
  LazTimes times_{true};
};

class Colour final : public LazItem {
 public:
  [[nodiscard]] std::size_t bytes() const override { return sizeof(last_); }
  void begin(const char* item) override { std::memcpy(last_.data(), item, sizeof(last_)); }
  void next(ArithmeticDecoder& from, char* item) override {
    colours_.next(from, last_);
    std::memcpy(item, last_.data(), sizeof(last_));
  }

 private:
  std::array<std::uint16_t, 3> last_{};
  LazColours colours_;
};

/// Bytes whose meaning the compression does not know.
class Bytes final : public LazItem {
 public:
  explicit Bytes(std::size_t count) : last_(count), models_(count, SymbolModel(256)) {}
  [[nodiscard]] std::size_t bytes() const override { return last_.size(); }
  void begin(const char* item) override { std::memcpy(last_.data(), item, last_.size()); }
  void next(ArithmeticDecoder& from, char* item) override {
    for (std::size_t i = 0; i < last_.size(); ++i)
      last_[i] = static_cast<char>(static_cast<unsigned char>(last_[i]) + from.symbol(models_[i]));
    std::memcpy(item, last_.data(), last_.size());
  }

 private:
  std::vector<char> last_;
  std::vector<SymbolModel> models_;
};

}  // namespace

std::unique_ptr<LazItem> make_laz_point() { return std::make_unique<Point>(); }
std::unique_ptr<LazItem> make_laz_time() { return std::make_unique<Time>(); }
std::unique_ptr<LazItem> make_laz_colour() { return std::make_unique<Colour>(); }
std::unique_ptr<LazItem> make_laz_bytes(std::size_t count) { return std::make_unique<Bytes>(count); }

}  // namespace pointskin::io
