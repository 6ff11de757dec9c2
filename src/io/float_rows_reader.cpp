// Points as bare floats without a header: PoissonRecon's .bnpts (position and normal) and the .xyz of splashsurf and
// other programs for particles (position).
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "core/format.hpp"
#include "io/readers.hpp"

namespace pointskin::io {
namespace {

template <std::size_t kColumns>
Cloud parse_rows(exec::Cpu& ex, const Source& source, const ReadOptions& options,
                 const std::array<const char*, kColumns>& names) {
  constexpr std::size_t kRowBytes = 4 * kColumns;
  if (source.bytes.size() % kRowBytes != 0)
    fail_at_byte(source, fmt::format("is truncated, its points have {} bytes each", kRowBytes), source.bytes.size(),
                 "copy or export it again");
  PointTable table{static_cast<std::int64_t>(source.bytes.size() / kRowBytes), {}};
  for (std::size_t c = 0; c < kColumns; ++c)
    table.columns.push_back(
        {names[c], AttributeType::float32, AttributeType::float32, source.bytes.data() + 4 * c, kRowBytes});
  return assemble(ex, source, table, options.shift);
}

}  // namespace

Cloud parse_bnpts(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  return parse_rows<6>(ex, source, options, {"x", "y", "z", "nx", "ny", "nz"});
}

bool is_binary_xyz(const Source& source) {
  constexpr std::size_t kLookedAt = 1 << 12;
  const std::string_view start = source.bytes.substr(0, kLookedAt);
  const auto is_no_text = [](char c) { return (c >= 0 && c < '\t') || (c > '\r' && c < ' '); };
  return source.bytes.size() % 12 == 0 && std::any_of(start.begin(), start.end(), is_no_text);
}

Cloud parse_binary_xyz(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  return parse_rows<3>(ex, source, options, {"x", "y", "z"});
}

}  // namespace pointskin::io
