// E57, scans of the ASTM's standard E2807: all scans of a file where their poses put them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exec/host_array.hpp"
#include "io/blocks.hpp"
#include "io/parsed_columns.hpp"
#include "io/readers.hpp"
#include "io/scans.hpp"
#include "io/with_pugixml/e57_document.hpp"
#include "io/with_pugixml/e57_pages.hpp"
#include "io/with_pugixml/e57_streams.hpp"

namespace pointskin::io {
namespace {

constexpr std::array kCartesian{"cartesianX", "cartesianY", "cartesianZ"};
constexpr std::array kSpherical{"sphericalRange", "sphericalAzimuth", "sphericalElevation"};
constexpr std::array kNormal{"nor:normalX", "nor:normalY", "nor:normalZ"};
constexpr std::array kColours{std::pair{"colorRed", "red"}, std::pair{"colorGreen", "green"},
                              std::pair{"colorBlue", "blue"}};
constexpr std::size_t kMostAttributes = 64;  ///< of all scans together

using Names = std::array<const char*, 3>;
using TypedNames = std::vector<std::pair<std::string, AttributeType>>;

bool is_among(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Calls channel(0 to 2) if the field is a colour's.
template <class F>
bool if_colour(const std::string& field, const F& channel) {
  for (std::size_t c = 0; c < kColours.size(); ++c)
    if (field == kColours[c].first) return channel(c), true;
  return false;
}

/// What the attribute of a field is called; empty: it has none. Fields that say which values are invalid have none, nor
/// have those that are the same for all points.
std::string attribute_of(const E57Field& field) {
  std::string name = field.name;
  if (if_colour(field.name, [&](std::size_t c) { name = kColours[c].second; })) return name;
  const bool is_flag = name.ends_with("Invalid") || name.ends_with("InvalidState");
  const bool is_place = is_among(kCartesian, name) || is_among(kSpherical, name) || is_among(kNormal, name);
  return is_flag || is_place || field.bits() == 0 ? std::string() : name;
}

/// A colour as a byte, by what the scan says is black and white.
double colour_byte(double value, const std::array<double, 2>& limits) {
  const double share = (value - limits[0]) / (limits[1] - limits[0]);
  return std::isfinite(share) ? std::round(255 * std::clamp(share, 0.0, 1.0)) : 0;
}

class E57Points {
 public:
  E57Points(const Source& source, const E57Pages& pages, std::vector<E57Scan> scans)
      : source_(source), pages_(pages), scans_(std::move(scans)) {}

  Cloud read(exec::Cpu& ex, const ReadOptions& options) {
    check_records();
    const auto count = static_cast<std::int64_t>(scans_.size());
    streams_.resize(scans_.size());
    run_in_order(ex, count, [&](std::int64_t s) {
      const auto scan = static_cast<std::size_t>(s);
      streams_[scan] = read_e57_streams(source_, pages_, scans_[scan]);
    });
    lay_out(ex);
    for (std::size_t s = 0; s < scans_.size(); ++s) {
      read_places(ex, s);
      read_attributes(ex, s);
      streams_[s].clear();
    }
    return assemble_scans(ex, source_, table(), described(), options.shift);
  }

 private:
  /// Many scans of a small file must not name the same bytes again and again.
  void check_records() const {
    std::uint64_t left = pages_.bytes.size();
    for (const E57Scan& scan : scans_) {
      if (scan.records > left)
        fail(source_, "its scans promise more points than it has bytes", "copy or export it again");
      left -= scan.records;
    }
  }

  /// Makes the columns, which have a row for each point of each scan.
  void lay_out(exec::Cpu& ex) {
    TypedNames types;
    has_normals_ = true;
    for (const E57Scan& scan : scans_) {
      first_.push_back(rows_);
      rows_ += static_cast<std::int64_t>(scan.records);
      has_normals_ = has_normals_ && scan.find(kNormal).has_value();
      for (const E57Field& field : scan.fields) add_type(field, types);
    }
    if (types.size() > kMostAttributes) fail(source_, "has points of too many values", "export fewer of them");
    for (const auto& [name, type] : types) attributes_.add(name, type);
    attributes_.allocate(rows_);
    for (std::vector<double>& axis : position_) exec::resize(ex, axis, static_cast<std::size_t>(rows_));
    if (!has_normals_) return;
    for (std::vector<float>& axis : normal_) exec::resize(ex, axis, static_cast<std::size_t>(rows_));
  }

  static void add_type(const E57Field& field, TypedNames& types) {
    const std::string name = attribute_of(field);
    if (name.empty()) return;
    const bool is_colour = if_colour(field.name, [](std::size_t) {});
    const AttributeType type = is_colour ? AttributeType::uint8 : field.type();
    const auto at = std::find_if(types.begin(), types.end(), [&](const auto& known) { return known.first == name; });
    if (at == types.end())
      types.emplace_back(name, type);
    else
      at->second = common_type(at->second, type);
  }

  /// The column that the values of a field go to.
  [[nodiscard]] std::optional<std::size_t> column_of(const E57Field& field) const {
    const std::string name = attribute_of(field);
    for (std::size_t column = 0; column < attributes_.size(); ++column)
      if (attributes_.name(column) == name) return column;
    return std::nullopt;
  }

  /// Calls f(record of the scan, row of the columns) for all points, in parallel.
  template <class F>
  void for_each_record(exec::Cpu& ex, std::size_t scan, const F& f) const {
    constexpr std::uint64_t kBlock = 1 << 14;
    const std::uint64_t records = scans_[scan].records;
    run_in_order(ex, static_cast<std::int64_t>((records + kBlock - 1) / kBlock), [&](std::int64_t block) {
      const std::uint64_t begin = static_cast<std::uint64_t>(block) * kBlock;
      for (std::uint64_t i = begin; i < std::min(records, begin + kBlock); ++i)
        f(i, first_[scan] + static_cast<std::int64_t>(i));
    });
  }

  [[nodiscard]] Vec3d vector_of(std::size_t scan, const std::array<std::size_t, 3>& fields, std::uint64_t i) const {
    Vec3d v{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      v[axis] = e57_value(scans_[scan].fields[fields[axis]], streams_[scan][fields[axis]], i);
    return v;
  }

  void read_places(exec::Cpu& ex, std::size_t s) {
    const E57Scan& scan = scans_[s];
    const auto cartesian = scan.find(kCartesian);
    const auto fields = cartesian ? cartesian : scan.find(kSpherical);
    if (!fields) fail(source_, "has a scan without coordinates", "export it with cartesian ones");
    for (const std::size_t field : *fields)
      if (scan.fields[field].coding == E57Coding::text) fail(source_, "has coordinates that are text", kE57Again);
    const auto invalid = scan.find(std::string(cartesian ? "cartesianInvalidState" : "sphericalInvalidState"));
    const auto normal = has_normals_ ? scan.find(kNormal) : std::nullopt;
    for_each_record(ex, s, [&](std::uint64_t i, std::int64_t row) {
      const auto at = static_cast<std::size_t>(row);
      Vec3d p = vector_of(s, *fields, i);
      if (!cartesian) p = Vec3d{std::cos(p.z) * std::cos(p.y), std::cos(p.z) * std::sin(p.y), std::sin(p.z)} * p.x;
      p = scan.pose.rotated(p) + scan.pose.translation;
      const bool is_empty = invalid && e57_value(scan.fields[*invalid], streams_[s][*invalid], i) != 0;
      for (std::size_t axis = 0; axis < 3; ++axis) position_[axis][at] = is_empty ? kNone : without_nan(p[axis]);
      if (!normal) return;
      const Vec3d n = scan.pose.rotated(vector_of(s, *normal, i));
      for (std::size_t axis = 0; axis < 3; ++axis) normal_[axis][at] = to_float(n[axis]);
    });
  }

  /// NaN marks directions without a point, and not points that are bad.
  static double without_nan(double value) {
    return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
  }

  void read_attributes(exec::Cpu& ex, std::size_t s) {
    for (std::size_t f = 0; f < scans_[s].fields.size(); ++f) {
      const E57Field& field = scans_[s].fields[f];
      const std::optional<std::size_t> column = column_of(field);
      if (!column) continue;
      const std::array<double, 2>* limits = nullptr;
      if_colour(field.name, [&](std::size_t c) { limits = &scans_[s].colour_limits[c]; });
      for_each_record(ex, s, [&](std::uint64_t i, std::int64_t row) {
        const double value = e57_value(field, streams_[s][f], i);
        attributes_.set(*column, row, limits != nullptr ? colour_byte(value, *limits) : value);
      });
    }
  }

  [[nodiscard]] PointTable table() const {
    PointTable table = attributes_.table();
    for (std::size_t axis = 0; axis < 3; ++axis)
      table.columns.push_back({std::string(1, "xyz"[axis]), AttributeType::float64, AttributeType::float64,
                               reinterpret_cast<const char*>(position_[axis].data()), sizeof(double), false});
    if (has_normals_)
      for (std::size_t axis = 0; axis < 3; ++axis)
        table.columns.push_back({std::string("n") + "xyz"[axis], AttributeType::float32, AttributeType::float32,
                                 reinterpret_cast<const char*>(normal_[axis].data()), sizeof(float), false});
    table.rows = rows_;
    return table;
  }

  [[nodiscard]] std::vector<Scan> described() const {
    std::vector<Scan> all;
    for (const E57Scan& scan : scans_) {
      Scan& out = all.emplace_back(Scan{static_cast<std::int64_t>(scan.records), {}, {}});
      // Programs that join scans write them without a pose: nobody knows where their points were seen from.
      if (scan.pose != E57Pose{} || !scan.find(kCartesian)) out.sensor = scan.pose.translation;
      for (std::size_t column = 0; column < attributes_.size(); ++column) {
        const auto fills_it = [&](const E57Field& field) { return column_of(field) == column; };
        if (std::none_of(scan.fields.begin(), scan.fields.end(), fills_it))
          out.lacking.push_back(attributes_.name(column));
      }
    }
    return all;
  }

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  const Source& source_;
  const E57Pages& pages_;
  std::vector<E57Scan> scans_;
  std::vector<std::vector<std::string>> streams_;  ///< of every field of every scan
  std::vector<std::int64_t> first_;                ///< row of every scan
  std::int64_t rows_ = 0;
  bool has_normals_ = false;
  std::array<std::vector<double>, 3> position_;
  std::array<std::vector<float>, 3> normal_;
  ParsedColumns attributes_;
};

}  // namespace

Cloud parse_e57(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const E57Pages pages = read_e57_pages(ex, source);
  std::vector<E57Scan> scans = parse_e57_document(source, pages);
  if (scans.empty()) fail(source, "holds no points", "check the program that wrote it");
  return E57Points(source, pages, std::move(scans)).read(ex, options);
}

}  // namespace pointskin::io
