// What a run holds at once, phase by phase: follows the allocations of fit_field.cpp, mesh_of_field.cpp and of the
// phases. Whoever allocates or frees an array there changes the model here; tests/property/memory_test.cpp holds the
// two together.
#pragma once

#include <cstdint>
#include <vector>

#include <pointskin/attribute.hpp>
#include <pointskin/reconstruct.hpp>

#include "octree/brick_counts.hpp"

namespace pointskin::detail {

/// Bytes of the attributes that the mesh keeps.
struct AttributeBytes {
  std::int64_t count = 0;
  std::int64_t uploaded = 0;       ///< a point, as the caller has them
  std::int64_t sorted = 0;         ///< a point, as they are interpolated
  std::int64_t averaged = 0;       ///< how many are averaged
  std::int64_t largest_mean = 0;   ///< a vertex, of those that are averaged
  std::int64_t largest_label = 0;  ///< a vertex, of the others
  bool gaps = false;               ///< some points lack a label
};

/// @param kept  whether the mesh keeps them at all
AttributeBytes bytes_of(const std::vector<Attribute>& attributes, bool kept);

/// What decides how much memory a run takes.
struct RunSize {
  std::int64_t points = 0;                  ///< that are used
  std::vector<octree::BrickCounts> levels;  ///< depth 0 first
  std::int64_t strays = 0;                  ///< points that are left out
  AttributeBytes attributes{};
};

/// The largest sum of buffers in one phase of a run.
struct PhaseBytes {
  const char* phase;
  std::int64_t bytes;
};

/// All phases that may be the one with the peak, in their order.
std::vector<PhaseBytes> model_memory(const RunSize& size, const Options& options);

/// The peak of a run whose points are all at one place: it ends when it knows that.
std::int64_t uploaded_bytes(std::int64_t points, const AttributeBytes& attributes);

}  // namespace pointskin::detail
