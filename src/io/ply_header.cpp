#include "io/ply_header.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <unordered_set>

#include "core/format.hpp"
#include "io/number.hpp"

namespace pointskin::io {
namespace {

constexpr const char* kAdvice = "export the file again";
constexpr std::size_t kMostElements = 256;

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    if (line.empty()) return words;
    const auto* end = std::find_if(line.begin(), line.end(), is_blank);
    words.push_back(line.substr(0, static_cast<std::size_t>(end - line.begin())));
    line.remove_prefix(words.back().size());
  }
}

std::optional<AttributeType> scalar_of(std::string_view name) {
  for (const AttributeType type :
       {AttributeType::int8, AttributeType::uint8, AttributeType::int16, AttributeType::uint16, AttributeType::int32,
        AttributeType::uint32, AttributeType::float32, AttributeType::float64})
    if (name == ply_name_of(type) || name == name_of(type)) return type;
  return std::nullopt;
}

class HeaderParser {
 public:
  explicit HeaderParser(const Source& source) : source_(source) {}

  PlyHeader parse() {
    if (!is_ply(source_.bytes)) fail_here("is no PLY file, the first line is not 'ply'");
    take_line();
    while (true) {
      const std::vector<std::string_view> words = words_of(take_line());
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format")
        parse_format(words);
      else if (words[0] == "element")
        parse_element(words);
      else if (words[0] == "property")
        parse_property(words);
      else
        fail_here("the header has the unknown word " + in_quotes(words[0]));
    }
    if (!has_format_) fail_here("the header does not name its format");
    header_.body = at_;
    header_.body_line = line_ + 1;
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail_here(const std::string& what) const { fail_at_line(source_, what, line_, kAdvice); }

  std::string_view take_line() {
    const std::size_t end = source_.bytes.find('\n', at_);
    if (end == std::string_view::npos) fail_at_byte(source_, "the header has no end", source_.bytes.size(), kAdvice);
    const std::string_view line = source_.bytes.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    return line;
  }

  void parse_format(const std::vector<std::string_view>& words) {
    if (words.size() != 3 || words[2] != "1.0") fail_here("the format line is not of version 1.0");
    if (words[1] == "ascii")
      header_.encoding = PlyEncoding::ascii;
    else if (words[1] == "binary_little_endian")
      header_.encoding = PlyEncoding::little_endian;
    else if (words[1] == "binary_big_endian")
      header_.encoding = PlyEncoding::big_endian;
    else
      fail_here("the format " + in_quotes(words[1]) + " is unknown");
    has_format_ = true;
  }

  void parse_element(const std::vector<std::string_view>& words) {
    if (words.size() != 3) fail_here("an element line needs a name and a count");
    std::int64_t count = 0;
    const char* end = words[2].data() + words[2].size();
    const auto [rest, error] = std::from_chars(words[2].data(), end, count);
    if (error != std::errc{} || rest != end || count < 0)
      fail_here("the element count " + in_quotes(words[2]) + " is not a whole number from 0 on");
    // The cap keeps the search for names cheap on garbled files.
    if (header_.elements.size() >= kMostElements) fail_here("the header has too many elements");
    if (header_.find(std::string(words[1])) != nullptr)
      fail_here("the element " + in_quotes(words[1]) + " comes twice");
    header_.elements.push_back({std::string(words[1]), count, {}});
    names_.clear();
  }

  void parse_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail_here("a property comes before any element");
    const bool is_list = words.size() == 5 && words[1] == "list";
    if (!is_list && words.size() != 3) fail_here("a property line needs a type and a name");
    const auto type = scalar_of(words[is_list ? 3 : 1]);
    const auto count_type = is_list ? scalar_of(words[2]) : AttributeType::uint8;
    if (!type || !count_type) fail_here("the property " + in_quotes(words.back()) + " has an unknown type");
    if (!is_integer(*count_type)) fail_here("the length of the list " + in_quotes(words.back()) + " is not an integer");
    PlyProperty property{std::string(words.back()), *type, is_list, *count_type};
    if (!names_.insert(property.name).second) fail_here("the property " + in_quotes(words.back()) + " comes twice");
    header_.elements.back().properties.push_back(std::move(property));
  }

  const Source& source_;
  PlyHeader header_;
  std::size_t at_ = 0;
  std::int64_t line_ = 0;
  bool has_format_ = false;
  std::unordered_set<std::string> names_;
};

/// Nothing is allocated for a count before it has passed here.
void check_counts(const Source& source, const PlyHeader& header) {
  const bool ascii = header.encoding == PlyEncoding::ascii;
  // In text a value takes a digit and a separator, but the very last one may do without.
  std::uint64_t left = source.bytes.size() - header.body + (ascii ? 1 : 0);
  for (const PlyElement& element : header.elements) {
    const std::uint64_t each = ascii ? 2 * element.properties.size() : element.smallest_row_bytes();
    const auto count = static_cast<std::uint64_t>(element.count);
    if (!fits(count, each, left))
      fail_at_byte(source,
                   fmt::format("is truncated, element {} promises {} rows of at least {} bytes but {} bytes are left",
                               in_quotes(element.name), count, each, left),
                   source.bytes.size(), "copy or export the file again");
    left -= count * each;
  }
}

}  // namespace

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

std::size_t PlyElement::smallest_row_bytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& p : properties) bytes += size_of(p.is_list ? p.count_type : p.type);
  return bytes;
}

const PlyElement* PlyHeader::find(const std::string& name) const {
  const auto hit = std::find_if(elements.begin(), elements.end(), [&](const PlyElement& e) { return e.name == name; });
  return hit == elements.end() ? nullptr : &*hit;
}

bool is_ply(std::string_view bytes) {
  return bytes.starts_with("ply") && (bytes.size() == 3 || bytes[3] == '\n' || is_blank(bytes[3]));
}

bool ply_announces_faces(std::string_view start) {
  constexpr std::string_view kFace = "\nelement face ";
  const std::string_view header = start.substr(0, start.find("end_header"));
  const std::size_t at = header.find(kFace);
  return at != std::string_view::npos && header.substr(at + kFace.size()).find_first_not_of(" 0\r\n") == 0;
}

const char* ply_name_of(AttributeType type) {
  switch (type) {
    case AttributeType::int8:
      return "char";
    case AttributeType::uint8:
      return "uchar";
    case AttributeType::int16:
      return "short";
    case AttributeType::uint16:
      return "ushort";
    case AttributeType::int32:
      return "int";
    case AttributeType::uint32:
      return "uint";
    case AttributeType::float32:
      return "float";
    default:
      return "double";
  }
}

PlyHeader parse_ply_header(const Source& source) {
  PlyHeader header = HeaderParser(source).parse();
  check_counts(source, header);
  return header;
}

}  // namespace pointskin::io
