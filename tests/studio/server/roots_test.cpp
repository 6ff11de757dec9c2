// Files below a few folders, and no others.
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "studio/session/roots.hpp"
#include "studio/session/utf8.hpp"

namespace pointskin::test {
namespace {

namespace fs = std::filesystem;
using studio::FolderEntry;
using studio::Lookup;
using studio::ReadableFile;
using studio::Roots;
using studio::WritableFile;

void save(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// root/{a.ply, sub/b.ply, out -> outside, file -> outside/secret, inner -> sub, loop -> loop}, outside/{secret, deep/secret}
class RootsBy : public testing::TestWithParam<Lookup> {
 protected:
  RootsBy() {
    std::string form = (fs::temp_directory_path() / "pointskin-roots-XXXXXX").string();
    folder_ = fs::canonical(mkdtemp(form.data()));
    root_ = folder_ / "root";
    fs::create_directories(root_ / "sub");
    fs::create_directories(folder_ / "outside" / "deep");
    fs::create_directories(folder_ / "root2");
    save(root_ / "a.ply", "inside");
    save(root_ / "sub" / "b.ply", "below");
    save(folder_ / "outside" / "secret", "secret");
    save(folder_ / "outside" / "deep" / "secret", "secret");
    save(folder_ / "root2" / "c.ply", "other");
    fs::create_symlink(folder_ / "outside", root_ / "out");
    fs::create_symlink(folder_ / "outside" / "secret", root_ / "file");
    fs::create_symlink("sub", root_ / "inner");
    fs::create_symlink("loop", root_ / "loop");
  }
  ~RootsBy() override { fs::remove_all(folder_); }

  [[nodiscard]] Roots roots() const { return Roots({root_}, GetParam()); }

  /// The code of the error that `action` throws; 0 if it throws none.
  template <class Action>
  static int code_of(const Action& action) {
    try {
      action();
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find("secret contents"), std::string::npos);
      return static_cast<int>(error.code());
    }
    return 0;
  }

  fs::path folder_, root_;
};

std::string content(const ReadableFile& file) {
  std::string text(100, '\0');
  const ssize_t count = read(file.number(), text.data(), text.size());
  text.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  return text;
}

TEST_P(RootsBy, ReadsBelowAndByAbsolutePaths) {
  EXPECT_EQ(content(roots().open_read("a.ply")), "inside");
  EXPECT_EQ(content(roots().open_read("./sub//b.ply")), "below");
  const ReadableFile file = roots().open_read(root_ / "sub" / "b.ply");
  EXPECT_EQ(content(file), "below");
  EXPECT_EQ(file.path(), root_ / "sub" / "b.ply");
  EXPECT_TRUE(file.pinned_path().ends_with("/b.ply")) << "readers tell formats by the extension";
  EXPECT_EQ(text_of(file.pinned_path()), "below");
  EXPECT_EQ(file.readable(file.pinned_path() + ": is broken"), file.path().string() + ": is broken");
}

TEST_P(RootsBy, NothingOutsideIsRead) {
  const fs::path secret = folder_ / "outside" / "secret";
  const std::vector<fs::path> paths = {secret,
                                       "/etc/passwd",
                                       "../outside/secret",
                                       "sub/../../outside/secret",
                                       "sub/../a.ply",
                                       root_ / ".." / "outside" / "secret",
                                       folder_ / "root2" / "c.ply",
                                       folder_ / "roo",
                                       "out/secret",
                                       "out/deep/secret",
                                       "file",
                                       "inner/b.ply",
                                       "loop",
                                       "loop/x",
                                       "sub",
                                       ".",
                                       "",
                                       "/",
                                       "nothing.ply",
                                       "a.ply/x",
                                       std::string("a.ply\0x", 7),
                                       std::string("out\0/secret", 11),
                                       std::string(300, 'x'),
                                       std::string(100'000, 'x'),
                                       fs::path("sub") / std::string(5000, '/') / "b.ply",
                                       "/proc/self/root/etc/passwd",
                                       "/proc/self/fd/0"};
  for (const fs::path& path : paths)
    EXPECT_EQ(code_of([&] { (void)roots().open_read(path); }), 3) << path.string().substr(0, 80);
}

TEST_P(RootsBy, PipesAreNotWaitedFor) {
  ASSERT_EQ(mkfifo((root_ / "pipe.ply").c_str(), 0600), 0);
  EXPECT_EQ(code_of([&] { (void)roots().open_read("pipe.ply"); }), 3);
}

TEST_P(RootsBy, ListsFoldersThenFilesAndNoLinks) {
  save(root_ / "Zebra.ply", "12345");
  save(root_ / ".hidden", "");
  save(root_ / "bad\xff.ply", "");
  const std::vector<FolderEntry> entries = roots().list("");
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[0].name, "sub");
  EXPECT_TRUE(entries[0].is_folder);
  EXPECT_EQ(entries[1].name, "Zebra.ply");
  EXPECT_EQ(entries[1].bytes, 5);
  EXPECT_EQ(entries[2].name, "a.ply");
  EXPECT_EQ(roots().list(root_).size(), 3U);
  EXPECT_EQ(roots().list("sub/").front().name, "b.ply");
}

TEST_P(RootsBy, NoFolderOutsideIsListed) {
  for (const fs::path path : {"..", "out", "out/deep", "inner", "/", "/etc", "a.ply", "nothing", "sub/..", "loop"})
    EXPECT_EQ(code_of([&] { (void)roots().list(path); }), 3) << path;
  EXPECT_EQ(code_of([&] { (void)roots().list(folder_); }), 3);
}

TEST_P(RootsBy, WritesWholeFilesOrNone) {
  {
    WritableFile file = roots().prepare_write("sub", "new.ply", false);
    EXPECT_EQ(file.path(), root_ / "sub" / "new.ply");
    EXPECT_EQ(fs::path(file.pinned_path()).extension(), ".ply");
    write_file_atomically(file.pinned_path(), "written");
    EXPECT_FALSE(fs::exists(file.path()));
    EXPECT_EQ(file.commit(), 7);
  }
  EXPECT_EQ(text_of(root_ / "sub" / "new.ply"), "written");
  {
    const WritableFile file = roots().prepare_write("sub", "gone.ply", false);
    write_file_atomically(file.pinned_path(), "half");
  }
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(root_ / "sub")) ++files;
  EXPECT_EQ(files, 2U) << "b.ply and new.ply; nothing of our own is left";
}

TEST_P(RootsBy, OverwritesOnlyWhenAskedTo) {
  EXPECT_EQ(code_of([&] { (void)roots().prepare_write("", "a.ply", false); }), 8);
  EXPECT_EQ(text_of(root_ / "a.ply"), "inside");
  fs::permissions(root_ / "a.ply", fs::perms{0640});
  WritableFile file = roots().prepare_write(root_, "a.ply", true);
  write_file_atomically(file.pinned_path(), "new");
  file.commit();
  EXPECT_EQ(text_of(root_ / "a.ply"), "new");
  EXPECT_EQ(static_cast<int>(fs::status(root_ / "a.ply").permissions()), 0640);
}

TEST_P(RootsBy, AFileThatAppearsMeanwhileStays) {
  WritableFile file = roots().prepare_write("", "new.ply", false);
  write_file_atomically(file.pinned_path(), "ours");
  save(root_ / "new.ply", "theirs");
  EXPECT_EQ(code_of([&] { file.commit(); }), 8);
  EXPECT_EQ(text_of(root_ / "new.ply"), "theirs");
}

TEST_P(RootsBy, NothingOutsideIsWritten) {
  for (const std::string name : {"", ".", "..", "a/b", "/etc/x", "../x"})
    EXPECT_EQ(code_of([&] { (void)roots().prepare_write("", name, true); }), 8) << name;
  EXPECT_EQ(code_of([&] { (void)roots().prepare_write("", std::string("a\0b", 3), true); }), 8);
  EXPECT_EQ(code_of([&] { (void)roots().prepare_write("", std::string(256, 'x'), true); }), 8);
  for (const fs::path folder : {"..", "out", "out/deep", "inner", "/", "/tmp", "nothing", "a.ply"})
    EXPECT_EQ(code_of([&] { (void)roots().prepare_write(folder, "x", true); }), 8) << folder;
  for (const std::string link : {"file", "out", "loop", "sub"})
    EXPECT_EQ(code_of([&] { (void)roots().prepare_write("", link, true); }), 8) << link;
  EXPECT_EQ(text_of(folder_ / "outside" / "secret"), "secret");
}

TEST_P(RootsBy, AFolderExchangedForALinkMeanwhileLeadsNowhere) {
  const Roots roots = this->roots();
  const ReadableFile reading = roots.open_read("sub/b.ply");
  WritableFile writing = roots.prepare_write("sub", "secret", true);
  fs::rename(root_ / "sub", root_ / "moved");
  fs::create_symlink(folder_ / "outside", root_ / "sub");
  save(folder_ / "outside" / "b.ply", "another");
  EXPECT_EQ(text_of(reading.pinned_path()), "below");
  write_file_atomically(writing.pinned_path(), "written");
  writing.commit();
  EXPECT_EQ(text_of(folder_ / "outside" / "secret"), "secret");
  EXPECT_EQ(text_of(root_ / "moved" / "secret"), "written");
}

TEST_P(RootsBy, AFileExchangedForALinkMeanwhileIsNoticed) {
  const Roots roots = this->roots();
  const ReadableFile reading = roots.open_read("a.ply");
  reading.check_unchanged();
  WritableFile writing = roots.prepare_write("", "a.ply", true);
  fs::remove(root_ / "a.ply");
  fs::create_symlink(folder_ / "outside" / "secret", root_ / "a.ply");
  EXPECT_EQ(code_of([&] { reading.check_unchanged(); }), 3);
  write_file_atomically(writing.pinned_path(), "written");
  writing.commit();
  EXPECT_EQ(text_of(root_ / "a.ply"), "written");
  EXPECT_EQ(text_of(folder_ / "outside" / "secret"), "secret");
}

TEST_P(RootsBy, SeveralRootsAreSearchedByTheirPaths) {
  const Roots both({root_, folder_ / "root2", root_ / "out" / "..", root_}, GetParam());
  EXPECT_EQ(both.folders().size(), 3U) << "one of them twice";
  EXPECT_EQ(content(both.open_read(folder_ / "root2" / "c.ply")), "other");
  EXPECT_EQ(code_of([] { Roots({"/nothing/of/this/name"}); }), 2);
  EXPECT_EQ(code_of([] { Roots(std::vector<fs::path>{}); }), 2);
}

INSTANTIATE_TEST_SUITE_P(Lookup, RootsBy, testing::Values(Lookup::automatic, Lookup::by_parts),
                         [](const auto& info) { return info.param == Lookup::by_parts ? "Parts" : "Openat2"; });

TEST(Utf8, IsTextThatJsonCanHold) {
  for (const std::string good : {"", "a", "\xc3\xa4", "\xe2\x82\xac", "\xf0\x9f\x98\x80", "\x7f", "\xf4\x8f\xbf\xbf"})
    EXPECT_TRUE(studio::is_utf8(good)) << good;
  for (const std::string bad : {"\x80", "\xc3", "a\xff", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                                "\xf8\x88\x80\x80\x80", "\xc3("})
    EXPECT_FALSE(studio::is_utf8(bad)) << testing::PrintToString(bad);
}

}  // namespace
}  // namespace pointskin::test
