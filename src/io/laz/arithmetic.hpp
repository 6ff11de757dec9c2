// The arithmetic coding of LAZ. Source: A. Said, "Introduction to Arithmetic Coding - Theory and Practice", HP Labs
// HPL-2004-76, with the constants of M. Isenburg, "LASzip: lossless compression of LiDAR data" (PE&RS 2013).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace pointskin::io {

/// Thrown where compressed bytes cannot be what an encoder made.
struct GarbledLaz {};

/// How probable a zero bit is, learnt from those before.
class BitModel {
 public:
  [[nodiscard]] std::uint32_t zero() const { return zero_; }
  void saw_zero() { ++zeros_; }
  void count() {
    if (--left_ == 0) update();
  }

 private:
  void update();

  std::uint32_t zeros_ = 1, seen_ = 2, zero_ = 1u << 12, cycle_ = 4, left_ = 4;
};

/// How probable each of 2 to 2048 symbols is, learnt from those before.
class SymbolModel {
 public:
  explicit SymbolModel(std::uint32_t symbols);

  [[nodiscard]] std::uint32_t symbols() const { return symbols_; }
  /// Where the share of a symbol begins, in [0, 2^15).
  [[nodiscard]] std::uint32_t begin(std::uint32_t symbol) const { return begins_[symbol]; }
  /// A range [first, last) of symbols that holds the one at `place` in [0, 2^15].
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> near(std::uint32_t place) const;
  void count(std::uint32_t symbol) {
    ++counts_[symbol];
    if (--left_ == 0) update();
  }

 private:
  void update();

  std::uint32_t symbols_, total_ = 0, cycle_, left_ = 0, table_shift_ = 0;
  std::vector<std::uint32_t> begins_, counts_, table_;
};

/// Models that are made when they are first asked for.
template <std::size_t kCount>
class LazyModels {
 public:
  explicit LazyModels(std::uint32_t symbols) : symbols_(symbols) {}
  SymbolModel& operator[](std::size_t i) {
    if (!models_[i]) models_[i] = std::make_unique<SymbolModel>(symbols_);
    return *models_[i];
  }

 private:
  std::uint32_t symbols_;
  std::array<std::unique_ptr<SymbolModel>, kCount> models_;
};

/// Decodes bits and symbols from bytes, which must outlive it. All functions throw GarbledLaz.
class ArithmeticDecoder {
 public:
  ArithmeticDecoder() = default;  ///< of no bytes: decoding soon throws GarbledLaz
  explicit ArithmeticDecoder(std::string_view bytes);

  std::uint32_t bit(BitModel& model);
  std::uint32_t symbol(SymbolModel& model);
  /// @param count  1 to 32
  std::uint32_t bits(std::uint32_t count);

 private:
  void renormalise();
  std::uint32_t next_byte();

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::uint32_t value_ = 0, length_ = std::numeric_limits<std::uint32_t>::max();
};

/// Decodes integers by what they differ from a prediction.
class IntegerDecoder {
 public:
  /// @param bits  of the integers, 16 or 32
  IntegerDecoder(std::uint32_t bits, std::uint32_t contexts);

  std::int32_t next(ArithmeticDecoder& from, std::int32_t predicted, std::uint32_t context = 0);
  /// The bits that the newest difference had.
  [[nodiscard]] std::uint32_t difference_bits() const { return difference_bits_; }

 private:
  std::uint32_t bits_, difference_bits_ = 0;
  std::vector<SymbolModel> lengths_;
  BitModel short_;
  std::vector<SymbolModel> high_;
};

/// The middle of the five values that came last, roughly: they are replaced from both ends in turn.
class StreamingMedian {
 public:
  [[nodiscard]] std::int32_t get() const { return values_[2]; }
  void add(std::int32_t value);

 private:
  std::array<std::int32_t, 5> values_{};
  bool at_high_end_ = true;
};

}  // namespace pointskin::io
