// Files written block by block: the same bytes for any number of threads and any target, whole or not at all.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <stdexcept>
#include <thread>
#include <vector>

#include "io/output.hpp"
#include "io/writers.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::bytes_of_file;
using test::make_file;
using test::story_of;
using test::TemporaryFolder;

constexpr int kThreads[] = {1, 2, 5, 16};

/// Blocks of very different sizes, some empty, the largest over 64 KiB: more than a pipe holds.
std::string bytes_of_block(std::int64_t b) {
  const std::size_t size = b % 7 == 3 ? 0 : static_cast<std::size_t>((b * 7919) % 70'001);
  return std::string(size, static_cast<char>('a' + b % 26));
}

io::Blocks blocks_of(std::int64_t count) {
  return {count, [](std::int64_t b, std::string& bytes) { bytes += bytes_of_block(b); }};
}

std::string all_bytes(std::int64_t count) {
  std::string bytes;
  for (std::int64_t b = 0; b < count; ++b) bytes += bytes_of_block(b);
  return bytes;
}

/// Lowers the limit on the size of files, which stands in for a full disk; puts it back at the end of its life.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &before_), 0);
    const rlimit small{bytes, before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST(BlockWriter, WritesTheBlocksOfAFileInOrder) {
  const TemporaryFolder folder;
  for (const int threads : kThreads)
    for (const std::int64_t count : {0, 1, 2, 15, 16, 17, 200}) {
      exec::Cpu ex(threads);
      io::write_blocks(ex, folder.file("a"), blocks_of(count));
      EXPECT_EQ(bytes_of_file(folder.file("a")), all_bytes(count)) << count << " blocks, " << threads << " threads";
    }
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(BlockWriter, WritesTheBlocksOfAPipeInOrder) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
  for (const int threads : kThreads) {
    std::string received;
    std::thread reader([&] { received = bytes_of_file(folder.file("pipe")); });
    exec::Cpu ex(threads);
    io::write_blocks(ex, folder.file("pipe"), blocks_of(60));
    reader.join();
    EXPECT_EQ(received, all_bytes(60)) << threads << " threads";
  }
}

TEST(BlockWriter, StopsWhenTheReaderOfAPipeGoesAway) {
  const TemporaryFolder folder;
  const auto old_handler = std::signal(SIGPIPE, SIG_IGN);
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
  for (const int threads : kThreads) {
    std::thread reader([&] {
      const int fd = ::open(folder.file("pipe").c_str(), O_RDONLY);
      char byte = 0;
      EXPECT_EQ(::read(fd, &byte, 1), 1);
      ::close(fd);
    });
    exec::Cpu ex(threads);
    const std::string story =
        story_of(ErrorCode::output_not_written, [&] { io::write_blocks(ex, folder.file("pipe"), blocks_of(500)); });
    reader.join();
    EXPECT_NE(story.find("Broken pipe"), std::string::npos) << story;
  }
  std::signal(SIGPIPE, old_handler);
}

TEST(BlockWriter, LeavesTheOldFileAndNoOtherWhenTheDiskRefusesHalfway) {
  const TemporaryFolder folder;
  make_file(folder.file("a"), "old");
  for (const int threads : kThreads) {
    exec::Cpu ex(threads);
    for (const rlim_t limit : {1'000u, 1'000'000u}) {
      const FullDisk disk(limit);
      const std::string story =
          story_of(ErrorCode::output_not_written, [&] { io::write_blocks(ex, folder.file("a"), blocks_of(200)); });
      EXPECT_NE(story.find("File too large"), std::string::npos) << story;
    }
    EXPECT_EQ(bytes_of_file(folder.file("a")), "old");
    EXPECT_EQ(folder.file_count(), 1u);
  }
}

TEST(BlockWriter, BringsErrorsOfTheDataToTheCallerAndLeavesNothing) {
  const TemporaryFolder folder;
  for (const int threads : kThreads)
    for (const std::int64_t bad : {0, 1, 50, 99}) {
      exec::Cpu ex(threads);
      const io::Blocks blocks{100, [&](std::int64_t b, std::string& bytes) {
                                if (b == bad) throw std::runtime_error("bad block");
                                bytes += bytes_of_block(b);
                              }};
      EXPECT_THROW(io::write_blocks(ex, folder.file("a"), blocks), std::runtime_error) << threads << " threads";
      EXPECT_EQ(folder.file_count(), 0u);
    }
}

TEST(BlockWriter, MakesEveryBlockOnce) {
  for (const int threads : kThreads) {
    std::vector<std::atomic<int>> calls(300);
    exec::Cpu ex(threads);
    io::write_blocks(ex, "/dev/null",
                     {300, [&](std::int64_t b, std::string&) { ++calls[static_cast<std::size_t>(b)]; }});
    for (const std::atomic<int>& count : calls) EXPECT_EQ(count, 1);
  }
}

/// A strip of `n` vertices and about as many triangles; `n` around the 2^14 rows of a block.
Mesh strip(std::int32_t n, const Vec3d& origin) {
  Mesh mesh;
  mesh.origin = origin;
  for (std::int32_t i = 0; i < n; ++i) {
    mesh.vertices.push_back({static_cast<float>(i), static_cast<float>(i % 7) / 3, static_cast<float>(i % 2)});
    mesh.normals.push_back({0, 0, 1});
    if (i >= 2) mesh.triangles.push_back({i - 2, i - 1, i});
  }
  return mesh;
}

TEST(MeshWriter, WritesTheSameBytesForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  for (const std::int32_t n : {3, 16383, 16384, 16385, 16386, 16387, 50'000})
    for (const Vec3d& origin : {Vec3d{0, 0, 0}, Vec3d{1e6, 2e6, 3e6}}) {
      const Mesh mesh = strip(n, origin);
      for (const std::string extension : {"ply", "obj", "stl"}) {
        write_mesh(folder.file("1." + extension), mesh, 1);
        write_mesh(folder.file("8." + extension), mesh, 8);
        EXPECT_EQ(bytes_of_file(folder.file("1." + extension)), bytes_of_file(folder.file("8." + extension)));
      }
      for (const char* name : {"8.ply", "8.obj"}) {
        const Mesh back = read_mesh(folder.file(name));
        EXPECT_EQ(back.vertices.size(), mesh.vertices.size()) << name;
        EXPECT_EQ(back.triangles, mesh.triangles) << name;
        if (origin == Vec3d{0, 0, 0}) {
          EXPECT_EQ(back.vertices, mesh.vertices) << name;
        }
      }
    }
}

TEST(MeshWriter, RefusesAWrongTriangleInAnyBlockBeforeTheFileIsTouched) {
  const TemporaryFolder folder;
  Mesh mesh = strip(50'000, {0, 0, 0});
  mesh.triangles[40'000][1] = 50'000;
  mesh.triangles[45'000][1] = -1;
  for (const int threads : kThreads) {
    const std::string story =
        story_of(ErrorCode::invalid_input, [&] { write_mesh(folder.file("a.ply"), mesh, threads); });
    EXPECT_NE(story.find("vertex 50000 of 50000"), std::string::npos) << story;
    EXPECT_EQ(folder.file_count(), 0u);
  }
}

TEST(BlockWriter, OfPlyKnowsThePlacesOfBlocksBeforeTheyAreMade) {
  Cloud cloud = test::sphere_cloud(40'000, 1);
  cloud.attributes.push_back({"class", std::vector<std::uint8_t>(cloud.positions.size(), 7)});
  for (const Vec3d& origin : {Vec3d{0, 0, 0}, Vec3d{1e5, 0, 0}}) {
    cloud.origin = origin;
    const io::Blocks blocks = io::format_ply_cloud(cloud, {});
    ASSERT_EQ(blocks.count, 4);  // the header, and 2^14 points each
    std::string bytes;
    for (std::int64_t b = 0; b < blocks.count; ++b) {
      EXPECT_EQ(blocks.place(b), std::ssize(bytes)) << b;
      blocks.make(b, bytes);
    }
    EXPECT_EQ(blocks.place(blocks.count), std::ssize(bytes));
  }
  EXPECT_FALSE(io::format_ply_cloud(cloud, {.ascii = true}).place);
}

}  // namespace
}  // namespace pointskin
