#include "scene/combine.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pointskin/error.hpp>

namespace pointskin::scene {
namespace {

bool is_same(const Cloud& a, std::size_t i, const Cloud& b, std::size_t j) {
  return a.positions[i] == b.positions[j] && (a.normals[i] == b.normals[j] || a.normals[i] == -b.normals[j]);
}

/// The indices in `a` of the first `count` points of `kept`, which are some of it, in its order.
std::vector<std::int64_t> origins_of(const Cloud& a, const Cloud& kept, std::size_t count) {
  std::vector<std::int64_t> origins;
  for (std::size_t i = 0; i < a.positions.size() && origins.size() < count; ++i)
    if (is_same(a, i, kept, origins.size())) origins.push_back(static_cast<std::int64_t>(i));
  if (origins.size() < count) throw Error(ErrorCode::internal, "points of a set operation are not those it was given");
  return origins;
}

void settle_kinds(std::vector<std::uint8_t>& kinds) {
  constexpr std::uint8_t kOriginal = 0;
  if (std::find(kinds.begin(), kinds.end(), kOriginal) == kinds.end()) std::fill(kinds.begin(), kinds.end(), kOriginal);
}

}  // namespace

void carry_attributes(const Cloud& a, BooleanResult& result) {
  const std::vector<std::int64_t> origins = origins_of(a, result.cloud, static_cast<std::size_t>(result.report.a.kept));
  for (const Attribute& attribute : a.attributes) {
    AttributeValues values = attribute.values.gather(origins);
    if (attribute.name == kAdded) {
      auto kinds = std::move(values).as<std::uint8_t>();
      kinds.resize(result.cloud.positions.size(), 0);
      settle_kinds(kinds);
      values = std::move(kinds);
    } else {
      values.resize(result.cloud.positions.size());
    }
    result.cloud.attributes.push_back({attribute.name, std::move(values)});
  }
}

void drop_added(std::vector<Attribute>& attributes) {
  std::erase_if(attributes, [](const Attribute& attribute) { return attribute.name == kAdded; });
}

}  // namespace pointskin::scene
