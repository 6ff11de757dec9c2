#include "io/las/header.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/format.hpp"
#include "io/point_table.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

constexpr char kAgain[] = "copy or export it again";
constexpr std::size_t kSmallestHeader = 227;  ///< of LAS 1.0 to 1.2
constexpr std::size_t kHeader14 = 375;
constexpr std::size_t kRecordHead = 54;   ///< before each variable length record
constexpr std::size_t kExtraBytes = 192;  ///< that describe one extra value

template <class T>
T at(std::string_view bytes, std::size_t offset) {
  return load<T>(bytes.data() + offset, false);
}

/// Text of a fixed length, which ends at its first zero.
std::string text_at(std::string_view bytes, std::size_t offset, std::size_t length) {
  const std::string_view field = bytes.substr(offset, length);
  return std::string(field.substr(0, field.find('\0')));
}

class Parser {
 public:
  explicit Parser(const Source& source) : source_(source), bytes_(source.bytes) {}

  LasHeader parse() {
    if (!is_las(bytes_)) fail(source_, "does not begin as a LAS file", kAgain);
    require(kSmallestHeader, "in its header");
    check_version();
    read_points();
    read_places();
    read_records();
    return header_;
  }

 private:
  void require(std::size_t bytes, const char* where) const {
    if (bytes_.size() < bytes) fail_at_byte(source_, fmt::format("is truncated {}", where), bytes_.size(), kAgain);
  }

  void check_version() {
    const int major = at<std::uint8_t>(bytes_, 24);
    header_.minor = at<std::uint8_t>(bytes_, 25);
    if (major != 1 || header_.minor > 4)
      fail(source_, fmt::format("is of LAS {}.{}", major, header_.minor), "export it as LAS 1.0 to 1.4");
    if (header_.minor == 4) require(kHeader14, "in its header");
  }

  void read_points() {
    const int format = at<std::uint8_t>(bytes_, 104);
    header_.is_compressed = (format & 0xC0) != 0;
    header_.format = format & 0x3F;
    if (header_.format > 10)
      fail(source_, fmt::format("has points of the format {}", header_.format), "export it with a format from 0 to 10");
    header_.point_bytes = at<std::uint16_t>(bytes_, 105);
    if (header_.point_bytes < las_format(header_.format).bytes)
      fail(source_,
           fmt::format("has points of {} bytes, too few for the format {}", header_.point_bytes, header_.format),
           kAgain);
    header_.body = at<std::uint32_t>(bytes_, 96);
    header_.points = at<std::uint32_t>(bytes_, 107);
    if (header_.minor == 4 && at<std::uint64_t>(bytes_, 247) != 0) header_.points = at<std::uint64_t>(bytes_, 247);
    if (header_.body < kSmallestHeader || header_.body > bytes_.size())
      fail_at_byte(source_, "is truncated before its points", bytes_.size(), kAgain);
    if (!header_.is_compressed && !fits(header_.points, header_.point_bytes, bytes_.size() - header_.body))
      fail_at_byte(source_,
                   fmt::format("is truncated, {} points are promised, but the file ends before", header_.points),
                   bytes_.size(), kAgain);
  }

  void read_places() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      header_.scale[axis] = at<double>(bytes_, 131 + 8 * axis);
      header_.offset[axis] = at<double>(bytes_, 155 + 8 * axis);
      const bool is_scale = std::isfinite(header_.scale[axis]) && header_.scale[axis] != 0;
      if (!is_scale || !(std::abs(header_.offset[axis]) <= kLargestCoordinate))
        fail(source_, "has a scale or an offset of its coordinates that cannot be", kAgain);
    }
  }

  /// Variable length records between the header and the points.
  void read_records() {
    const std::uint32_t count = at<std::uint32_t>(bytes_, 100);
    std::size_t place = at<std::uint16_t>(bytes_, 94);
    for (std::uint32_t i = 0; i < count && place + kRecordHead <= header_.body; ++i) {
      const std::string user = text_at(bytes_, place + 2, 16);
      const auto id = at<std::uint16_t>(bytes_, place + 18);
      const std::size_t length = at<std::uint16_t>(bytes_, place + 20);
      place += kRecordHead;
      if (length > header_.body - place)
        fail_at_byte(source_, "has a record that ends behind its points", place, kAgain);
      const std::string_view record = bytes_.substr(place, length);
      if (user == "LASF_Spec" && id == 4) read_extras(record);
      if (user == "laszip encoded" && id == 22204) header_.compression = record;
      place += length;
    }
  }

  void read_extras(std::string_view record) {
    constexpr std::array kTypes{AttributeType::uint8,  AttributeType::int8,   AttributeType::uint16,
                                AttributeType::int16,  AttributeType::uint32, AttributeType::int32,
                                AttributeType::uint64, AttributeType::int64,  AttributeType::float32,
                                AttributeType::float64};
    std::size_t offset = las_format(header_.format).bytes;
    for (; record.size() >= kExtraBytes; record.remove_prefix(kExtraBytes)) {
      const std::size_t kind = at<std::uint8_t>(record, 2);
      const int options = at<std::uint8_t>(record, 3);
      // Types 11 to 30 are pairs and triples of these, which are deprecated; 0 is a number of bytes without a meaning.
      const std::size_t values = kind == 0 ? static_cast<std::size_t>(options) : (kind - 1) / kTypes.size() + 1;
      const AttributeType type = kind == 0 ? AttributeType::uint8 : kTypes[(kind - 1) % kTypes.size()];
      if (kind > 30 || offset + values * size_of(type) > header_.point_bytes) return;
      LasExtra extra{text_at(record, 4, 32), type, offset};
      if (options & 8) extra.scale = at<double>(record, 112);
      if (options & 16) extra.shift = at<double>(record, 136);
      if (kind > 0 && values == 1 && !extra.name.empty() && std::isfinite(extra.scale) && std::isfinite(extra.shift))
        header_.extras.push_back(extra);
      offset += values * size_of(type);
    }
  }

  const Source& source_;
  std::string_view bytes_;
  LasHeader header_;
};

}  // namespace

LasFormat las_format(int format) {
  switch (format) {
    case 0:
      return {20, false, {}, {}, {}, {}};
    case 1:
      return {28, false, 20, {}, {}, {}};
    case 2:
      return {26, false, {}, 20, {}, {}};
    case 3:
      return {34, false, 20, 28, {}, {}};
    case 4:
      return {57, false, 20, {}, {}, 28};
    case 5:
      return {63, false, 20, 28, {}, 34};
    case 6:
      return {30, true, 22, {}, {}, {}};
    case 7:
      return {36, true, 22, 30, {}, {}};
    case 8:
      return {38, true, 22, 30, 36, {}};
    case 9:
      return {59, true, 22, {}, {}, 30};
    default:
      return {67, true, 22, 30, 36, 38};
  }
}

bool is_las(std::string_view start) { return start.starts_with("LASF"); }

LasHeader parse_las_header(const Source& source) { return Parser(source).parse(); }

}  // namespace pointskin::io
