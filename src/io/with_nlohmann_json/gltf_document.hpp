// A glTF 2.0 file as a document with buffers, and its accessors as arrays. Source: Khronos, "glTF 2.0 Specification".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/attribute.hpp>

#include "io/source.hpp"

namespace pointskin::io {

/// Numbers of an accessor, row by row, in the type of the file, or as floats where integers stand for shares of 1.
struct GltfArray {
  std::size_t count = 0;
  std::size_t components = 0;
  AttributeType type = AttributeType::float32;
  bool normalised = false;  ///< integers stand for shares of 1
  std::vector<char> bytes;  ///< packed
  [[nodiscard]] double at(std::size_t row, std::size_t component) const;
  /// The same, with shares of 1 where the integers stand for them.
  [[nodiscard]] double share(std::size_t row, std::size_t component) const;
};

/// All places are checked before they are read; sizes are compared with the buffers before memory is taken.
class GltfDocument {
 public:
  /// Reads a GLB, or the JSON of a .gltf with buffers as data: URIs or as files in the same folder.
  /// @throws Error invalid_input
  explicit GltfDocument(const Source& source);

  [[nodiscard]] const nlohmann::ordered_json& json() const { return json_; }
  [[nodiscard]] const Source& source() const { return source_; }

  /// @throws Error invalid_input for an accessor that there is not, or that reaches beyond its buffer
  [[nodiscard]] GltfArray array(std::int64_t accessor) const;

  /// Member `index` of a list of the document.
  [[nodiscard]] const nlohmann::ordered_json& item(const char* list, std::int64_t index) const;

  /// A whole number, or `fallback` where there is none. @throws Error invalid_input for anything else
  [[nodiscard]] std::int64_t whole(const nlohmann::ordered_json& object, const char* key, std::int64_t fallback) const;

  [[noreturn]] void fail_here(const std::string& what) const;

 private:
  void read_json(std::string_view text);
  void read_buffers(std::string_view binary);
  std::string load_uri(const std::string& uri) const;
  /// Bytes of a view; those of a compressed one are unpacked into `room`.
  [[nodiscard]] std::string_view view_bytes(std::int64_t view, std::string& room) const;
  [[nodiscard]] std::string_view buffer_bytes(const nlohmann::ordered_json& view) const;
  [[nodiscard]] std::string unpacked(const nlohmann::ordered_json& packing) const;
  void copy_elements(const nlohmann::ordered_json& accessor, GltfArray& array) const;
  void apply_sparse(const nlohmann::ordered_json& sparse, GltfArray& array) const;

  Source source_;
  nlohmann::ordered_json json_;
  std::vector<std::string> owned_;
  std::vector<std::string_view> buffers_;
};

}  // namespace pointskin::io
