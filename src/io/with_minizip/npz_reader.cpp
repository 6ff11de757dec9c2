// A .npz file: arrays by their names, points and whatever is as long, and the corners of triangles.
#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "io/numpy_table.hpp"
#include "io/readers.hpp"
#include "io/text_columns.hpp"
#include "io/zip.hpp"

namespace pointskin::io {
namespace {

/// The arrays of a .npz file.
class Archive {
 public:
  explicit Archive(const Source& source) : source_(source) {
    constexpr std::string_view kEnding = ".npy";
    for (const ZipEntry& entry : zip_entries(source)) {
      if (!entry.name.ends_with(kEnding)) continue;
      const std::string_view bytes = entry.stored.empty() ? unpacked_.emplace_back(unzip(source, entry)) : entry.stored;
      const std::string name = entry.name.substr(0, entry.name.size() - kEnding.size());
      if (!is_npy(bytes)) fail(source, in_quotes(entry.name) + " in it is no array", "save it again with numpy.savez");
      try_add(name, bytes);
    }
  }

  /// What is as long as the points.
  NumpyTable table() const {
    const Member* const points = positions();
    if (points != nullptr && (points->array.is_structured() || points->array.columns != 3))
      return table_of(source_, points->array);
    const Member* const x = find([](const Member& m) { return m.name == "x"; });
    if (points == nullptr && x == nullptr)
      fail(source_, "has no array of points", "save one of shape (n, 3) under the name points");
    NumpyTable table((points != nullptr ? points : x)->array.rows);
    if (points != nullptr) table.add_vector(points->array, 0, 3, kPositionNames);
    for (const Member& member : members_)
      if (&member != points) add(member, table);
    return table;
  }

  std::vector<Triangle> triangles(std::int64_t vertices) const {
    const Member* const faces = find([](const Member& m) { return names_faces(m.name) && m.array.columns == 3; });
    if (faces == nullptr) return {};
    const NpyArray& array = faces->array;
    const NpyField& field = array.fields[0];
    if (array.is_structured() || !is_integer(field.type))
      fail(source_, "the faces are no whole numbers", "save them as int32");
    std::vector<Triangle> triangles(static_cast<std::size_t>(array.rows));
    for (std::int64_t row = 0; row < array.rows; ++row) {
      std::array<std::int32_t, 3> corners{};
      for (std::int64_t c = 0; c < 3; ++c) {
        const std::int64_t id = load_integer(field.type, array.column(c) + row * array.stride(), field.swapped);
        if (id < 0 || id >= vertices)
          fail(source_, fmt::format("the face {} names vertex {} of {}", row, id, vertices), "save the mesh again");
        corners[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(id);
      }
      triangles[static_cast<std::size_t>(row)] = {corners[0], corners[1], corners[2]};
    }
    return triangles;
  }

 private:
  struct Member {
    std::string name;
    NpyArray array;
  };

  /// What is no array of numbers in one or two dimensions is passed over, unless it should be the points.
  void try_add(const std::string& name, std::string_view bytes) {
    const Source part{fmt::format("{} in {}", name, source_.name), bytes};
    try {
      members_.push_back({name, parse_npy(part)});
    } catch (const Error&) {
      if (names_positions(name) || names_normals(name) || names_faces(name)) throw;
    }
  }

  template <class Is>
  const Member* find(const Is& is) const {
    const auto at = std::find_if(members_.begin(), members_.end(), is);
    return at == members_.end() ? nullptr : &*at;
  }

  /// The array that is called so; else the only one that could be.
  const Member* positions() const {
    const auto could_be = [](const Member& m) {
      return m.array.is_structured() || (!m.array.is_flat && m.array.columns >= 3);
    };
    const Member* const named = find([&](const Member& m) { return names_positions(m.name) && could_be(m); });
    if (named != nullptr) return named;
    const auto others = std::count_if(members_.begin(), members_.end(), could_be);
    return others == 1 ? find(could_be) : nullptr;
  }

  void add(const Member& member, NumpyTable& table) const {
    const auto& [name, array] = member;
    if (array.is_structured() || array.rows != table.table().rows || names_faces(name)) return;
    if (names_normals(name) && array.columns == 3)
      table.add_vector(array, 0, 3, kNormalNames);
    else if (names_colours(name) && (array.columns == 3 || array.columns == 4))
      table.add_colours(array, 0, array.columns);
    else
      table.add_attributes(canonical_names({name})[0], array);
  }

  const Source& source_;
  std::deque<std::string> unpacked_;
  std::vector<Member> members_;
};

}  // namespace

Cloud parse_npz_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const Archive archive(source);
  return assemble(ex, source, archive.table().table(), options.shift);
}

Mesh parse_npz_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const Archive archive(source);
  const NumpyTable table = archive.table();
  check_vertex_count(source, table.table().rows);
  std::vector<Triangle> triangles = archive.triangles(table.table().rows);
  if (!triangles.empty()) return assemble_mesh(ex, source, table.table(), std::move(triangles), options);
  Cloud points = assemble(ex, source, table.table(), options.shift);
  return {points.origin, std::move(points.positions), std::move(points.normals), std::move(points.attributes), {}};
}

}  // namespace pointskin::io
