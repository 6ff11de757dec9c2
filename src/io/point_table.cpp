#include "io/point_table.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/blocks.hpp"

namespace pointskin::io {
namespace {

constexpr std::int64_t kBlockRows = 4096;

/// Column numbers by what they mean.
struct Roles {
  std::array<std::size_t, 3> position{};
  std::optional<std::array<std::size_t, 3>> normal;
  std::vector<std::size_t> attributes;
};

std::optional<std::array<std::size_t, 3>> find_three(const PointTable& table, std::array<const char*, 3> names) {
  std::array<std::size_t, 3> found{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto hit = std::find_if(table.columns.begin(), table.columns.end(),
                                  [&](const Column& c) { return c.name == names[axis]; });
    if (hit == table.columns.end()) return std::nullopt;
    found[axis] = static_cast<std::size_t>(hit - table.columns.begin());
  }
  return found;
}

Roles find_roles(const Source& source, const PointTable& table) {
  const auto position = find_three(table, {"x", "y", "z"});
  if (!position) fail(source, "the points have no x, y and z", "export it with coordinates");
  Roles roles{*position, find_three(table, {"nx", "ny", "nz"}), {}};
  if (!roles.normal) roles.normal = find_three(table, {"normal_x", "normal_y", "normal_z"});
  const auto contains = [](const std::array<std::size_t, 3>& three, std::size_t c) {
    return std::find(three.begin(), three.end(), c) != three.end();
  };
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (!contains(roles.position, c) && !(roles.normal && contains(*roles.normal, c))) roles.attributes.push_back(c);
  return roles;
}

/// Calls put(i, value of row rows[i]) for all i; the column's type is looked up once.
template <class Put>
void gather(const Column& column, const std::vector<std::int64_t>& rows, const Put& put) {
  visit(column.stored, [&](auto tag) {
    using T = decltype(tag);
    for (std::size_t i = 0; i < rows.size(); ++i)
      put(i, static_cast<double>(load<T>(column.data + rows[i] * column.stride_bytes, column.swapped)));
  });
}

/// The rows of a block that have finite coordinates, and these.
struct FinitePoints {
  std::vector<std::int64_t> rows;
  std::vector<Vec3d> points;
};

FinitePoints finite_points(const PointTable& table, const Roles& roles, std::int64_t block) {
  const std::int64_t first = block * kBlockRows;
  const auto count = static_cast<std::size_t>(std::min(table.rows, first + kBlockRows) - first);
  FinitePoints all{std::vector<std::int64_t>(count), std::vector<Vec3d>(count)};
  for (std::size_t i = 0; i < count; ++i) all.rows[i] = first + static_cast<std::int64_t>(i);
  for (std::size_t axis = 0; axis < 3; ++axis)
    gather(table.columns[roles.position[axis]], all.rows, [&](std::size_t i, double v) { all.points[i][axis] = v; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d p = all.points[i];
    if (!(std::abs(p[0]) <= kLargestCoordinate && std::abs(p[1]) <= kLargestCoordinate &&
          std::abs(p[2]) <= kLargestCoordinate))
      continue;
    all.rows[kept] = all.rows[i];
    all.points[kept++] = p;
  }
  all.rows.resize(kept);
  all.points.resize(kept);
  return all;
}

struct Box {
  Vec3d lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity()};
  Vec3d upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
              -std::numeric_limits<double>::infinity()};
  void add(const Vec3d& low, const Vec3d& high) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], low[axis]);
      upper[axis] = std::max(upper[axis], high[axis]);
    }
  }
};

/// What the first pass finds out: where each block's points go, and their box.
struct Survey {
  std::vector<std::int64_t> first;  ///< shape (blocks + 1); the last is the number of points kept
  Box box;
};

Survey survey(exec::Cpu& ex, const PointTable& table, const Roles& roles) {
  const std::int64_t blocks = (table.rows + kBlockRows - 1) / kBlockRows;
  Survey result{std::vector<std::int64_t>(static_cast<std::size_t>(blocks) + 1, 0), {}};
  std::vector<Box> boxes(static_cast<std::size_t>(blocks));
  run_in_order(ex, blocks, [&](std::int64_t b) {
    const FinitePoints kept = finite_points(table, roles, b);
    for (const Vec3d& p : kept.points) boxes[static_cast<std::size_t>(b)].add(p, p);
    result.first[static_cast<std::size_t>(b) + 1] = static_cast<std::int64_t>(kept.points.size());
  });
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    result.first[b + 1] += result.first[b];
    result.box.add(boxes[b].lower, boxes[b].upper);
  }
  return result;
}

/// The "auto" rule of ReadOptions::shift.
Vec3d automatic_shift(const PointTable& table, const Roles& roles, const Box& box) {
  constexpr double kExactEnough = 1000;
  const bool holds_floats = std::all_of(roles.position.begin(), roles.position.end(),
                                        [&](std::size_t c) { return table.columns[c].stored == Scalar::float32; });
  if (holds_floats) return {0, 0, 0};
  double magnitude = 0;
  double extent = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    magnitude = std::max({magnitude, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
    extent = std::max(extent, box.upper[axis] - box.lower[axis]);
  }
  if (magnitude == 0 || magnitude < kExactEnough * extent) return {0, 0, 0};
  Vec3d centre{};
  // Adding zero turns -0 into 0, which compares and prints as expected.
  for (std::size_t axis = 0; axis < 3; ++axis) centre[axis] = std::round((box.lower[axis] + box.upper[axis]) / 2) + 0.0;
  return centre;
}

Vec3f to_normal(const Vec3f& n) { return std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z) ? n : Vec3f{}; }

/// The second pass over block `b`: writes its points from index `to` of the cloud on.
void fill_block(const PointTable& table, const Roles& roles, std::int64_t b, std::int64_t to, Cloud& cloud) {
  const FinitePoints kept = finite_points(table, roles, b);
  const Vec3d& origin = cloud.origin;
  Vec3f* positions = cloud.positions.data() + to;
  for (std::size_t i = 0; i < kept.points.size(); ++i) {
    const Vec3d& p = kept.points[i];
    positions[i] = {to_float(p[0] - origin[0]), to_float(p[1] - origin[1]), to_float(p[2] - origin[2])};
  }
  if (roles.normal) {
    Vec3f* normals = cloud.normals.data() + to;
    gather(table.columns[(*roles.normal)[0]], kept.rows, [&](std::size_t i, double v) { normals[i].x = to_float(v); });
    gather(table.columns[(*roles.normal)[1]], kept.rows, [&](std::size_t i, double v) { normals[i].y = to_float(v); });
    gather(table.columns[(*roles.normal)[2]], kept.rows, [&](std::size_t i, double v) { normals[i].z = to_float(v); });
    std::transform(normals, normals + kept.rows.size(), normals, to_normal);
  }
  for (std::size_t a = 0; a < roles.attributes.size(); ++a) {
    float* values = cloud.attributes[a].values.data() + to;
    gather(table.columns[roles.attributes[a]], kept.rows, [&](std::size_t i, double v) { values[i] = to_float(v); });
  }
}

void check_shift(const Vec3d& shift) {
  for (const double s : shift)
    if (!(std::abs(s) <= kLargestCoordinate)) throw Error(ErrorCode::usage, "the shift must be three finite numbers");
}

}  // namespace

bool is_coordinate(const std::string& name) { return name == "x" || name == "y" || name == "z"; }

void ParsedColumns::add(const std::string& name, Scalar declared) {
  columns_.push_back({name, declared, is_coordinate(name), {}, {}});
}

void ParsedColumns::allocate(std::int64_t rows) {
  rows_ = rows;
  for (Storage& column : columns_) {
    if (column.is_wide)
      column.wide.resize(static_cast<std::size_t>(rows));
    else
      column.narrow.resize(static_cast<std::size_t>(rows));
  }
}

void ParsedColumns::redeclare(std::size_t column, const std::string& name, Scalar declared) {
  columns_[column].name = name;
  columns_[column].declared = declared;
}

bool ParsedColumns::holds_bytes(std::size_t column) const {
  const std::vector<float>& values = columns_[column].narrow;
  return std::all_of(values.begin(), values.end(),
                     [](float v) { return v >= 0 && v <= 255 && v == static_cast<float>(static_cast<int>(v)); });
}

bool ParsedColumns::exceeds(std::size_t column, float limit) const {
  const std::vector<float>& values = columns_[column].narrow;
  return std::any_of(values.begin(), values.end(), [&](float v) { return v > limit; });
}

PointTable ParsedColumns::table() const {
  PointTable table{rows_, {}};
  for (const Storage& c : columns_) {
    if (c.is_wide)
      table.columns.push_back(
          {c.name, c.declared, Scalar::float64, reinterpret_cast<const char*>(c.wide.data()), sizeof(double), false});
    else
      table.columns.push_back(
          {c.name, c.declared, Scalar::float32, reinterpret_cast<const char*>(c.narrow.data()), sizeof(float), false});
  }
  return table;
}

Cloud assemble(exec::Cpu& ex, const Source& source, const PointTable& table, const std::optional<Vec3d>& shift) {
  if (shift) check_shift(*shift);
  const Roles roles = find_roles(source, table);
  const Survey found = survey(ex, table, roles);
  const auto kept = static_cast<std::size_t>(found.first.back());
  Cloud cloud;
  cloud.dropped = table.rows - found.first.back();
  if (shift)
    cloud.origin = *shift;
  else if (kept > 0)
    cloud.origin = automatic_shift(table, roles, found.box);
  cloud.positions.resize(kept);
  if (roles.normal) cloud.normals.resize(kept);
  for (const std::size_t c : roles.attributes) {
    const Column& column = table.columns[c];
    cloud.attributes.push_back({column.name,
                                column.declared == Scalar::uint8 ? AttributeType::uint8 : AttributeType::float32,
                                std::vector<float>(kept)});
  }
  run_in_order(ex, static_cast<std::int64_t>(found.first.size()) - 1,
               [&](std::int64_t b) { fill_block(table, roles, b, found.first[static_cast<std::size_t>(b)], cloud); });
  return cloud;
}

}  // namespace pointskin::io
