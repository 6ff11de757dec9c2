#include "io/with_pugixml/e57_streams.hpp"

#include <algorithm>
#include <string_view>

#include "core/format.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

constexpr std::size_t kSectionHead = 32;
constexpr std::size_t kPacketHead = 4, kDataHead = 6;
enum : std::uint8_t { kIndexPacket = 0, kDataPacket = 1, kEmptyPacket = 2 };

std::uint16_t short_at(std::string_view bytes, std::size_t at) { return load<std::uint16_t>(bytes.data() + at, false); }

[[noreturn]] void fail_garbled(const Source& source) { fail(source, "the packets of a scan are garbled", kE57Again); }

/// The packets of a scan, one after the other.
std::string_view packets_of(const Source& source, const E57Pages& pages, const E57Scan& scan) {
  const std::size_t section = pages.place_of(source, scan.place);
  const std::string_view bytes = std::string_view(pages.bytes).substr(section);
  if (bytes.size() < kSectionHead || bytes[0] != 1) fail_garbled(source);
  const auto length = load<std::uint64_t>(bytes.data() + 8, false);
  const std::size_t first = pages.place_of(source, load<std::uint64_t>(bytes.data() + 16, false));
  if (length > bytes.size() || first < section || first - section > length) fail_garbled(source);
  return bytes.substr(first - section, length - (first - section));
}

/// Adds the parts of the streams that a packet of data holds.
void take_packet(const Source& source, std::string_view packet, std::vector<std::string>& streams) {
  if (packet.size() < kDataHead) fail_garbled(source);
  const std::size_t count = short_at(packet, 4);
  if (count == 0) return;
  if (count != streams.size() || packet.size() < kDataHead + 2 * count) fail_garbled(source);
  std::size_t at = kDataHead + 2 * count;
  for (std::size_t s = 0; s < count; ++s) {
    const std::size_t length = short_at(packet, kDataHead + 2 * s);
    if (length > packet.size() - at) fail_garbled(source);
    streams[s].append(packet.substr(at, length));
    at += length;
  }
}

}  // namespace

std::vector<std::string> read_e57_streams(const Source& source, const E57Pages& pages, const E57Scan& scan) {
  // At least a byte a point, however few bits its values have: memory is taken for each.
  if (scan.fields.empty() || !fits(scan.records, 1, pages.bytes.size()))
    fail(source, fmt::format("{} points are promised, but the file ends before", scan.records), kE57Again);
  std::vector<std::string> streams(scan.fields.size());
  std::string_view rest = packets_of(source, pages, scan);
  while (rest.size() >= kPacketHead) {
    const auto kind = static_cast<std::uint8_t>(rest[0]);
    const std::size_t length = std::size_t{short_at(rest, 2)} + 1;
    if (kind > kEmptyPacket || length < kPacketHead || length > rest.size()) fail_garbled(source);
    if (kind == kDataPacket) take_packet(source, rest.substr(0, length), streams);
    rest.remove_prefix(length);
  }
  for (std::size_t s = 0; s < streams.size(); ++s) {
    const std::uint64_t bits = scan.fields[s].bits();
    if (bits > 0 && !fits(scan.records, bits, 8 * std::uint64_t{streams[s].size()}))
      fail(source,
           fmt::format("the values {} end before the {} points do", in_quotes(scan.fields[s].name), scan.records),
           kE57Again);
    streams[s].append(kE57Padding, '\0');
  }
  return streams;
}

double e57_value(const E57Field& field, const std::string& stream, std::uint64_t record) {
  if (field.coding == E57Coding::float32) return load<float>(stream.data() + 4 * record, false);
  if (field.coding == E57Coding::float64) return load<double>(stream.data() + 8 * record, false);
  const unsigned bits = field.bits();
  const std::uint64_t first = record * bits;
  const char* const at = stream.data() + first / 8;
  const unsigned skipped = first % 8;
  std::uint64_t raw = load<std::uint64_t>(at, false) >> skipped;
  if (skipped > 0) raw |= std::uint64_t{static_cast<unsigned char>(at[8])} << (64 - skipped);
  if (bits < 64) raw &= (std::uint64_t{1} << bits) - 1;
  const std::uint64_t most = static_cast<std::uint64_t>(field.maximum) - static_cast<std::uint64_t>(field.minimum);
  const auto whole = static_cast<std::int64_t>(static_cast<std::uint64_t>(field.minimum) + std::min(raw, most));
  return field.scale * static_cast<double>(whole) + field.offset;
}

}  // namespace pointskin::io
