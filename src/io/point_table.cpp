#include "io/point_table.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "exec/host_array.hpp"
#include "io/blocks.hpp"
#include "io/shift.hpp"

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

std::optional<std::array<std::size_t, 3>> find_normal(const PointTable& table) {
  const auto normal = find_three(table, {"nx", "ny", "nz"});
  return normal ? normal : find_three(table, {"normal_x", "normal_y", "normal_z"});
}

Roles find_roles(const Source& source, const PointTable& table) {
  const auto position = find_three(table, {"x", "y", "z"});
  if (!position) fail(source, "the points have no x, y and z", "export it with coordinates");
  Roles roles{*position, find_normal(table), {}};
  const auto contains = [](const std::array<std::size_t, 3>& three, std::size_t c) {
    return std::find(three.begin(), three.end(), c) != three.end();
  };
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (!contains(roles.position, c) && !(roles.normal && contains(*roles.normal, c))) roles.attributes.push_back(c);
  return roles;
}

/// Consecutive rows of a table.
struct RowRange {
  std::int64_t first, end;
  explicit RowRange(const PointTable& table) : first(0), end(table.rows) {}
  RowRange(const PointTable& table, std::int64_t block)
      : first(block * kBlockRows), end(std::min(table.rows, first + kBlockRows)) {}
};

double value_at(const Column& column, std::int64_t row) {
  return visit_type(column.stored, [&](auto tag) {
    return static_cast<double>(load<decltype(tag)>(column.data + row * column.stride_bytes, column.swapped));
  });
}

/// Calls f(three values) for every row in order. The type is looked up once if the three columns are stored alike, as
/// they are in all but odd files.
template <class F>
void for_triples(const PointTable& table, const std::array<std::size_t, 3>& columns, const RowRange& rows, const F& f) {
  const Column& x = table.columns[columns[0]];
  const Column& y = table.columns[columns[1]];
  const Column& z = table.columns[columns[2]];
  const auto is_like_x = [&](const Column& c) {
    return c.stored == x.stored && c.swapped == x.swapped && c.stride_bytes == x.stride_bytes;
  };
  if (!is_like_x(y) || !is_like_x(z)) {
    for (std::int64_t row = rows.first; row < rows.end; ++row)
      f(Vec3d{value_at(x, row), value_at(y, row), value_at(z, row)});
    return;
  }
  visit_type(x.stored, [&](auto tag) {
    using T = decltype(tag);
    const auto value = [&](const Column& column, std::int64_t offset) {
      return static_cast<double>(load<T>(column.data + offset, x.swapped));
    };
    const std::int64_t stride = x.stride_bytes;
    std::int64_t offset = rows.first * stride;
    for (std::int64_t row = rows.first; row < rows.end; ++row, offset += stride)
      f(Vec3d{value(x, offset), value(y, offset), value(z, offset)});
  });
}

bool is_finite(const Vec3d& p) {
  return std::abs(p[0]) <= kLargestCoordinate && std::abs(p[1]) <= kLargestCoordinate &&
         std::abs(p[2]) <= kLargestCoordinate;
}

/// What the first pass finds out: where each block's points go, and, if asked for, boxes of kRunRows rows each.
struct Survey {
  std::vector<std::int64_t> first;  ///< shape (blocks + 1); the last is the number of points kept
  std::vector<Box> runs;

  [[nodiscard]] std::int64_t blocks() const { return static_cast<std::int64_t>(first.size()) - 1; }
};

Survey survey(exec::Cpu& ex, const PointTable& table, const Roles& roles, bool want_boxes) {
  static_assert(kBlockRows % kRunRows == 0);
  const std::int64_t blocks = (table.rows + kBlockRows - 1) / kBlockRows;
  Survey result{std::vector<std::int64_t>(static_cast<std::size_t>(blocks) + 1, 0), {}};
  if (want_boxes) result.runs.resize(static_cast<std::size_t>((table.rows + kRunRows - 1) / kRunRows));
  run_in_order(ex, blocks, [&](std::int64_t b) {
    std::int64_t kept = 0;
    std::int64_t row = b * kBlockRows;
    for_triples(table, roles.position, {table, b}, [&](const Vec3d& p) {
      const auto run = static_cast<std::size_t>(row++ / kRunRows);
      if (!is_finite(p)) return;
      ++kept;
      if (want_boxes) result.runs[run].add(p, p);
    });
    result.first[static_cast<std::size_t>(b) + 1] = kept;
  });
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  return result;
}

bool holds_floats(const PointTable& table, const Roles& roles) {
  return std::all_of(roles.position.begin(), roles.position.end(),
                     [&](std::size_t c) { return table.columns[c].stored == AttributeType::float32; });
}

Vec3f to_normal(const Vec3f& n) { return std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z) ? n : Vec3f{}; }

/// Which rows of a block stay.
struct KeptRows {
  RowRange rows;
  std::array<bool, kBlockRows> flags;
  bool all = true;

  /// Calls f(offset of the value, index among those kept) for every row that stays.
  template <class F>
  void for_each(std::int64_t stride_bytes, const F& f) const {
    std::int64_t offset = rows.first * stride_bytes;
    std::int64_t to = 0;
    if (all) {
      for (; to < rows.end - rows.first; ++to, offset += stride_bytes) f(offset, to);
      return;
    }
    for (std::int64_t row = 0; row < rows.end - rows.first; ++row, offset += stride_bytes)
      if (flags[static_cast<std::size_t>(row)]) f(offset, to++);
  }
};

/// The second pass over an attribute of a block: values of the stored type become those of the attribute's.
void fill_attribute(const Column& column, const KeptRows& kept, std::int64_t to, AttributeValues& values) {
  visit_type(column.declared, [&](auto declared) {
    using T = decltype(declared);
    T* out = values.edit<T>().data() + to;
    if (column.stored == column.declared)
      return kept.for_each(column.stride_bytes, [&](std::int64_t offset, std::int64_t i) {
        out[i] = load<T>(column.data + offset, column.swapped);
      });
    visit_type(column.stored, [&](auto stored) {
      kept.for_each(column.stride_bytes, [&](std::int64_t offset, std::int64_t i) {
        out[i] = narrowed<T>(static_cast<double>(load<decltype(stored)>(column.data + offset, column.swapped)));
      });
    });
  });
}

Vec3f relative(const Vec3d& p, const Vec3d& origin) {
  return {to_float(p[0] - origin[0]), to_float(p[1] - origin[1]), to_float(p[2] - origin[2])};
}

/// The second pass over block `b`: writes its points from index `to` of the cloud on.
void fill_block(const PointTable& table, const Roles& roles, std::int64_t b, std::int64_t to, Cloud& cloud) {
  KeptRows kept{RowRange(table, b), {}, true};
  const Vec3d& origin = cloud.origin;
  Vec3f* position = cloud.positions.data() + to;
  auto* keep = kept.flags.begin();
  for_triples(table, roles.position, kept.rows, [&](const Vec3d& p) {
    *keep = is_finite(p);
    kept.all = kept.all && *keep;
    if (*keep++) *position++ = relative(p, origin);
  });
  if (roles.normal) {
    Vec3f* normal = cloud.normals.data() + to;
    keep = kept.flags.begin();
    for_triples(table, *roles.normal, kept.rows, [&](const Vec3d& n) {
      if (*keep++) *normal++ = to_normal({to_float(n[0]), to_float(n[1]), to_float(n[2])});
    });
  }
  for (std::size_t a = 0; a < roles.attributes.size(); ++a)
    fill_attribute(table.columns[roles.attributes[a]], kept, to, cloud.attributes[a].values);
}

/// `size` values whose pages all threads have mapped.
AttributeValues make_values(exec::Cpu& ex, AttributeType type, std::size_t size) {
  return visit_type(type, [&](auto tag) {
    std::vector<decltype(tag)> values;
    exec::resize_to_overwrite(ex, values, size);
    return AttributeValues(std::move(values));
  });
}

void check_shift(const Vec3d& shift) {
  for (const double s : {shift.x, shift.y, shift.z})
    if (!(std::abs(s) <= kLargestCoordinate)) throw Error(ErrorCode::usage, "the shift must be three finite numbers");
}

}  // namespace

bool has_normals(const PointTable& table) { return find_normal(table).has_value(); }

bool is_coordinate(const std::string& name) { return name == "x" || name == "y" || name == "z"; }

void read_positions(const PointTable& table, const Source& source, const Vec3d& origin, Vec3f* out) {
  for_triples(table, find_roles(source, table).position, RowRange(table),
              [&](const Vec3d& p) { *out++ = relative(p, origin); });
}

std::vector<Vec3d> points_beyond(exec::Cpu& ex, const Source& source, const PointTable& table, const Box& box) {
  const Roles roles = find_roles(source, table);
  const std::int64_t blocks = (table.rows + kBlockRows - 1) / kBlockRows;
  std::vector<std::vector<Vec3d>> found(static_cast<std::size_t>(blocks));
  run_in_order(ex, blocks, [&](std::int64_t b) {
    for_triples(table, roles.position, {table, b}, [&](const Vec3d& p) {
      bool inside = true;
      for (std::size_t axis = 0; axis < 3; ++axis)
        inside = inside && p[axis] >= box.lower[axis] && p[axis] <= box.upper[axis];
      if (!inside && is_finite(p)) found[static_cast<std::size_t>(b)].push_back(p);
    });
  });
  std::vector<Vec3d> all;
  for (const std::vector<Vec3d>& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

std::int64_t OriginSearch::add(exec::Cpu& ex, const Source& source, const PointTable& part) {
  const Roles roles = find_roles(source, part);
  const Survey found = survey(ex, part, roles, true);
  runs_.insert(runs_.end(), found.runs.begin(), found.runs.end());
  points_ += found.first.back();
  resolution_ = part.resolution;
  has_digits_ = !holds_floats(part, roles);
  return found.first.back();
}

Vec3d OriginSearch::origin(const std::function<std::vector<Vec3d>(const Box&)>& beyond) const {
  return points_ > 0 ? automatic_shift(runs_, points_, resolution_, has_digits_, beyond) : Vec3d{};
}

Cloud assemble(exec::Cpu& ex, const Source& source, const PointTable& table, const std::optional<Vec3d>& shift) {
  if (shift) check_shift(*shift);
  const Roles roles = find_roles(source, table);
  const bool wants_shift = !shift;
  const Survey found = survey(ex, table, roles, wants_shift);
  const auto kept = static_cast<std::size_t>(found.first.back());
  Cloud cloud;
  cloud.dropped = table.rows - found.first.back();
  if (shift)
    cloud.origin = *shift;
  else if (wants_shift && kept > 0)
    cloud.origin = automatic_shift(found.runs, found.first.back(), table.resolution, !holds_floats(table, roles),
                                   [&](const Box& box) { return points_beyond(ex, source, table, box); });
  exec::resize_to_overwrite(ex, cloud.positions, kept);
  if (roles.normal) exec::resize_to_overwrite(ex, cloud.normals, kept);
  for (const std::size_t c : roles.attributes) {
    const Column& column = table.columns[c];
    cloud.attributes.push_back({column.name, make_values(ex, column.declared, kept)});
  }
  run_in_order(ex, found.blocks(),
               [&](std::int64_t b) { fill_block(table, roles, b, found.first[static_cast<std::size_t>(b)], cloud); });
  return cloud;
}

}  // namespace pointskin::io
