#include "io/laz/decoder.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "io/blocks.hpp"
#include "io/laz/items.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

constexpr char kAgain[] = "copy or export it again";
constexpr std::uint64_t kMostUnpacked = 1000;  ///< times the bytes of the file: points are seldom a tenth as large
constexpr std::uint32_t kAdaptive = std::numeric_limits<std::uint32_t>::max();

enum class Kind : std::uint16_t {
  bytes = 0,
  point = 6,
  time = 7,
  colour = 8,
  wave = 9,
  point14 = 10,
  colour14 = 11,
  colour_infrared14 = 12,
  wave14 = 13,
  bytes14 = 14,
};

struct Item {
  Kind kind;
  std::size_t bytes;
  int version;
};

/// How the points are compressed, as the record of LASzip tells it.
struct Coding {
  bool is_chunked = true, is_layered = false;
  std::uint32_t chunk_points = 0;
  std::vector<Item> items;
};

struct Chunk {
  std::uint64_t first = 0, points = 0;  ///< in the file
  std::string_view bytes;
};

[[noreturn]] void fail_garbled(const Source& source, const std::string& what) { fail(source, what, kAgain); }

Coding coding_of(const Source& source, const LasHeader& header) {
  const std::string_view record = header.compression;
  constexpr std::size_t kHead = 34, kItem = 6;
  if (record.size() < kHead + kItem) fail_garbled(source, "is compressed, but does not say how");
  const auto compressor = load<std::uint16_t>(record.data(), false);
  const auto coder = load<std::uint16_t>(record.data() + 2, false);
  if (compressor < 1 || compressor > 3 || coder != 0)
    fail(source, fmt::format("is compressed in the way {} of LASzip", compressor), "unpack it with laszip");
  Coding coding{compressor != 1, compressor == 3, load<std::uint32_t>(record.data() + 12, false), {}};
  const std::size_t count = load<std::uint16_t>(record.data() + 32, false);
  if (!fits(count, kItem, record.size() - kHead)) fail_garbled(source, "is compressed, but does not say how");
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const char* at = record.data() + kHead + i * kItem;
    coding.items.push_back({static_cast<Kind>(load<std::uint16_t>(at, false)), load<std::uint16_t>(at + 2, false),
                            load<std::uint16_t>(at + 4, false)});
    bytes += coding.items.back().bytes;
  }
  if (bytes != header.point_bytes) fail_garbled(source, "has points of another length than its compression");
  if (coding.is_chunked && coding.chunk_points == 0) fail_garbled(source, "has chunks without points");
  return coding;
}

[[noreturn]] void fail_item(const Source& source, const Item& item) {
  fail(source, fmt::format("has points with the part {} of version {}", static_cast<int>(item.kind), item.version),
       "unpack it with laszip");
}

std::unique_ptr<LazItem> make_item(const Source& source, const Item& item) {
  if (item.version != 2) fail_item(source, item);
  switch (item.kind) {
    case Kind::point:
      return make_laz_point();
    case Kind::time:
      return make_laz_time();
    case Kind::colour:
      return make_laz_colour();
    case Kind::bytes:
      return make_laz_bytes(item.bytes);
    default:
      fail_item(source, item);
  }
}

std::unique_ptr<LazLayeredItem> make_layered_item(const Source& source, const Item& item) {
  if (item.version < 3 || item.version > 4) fail_item(source, item);
  const bool keeps_old = item.version == 3;
  switch (item.kind) {
    case Kind::point14:
      return make_laz_point14(keeps_old);
    case Kind::colour14:
    case Kind::colour_infrared14:
      return make_laz_colour14(item.kind == Kind::colour_infrared14, keeps_old);
    case Kind::wave14:
      return make_laz_skipped14(item.bytes);
    case Kind::bytes14:
      return make_laz_bytes14(item.bytes, keeps_old);
    default:
      fail_item(source, item);
  }
}

template <class Made, class Make>
std::vector<std::unique_ptr<Made>> make_items(const Source& source, const Coding& coding, const Make& make) {
  std::vector<std::unique_ptr<Made>> items;
  for (const Item& item : coding.items) {
    items.push_back(make(source, item));
    if (items.back()->bytes() != item.bytes) fail_item(source, item);
  }
  return items;
}

/// Where the chunks are. The table of their sizes lies behind them, and is compressed itself.
class ChunkTable {
 public:
  ChunkTable(const Source& source, const LasHeader& header, const Coding& coding)
      : source_(source), header_(header), coding_(coding) {}

  std::vector<Chunk> chunks() {
    const std::string_view bytes = source_.bytes;
    if (!coding_.is_chunked) return {{0, header_.points, bytes.substr(header_.body)}};
    if (bytes.size() - header_.body < 8) fail_cut();
    std::uint64_t place = load<std::uint64_t>(bytes.data() + header_.body, false);
    if (place == std::numeric_limits<std::uint64_t>::max())  // written to a pipe: the place is at the end
      place = load<std::uint64_t>(bytes.data() + bytes.size() - 8, false);
    const std::uint64_t begin = header_.body + 8;
    if (place < begin || place > bytes.size() - 8) fail_cut();
    if (load<std::uint32_t>(bytes.data() + place, false) != 0)
      fail_garbled(source_, "has a chunk table of another version");
    const std::uint64_t count = load<std::uint32_t>(bytes.data() + place + 4, false);
    if (count > (place - begin) / header_.point_bytes) fail_garbled(source_, "has a chunk table that is too long");
    return read(bytes.substr(begin, place - begin), bytes.substr(place + 8), count);
  }

 private:
  [[noreturn]] void fail_cut() const {
    fail_at_byte(source_, "is truncated, its chunk table is missing", source_.bytes.size(), kAgain);
  }

  std::vector<Chunk> read(std::string_view all, std::string_view table, std::uint64_t count) {
    std::vector<Chunk> chunks;
    if (count == 0) {
      if (header_.points > 0) fail_garbled(source_, "has no chunks");
      return chunks;
    }
    ArithmeticDecoder from(table);
    IntegerDecoder sizes(32, 2);
    std::uint32_t points = 0, length = 0;
    std::uint64_t first = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      if (coding_.chunk_points == kAdaptive)
        points = static_cast<std::uint32_t>(sizes.next(from, static_cast<std::int32_t>(points), 0));
      length = static_cast<std::uint32_t>(sizes.next(from, static_cast<std::int32_t>(length), 1));
      const std::uint64_t left = header_.points - first;
      const std::uint64_t here =
          std::min<std::uint64_t>(coding_.chunk_points == kAdaptive ? points : coding_.chunk_points, left);
      if (length > all.size() || here == 0) fail_garbled(source_, "has a garbled chunk table");
      chunks.push_back({first, here, all.substr(0, length)});
      all.remove_prefix(length);
      first += here;
    }
    if (first != header_.points) fail_garbled(source_, "has fewer points in its chunks than it promises");
    return chunks;
  }

  const Source& source_;
  const LasHeader& header_;
  const Coding& coding_;
};

/// Decodes a chunk to `to`.
void decode_pointwise(const Source& source, const Coding& coding, const Chunk& chunk, std::size_t point_bytes,
                      char* to) {
  const auto items = make_items<LazItem>(source, coding, make_item);
  if (chunk.points == 0) return;
  if (chunk.bytes.size() < point_bytes) throw GarbledLaz();
  std::memcpy(to, chunk.bytes.data(), point_bytes);
  std::size_t at = 0;
  for (const std::unique_ptr<LazItem>& item : items) {
    item->begin(to + at);
    at += item->bytes();
  }
  ArithmeticDecoder from(chunk.bytes.substr(point_bytes));
  for (std::uint64_t i = 1; i < chunk.points; ++i) {
    char* part = to + i * point_bytes;
    for (const std::unique_ptr<LazItem>& item : items) {
      item->next(from, part);
      part += item->bytes();
    }
  }
}

/// The layers of each item, one after the other; their sizes come first, behind the first point and a number.
std::vector<std::vector<std::string_view>> layers_of(const std::vector<std::unique_ptr<LazLayeredItem>>& items,
                                                     std::string_view bytes) {
  std::size_t count = 0;
  for (const std::unique_ptr<LazLayeredItem>& item : items) count += item->layers();
  if (bytes.size() < 4 + 4 * count) throw GarbledLaz();
  const char* size = bytes.data() + 4;
  bytes.remove_prefix(4 + 4 * count);
  std::vector<std::vector<std::string_view>> layers;
  for (const std::unique_ptr<LazLayeredItem>& item : items) {
    layers.emplace_back();
    for (std::size_t i = 0; i < item->layers(); ++i, size += 4) {
      const std::size_t length = load<std::uint32_t>(size, false);
      if (length > bytes.size()) throw GarbledLaz();
      layers.back().push_back(bytes.substr(0, length));
      bytes.remove_prefix(length);
    }
  }
  return layers;
}

void decode_layered(const Source& source, const Coding& coding, const Chunk& chunk, std::size_t point_bytes, char* to) {
  const auto items = make_items<LazLayeredItem>(source, coding, make_layered_item);
  if (items[0]->layers() != 9) fail_item(source, coding.items[0]);
  if (chunk.points == 0) return;
  if (chunk.bytes.size() < point_bytes) throw GarbledLaz();
  std::memcpy(to, chunk.bytes.data(), point_bytes);
  const auto layers = layers_of(items, chunk.bytes.substr(point_bytes));
  std::size_t channel = laz_channel(to), at = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    items[i]->begin(to + at, layers[i], channel);
    at += items[i]->bytes();
  }
  for (std::uint64_t i = 1; i < chunk.points; ++i) {
    char* part = to + i * point_bytes;
    for (const std::unique_ptr<LazLayeredItem>& item : items) {
      item->next(part, channel);
      part += item->bytes();
    }
  }
}

}  // namespace

std::string unpack_laz(exec::Cpu& ex, const Source& source, const LasHeader& header) {
  const Coding coding = coding_of(source, header);
  const std::vector<Chunk> chunks = ChunkTable(source, header, coding).chunks();
  if (!fits(header.points, header.point_bytes, kMostUnpacked * source.bytes.size()))
    fail_garbled(source, fmt::format("promises {} points, more than its bytes can hold", header.points));
  std::string points(header.points * header.point_bytes, '\0');
  run_in_order(ex, static_cast<std::int64_t>(chunks.size()), [&](std::int64_t c) {
    const Chunk& chunk = chunks[static_cast<std::size_t>(c)];
    char* const to = points.data() + chunk.first * header.point_bytes;
    try {
      (coding.is_layered ? decode_layered : decode_pointwise)(source, coding, chunk, header.point_bytes, to);
    } catch (const GarbledLaz&) {
      fail_garbled(source, fmt::format("the compressed points from {} on are garbled", chunk.first));
    }
  });
  return points;
}

}  // namespace pointskin::io
