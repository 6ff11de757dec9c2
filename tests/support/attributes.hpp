// Attributes for tests: made by functions of the place, and compared bit by bit.
#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>

namespace pointskin::test {

/// f(p) at every point, as T.
template <class T, class F>
Attribute attribute_of(const std::string& name, const std::vector<Vec3f>& positions, const F& f) {
  std::vector<T> values;
  values.reserve(positions.size());
  for (const Vec3f& p : positions) values.push_back(static_cast<T>(f(p)));
  return {name, std::move(values)};
}

/// All values as floats, whatever their type; NaN where they are missing.
inline std::vector<float> floats_of(const AttributeValues& values) {
  std::vector<float> floats(values.size());
  for (std::size_t i = 0; i < floats.size(); ++i) floats[i] = static_cast<float>(values.at(i));
  return floats;
}
inline std::vector<float> floats_of(const Attribute& attribute) { return floats_of(attribute.values); }

/// The same type and bits, NaN included, missing at the same places.
inline bool same_bytes(const AttributeValues& a, const AttributeValues& b) {
  if (a.type() != b.type() || a.size() != b.size() || a.mask() != b.mask()) return false;
  return visit_type(a.type(), [&](auto tag) {
    using T = decltype(tag);
    return a.empty() || std::memcmp(a.as<T>().data(), b.as<T>().data(), a.size() * sizeof(T)) == 0;
  });
}

}  // namespace pointskin::test
