// Blobs read back, as a page reads them: header, sections, meshoptimizer's decoders.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/vector.hpp>

namespace pointskin::test {

class BlobReader {
 public:
  /// Checks magic, version, lengths and alignment on the way. @throws std::runtime_error saying what is wrong
  explicit BlobReader(const std::vector<std::byte>& blob);

  [[nodiscard]] const nlohmann::json& header() const { return header_; }
  [[nodiscard]] bool has(const std::string& section) const;
  [[nodiscard]] nlohmann::json section(const std::string& name) const;
  /// The bytes of a section, unpacked. @throws std::runtime_error if there is none, or it does not unpack
  [[nodiscard]] std::vector<std::byte> bytes(const std::string& name) const;

  /// The same as numbers.
  template <class T>
  [[nodiscard]] std::vector<T> numbers(const std::string& name) const {
    const std::vector<std::byte> data = bytes(name);
    std::vector<T> out(data.size() / sizeof(T));
    if (!data.empty()) std::memcpy(out.data(), data.data(), out.size() * sizeof(T));
    return out;
  }

  /// World coordinates, unit normals.
  [[nodiscard]] std::vector<Vec3d> positions() const;
  [[nodiscard]] std::vector<Vec3d> normals() const;
  /// Box of the positions, world coordinates.
  [[nodiscard]] Vec3d lower() const { return corner("lower"); }
  [[nodiscard]] Vec3d upper() const { return corner("upper"); }

 private:
  [[nodiscard]] Vec3d corner(const char* name) const;

  nlohmann::json header_;
  std::vector<std::byte> data_;  ///< behind the header
};

}  // namespace pointskin::test
