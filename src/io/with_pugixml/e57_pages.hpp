// The pages of E57 files. Source: ASTM E2807-11, "3D imaging data exchange", clause 7, and libE57Format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "exec/cpu.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// The advice in errors about E57 files.
constexpr char kE57Again[] = "copy or export it again";

/// A file without the checksums at the ends of its pages, and where its XML lies.
struct E57Pages {
  std::string bytes;
  std::size_t page_bytes = 0;  ///< of a page of the file, with its checksum
  std::string_view xml;        ///< within `bytes`

  /// Where the byte of the file that others name lies in `bytes`. @throws Error invalid_input if it lies in none
  [[nodiscard]] std::size_t place_of(const Source& source, std::uint64_t in_file) const;
};

/// Checks the header and the checksums of all pages, in parallel. Memory: the file once more.
/// @throws Error invalid_input
E57Pages read_e57_pages(exec::Cpu& ex, const Source& source);

}  // namespace pointskin::io
