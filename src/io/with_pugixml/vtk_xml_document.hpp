// Data arrays of VTK's XML files: as text, in base64, or behind the XML, compressed by zlib or not.
// Source: Kitware, "VTK XML formats", docs.vtk.org.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

#include <pointskin/attribute.hpp>

#include "io/scalar.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// Values of one type, tuple after tuple. Does not own them.
struct VtkArray {
  std::string name;
  AttributeType type = AttributeType::float32;      ///< as they are stored
  AttributeType declared = AttributeType::float32;  ///< as the file has it; numbers in text are stored in double
  std::int64_t tuples = 0, components = 1;
  const char* data = nullptr;
  bool swapped = false;

  [[nodiscard]] const char* at(std::int64_t component) const {
    return behind(data, static_cast<std::size_t>(component) * size_of(type));
  }
  [[nodiscard]] std::int64_t stride() const { return components * static_cast<std::int64_t>(size_of(type)); }
  /// A value of an array of integers with one component.
  [[nodiscard]] std::int64_t integer(std::int64_t tuple) const;
};

/// Lengths are compared with the bytes that are left before memory is taken. What arrays point to lives as long as it.
class VtkXmlDocument {
 public:
  /// @throws Error invalid_input
  explicit VtkXmlDocument(const Source& source);

  [[nodiscard]] pugi::xml_node root() const { return root_; }
  /// The pieces of the data set, which is of that type.
  [[nodiscard]] std::vector<pugi::xml_node> pieces(const char* type) const;
  /// A count that a piece names; 0 where it names none.
  [[nodiscard]] std::int64_t count(pugi::xml_node piece, const char* name) const;
  /// The array of a `DataArray`. @param tuples  that it must have; -1: as many as it says
  VtkArray array(pugi::xml_node node, std::int64_t tuples);

  [[noreturn]] void fail_here(const std::string& what) const;

 private:
  void find_appended(std::string_view& xml);
  std::string_view values(pugi::xml_node node, const std::string& name);
  std::string_view take_plain(std::string_view stream, const std::string& name) const;
  std::string_view unpack(std::string_view stream, const std::string& name, bool is_base64);
  std::string_view parse_text(pugi::xml_node node, VtkArray& array);
  [[nodiscard]] std::uint64_t header_word(const char* from) const;
  [[nodiscard]] std::size_t word_bytes() const { return wide_header_ ? 8 : 4; }

  const Source& source_;
  pugi::xml_document document_;
  pugi::xml_node root_;
  bool big_endian_ = false, wide_header_ = false, compressed_ = false, appended_base64_ = false;
  std::string_view appended_;
  std::deque<std::string> owned_;
  std::deque<AttributeValues> parsed_;
};

}  // namespace pointskin::io
