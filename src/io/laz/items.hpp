// The parts that LAZ compresses points in. Every part of a chunk's first point is stored as it is; the others follow from
// it. Source: M. Isenburg, "LASzip: lossless compression of LiDAR data" (PE&RS 2013), and the layout of LASzip 2 to 3.4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "io/laz/arithmetic.hpp"

namespace pointskin::io {

/// A part of every point, of the point-wise kind (point formats 0 to 5): all parts share one stream of bytes.
class LazItem {
 public:
  virtual ~LazItem() = default;
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Begins a chunk. @param item  of its first point
  virtual void begin(const char* item) = 0;
  /// The next one.
  virtual void next(ArithmeticDecoder& from, char* item) = 0;
};

std::unique_ptr<LazItem> make_laz_point();
std::unique_ptr<LazItem> make_laz_time();
std::unique_ptr<LazItem> make_laz_colour();
std::unique_ptr<LazItem> make_laz_bytes(std::size_t count);

/// The same for point formats 6 to 10: every kind of value has a stream of its own, a layer, which is empty if the value
/// is that of the first point throughout; models are kept for each of four scanner channels.
class LazLayeredItem {
 public:
  virtual ~LazLayeredItem() = default;
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  [[nodiscard]] virtual std::size_t layers() const = 0;
  /// Begins a chunk. @param layers  the bytes of each @param channel  of its first point
  virtual void begin(const char* item, const std::vector<std::string_view>& layers, std::size_t channel) = 0;
  /// @param channel  which the point decides, and other parts take
  virtual void next(char* item, std::size_t& channel) = 0;
};

/// @param keeps_old_context  as the versions of these items before 4 do it: the point tells the other parts its channel
///        only where it changes, and 0 elsewhere, and they take the last values of the channel before once
std::unique_ptr<LazLayeredItem> make_laz_point14(bool keeps_old_context);
std::unique_ptr<LazLayeredItem> make_laz_colour14(bool with_infrared, bool keeps_old_context);
std::unique_ptr<LazLayeredItem> make_laz_bytes14(std::size_t count, bool keeps_old_context);
/// Waveforms: their layers are passed over.
std::unique_ptr<LazLayeredItem> make_laz_skipped14(std::size_t bytes);

/// The scanner channel of a point of the formats 6 to 10.
inline std::size_t laz_channel(const char* point) { return static_cast<unsigned char>(point[15]) >> 4 & 3; }

/// Times of points: differences of up to four sequences.
class LazTimes {
 public:
  /// @param with_unchanged  there is a code for "the same", as the point-wise kind has it
  explicit LazTimes(bool with_unchanged);
  void begin(std::uint64_t first) { times_ = {first}; }
  std::uint64_t next(ArithmeticDecoder& from);

 private:
  bool take_from_rest(ArithmeticDecoder& from);
  bool take_from_motion(ArithmeticDecoder& from);
  std::int32_t scaled_difference(ArithmeticDecoder& from, std::int32_t code);
  void jump(ArithmeticDecoder& from);
  void count_extreme(std::int32_t difference);

  std::uint32_t same_;  ///< 1 if there is a code for that
  SymbolModel at_rest_, in_motion_;
  IntegerDecoder differences_;
  std::size_t last_ = 0, newest_ = 0;
  std::array<std::uint64_t, 4> times_{};
  std::array<std::int32_t, 4> steps_{}, extremes_{};
};

/// Colours of 16 bits, byte by byte.
class LazColours {
 public:
  LazColours();
  /// @param last  red, green and blue, which become the next ones
  void next(ArithmeticDecoder& from, std::array<std::uint16_t, 3>& last);

 private:
  std::uint32_t byte(ArithmeticDecoder& from, std::uint32_t changed, std::size_t which, std::int32_t predicted,
                     std::uint32_t last);

  SymbolModel changed_;
  std::vector<SymbolModel> bytes_;
};

}  // namespace pointskin::io
