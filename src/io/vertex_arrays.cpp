#include <pointskin/error.hpp>

#include "core/format.hpp"
#include "io/writers.hpp"

namespace pointskin::io {

void check_attributes(const VertexArrays& vertices) {
  for (const Attribute& attribute : vertices.attributes)
    if (attribute.values.size() != vertices.positions.size())
      throw Error(ErrorCode::usage, fmt::format("the attribute {} has {} values for {} vertices", attribute.name,
                                                attribute.values.size(), vertices.positions.size()));
}

std::vector<const Attribute*> byte_colours(const std::vector<Attribute>& attributes, bool with_alpha) {
  std::vector<const Attribute*> channels;
  for (const char* name : {"red", "green", "blue", "alpha"}) {
    const std::size_t before = channels.size();
    if (before == 3 && !with_alpha) break;
    for (const Attribute& attribute : attributes)
      if (attribute.name == name && attribute.type() == AttributeType::uint8 && !attribute.values.has_mask() &&
          channels.size() == before)
        channels.push_back(&attribute);
    if (channels.size() == before) break;
  }
  return channels.size() < 3 ? std::vector<const Attribute*>() : channels;
}

}  // namespace pointskin::io
