#include "scene/operations.hpp"

#include <iterator>

#include <pointskin/error.hpp>

namespace pointskin::scene {

const char* name_of(const SceneOperation& operation) {
  constexpr const char* kNames[] = {"guide", "remove", "flip", "insert", "deform", "boolean", "orient", "options"};
  static_assert(std::size(kNames) == std::variant_size_v<SceneOperation>);
  return kNames[operation.index()];
}

bool is_edit(const SceneOperation& operation) {
  constexpr std::size_t kEdits = 4;  // they come first
  return operation.index() < kEdits;
}

Operation edit_of(const SceneOperation& operation) {
  if (const auto* guide = std::get_if<Guide>(&operation)) return *guide;
  if (const auto* remove = std::get_if<Remove>(&operation)) return *remove;
  if (const auto* flip = std::get_if<Flip>(&operation)) return *flip;
  if (const auto* insert = std::get_if<Insert>(&operation)) return *insert;
  throw Error(ErrorCode::internal, "this operation is not one of an editing session");
}

}  // namespace pointskin::scene
