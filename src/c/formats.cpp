#include <pointskin/c.h>
#include <pointskin/formats.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace {

/// Extensions of every format, separated by spaces.
const std::vector<std::string>& extensions() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> lists;
    for (const pointskin::FormatInfo& format : pointskin::file_formats()) {
      lists.emplace_back();
      for (const std::string& extension : format.extensions)
        lists.back() += (lists.back().empty() ? "" : " ") + extension;
    }
    return lists;
  }();
  return all;
}

}  // namespace

int64_t psk_format_count(void) { return static_cast<std::int64_t>(pointskin::file_formats().size()); }

psk_format psk_format_get(int64_t index) {
  if (index < 0 || index >= psk_format_count()) return {};
  const auto at = static_cast<std::size_t>(index);
  const pointskin::FormatInfo& format = pointskin::file_formats()[at];
  return {format.name.c_str(),         extensions()[at].c_str(),     format.reads_clouds ? 1 : 0,
          format.reads_meshes ? 1 : 0, format.writes_clouds ? 1 : 0, format.writes_meshes ? 1 : 0};
}
