// BGEO, the particles of Houdini up to version 11 and of programs that write its files since (SPlisHSPlasH, Partio),
// version 5. Numbers are big endian. Source: "Geometry file formats", SideFX, and Partio's description of it.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "io/inflate.hpp"
#include "io/libraries.hpp"
#include "io/readers.hpp"

namespace pointskin::io {
namespace {

constexpr char kAgain[] = "copy or export it again";
constexpr std::string_view kMagic = "BgeoV";
constexpr std::int64_t kMostAttributes = 1024;
constexpr std::int64_t kMostComponents = 64;
constexpr std::int64_t kPositionBytes = 16;  ///< x, y, z and a weight

/// Values of one kind in every point, four bytes each.
struct BgeoAttribute {
  std::string name;
  AttributeType type = AttributeType::float32;
  std::int64_t count = 0;
  bool is_text = false;  ///< numbers of strings, which are passed over
};

class Parser {
 public:
  explicit Parser(const Source& source) : source_(source), left_(source.bytes) {}

  PointTable parse() {
    if (!left_.starts_with(kMagic)) fail(source_, "does not begin as a BGEO file of version 5", kAgain);
    left_.remove_prefix(kMagic.size());
    const std::int32_t version = take<std::int32_t>();
    if (version != 5) fail(source_, fmt::format("is of the version {} of BGEO", version), "save it as version 5");
    const std::int64_t points = take_count();
    for (int i = 0; i < 3; ++i) take_count();  // primitives and groups
    const std::int64_t attributes = take_count();
    for (int i = 0; i < 3; ++i) take_count();  // attributes of others
    if (attributes > kMostAttributes) fail_here("promises too many attributes");
    for (std::int64_t a = 0; a < attributes; ++a) attributes_.push_back(take_attribute());
    return table(points);
  }

 private:
  [[noreturn]] void fail_here(const std::string& what) const {
    fail_at_byte(source_, what, source_.bytes.size() - left_.size(), kAgain);
  }

  std::string_view take_bytes(std::size_t count) {
    if (count > left_.size()) fail_here("is truncated");
    const std::string_view bytes = left_.substr(0, count);
    left_.remove_prefix(count);
    return bytes;
  }

  template <class T>
  T take() {
    return load<T>(take_bytes(sizeof(T)).data(), true);
  }

  std::int64_t take_count() {
    const auto count = take<std::int32_t>();
    if (count < 0) fail_here("promises a negative number of things");
    return count;
  }

  std::string take_text() { return std::string(take_bytes(take<std::uint16_t>())); }

  BgeoAttribute take_attribute() {
    BgeoAttribute attribute{take_text(), AttributeType::float32, take<std::uint16_t>()};
    enum Kind { floats = 0, integers = 1, strings = 4, vectors = 5 };
    const std::int64_t kind = take_count();
    if (kind != floats && kind != integers && kind != strings && kind != vectors)
      fail_here(fmt::format("the attribute {} has the unknown type {}", in_quotes(attribute.name), kind));
    if (kind == integers || kind == strings) attribute.type = AttributeType::int32;
    attribute.is_text = kind == strings;
    if (attribute.is_text) {
      const std::int64_t words = take_count();
      for (std::int64_t i = 0; i < words; ++i) take_text();
    } else {
      take_bytes(4 * static_cast<std::size_t>(attribute.count));  // values of points that have none
    }
    return attribute;
  }

  PointTable table(std::int64_t points) {
    std::int64_t row_bytes = kPositionBytes;
    for (const BgeoAttribute& attribute : attributes_) row_bytes += 4 * attribute.count;
    if (!fits(static_cast<std::uint64_t>(points), static_cast<std::uint64_t>(row_bytes), left_.size()))
      fail_here(fmt::format("is truncated, {} points are promised, but the file ends before", points));
    PointTable table{points, {}};
    const char* data = left_.data();
    const auto add = [&](std::string name, AttributeType type, std::int64_t place) {
      table.columns.push_back({std::move(name), type, type, data + place, row_bytes, true});
    };
    for (std::int64_t axis = 0; axis < 3; ++axis) add(std::string(1, "xyz"[axis]), AttributeType::float32, 4 * axis);
    std::int64_t place = kPositionBytes;
    for (const BgeoAttribute& a : attributes_) {
      for (std::int64_t c = 0; c < a.count && !a.is_text && a.count <= kMostComponents; ++c)
        add(name_of(a, c), a.type, place + 4 * c);
      place += 4 * a.count;
    }
    return table;
  }

  /// Houdini's names of normals and colours as the other formats have them.
  static std::string name_of(const BgeoAttribute& attribute, std::int64_t component) {
    const auto axis = static_cast<std::size_t>(component);
    if (attribute.count == 1) return attribute.name;
    if (attribute.count == 3 && attribute.name == "N") return std::string("n") + "xyz"[axis];
    if (attribute.count == 3 && attribute.name == "Cd") return axis == 0 ? "red" : axis == 1 ? "green" : "blue";
    if (attribute.count == 3) return fmt::format("{}_{}", attribute.name, "xyz"[axis]);
    return fmt::format("{}_{}", attribute.name, component);
  }

  const Source& source_;
  std::string_view left_;
  std::vector<BgeoAttribute> attributes_;
};

}  // namespace

bool is_bgeo(std::string_view start) { return start.starts_with(kMagic); }

Cloud parse_bgeo(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  if (!is_gzip(source.bytes)) return assemble(ex, source, Parser(source).parse(), options.shift);
  if constexpr (!kHasZlib)
    fail(source, "is packed by gzip, and this build was made without zlib", "unpack it by gunzip");
  std::optional<std::string> unpacked;
  if constexpr (kHasZlib) unpacked = gunzip(source.bytes);
  if (!unpacked) fail(source, "is packed by gzip, and broken", kAgain);
  const Source inner{source.name, *unpacked};
  return assemble(ex, inner, Parser(inner).parse(), options.shift);
}

}  // namespace pointskin::io
