#include "io/scans.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "io/blocks.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

/// The coordinates of a table.
class Coordinates {
 public:
  explicit Coordinates(const PointTable& table) {
    for (const Column& column : table.columns)
      if (is_coordinate(column.name)) axes_.push_back(&column);
  }
  [[nodiscard]] bool is_empty(std::int64_t row) const { return std::isnan(value(*axes_.front(), row)); }
  [[nodiscard]] bool is_kept(std::int64_t row) const {
    return std::all_of(axes_.begin(), axes_.end(),
                       [&](const Column* axis) { return std::abs(value(*axis, row)) <= kLargestCoordinate; });
  }

 private:
  static double value(const Column& column, std::int64_t row) {
    return load<double>(column.data + row * column.stride_bytes, column.swapped);
  }
  std::vector<const Column*> axes_;
};

struct Counts {
  std::int64_t kept = 0, empty = 0;
};

/// Of every scan.
std::vector<Counts> count_points(exec::Cpu& ex, const PointTable& table, const std::vector<Scan>& scans) {
  const Coordinates coordinates(table);
  std::vector<std::int64_t> first{0};
  for (const Scan& scan : scans) first.push_back(first.back() + scan.rows);
  std::vector<Counts> counts(scans.size());
  run_in_order(ex, static_cast<std::int64_t>(scans.size()), [&](std::int64_t s) {
    const auto scan = static_cast<std::size_t>(s);
    for (std::int64_t row = first[scan]; row < first[scan + 1]; ++row) {
      counts[scan].kept += coordinates.is_kept(row) ? 1 : 0;
      counts[scan].empty += coordinates.is_empty(row) ? 1 : 0;
    }
  });
  return counts;
}

void add_sensors(const std::vector<Scan>& scans, const std::vector<Counts>& counts, Cloud& cloud) {
  const auto is_known = [](const Scan& scan) { return scan.sensor.has_value(); };
  if (std::none_of(scans.begin(), scans.end(), is_known)) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(cloud.positions.size());
    for (std::size_t s = 0; s < scans.size(); ++s)
      values.insert(values.end(), static_cast<std::size_t>(counts[s].kept),
                    scans[s].sensor ? (*scans[s].sensor)[axis] : std::numeric_limits<double>::quiet_NaN());
    cloud.attributes.push_back({std::string("sensor_") + "xyz"[axis], std::move(values)});
  }
}

void take_away(const Scan& scan, std::size_t first, std::size_t end, Cloud& cloud) {
  for (const std::string& name : scan.lacking)
    for (Attribute& attribute : cloud.attributes)
      if (attribute.name == name)
        for (std::size_t i = first; i < end; ++i) attribute.values.set_missing(i);
}

}  // namespace

Cloud assemble_scans(exec::Cpu& ex, const Source& source, const PointTable& table, const std::vector<Scan>& scans,
                     const std::optional<Vec3d>& shift) {
  Cloud cloud = assemble(ex, source, table, shift);
  const std::vector<Counts> counts = count_points(ex, table, scans);
  std::size_t first = 0;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const std::size_t end = first + static_cast<std::size_t>(counts[s].kept);
    take_away(scans[s], first, end, cloud);
    first = end;
    cloud.dropped -= counts[s].empty;
  }
  add_sensors(scans, counts, cloud);
  return cloud;
}

}  // namespace pointskin::io
