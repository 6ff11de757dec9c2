// The depth that a cloud supports.
#pragma once

#include <pointskin/reconstruct.hpp>

#include "reconstruct/engine.hpp"

namespace pointskin::detail {

/// pointskin::suggest_depth on an engine.
DepthSuggestion suggest_depth(const Engine& engine, const Input& input, const Options& options);

}  // namespace pointskin::detail
