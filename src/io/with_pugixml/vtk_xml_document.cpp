#include "io/with_pugixml/vtk_xml_document.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "core/format.hpp"
#include "io/base64.hpp"
#include "io/inflate.hpp"
#include "io/libraries.hpp"
#include "io/number.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

constexpr char kAgain[] = "copy or export it again";
constexpr std::int64_t kMostComponents = 1 << 16;

std::optional<AttributeType> type_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, AttributeType>, 11> kTypes{{{"Int8", AttributeType::int8},
                                                                               {"UInt8", AttributeType::uint8},
                                                                               {"Int16", AttributeType::int16},
                                                                               {"UInt16", AttributeType::uint16},
                                                                               {"Int32", AttributeType::int32},
                                                                               {"UInt32", AttributeType::uint32},
                                                                               {"Int64", AttributeType::int64},
                                                                               {"UInt64", AttributeType::uint64},
                                                                               {"Float32", AttributeType::float32},
                                                                               {"Float64", AttributeType::float64},
                                                                               {"Bit", AttributeType::uint8}}};
  const auto* const at = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == name; });
  if (at == kTypes.end() || name == "Bit") return std::nullopt;
  return at->second;
}

bool is_space(char c) { return is_blank(c) || c == '\n'; }

std::string_view trimmed(std::string_view text) {
  const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
  return {begin, text.end()};
}

}  // namespace

std::int64_t VtkArray::integer(std::int64_t tuple) const {
  return load_integer(type, data + tuple * stride(), swapped);
}

void VtkXmlDocument::fail_here(const std::string& what) const { fail(source_, what, kAgain); }

VtkXmlDocument::VtkXmlDocument(const Source& source) : source_(source) {
  std::string_view xml = source.bytes;
  find_appended(xml);
  const std::string whole = appended_.empty() ? std::string(xml) : std::string(xml) + "</AppendedData></VTKFile>";
  const pugi::xml_parse_result parsed =
      document_.load_buffer(whole.data(), whole.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) fail_here(fmt::format("is no XML: {}", parsed.description()));
  root_ = document_.child("VTKFile");
  if (!root_) fail_here("has no element VTKFile");
  big_endian_ = root_.attribute("byte_order").value() == std::string_view("BigEndian");
  wide_header_ = root_.attribute("header_type").value() == std::string_view("UInt64");
  const std::string_view compressor = root_.attribute("compressor").value();
  compressed_ = !compressor.empty();
  if (compressed_ && compressor != "vtkZLibDataCompressor")
    fail(source_, "is compressed by " + in_quotes(compressor), "save it with zlib, or not compressed");
  if (compressed_ && !kHasZlib)
    fail(source_, "is compressed, and this build was made without zlib", "save it not compressed");
}

/// What lies behind the XML may be any bytes, so it is cut off: from the underscore on, which begins it.
void VtkXmlDocument::find_appended(std::string_view& xml) {
  const std::size_t element = xml.find("<AppendedData");
  if (element == std::string_view::npos) return;
  const std::size_t end = xml.find('>', element);
  const std::size_t mark = end == std::string_view::npos ? end : xml.find('_', end);
  if (mark == std::string_view::npos) fail_here("has appended data that do not begin");
  appended_base64_ = xml.substr(element, end - element).find("base64") != std::string_view::npos;
  appended_ = xml.substr(mark + 1);
  xml = xml.substr(0, end + 1);
}

std::vector<pugi::xml_node> VtkXmlDocument::pieces(const char* type) const {
  std::vector<pugi::xml_node> found;
  for (const pugi::xml_node piece : root_.child(type).children("Piece")) found.push_back(piece);
  return found;
}

std::int64_t VtkXmlDocument::count(pugi::xml_node piece, const char* name) const {
  const std::int64_t value = piece.attribute(name).as_llong(0);
  if (value < 0) fail_here(fmt::format("{} is negative", name));
  return value;
}

std::uint64_t VtkXmlDocument::header_word(const char* from) const {
  return wide_header_ ? load<std::uint64_t>(from, big_endian_) : load<std::uint32_t>(from, big_endian_);
}

VtkArray VtkXmlDocument::array(pugi::xml_node node, std::int64_t tuples) {
  VtkArray array;
  array.name = node.attribute("Name").value();
  array.swapped = big_endian_;
  const std::optional<AttributeType> type = type_of(node.attribute("type").value());
  if (!type)
    fail_here(fmt::format("the array {} has the unknown type {}", in_quotes(array.name),
                          in_quotes(node.attribute("type").value())));
  array.type = array.declared = *type;
  array.components = node.attribute("NumberOfComponents").as_llong(1);
  if (array.components < 1 || array.components > kMostComponents)
    fail_here(fmt::format("the array {} has {} components", in_quotes(array.name), array.components));
  array.tuples = tuples >= 0 ? tuples : count(node, "NumberOfTuples");
  const bool is_text = node.attribute("format").value() == std::string_view("ascii");
  const std::string_view bytes = is_text ? parse_text(node, array) : values(node, array.name);
  if (tuples < 0) array.tuples = static_cast<std::int64_t>(bytes.size()) / array.stride();
  if (!fits(static_cast<std::uint64_t>(array.tuples), static_cast<std::uint64_t>(array.stride()), bytes.size()))
    fail_here(fmt::format("is truncated, the array {} has fewer than {} values", in_quotes(array.name), array.tuples));
  array.data = bytes.data();
  return array;
}

/// The bytes of an array in binary.
std::string_view VtkXmlDocument::values(pugi::xml_node node, const std::string& name) {
  const std::string_view format = node.attribute("format").value();
  if (format == "binary") return unpack(trimmed(node.text().get()), name, true);
  if (format != "appended")
    fail_here(fmt::format("the array {} has the unknown format {}", in_quotes(name), in_quotes(format)));
  const std::uint64_t offset = node.attribute("offset").as_ullong(0);
  if (offset > appended_.size()) fail_here("is truncated, the array " + in_quotes(name) + " begins behind its end");
  return unpack(appended_.substr(offset), name, appended_base64_);
}

/// The length comes first.
std::string_view VtkXmlDocument::take_plain(std::string_view stream, const std::string& name) const {
  if (stream.size() < word_bytes()) fail_here("is truncated in the array " + in_quotes(name));
  const std::uint64_t bytes = header_word(stream.data());
  stream.remove_prefix(word_bytes());
  if (bytes > stream.size()) fail_here("is truncated in the array " + in_quotes(name));
  return stream.substr(0, bytes);
}

/// Compressed: the number of blocks, their length, that of the last one (0: it is whole), and the packed lengths of all
/// come first. In base64 these are encoded by themselves.
std::string_view VtkXmlDocument::unpack(std::string_view stream, const std::string& name, bool is_base64) {
  const auto fail_cut = [&] { fail_here("is truncated in the array " + in_quotes(name)); };
  const std::size_t word = word_bytes();
  if (!compressed_) {
    if (!is_base64) return take_plain(stream, name);
    // The length tells how much of the text belongs to the array.
    const std::string head = from_base64(stream.substr(0, base64_length(word)));
    if (head.size() < word) fail_cut();
    const std::uint64_t bytes = header_word(head.data());
    if (bytes > stream.size()) fail_cut();
    return take_plain(owned_.emplace_back(from_base64(stream.substr(0, base64_length(word + bytes)))), name);
  }
  std::string head =
      is_base64 ? from_base64(stream.substr(0, base64_length(3 * word))) : std::string(stream.substr(0, 3 * word));
  if (head.size() < 3 * word) fail_cut();
  const std::uint64_t blocks = header_word(head.data());
  const std::uint64_t block_bytes = header_word(head.data() + word), last_bytes = header_word(head.data() + 2 * word);
  if (!fits(blocks + 3, word, stream.size())) fail_cut();
  const std::size_t head_bytes = (blocks + 3) * word;
  const std::size_t head_length = is_base64 ? base64_length(head_bytes) : head_bytes;
  if (head_length > stream.size()) fail_cut();
  head = is_base64 ? from_base64(stream.substr(0, head_length)) : std::string(stream.substr(0, head_length));
  if (head.size() < head_bytes) fail_cut();
  std::uint64_t packed_bytes = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t length = header_word(head.data() + (3 + b) * word);
    if (length > stream.size() - packed_bytes) fail_cut();
    packed_bytes += length;
  }
  stream.remove_prefix(head_length);
  const std::string own = is_base64 ? from_base64(stream.substr(0, base64_length(packed_bytes))) : std::string();
  std::string_view packed = is_base64 ? std::string_view(own) : stream;
  const std::uint64_t most = kMostDeflated * packed_bytes;
  const std::uint64_t whole_blocks = blocks > 0 && last_bytes > 0 ? blocks - 1 : blocks;
  if (packed.size() < packed_bytes || last_bytes > most || !fits(whole_blocks, block_bytes, most)) fail_cut();
  std::string& out = owned_.emplace_back();
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t length = header_word(head.data() + (3 + b) * word);
    const bool is_last = b + 1 == blocks;
    bool done = false;
    if constexpr (kHasZlib)
      done = inflate_to(packed.substr(0, length), is_last && last_bytes > 0 ? last_bytes : block_bytes, out);
    if (!done) fail_here("the array " + in_quotes(name) + " is garbled");
    packed.remove_prefix(length);
  }
  return out;
}

/// Numbers in text, as they would be in binary on this machine; coordinates in double.
std::string_view VtkXmlDocument::parse_text(pugi::xml_node node, VtkArray& array) {
  const std::string_view text = node.text().get();
  const bool is_open = array.tuples == 0;  // all that there are
  const std::uint64_t most = (text.size() + 1) / 2;
  if (!fits(static_cast<std::uint64_t>(array.tuples), static_cast<std::uint64_t>(array.components), most))
    fail_here(fmt::format("is truncated, the array {} has fewer than {} values", in_quotes(array.name), array.tuples));
  if (!is_integer(array.type)) array.type = AttributeType::float64;
  array.swapped = false;
  const std::uint64_t wanted = is_open ? most : static_cast<std::uint64_t>(array.tuples * array.components);
  std::string& out = owned_.emplace_back();
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::uint64_t i = 0; i < wanted; ++i) {
    at = std::find_if_not(at, end, is_space);
    if (at == end) break;
    visit_type(array.type, [&](auto tag) {
      using T = decltype(tag);
      T value{};
      const char* rest = nullptr;
      if constexpr (std::is_integral_v<T>) {
        const auto [stop, error] = std::from_chars(at, end, value);
        rest = error == std::errc{} ? stop : nullptr;
      } else {
        double wide = 0;
        rest = parse_number(at, end, wide);
        value = narrowed<T>(wide);
      }
      if (rest == nullptr || (rest != end && !is_space(*rest)))
        fail_here(fmt::format("value {} of the array {} is no number of its type", i, in_quotes(array.name)));
      at = rest;
      out.append(reinterpret_cast<const char*>(&value), sizeof(T));
    });
  }
  return out;
}

}  // namespace pointskin::io
