// Zip archives as they are read, by minizip, whose file is memory here.
#include "io/zip.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include <minizip/unzip.h>

#include "io/inflate.hpp"

namespace pointskin::io {
namespace {

constexpr char kAgain[] = "copy or export it again";
constexpr std::uint64_t kMostEntries = 1 << 16;

/// Memory as minizip's file.
struct Memory {
  std::string_view bytes;
  std::uint64_t at = 0;
};

Memory& memory(voidpf of) { return *static_cast<Memory*>(of); }

voidpf open_memory(voidpf all, const void* /*name*/, int /*mode*/) { return all; }

uLong read_memory(voidpf /*all*/, voidpf stream, void* to, uLong count) {
  Memory& m = memory(stream);
  const std::uint64_t part =
      std::min<std::uint64_t>(count, m.bytes.size() - std::min<std::uint64_t>(m.at, m.bytes.size()));
  if (part > 0) std::memcpy(to, m.bytes.data() + m.at, part);
  m.at += part;
  return static_cast<uLong>(part);
}

ZPOS64_T tell_memory(voidpf /*all*/, voidpf stream) { return memory(stream).at; }

long seek_memory(voidpf /*all*/, voidpf stream, ZPOS64_T offset, int origin) {
  Memory& m = memory(stream);
  const std::uint64_t base = origin == ZLIB_FILEFUNC_SEEK_CUR   ? m.at
                             : origin == ZLIB_FILEFUNC_SEEK_END ? m.bytes.size()
                                                                : 0;
  if (base + offset > m.bytes.size()) return -1;
  m.at = base + offset;
  return 0;
}

int close_memory(voidpf /*all*/, voidpf /*stream*/) { return 0; }

zlib_filefunc64_def functions_on(Memory& memory) {
  return {open_memory, read_memory, nullptr, tell_memory, seek_memory, close_memory, close_memory, &memory};
}

[[noreturn]] void fail_broken(const Source& source, const std::string& what) { fail(source, what, kAgain); }

class Reader {
 public:
  explicit Reader(const Source& source) : source_(source), memory_{source.bytes} {
    zlib_filefunc64_def functions = functions_on(memory_);
    file_.reset(unzOpen2_64("", &functions));
    if (!file_) fail_broken(source, "is no zip archive, or is cut off");
  }

  std::vector<ZipEntry> entries() {
    unz_global_info64 info{};
    if (unzGetGlobalInfo64(file_.get(), &info) != UNZ_OK || info.number_entry > kMostEntries)
      fail_broken(source_, "is a broken archive");
    std::vector<ZipEntry> found;
    std::uint64_t left = source_.bytes.size();
    for (std::uint64_t i = 0; i < info.number_entry; ++i) {
      const int at = i == 0 ? unzGoToFirstFile(file_.get()) : unzGoToNextFile(file_.get());
      if (at != UNZ_OK) fail_broken(source_, "is a broken archive");
      found.push_back(entry(left));
    }
    return found;
  }

  std::string unpack(const ZipEntry& entry) {
    const unz64_file_pos at{entry.place[0], entry.place[1]};
    if (unzGoToFilePos64(file_.get(), &at) != UNZ_OK || unzOpenCurrentFile(file_.get()) != UNZ_OK)
      fail_broken(source_, "is a broken archive");
    std::string bytes(entry.bytes, '\0');
    std::uint64_t done = 0;
    while (done < bytes.size()) {
      const auto part = static_cast<unsigned>(std::min<std::uint64_t>(bytes.size() - done, 1u << 30));
      const int count = unzReadCurrentFile(file_.get(), bytes.data() + done, part);
      if (count <= 0) break;
      done += static_cast<std::uint64_t>(count);
    }
    const int closed = unzCloseCurrentFile(file_.get());  // compares the checksum
    if (done != bytes.size() || closed != UNZ_OK) fail_broken(source_, in_quotes(entry.name) + " in it is broken");
    return bytes;
  }

 private:
  struct Close {
    void operator()(void* file) const { unzClose(file); }
  };

  /// The one at which the archive stands. @param left  bytes that compressed files may still have
  ZipEntry entry(std::uint64_t& left) {
    unz_file_info64 info{};
    std::array<char, 512> name{};
    unz64_file_pos place{};
    if (unzGetCurrentFileInfo64(file_.get(), &info, name.data(), name.size() - 1, nullptr, 0, nullptr, 0) != UNZ_OK ||
        unzGetFilePos64(file_.get(), &place) != UNZ_OK)
      fail_broken(source_, "is a broken archive");
    ZipEntry entry{name.data(), info.uncompressed_size, {}, {place.pos_in_zip_directory, place.num_of_file}};
    if (info.flag & 1) fail(source_, in_quotes(entry.name) + " in it is encrypted", "save it without a password");
    const bool deflated = info.compression_method == Z_DEFLATED;
    if (!deflated && info.compression_method != 0)
      fail(source_, in_quotes(entry.name) + " in it is compressed in another way than deflate", "save it with deflate");
    if (info.compressed_size > left || (!deflated && info.compressed_size != info.uncompressed_size) ||
        !fits(info.uncompressed_size, 1, kMostDeflated * info.compressed_size))
      fail_broken(source_, in_quotes(entry.name) + " in it cannot be as long as it says");
    left -= info.compressed_size;
    if (!deflated) entry.stored = stored(entry);
    return entry;
  }

  std::string_view stored(const ZipEntry& entry) {
    if (unzOpenCurrentFile(file_.get()) != UNZ_OK) fail_broken(source_, "is a broken archive");
    const std::uint64_t begin = unzGetCurrentFileZStreamPos64(file_.get());
    unzCloseCurrentFile(file_.get());
    if (begin > source_.bytes.size() || entry.bytes > source_.bytes.size() - begin)
      fail_broken(source_, in_quotes(entry.name) + " in it is cut off");
    return source_.bytes.substr(begin, entry.bytes);
  }

  const Source& source_;
  Memory memory_;
  std::unique_ptr<void, Close> file_;
};

}  // namespace

std::vector<ZipEntry> zip_entries(const Source& source) { return Reader(source).entries(); }

std::string unzip(const Source& source, const ZipEntry& entry) { return Reader(source).unpack(entry); }

}  // namespace pointskin::io
