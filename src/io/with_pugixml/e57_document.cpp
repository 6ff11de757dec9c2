#include "io/with_pugixml/e57_document.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include <pugixml.hpp>

#include "core/format.hpp"
#include "io/number.hpp"
#include "io/point_table.hpp"

namespace pointskin::io {
namespace {

constexpr std::size_t kMostFields = 64;  ///< keeps searches and memory small on garbled files

class Document {
 public:
  Document(const Source& source, const E57Pages& pages) : source_(source) {
    const pugi::xml_parse_result result = document_.load_buffer(pages.xml.data(), pages.xml.size());
    if (!result) fail(source, std::string("its XML is garbled, ") + result.description(), kE57Again);
  }

  std::vector<E57Scan> scans() const {
    std::vector<E57Scan> all;
    for (const pugi::xml_node& node : document_.child("e57Root").child("data3D").children()) {
      E57Scan scan = scan_of(node);
      if (scan.records > 0) all.push_back(std::move(scan));
    }
    return all;
  }

 private:
  E57Scan scan_of(const pugi::xml_node& node) const {
    const pugi::xml_node points = node.child("points");
    E57Scan scan;
    scan.records = whole(points.attribute("recordCount"), std::uint64_t{0});
    if (scan.records == 0) return scan;
    scan.place = whole(points.attribute("fileOffset"), std::uint64_t{0});
    for (const pugi::xml_node& field : points.child("prototype").children()) {
      if (field.type() != pugi::node_element) continue;
      if (scan.fields.size() == kMostFields) fail(source_, "has points of too many values", "export fewer of them");
      scan.fields.push_back(field_of(field));
    }
    scan.pose = pose_of(node.child("pose"));
    for (std::size_t c = 0; c < 3; ++c) scan.colour_limits[c] = limits_of(scan, node.child("colorLimits"), c);
    return scan;
  }

  E57Field field_of(const pugi::xml_node& node) const {
    const std::string_view type = node.attribute("type").value();
    E57Field field;
    field.name = node.name();
    if (type == "Integer" || type == "ScaledInteger") {
      field.coding = type == "Integer" ? E57Coding::integer : E57Coding::scaled;
      field.minimum = whole(node.attribute("minimum"), field.minimum);
      field.maximum = whole(node.attribute("maximum"), field.maximum);
      if (field.minimum > field.maximum) fail_field(field, "has a minimum above its maximum");
    } else if (type == "Float") {
      field.coding =
          std::strcmp(node.attribute("precision").value(), "single") == 0 ? E57Coding::float32 : E57Coding::float64;
    } else if (type == "String") {
      field.coding = E57Coding::text;
    } else {
      fail_field(field, "is of the type " + in_quotes(type));
    }
    if (field.coding != E57Coding::scaled) return field;
    field.scale = number(node.attribute("scale").value(), 1);
    field.offset = number(node.attribute("offset").value(), 0);
    return field;
  }

  E57Pose pose_of(const pugi::xml_node& node) const {
    E57Pose pose;
    const auto part = [&](const char* of, const char* axis) {
      return number(node.child(of).child(axis).child_value(), 0);
    };
    if (node.child("translation"))
      pose.translation = {part("translation", "x"), part("translation", "y"), part("translation", "z")};
    if (!node.child("rotation")) return pose;
    double w = part("rotation", "w");
    Vec3d q{part("rotation", "x"), part("rotation", "y"), part("rotation", "z")};
    const double length = std::sqrt(w * w + q.x * q.x + q.y * q.y + q.z * q.z);
    if (!(length > 0) || !std::isfinite(length)) fail(source_, "has a pose without a rotation", kE57Again);
    w /= length;
    q = q * (1 / length);
    pose.rotation = {{{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - w * q.z), 2 * (q.x * q.z + w * q.y)},
                      {2 * (q.x * q.y + w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - w * q.x)},
                      {2 * (q.x * q.z - w * q.y), 2 * (q.y * q.z + w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)}}};
    return pose;
  }

  /// What the scan says, else the ends of the integers that the field may hold, else those of bytes.
  std::array<double, 2> limits_of(const E57Scan& scan, const pugi::xml_node& node, std::size_t channel) const {
    constexpr std::array kNames{"colorRed", "colorGreen", "colorBlue"};
    const std::string name = kNames[channel];
    std::array<double, 2> limits{0, 255};
    const auto field = scan.find(name);
    if (field && scan.fields[*field].coding == E57Coding::integer &&
        scan.fields[*field].type() != AttributeType::float64)
      limits = {static_cast<double>(scan.fields[*field].minimum), static_cast<double>(scan.fields[*field].maximum)};
    const double black = number(node.child((name + "Minimum").c_str()).child_value(), limits[0]);
    const double white = number(node.child((name + "Maximum").c_str()).child_value(), limits[1]);
    return white > black ? std::array{black, white} : std::array{0.0, 255.0};
  }

  template <class Whole>
  Whole whole(const pugi::xml_attribute& attribute, Whole otherwise) const {
    const std::string_view text = attribute.value();
    if (text.empty()) return otherwise;
    Whole value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
      fail(source_,
           fmt::format("its XML has the {} {}, which is no whole number", in_quotes(attribute.name()), in_quotes(text)),
           kE57Again);
    return value;
  }

  /// @param otherwise  for no text at all
  double number(std::string_view text, double otherwise) const {
    while (!text.empty() && (is_blank(text.front()) || text.front() == '\n')) text.remove_prefix(1);
    while (!text.empty() && (is_blank(text.back()) || text.back() == '\n')) text.remove_suffix(1);
    if (text.empty()) return otherwise;
    double value = 0;
    const char* const end = text.data() + text.size();
    if (parse_number(text.data(), end, value) != end || !(std::abs(value) <= kLargestCoordinate))
      fail(source_, fmt::format("its XML has {} where a number must be", in_quotes(text)), kE57Again);
    return value;
  }

  [[noreturn]] void fail_field(const E57Field& field, const std::string& what) const {
    fail(source_, fmt::format("the value {} of its points {}", in_quotes(field.name), what), kE57Again);
  }

  const Source& source_;
  pugi::xml_document document_;
};

}  // namespace

unsigned E57Field::bits() const {
  if (coding == E57Coding::float32) return 32;
  if (coding == E57Coding::float64) return 64;
  if (coding == E57Coding::text) return 0;
  std::uint64_t most = static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(minimum);
  unsigned count = 0;
  for (; most > 0; most >>= 1) ++count;
  return count;
}

AttributeType E57Field::type() const {
  if (coding == E57Coding::float32) return AttributeType::float32;
  if (coding != E57Coding::integer) return AttributeType::float64;
  const auto holds = [&](AttributeType type) {
    return visit_type(type, [&](auto tag) {
      using T = decltype(tag);
      if constexpr (std::is_integral_v<T>) return std::in_range<T>(minimum) && std::in_range<T>(maximum);
      return false;
    });
  };
  using enum AttributeType;
  for (const AttributeType type : {uint8, int8, uint16, int16, uint32, int32})
    if (holds(type)) return type;
  constexpr std::int64_t kExact = std::int64_t{1} << 53;
  return minimum >= -kExact && maximum <= kExact ? int64 : float64;
}

Vec3d E57Pose::rotated(const Vec3d& v) const {
  Vec3d turned{};
  for (std::size_t row = 0; row < 3; ++row)
    turned[row] = rotation[row].x * v.x + rotation[row].y * v.y + rotation[row].z * v.z;
  return turned;
}

std::optional<std::size_t> E57Scan::find(const std::string& name) const {
  const auto at = std::find_if(fields.begin(), fields.end(), [&](const E57Field& f) { return f.name == name; });
  if (at == fields.end()) return std::nullopt;
  return static_cast<std::size_t>(at - fields.begin());
}

std::optional<std::array<std::size_t, 3>> E57Scan::find(const std::array<const char*, 3>& names) const {
  std::array<std::size_t, 3> found{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = find(std::string(names[axis]));
    if (!at) return std::nullopt;
    found[axis] = *at;
  }
  return found;
}

std::vector<E57Scan> parse_e57_document(const Source& source, const E57Pages& pages) {
  return Document(source, pages).scans();
}

}  // namespace pointskin::io
