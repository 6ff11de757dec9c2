#include "cli/files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>

namespace pointskin::test {
namespace {

/// Corners of the cube grid get one id each, whichever faces they lie on.
class CubeGrid {
 public:
  explicit CubeGrid(int n) : n_(n) {
    for (int axis = 0; axis < 3; ++axis) {
      add_face(axis, 0);
      add_face(axis, n);
    }
  }
  [[nodiscard]] std::string ply() const {
    std::ostringstream text;
    text << "ply\nformat ascii 1.0\nelement vertex " << points_.size() << "\nproperty float x\nproperty float y\n"
         << "property float z\nelement face " << triangles_.size() << "\nproperty list uchar int vertex_indices\n"
         << "end_header\n";
    for (const auto& p : points_) text << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    for (const auto& t : triangles_) text << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
    return text.str();
  }

 private:
  using Corner = std::array<int, 3>;

  int id_of(const Corner& corner) {
    const auto [at, added] = ids_.try_emplace(corner, static_cast<int>(points_.size()));
    if (added) points_.push_back(corner);
    return at->second;
  }

  void add_face(int axis, int level) {
    const auto a = static_cast<std::size_t>(axis), b = (a + 1) % 3, c = (a + 2) % 3;
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; j < n_; ++j) {
        std::array<int, 4> q{};
        for (int k = 0; k < 4; ++k) {
          Corner corner{};
          corner[a] = level;
          corner[b] = i + (k == 1 || k == 2 ? 1 : 0);
          corner[c] = j + (k >= 2 ? 1 : 0);
          q[static_cast<std::size_t>(k)] = id_of(corner);
        }
        if (level == 0) std::swap(q[1], q[3]);  // The normal of this face points down its axis.
        triangles_.push_back({q[0], q[1], q[2]});
        triangles_.push_back({q[0], q[2], q[3]});
      }
    }
  }

  int n_;
  std::map<Corner, int> ids_;
  std::vector<Corner> points_;
  std::vector<std::array<int, 3>> triangles_;
};

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "pointskin-cli-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<Sample> sphere(int count, const Vec3f& centre) {
  std::vector<Sample> samples;
  const double golden_angle = std::acos(-1.0) * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count;
    const double r = std::sqrt(1 - z * z);
    const Vec3f n{static_cast<float>(r * std::cos(golden_angle * i)),
                  static_cast<float>(r * std::sin(golden_angle * i)), static_cast<float>(z)};
    samples.push_back({{centre.x + n.x, centre.y + n.y, centre.z + n.z}, n});
  }
  return samples;
}

std::vector<Sample> shuffled(std::vector<Sample> samples, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::shuffle(samples.begin(), samples.end(), random);
  return samples;
}

std::string ply_bytes(const std::vector<Sample>& samples, bool with_normals) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(samples.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\n";
  if (with_normals) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
  bytes += "end_header\n";
  for (const Sample& s : samples) {
    bytes.append(reinterpret_cast<const char*>(&s), with_normals ? sizeof(Sample) : sizeof(Vec3f));
  }
  return bytes;
}

std::string cube_mesh_ply(int n) { return CubeGrid(n).ply(); }

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_file(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

}  // namespace pointskin::test
