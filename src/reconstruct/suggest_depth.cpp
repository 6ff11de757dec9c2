#include "reconstruct/suggest_depth.hpp"

#include <pointskin/error.hpp>

#include "diagnose/warnings.hpp"

namespace pointskin {
namespace detail {

namespace {

/// Whether the run fits into `memory`; not if counting its cells does not.
bool fits(const Engine& engine, const Input& input, Options options, std::int64_t memory) {
  options.max_memory_bytes = memory;
  try {
    return bytes_of_run(engine, input, options) <= memory;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::over_limit) throw;
    return false;
  }
}

}  // namespace

DepthSuggestion suggest_depth(const Engine& engine, const Input& input, const Options& options) {
  const Device& device = engine.workspace().device();
  engine.limit_memory(options.max_memory_bytes);
  const Detail detail = engine.measure_detail(input, options);
  DepthSuggestion suggestion;
  suggestion.spacing = detail.spacing;
  suggestion.noise = detail.noise;
  suggestion.supported = diagnose::supported_depth(detail.cube, detail.spacing, detail.noise);
  suggestion.depth = suggestion.supported;
  const std::int64_t memory = options.max_memory_bytes > 0 ? options.max_memory_bytes : device.available_bytes();
  Options tried = options;
  for (; suggestion.depth > 1; --suggestion.depth) {
    tried.depth = suggestion.depth;
    // The estimate from the points themselves sorts them: only where that from their number is not clearly enough.
    if (estimate_device_bytes(input.size(), tried) <= memory / 2) break;
    if (fits(engine, input, tried, memory)) break;
  }
  return suggestion;
}

}  // namespace detail

DepthSuggestion suggest_depth(const Cloud& cloud, const Options& options, Device device) {
  Options any = options;
  any.depth = Options::kAutomaticDepth;
  validate(any);
  return detail::suggest_depth(detail::Engine(device), cloud, options);
}

}  // namespace pointskin
