// LAS 1.0 to 1.4, points of all formats. Coordinates are whole numbers times the scale of the file, plus its offset.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "io/blocks.hpp"
#include "io/las/header.hpp"
#include "io/laz/decoder.hpp"
#include "io/readers.hpp"

namespace pointskin::io {
namespace {

/// Points one after the other, as they are in a file that is not compressed.
class LasTable {
 public:
  LasTable(exec::Cpu& ex, const LasHeader& header, const char* points)
      : ex_(ex), header_(header), format_(las_format(header.format)), points_(points) {
    table_.rows = static_cast<std::int64_t>(header.points);
    const Vec3d& s = header.scale;
    table_.resolution = std::min({std::abs(s.x), std::abs(s.y), std::abs(s.z)});
  }

  PointTable make() {
    add_coordinates();
    add_stored("intensity", AttributeType::uint16, 12);
    if (format_.is_extended)
      add_extended();
    else
      add_classic();
    if (format_.time) add_stored("gps_time", AttributeType::float64, *format_.time);
    if (format_.colour) add_colours();
    if (format_.infrared) add_stored("infrared", AttributeType::uint16, *format_.infrared);
    for (const LasExtra& extra : header_.extras) add_extra(extra);
    return std::move(table_);
  }

 private:
  [[nodiscard]] const char* point(std::int64_t row) const { return points_ + row * stride(); }
  [[nodiscard]] std::int64_t stride() const { return static_cast<std::int64_t>(header_.point_bytes); }

  /// A column that lies in the points as it is.
  void add_stored(std::string name, AttributeType type, std::size_t offset) {
    table_.columns.push_back({std::move(name), type, type, points_ + offset, stride()});
  }

  /// A column of values f(bytes of the point), made in parallel.
  template <class T, class F>
  void add_made(std::string name, const F& f) {
    constexpr std::int64_t kBlockRows = 1 << 14;
    made_.push_back(AttributeValues(type_of<T>(), static_cast<std::size_t>(table_.rows)));
    AttributeValues& own = made_.back();
    T* const values = own.edit<T>().data();
    ex_.run_blocks((table_.rows + kBlockRows - 1) / kBlockRows, [&](std::int64_t b) {
      for (std::int64_t row = b * kBlockRows; row < std::min(table_.rows, (b + 1) * kBlockRows); ++row)
        values[row] = static_cast<T>(f(point(row)));
    });
    table_.columns.push_back(
        {std::move(name), type_of<T>(), type_of<T>(), reinterpret_cast<const char*>(values), sizeof(T)});
  }

  /// Bits of a byte.
  void add_bits(std::string name, std::size_t offset, int first, int count) {
    add_made<std::uint8_t>(std::move(name), [offset, first, mask = (1 << count) - 1](const char* p) {
      return load<std::uint8_t>(p + offset, false) >> first & mask;
    });
  }

  void add_coordinates() {
    constexpr std::array kNames{"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis)
      add_made<double>(kNames[axis], [scale = header_.scale[axis], offset = header_.offset[axis], axis](const char* p) {
        return load<std::int32_t>(p + 4 * axis, false) * scale + offset;
      });
  }

  /// Formats 0 to 5.
  void add_classic() {
    add_bits("return_number", 14, 0, 3);
    add_bits("number_of_returns", 14, 3, 3);
    add_bits("classification", 15, 0, 5);
    add_stored("scan_angle", AttributeType::int8, 16);
    add_stored("user_data", AttributeType::uint8, 17);
    add_stored("point_source_id", AttributeType::uint16, 18);
  }

  /// Formats 6 to 10.
  void add_extended() {
    add_bits("return_number", 14, 0, 4);
    add_bits("number_of_returns", 14, 4, 4);
    add_stored("classification", AttributeType::uint8, 16);
    constexpr double kDegrees = 0.006;
    add_made<float>("scan_angle", [](const char* p) { return kDegrees * load<std::int16_t>(p + 18, false); });
    add_stored("user_data", AttributeType::uint8, 17);
    add_stored("point_source_id", AttributeType::uint16, 20);
  }

  /// The standard wants the whole range of 16 bits. Many files have bytes, as they are or 256 or 257 times as large: then
  /// colours are uint8.
  void add_colours() {
    constexpr std::array kNames{"red", "green", "blue"};
    const int factor = colour_factor();
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t offset = *format_.colour + 2 * c;
      if (factor == 0)
        add_stored(kNames[c], AttributeType::uint16, offset);
      else
        add_made<std::uint8_t>(
            kNames[c], [offset, factor](const char* p) { return load<std::uint16_t>(p + offset, false) / factor; });
    }
  }

  /// 1, 256 or 257 if all colours are so many times a byte; 0: none of them.
  [[nodiscard]] int colour_factor() const {
    bool is_byte = true, is_shifted = true, is_spread = true;
    for (std::int64_t row = 0; row < table_.rows && (is_byte || is_shifted || is_spread); ++row)
      for (std::size_t c = 0; c < 3; ++c) {
        const int v = load<std::uint16_t>(point(row) + *format_.colour + 2 * c, false);
        is_byte = is_byte && v < 256;
        is_shifted = is_shifted && v % 256 == 0;
        is_spread = is_spread && v % 257 == 0;
      }
    return is_byte ? 1 : is_spread ? 257 : is_shifted ? 256 : 0;
  }

  void add_extra(const LasExtra& extra) {
    const auto is_taken = [&](const Column& c) { return c.name == extra.name; };
    if (std::any_of(table_.columns.begin(), table_.columns.end(), is_taken)) return;
    if (!extra.is_scaled()) return add_stored(extra.name, extra.type, extra.offset);
    add_made<double>(extra.name, [&extra](const char* p) {
      return extra.shift + extra.scale * visit_type(extra.type, [&](auto tag) {
                             return static_cast<double>(load<decltype(tag)>(p + extra.offset, false));
                           });
    });
  }

  exec::Cpu& ex_;
  const LasHeader& header_;
  LasFormat format_;
  const char* points_;
  PointTable table_;
  std::deque<AttributeValues> made_;
};

}  // namespace

Cloud parse_las(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const LasHeader header = parse_las_header(source);
  std::string own;
  if (header.is_compressed) own = unpack_laz(ex, source, header);
  LasTable table(ex, header, header.is_compressed ? own.data() : source.bytes.data() + header.body);
  return assemble(ex, source, table.make(), options.shift);
}

}  // namespace pointskin::io
