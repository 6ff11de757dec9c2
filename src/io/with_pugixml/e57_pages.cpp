#include "io/with_pugixml/e57_pages.hpp"

#include <algorithm>

#include "core/format.hpp"
#include "io/blocks.hpp"
#include "io/crc32c.hpp"
#include "io/readers.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

constexpr std::size_t kHeader = 48;
constexpr std::size_t kChecksum = 4;
constexpr std::size_t kSmallestPage = 64, kLargestPage = 1 << 20;

// Mutations would never get by the checksums.
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr bool kChecksSums = false;
#else
constexpr bool kChecksSums = true;
#endif

struct Header {
  std::uint64_t file_bytes = 0, xml_place = 0, xml_bytes = 0, page_bytes = 0;
};

Header parse_header(const Source& source) {
  const std::string_view bytes = source.bytes;
  if (!is_e57(bytes)) fail(source, "does not begin as an E57 file", kE57Again);
  if (bytes.size() < kHeader) fail_at_byte(source, "is truncated in its header", bytes.size(), kE57Again);
  const auto number = [&](std::size_t at) { return load<std::uint64_t>(bytes.data() + at, false); };
  if (const auto major = load<std::uint32_t>(bytes.data() + 8, false); major != 1)
    fail(source, fmt::format("is of E57 {}.{}", major, load<std::uint32_t>(bytes.data() + 12, false)),
         "export it as E57 1.0");
  const Header header{number(16), number(24), number(32), number(40)};
  if (header.page_bytes < kSmallestPage || header.page_bytes > kLargestPage)
    fail(source, fmt::format("has pages of {} bytes", header.page_bytes), kE57Again);
  if (header.file_bytes > bytes.size())
    fail_at_byte(source, fmt::format("is truncated, {} bytes are promised", header.file_bytes), bytes.size(),
                 kE57Again);
  if (header.file_bytes < header.page_bytes || header.file_bytes % header.page_bytes != 0)
    fail(source, "does not end at the end of a page", kE57Again);
  return header;
}

/// Copies the pages [first, last) without their checksums.
void copy_pages(const Source& source, const Header& header, std::size_t first, std::size_t last, std::string& to) {
  const std::size_t held = header.page_bytes - kChecksum;
  for (std::size_t page = first; page < last; ++page) {
    const std::string_view from = source.bytes.substr(page * header.page_bytes, held);
    const auto sum = load<std::uint32_t>(from.data() + held, true);
    if (kChecksSums && crc32c(from) != sum)
      fail_at_byte(source, "is damaged, the checksum of a page differs", page * header.page_bytes, kE57Again);
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(page * held));
  }
}

}  // namespace

bool is_e57(std::string_view start) { return start.starts_with("ASTM-E57"); }

std::size_t E57Pages::place_of(const Source& source, std::uint64_t in_file) const {
  const std::size_t held = page_bytes - kChecksum;
  const std::uint64_t page = in_file / page_bytes;
  const std::uint64_t rest = in_file % page_bytes;
  if (rest >= held || page >= bytes.size() / held)
    fail(source, fmt::format("names byte {}, where nothing can be", in_file), kE57Again);
  return page * held + rest;
}

E57Pages read_e57_pages(exec::Cpu& ex, const Source& source) {
  const Header header = parse_header(source);
  constexpr std::size_t kBlockPages = 256;
  const std::size_t pages = header.file_bytes / header.page_bytes;
  E57Pages read{std::string(pages * (header.page_bytes - kChecksum), '\0'), header.page_bytes, {}};
  run_in_order(ex, static_cast<std::int64_t>((pages + kBlockPages - 1) / kBlockPages), [&](std::int64_t block) {
    const std::size_t first = static_cast<std::size_t>(block) * kBlockPages;
    copy_pages(source, header, first, std::min(pages, first + kBlockPages), read.bytes);
  });
  const std::size_t place = read.place_of(source, header.xml_place);
  if (header.xml_bytes > read.bytes.size() - place) fail(source, "ends before its XML does", kE57Again);
  read.xml = std::string_view(read.bytes).substr(place, header.xml_bytes);
  return read;
}

}  // namespace pointskin::io
