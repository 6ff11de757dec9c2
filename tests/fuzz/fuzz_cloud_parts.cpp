// Fuzzes the reader of clouds in parts: the input is a file of text, PLY or NPY. What it reads must be what read_cloud() reads, in
// any parts.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/merge.hpp>

#include "exec/cpu.hpp"
#include "io/cloud_parts.hpp"
#include "whole_and_parts.hpp"

using namespace pointskin;
using fuzz::require;
using fuzz::same_bytes;

namespace {

bool same_attribute(const Attribute& a, const Attribute& b) {
  return a.name == b.name && a.type() == b.type() && a.values.visit([&](const auto& values) {
    using T = typename std::decay_t<decltype(values)>::value_type;
    return same_bytes(values, b.values.as<T>());
  });
}

bool is_same(const Cloud& a, const Cloud& b) {
  return same_bytes(a.positions, b.positions) && same_bytes(a.normals, b.normals) && a.origin == b.origin &&
         a.dropped == b.dropped &&
         std::equal(a.attributes.begin(), a.attributes.end(), b.attributes.begin(), b.attributes.end(), same_attribute);
}

/// @throws Error as the reader
Cloud read_in_parts(io::CloudParts& file, std::int64_t rows) {
  exec::Cpu ex(1);
  file.choose_origin(ex, std::nullopt);
  Cloud all;
  io::CloudParts::Bytes buffer;
  for (std::int64_t first = 0; first < file.rows(); first += rows)
    merge_into(all, file.read(ex, first, std::min(rows, file.rows() - first), buffer));
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile file("fuzz", data, size);
  const std::string path = file.path();
  const std::optional<Cloud> whole =
      fuzz::read_or_nothing([&] { return read_cloud(path, {.shift = std::nullopt, .threads = 1}); });
  try {
    exec::Cpu ex(1);
    if (const auto parts = io::CloudParts::open(ex, path)) {
      const Cloud all = read_in_parts(*parts, 1 << 20), few = read_in_parts(*parts, 3);
      require(whole.has_value() && is_same(all, few));
      require(whole->positions.empty() ? all.positions.empty() : is_same(all, *whole));
    }
  } catch (const Error&) {
    require(!whole);
  }
  return 0;
}
