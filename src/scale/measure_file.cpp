// The numbers of measure() for a mesh that memory does not hold.
//
// Which vertices are joined is one array over all vertices. The stars of vertices are listed for a range of vertices at a
// time, from all triangles that have a corner in it; those are read twice, once to count and once to fill. Areas and volumes
// are summed in the blocks of measure(), in the same order; each block fetches the positions that it needs from the file.
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/scale.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "core/vec3.hpp"
#include "exec/algorithms.hpp"
#include "exec/cpu_primitives.hpp"
#include "io/ply_mesh_parts.hpp"
#include "mesh/joined_vertices.hpp"
#include "mesh/mesh_checks.hpp"
#include "mesh/star.hpp"

namespace pointskin {
namespace {

using exec::Buffer;
using exec::Cpu;
using io::PlyMeshParts;
using mesh_detail::CornerBounds;

constexpr std::int64_t kPart = 4 * exec::kCpuBlock;  // triangles that a thread reads at once
constexpr std::int64_t kRows = 2 * exec::kCpuBlock;  // vertices that a thread reads at once, at most
constexpr std::int64_t kCounted = 1024;              // vertices whose corners are counted together
constexpr std::int64_t kReaches = 64;  // parts of the vertices that a part of the triangles may have corners in

/// A triangle around a vertex: the corners before and after it.
struct Side {
  std::int32_t before, after;
};

/// What a thread reads into.
struct Scratch {
  PlyMeshParts::Bytes bytes;
  std::vector<Triangle> triangles;
  std::vector<std::uint64_t> order;  ///< vertex and corner
  std::vector<Vec3f> rows, corners;
};

/// How the memory is shared out, in bytes.
struct Plan {
  std::int64_t fixed = 0;  ///< for all vertices and parts
  std::int64_t per_thread = 0;
  int threads = 1;
  std::int64_t range = 0;  ///< for the stars of a range of vertices
};

std::int64_t parts_of(const PlyMeshParts& file) { return exec::block_count(file.triangles(), kPart); }

Plan plan_for(const PlyMeshParts& file, const ScaleOptions& options) {
  constexpr auto kVertex = static_cast<std::int64_t>(sizeof(Vec3f));
  constexpr auto kTriangle = static_cast<std::int64_t>(sizeof(Triangle));
  Plan plan;
  const std::int64_t joined = 4 * file.vertices() + file.vertices() / 8 +
                              8 * (file.vertices() / kCounted + parts_of(file)) +
                              static_cast<std::int64_t>(sizeof(CornerBounds)) * (file.vertices() / kRows + 1);
  const std::int64_t origin = 48 * (file.vertices() / 64) + PlyMeshParts::kBufferBytes;
  plan.fixed = std::max(joined, origin);
  plan.per_thread =
      kPart * (file.triangle_bytes() + kTriangle + 3 * (8 + kVertex)) + kRows * (file.vertex_bytes() + kVertex);
  const std::int64_t left = options.max_memory_bytes - plan.fixed;
  const std::int64_t affordable = std::max<std::int64_t>(1, left / 4 / plan.per_thread);
  plan.threads = static_cast<int>(std::min<std::int64_t>(Cpu(options.threads).threads(), affordable));
  plan.range = left - plan.threads * plan.per_thread;
  return plan;
}

std::int64_t bytes_of_range(std::int64_t vertices, std::int64_t corners) {
  return static_cast<std::int64_t>(sizeof(std::int64_t)) * (vertices + 1) +
         static_cast<std::int64_t>(sizeof(Side)) * corners;
}

/// What reading a mesh and measuring it takes: the mapped file or what measure() needs, beside the mesh.
std::int64_t bytes_as_a_whole(const PlyMeshParts& file) {
  const std::int64_t mesh = file.vertices() * (12 + file.vertex_bytes()) + 12 * file.triangles();
  return mesh + std::max(file.file_bytes(), 12 * file.vertices() + 12 * file.triangles());
}

class MeasureInParts {
 public:
  MeasureInParts(PlyMeshParts& file, const std::string& path, const Plan& plan)
      : file_(file), path_(path), plan_(plan), ex_(plan.threads) {}

  MeshReport run() {
    if (plan_.range <= 0) fail_on_memory(bytes_of_range(kCounted, 6 * kCounted));
    MeshReport report;
    report.vertices = file_.vertices();
    report.triangles = file_.triangles();
    file_.find_origin(ex_);
    join();
    count_stars(report);
    sum_triangles(report);
    report.euler = report.used_vertices - report.edges + report.triangles;
    return report;
  }

 private:
  struct Range {
    std::int64_t first, end, corners;
  };

  [[noreturn]] void fail_on_memory(std::int64_t range) const {
    throw Error(ErrorCode::over_limit,
                fmt::format("{}: measuring the mesh takes {} bytes; allow more memory", io::printable(path_),
                            std::min(plan_.fixed + plan_.per_thread + range, bytes_as_a_whole(file_))));
  }

  [[nodiscard]] std::int64_t reach_of(std::int64_t vertex) const { return vertex * kReaches / file_.vertices(); }

  /// Calls use(part, its triangles, scratch) for the parts of a list, on many threads.
  template <class Use>
  void for_parts(const std::vector<std::int64_t>& parts, const Use& use) {
    ex_.run_blocks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t i) {
      std::unique_ptr<Scratch> scratch = take_scratch();
      const std::int64_t part = parts[static_cast<std::size_t>(i)];
      const std::int64_t first = part * kPart;
      scratch->triangles.resize(static_cast<std::size_t>(std::min(kPart, file_.triangles() - first)));
      file_.read_triangles(first, static_cast<std::int64_t>(scratch->triangles.size()), scratch->bytes,
                           scratch->triangles.data());
      use(part, *scratch);
      const std::lock_guard lock(mutex_);
      scratches_.push_back(std::move(scratch));
    });
  }

  /// One that no other thread has.
  std::unique_ptr<Scratch> take_scratch() {
    const std::lock_guard lock(mutex_);
    if (scratches_.empty()) return std::make_unique<Scratch>();
    std::unique_ptr<Scratch> scratch = std::move(scratches_.back());
    scratches_.pop_back();
    return scratch;
  }

  /// The parts with a corner among the vertices of some reaches, a bit each.
  [[nodiscard]] std::vector<std::int64_t> parts_in(std::uint64_t reaches) const {
    std::vector<std::int64_t> parts;
    for (std::int64_t part = 0; part < parts_of(file_); ++part)
      if ((reaches_.data()[part] & reaches) != 0) parts.push_back(part);
    return parts;
  }

  /// Which vertices are joined and used, how many corners they have, and where the parts have theirs.
  void join() {
    const std::int64_t counted = exec::block_count(file_.vertices(), kCounted);
    joined_ = mesh_detail::join_vertices(ex_, file_.vertices(), ArrayView<const Triangle>{});
    corners_ = Buffer<std::int64_t>(ex_.pool(), counted);
    reaches_ = Buffer<std::uint64_t>(ex_.pool(), parts_of(file_));
    exec::fill(ex_, corners_.view(), std::int64_t{0});
    exec::fill(ex_, reaches_.view(), ~std::uint64_t{0});
    for_parts(parts_in(~std::uint64_t{0}), [&](std::int64_t part, const Scratch& scratch) {
      const auto n = static_cast<std::int64_t>(scratch.triangles.size());
      const mesh_detail::JoinCorners join{joined_.view(), {scratch.triangles.data(), n}};
      std::uint64_t reaches = 0;
      for (std::int64_t i = 0; i < n; ++i) {
        join(i);
        const Triangle& t = scratch.triangles[static_cast<std::size_t>(i)];
        for (const std::int32_t v : t) {
          reaches |= std::uint64_t{1} << reach_of(v);
          if (!mesh_detail::degenerate(t))
            std::atomic_ref(corners_.data()[v / kCounted]).fetch_add(1, std::memory_order_relaxed);
        }
      }
      reaches_.data()[part] = reaches;
    });
  }

  /// Ranges of vertices whose stars fit into memory.
  [[nodiscard]] std::vector<Range> ranges() const {
    std::vector<Range> ranges;
    for (std::int64_t first = 0; first < file_.vertices(); first += kCounted) {
      const std::int64_t end = std::min(first + kCounted, file_.vertices());
      const std::int64_t corners = corners_.data()[first / kCounted];
      if (bytes_of_range(end - first, corners) > plan_.range) fail_on_memory(bytes_of_range(end - first, corners));
      const bool fits =
          !ranges.empty() && bytes_of_range(end - ranges.back().first, ranges.back().corners + corners) <= plan_.range;
      if (!fits) ranges.push_back({first, first, 0});
      ranges.back().end = end;
      ranges.back().corners += corners;
    }
    return ranges;
  }

  void count_stars(MeshReport& report) {
    const std::vector<Range> all = ranges();
    std::int64_t vertices = 0;
    std::int64_t corners = 0;
    for (const Range& range : all) {
      vertices = std::max(vertices, range.end - range.first);
      corners = std::max(corners, range.corners);
    }
    Buffer<std::int64_t> ends(ex_.pool(), vertices + 1);
    Buffer<Side> sides(ex_.pool(), corners);
    for (const Range& range : all)
      count_range(range, ends.view().part(0, range.end - range.first + 1), sides.data(), report);
  }

  /// The stars of a range. Star v is [v > 0 ? ends[v - 1] : 0, ends[v]) of the sides, in no particular order.
  void count_range(const Range& range, ArrayView<std::int64_t> ends, Side* sides, MeshReport& report) {
    const std::int64_t vertices = range.end - range.first;
    std::uint64_t reaches = 0;
    for (std::int64_t reach = reach_of(range.first); reach <= reach_of(range.end - 1); ++reach)
      reaches |= std::uint64_t{1} << reach;
    const std::vector<std::int64_t> parts = parts_in(reaches);
    const auto for_corners = [&](const auto& use) {
      for_parts(parts, [&](std::int64_t, const Scratch& scratch) {
        for (const Triangle& t : scratch.triangles) {
          if (mesh_detail::degenerate(t)) continue;
          for (std::size_t k = 0; k < 3; ++k)
            if (t[k] >= range.first && t[k] < range.end)
              use(std::atomic_ref(ends[t[k] - range.first]).fetch_add(1, std::memory_order_relaxed),
                  Side{t[(k + 2) % 3], t[(k + 1) % 3]});
        }
      });
    };
    exec::fill(ex_, ends, std::int64_t{0});
    for_corners([](std::int64_t, const Side&) {});
    exec::exclusive_scan<std::int64_t>(ex_, "stars", ArrayView<const std::int64_t>(ends).part(0, vertices), ends);
    for_corners([&](std::int64_t slot, const Side& side) { sides[slot] = side; });
    const mesh_detail::JoinedView joined = joined_.view();
    mesh_detail::add_parts(
        ex_, vertices,
        [&](std::int64_t begin, std::int64_t end) {
          MeshReport part;
          mesh_detail::Star star;
          for (std::int64_t v = begin; v < end; ++v) {
            if (!joined.is_used(range.first + v)) continue;
            ++part.used_vertices;
            if (joined.begins_piece(range.first + v)) ++part.components;
            star.clear();
            for (std::int64_t i = v > 0 ? ends[v - 1] : 0; i < ends[v]; ++i) star.add(sides[i].before, sides[i].after);
            mesh_detail::count_star(static_cast<std::int32_t>(range.first + v), star, part);
          }
          return part;
        },
        report);
  }

  [[nodiscard]] CornerBounds bounds() {
    const mesh_detail::JoinedView joined = joined_.view();
    std::vector<CornerBounds> boxes(static_cast<std::size_t>(exec::block_count(file_.vertices(), kRows)),
                                    CornerBounds::none());
    ex_.run_blocks(static_cast<std::int64_t>(boxes.size()), [&](std::int64_t b) {
      Scratch scratch;
      const std::int64_t first = b * kRows;
      const std::int64_t count = std::min(kRows, file_.vertices() - first);
      scratch.rows.resize(static_cast<std::size_t>(count));
      file_.read_vertices(first, count, scratch.bytes, scratch.rows.data());
      for (std::int64_t i = 0; i < count; ++i)
        if (joined.is_used(first + i))
          boxes[static_cast<std::size_t>(b)].add(scratch.rows[static_cast<std::size_t>(i)]);
    });
    CornerBounds all = CornerBounds::none();
    for (const CornerBounds& box : boxes) all.add(box);
    all.close();
    return all;
  }

  /// Positions of the corners of the triangles, by as few reads as their vertices are near each other.
  void fetch_corners(Scratch& scratch) const {
    constexpr std::int64_t kGap = 32;  // vertices that are read and not needed, rather than to read again
    const std::size_t n = 3 * scratch.triangles.size();
    scratch.order.clear();
    for (std::size_t i = 0; i < n; ++i)
      scratch.order.push_back(static_cast<std::uint64_t>(scratch.triangles[i / 3][i % 3]) << 32 | i);
    std::sort(scratch.order.begin(), scratch.order.end());
    const auto vertex = [&](std::size_t i) { return static_cast<std::int64_t>(scratch.order[i] >> 32); };
    scratch.corners.resize(n);
    scratch.rows.resize(static_cast<std::size_t>(kRows));
    for (std::size_t begin = 0; begin < n;) {
      const std::int64_t first = vertex(begin);
      std::size_t end = begin + 1;
      while (end < n && vertex(end) - vertex(end - 1) <= kGap && vertex(end) - first < kRows) ++end;
      file_.read_vertices(first, vertex(end - 1) - first + 1, scratch.bytes, scratch.rows.data());
      for (; begin < end; ++begin)
        scratch.corners[scratch.order[begin] & 0xffffffffU] =
            scratch.rows[static_cast<std::size_t>(vertex(begin) - first)];
    }
  }

  /// Areas, volume and degenerate triangles, in the blocks of measure() and their order.
  void sum_triangles(MeshReport& report) {
    constexpr std::int64_t kAtOnce = 1024;  // parts whose sums wait to be added
    constexpr std::int64_t kBlocks = kPart / exec::kCpuBlock;
    const Vec3d centre = bounds().centre();
    for (std::int64_t first = 0; first < parts_of(file_); first += kAtOnce) {
      std::vector<std::int64_t> parts;
      for (std::int64_t part = first; part < std::min(first + kAtOnce, parts_of(file_)); ++part) parts.push_back(part);
      std::vector<MeshReport> sums(parts.size() * kBlocks);
      for_parts(parts, [&](std::int64_t part, Scratch& scratch) {
        fetch_corners(scratch);
        MeshReport* const of_part = sums.data() + (part - first) * kBlocks;
        for (std::size_t i = 0; i < scratch.triangles.size(); ++i) {
          const auto corner = [&](std::size_t k) { return to_double(scratch.corners[3 * i + k]) - centre; };
          mesh_detail::add_triangle(scratch.triangles[i], corner(0), corner(1), corner(2),
                                    of_part[i / static_cast<std::size_t>(exec::kCpuBlock)]);
        }
      });
      for (const MeshReport& sum : sums) mesh_detail::add(sum, report);
    }
  }

  PlyMeshParts& file_;
  const std::string& path_;
  Plan plan_;
  Cpu ex_;
  mesh_detail::Joined joined_;
  Buffer<std::int64_t> corners_;  // (v / kCounted) of triangles that are not degenerate
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> scratches_;  // of threads that work no more
  Buffer<std::uint64_t> reaches_;                    // (parts) a bit for each reach with a corner
};

/// For files that cannot be read in parts.
MeshReport measure_as_a_whole(const std::string& path, const ScaleOptions& options) {
  const auto refuse = [&](std::int64_t bytes) {
    if (bytes > options.max_memory_bytes)
      throw Error(
          ErrorCode::over_limit,
          fmt::format("{} cannot be read in parts, and may take {} bytes as a whole; allow more memory, or convert "
                      "it to binary PLY with triangles",
                      io::printable(path), bytes));
  };
  constexpr std::int64_t kOfFile = 6;
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  if (!error && bytes < std::numeric_limits<std::int64_t>::max() / kOfFile)
    refuse(kOfFile * static_cast<std::int64_t>(bytes));
  const Mesh mesh = read_mesh(path, {.shift = std::nullopt, .threads = options.threads});
  refuse(24 * static_cast<std::int64_t>(mesh.vertices.size() + mesh.triangles.size()));
  return measure(mesh, options.threads);
}

}  // namespace

MeshReport measure_file(const std::string& path, const ScaleOptions& options) {
  if (options.max_memory_bytes < 0) throw Error(ErrorCode::usage, "the most memory must not be negative");
  if (options.max_memory_bytes > 0) {
    const std::unique_ptr<PlyMeshParts> file = PlyMeshParts::open(path);
    if (file == nullptr) return measure_as_a_whole(path, options);
    if (bytes_as_a_whole(*file) > options.max_memory_bytes)
      return MeasureInParts(*file, path, plan_for(*file, options)).run();
  }
  return measure(read_mesh(path, {.shift = std::nullopt, .threads = options.threads}), options.threads);
}

}  // namespace pointskin
