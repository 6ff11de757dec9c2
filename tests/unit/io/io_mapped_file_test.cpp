#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include <pointskin/formats.hpp>

#include "io/file_descriptor.hpp"
#include "io/input.hpp"
#include "io/mapped_file.hpp"
#include "support/io_files.hpp"

namespace pointskin {
namespace {

using io::FileDescriptor;
using io::MappedFile;
using test::make_file;
using test::story_of;
using test::TemporaryFolder;

constexpr std::size_t kBytes = 100'000;  // pages, and a part of one

class MappedFileTest : public testing::Test {
 protected:
  MappedFileTest() { make_file(path_, std::string(kBytes, 'x')); }

  TemporaryFolder folder_;
  std::string path_ = folder_.file("a");
};

using handler_type = void (*)(int, siginfo_t*, void*);

handler_type bus_handler() {
  struct sigaction now = {};
  ::sigaction(SIGBUS, nullptr, &now);
  return now.sa_sigaction;
}

TEST_F(MappedFileTest, HoldsTheBytesOfTheFile) {
  const FileDescriptor file(::open(path_.c_str(), O_RDONLY));
  MappedFile mapped;
  EXPECT_FALSE(mapped.mapped());
  ASSERT_TRUE(mapped.map(file.get(), kBytes));
  EXPECT_EQ(mapped.bytes(), std::string(kBytes, 'x'));
  EXPECT_FALSE(mapped.lost_bytes());
}

TEST_F(MappedFileTest, ReadsZerosWhereTheFileWasCutAndSaysSo) {
  const FileDescriptor file(::open(path_.c_str(), O_RDONLY));
  MappedFile mapped;
  ASSERT_TRUE(mapped.map(file.get(), kBytes));
  ASSERT_EQ(::truncate(path_.c_str(), 10), 0);
  EXPECT_EQ(mapped.bytes()[kBytes - 1], '\0');
  EXPECT_EQ(mapped.bytes()[kBytes / 2], '\0');
  EXPECT_EQ(mapped.bytes()[0], 'x');
  EXPECT_TRUE(mapped.lost_bytes());
}

TEST_F(MappedFileTest, LeavesTheHandlerAsItWas) {
  const FileDescriptor file(::open(path_.c_str(), O_RDONLY));
  const handler_type before = bus_handler();
  {
    MappedFile first, second;
    ASSERT_TRUE(first.map(file.get(), kBytes));
    ASSERT_TRUE(second.map(file.get(), kBytes));
    EXPECT_NE(bus_handler(), before);
  }
  EXPECT_EQ(bus_handler(), before);
}

TEST_F(MappedFileTest, LeavesFaultsElsewhereToOthers) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto fault_elsewhere = [&] {
    std::signal(SIGBUS, [](int) { ::_exit(7); });
    const FileDescriptor file(::open(path_.c_str(), O_RDONLY));
    MappedFile mapped;
    mapped.map(file.get(), kBytes);
    const auto* const other =
        static_cast<const volatile char*>(::mmap(nullptr, kBytes, PROT_READ, MAP_SHARED, file.get(), 0));
    if (::truncate(path_.c_str(), 10) != 0) ::_exit(3);
    ::_exit(other[kBytes - 1] == 0 ? 1 : 2);
  };
  EXPECT_EXIT(fault_elsewhere(), testing::ExitedWithCode(7), "");
  const auto sent_by_a_process = [&] {
    std::signal(SIGBUS, [](int) { ::_exit(7); });
    const FileDescriptor file(::open(path_.c_str(), O_RDONLY));
    MappedFile mapped;
    mapped.map(file.get(), kBytes);
    ::raise(SIGBUS);
    ::_exit(1);
  };
  EXPECT_EXIT(sent_by_a_process(), testing::ExitedWithCode(7), "");
}

TEST_F(MappedFileTest, RefusesMoreThanItCanWatch) {
  const FileDescriptor file(::open(path_.c_str(), O_RDONLY));
  std::vector<std::unique_ptr<MappedFile>> all;
  bool refused = false;
  for (int i = 0; i < 100 && !refused; ++i) {
    all.push_back(std::make_unique<MappedFile>());
    refused = !all.back()->map(file.get(), kBytes);
  }
  EXPECT_TRUE(refused);
  all.clear();
  MappedFile again;
  EXPECT_TRUE(again.map(file.get(), kBytes));
}

/// The last page is still there, so that nothing faults.
TEST_F(MappedFileTest, InputThatWasCutWithinItsLastPageIsFoundOut) {
  const io::Input input(path_);
  input.check_whole();
  ASSERT_EQ(::truncate(path_.c_str(), kBytes - 5), 0);
  EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { input.check_whole(); }).find("was cut short"), std::string::npos);
}

TEST(MayHoldFaces, OfAFileThatCannotBeOpenedIsAnError) {
  const TemporaryFolder folder;
  EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { may_hold_faces(folder.file("none.ply")); }), "");
}

}  // namespace
}  // namespace pointskin
