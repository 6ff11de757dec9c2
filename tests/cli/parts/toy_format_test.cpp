// A format that is added to the table, and nowhere else, is read, probed, named in messages and written: nothing else
// in the library or the program knows formats. The other places where people meet a format by name are the help texts
// and documents, which tests/cli/formats_help_test.cpp compares with the table.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include <pointskin/error.hpp>

#include "io/formats.hpp"
#include "output_check.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

/// "toy", then a line x y z for each corner of each triangle.
Mesh read_toy(exec::Cpu& /*ex*/, const io::Source& source, const ReadOptions& /*options*/) {
  std::istringstream text(std::string(source.bytes.substr(3)));
  Mesh mesh;
  for (Vec3f p; text >> p.x >> p.y >> p.z;) mesh.vertices.push_back(p);
  for (std::int32_t v = 0; v + 2 < static_cast<std::int32_t>(mesh.vertices.size()); v += 3)
    mesh.triangles.push_back({v, v + 1, v + 2});
  return mesh;
}

io::Blocks write_toy(const Mesh& mesh, const WriteOptions& /*options*/) {
  return {1, [&mesh](std::int64_t /*block*/, std::string& bytes) {
            std::ostringstream text;
            text << "toy\n";
            for (const Triangle& triangle : mesh.triangles)
              for (const std::int32_t v : triangle) {
                const Vec3f& p = mesh.vertices[static_cast<std::size_t>(v)];
                text << p.x << ' ' << p.y << ' ' << p.z << '\n';
              }
            bytes += text.str();
          }};
}

class ToyFormat : public testing::Test {
 protected:
  ToyFormat() {
    table_.push_back({{.name = "toy", .extensions = {".toy"}, .attributes = HeldAttributes::none},
                      {.has_magic = [](std::string_view start) { return start.starts_with("toy\n"); },
                       .read_mesh = read_toy,
                       .write_mesh = write_toy}});
    infos_ = io::infos_of(table_);
  }

  std::vector<io::Format> table_{io::formats().begin(), io::formats().end()};
  std::vector<FormatInfo> infos_;
  const std::string one_triangle_ = "toy\n0 0 0\n1 0 0\n0 1 0\n";
};

TEST_F(ToyFormat, IsReadByItsNameAndByItsFirstBytes) {
  for (const char* name : {"a.toy", "a.xyz", "stdin"}) {
    const Mesh mesh = io::parse_mesh({name, one_triangle_}, {}, table_);
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}})) << name;
    EXPECT_EQ(io::parse_cloud({name, one_triangle_}, {}, table_).positions, mesh.vertices) << name;
  }
  EXPECT_EQ(io::parse_mesh({"a.toy", "TOY 0 0 0 1 0 0 0 1 0"}, {}, table_).triangles.size(), 1U) << "by its name alone";
}

TEST_F(ToyFormat, IsProbed) {
  EXPECT_TRUE(io::may_hold_faces("a.toy", "", table_));
  EXPECT_TRUE(io::may_hold_faces("a", one_triangle_, table_));
  EXPECT_FALSE(io::may_hold_faces("a.toy", "")) << "without the entry it is unknown";
}

TEST_F(ToyFormat, IsNamedWhereOthersAreUnknown) {
  const auto list = [&](bool FormatInfo::*can) { return extension_list(can, infos_); };
  EXPECT_TRUE(list(&FormatInfo::reads_meshes).ends_with(" or .toy"));
  EXPECT_EQ(story_of(ErrorCode::usage, [&] { cli::check_mesh_output("a.step", infos_); }),
            "a.step: unknown output format; use " + list(&FormatInfo::writes_meshes) + ", or - for PLY on stdout");
  EXPECT_EQ(story_of(ErrorCode::usage, [&] { io::mesh_format("a.step", table_); }),
            "a.step: unknown extension; use " + list(&FormatInfo::writes_meshes));
  EXPECT_EQ(story_of(ErrorCode::invalid_input,
                     [&] {
                       io::parse_mesh({"a.step", "1"}, {}, table_);
                     }),
            "a.step: has the unknown extension '.step'; use " + list(&FormatInfo::reads_meshes));
  EXPECT_EQ(story_of(ErrorCode::invalid_input,
                     [&] {
                       io::parse_mesh({"a.csv", "1"}, {}, table_);
                     }),
            "a.csv: is a file of points, not a mesh; name a " + list(&FormatInfo::reads_meshes) + " file");
}

TEST_F(ToyFormat, IsWritten) {
  const TemporaryFolder folder;
  const std::string path = folder.file("box.toy");
  EXPECT_EQ(story_of(ErrorCode::usage, [&] { cli::check_mesh_output(path, infos_); }), "");
  const Mesh box = box_mesh();
  exec::Cpu ex(1);
  io::write_blocks(ex, path, io::mesh_format(path, table_).run.write_mesh(box, {}));
  const std::string bytes = bytes_of_file(path);
  EXPECT_EQ(bytes.substr(0, 4), "toy\n");
  EXPECT_EQ(io::parse_mesh({path, bytes}, {}, table_).triangles.size(), box.triangles.size());
}

TEST_F(ToyFormat, HoldsNoCloud) { EXPECT_EQ(io::cloud_format("a.toy", table_).info.name, "PLY"); }

}  // namespace
}  // namespace pointskin::test
