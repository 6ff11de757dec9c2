// Archives as they are written. minizip is not asked: where memory runs out it writes through a null pointer (1.1).
// Source: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification" 6.3.10, 4.3 to 4.5; deflate and checksums by zlib.
#include <pointskin/error.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <zlib.h>

#include "io/zip.hpp"

namespace pointskin::io {
namespace {

constexpr std::uint64_t kNo32Bits = 0xFFFFFFFF;  ///< stands in for what a field of 64 bits tells
constexpr std::uint64_t kNo16Bits = 0xFFFF;
constexpr unsigned kMostAtOnce = 1u << 30;  // zlib counts in unsigned int

/// Little-endian fields, one after another.
class Fields {
 public:
  Fields& u16(std::uint64_t value) { return add(value, 2); }
  Fields& u32(std::uint64_t value) { return add(value, 4); }
  Fields& u64(std::uint64_t value) { return add(value, 8); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  Fields& add(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) bytes_ += static_cast<char>(value >> (8 * i) & 0xFF);
    return *this;
  }
  std::string bytes_;
};

/// What both headers of a file tell of it.
struct Packed {
  std::string name;
  bool is_deflated = false;
  bool is_text = false;  ///< as zlib sees it
  std::uint32_t checksum = 0;
  std::uint64_t packed = 0, unpacked = 0;  ///< bytes
  std::uint64_t offset = 0;                ///< of the local header

  [[nodiscard]] bool is_large() const { return packed >= kNo32Bits || unpacked >= kNo32Bits; }
};

/// What the format does not hold without its extension of 64 bits needs a reader of version 4.5.
int version_for(bool is_large) { return is_large ? 45 : 20; }

/// From the version that a reader needs to the lengths: the same in both headers.
Fields& add_common(Fields& fields, const Packed& file, bool is_large, std::size_t extra_bytes) {
  constexpr std::uint32_t kFirstDay = (1 << 21) | (1 << 16);  // that the format knows: the same bytes at any time
  fields.u16(static_cast<std::uint64_t>(version_for(is_large))).u16(0).u16(file.is_deflated ? Z_DEFLATED : 0);
  fields.u32(kFirstDay).u32(file.checksum);
  fields.u32(file.is_large() ? kNo32Bits : file.packed).u32(file.is_large() ? kNo32Bits : file.unpacked);
  return fields.u16(file.name.size()).u16(extra_bytes);
}

Fields sizes_of_64_bits(const Packed& file) {
  Fields fields;
  return fields.u64(file.unpacked).u64(file.packed);
}

std::string extra_of(const std::string& values) {
  if (values.empty()) return {};
  Fields fields;
  return fields.u16(1).u16(values.size()).bytes() + values;
}

std::string local_header(const Packed& file) {
  const std::string extra = file.is_large() ? extra_of(sizes_of_64_bits(file).bytes()) : "";
  Fields fields;
  fields.u32(0x04034b50);
  return add_common(fields, file, file.is_large(), extra.size()).bytes() + file.name + extra;
}

std::string central_header(const Packed& file) {
  const bool is_far = file.offset >= kNo32Bits;
  Fields values;
  if (file.is_large()) values = sizes_of_64_bits(file);
  if (is_far) values.u64(file.offset);
  const std::string extra = extra_of(values.bytes());
  Fields fields;
  fields.u32(0x02014b50).u16(0);
  add_common(fields, file, file.is_large() || is_far, extra.size());
  fields.u16(0)
      .u16(0)
      .u16(file.is_text ? 1 : 0)
      .u32(0)
      .u32(is_far ? kNo32Bits : file.offset);  // no comment, one disk, no permissions
  return fields.bytes() + file.name + extra;
}

std::string end_of_archive(std::uint64_t count, std::uint64_t begin, std::uint64_t bytes) {
  Fields fields;
  if (count >= kNo16Bits || begin >= kNo32Bits || bytes >= kNo32Bits) {
    fields.u32(0x06064b50).u64(44).u16(45).u16(45).u32(0).u32(0).u64(count).u64(count).u64(bytes).u64(begin);
    fields.u32(0x07064b50).u32(0).u64(begin + bytes).u32(1);  // where the record before begins
  }
  const std::uint64_t shown = std::min(count, kNo16Bits);
  fields.u32(0x06054b50).u16(0).u16(0).u16(shown).u16(shown);
  return fields.u32(std::min(bytes, kNo32Bits)).u32(std::min(begin, kNo32Bits)).u16(0).bytes();
}

std::uint32_t checksum_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// A stream of deflate without a header of zlib's. Throws std::bad_alloc where zlib has no memory.
class Deflater {
 public:
  Deflater() {
    constexpr int kMemory = 8;  // zlib's default
    const int begun =
        ::deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, kMemory, Z_DEFAULT_STRATEGY);
    if (begun != Z_OK) throw std::bad_alloc();
  }
  ~Deflater() { ::deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  /// All of a stream. @returns true if zlib takes it for text
  bool append(std::string_view bytes, std::string& out) {
    std::size_t read = 0;
    int state = Z_OK;
    while (state != Z_STREAM_END) {
      const std::size_t part = std::min<std::size_t>(bytes.size() - read, kMostAtOnce);
      const std::size_t held = out.size();
      const auto room = static_cast<unsigned>(std::min<std::size_t>(part / 2 + (1u << 12), kMostAtOnce));
      out.resize(held + room);
      stream_.next_in = reinterpret_cast<Bytef*>(
          const_cast<char*>(bytes.data() + read));  // NOLINT(cppcoreguidelines-pro-type-const-cast)
      stream_.avail_in = static_cast<unsigned>(part);
      stream_.next_out = reinterpret_cast<Bytef*>(out.data() + held);
      stream_.avail_out = room;
      state = ::deflate(&stream_, read + part == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
      read += part - stream_.avail_in;
      out.resize(held + room - stream_.avail_out);
    }
    return stream_.data_type == Z_TEXT;
  }

 private:
  z_stream stream_{};
};

Packed add_file(const ZipFile& file, bool is_deflated, std::string& archive) {
  if (file.name.size() > kNo16Bits)
    throw Error(ErrorCode::over_limit, "a name in a zip archive has at most 65,535 bytes");
  Packed packed{file.name,         is_deflated,       false,         checksum_of(file.bytes),
                file.bytes.size(), file.bytes.size(), archive.size()};
  if (!is_deflated) {
    archive += local_header(packed);
    archive += file.bytes;
    return packed;
  }
  std::string bytes;
  packed.is_text = Deflater().append(file.bytes, bytes);
  packed.packed = bytes.size();
  archive += local_header(packed);
  archive += bytes;
  return packed;
}

}  // namespace

std::string zip(const std::vector<ZipFile>& files, bool deflated) {
  std::string archive;
  std::string directory;
  for (const ZipFile& file : files) directory += central_header(add_file(file, deflated, archive));
  const std::uint64_t begin = archive.size();
  archive += directory;
  archive += end_of_archive(files.size(), begin, directory.size());
  return archive;
}

}  // namespace pointskin::io
