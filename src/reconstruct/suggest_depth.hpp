// The depth that a cloud supports.
#pragma once

#include <pointskin/reconstruct.hpp>

#include "reconstruct/engine.hpp"

namespace pointskin::detail {

/// pointskin::suggest_depth on an engine of `device`.
DepthSuggestion suggest_depth(Engine& engine, const Device& device, const Cloud& cloud, const Options& options);

}  // namespace pointskin::detail
