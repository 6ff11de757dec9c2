// The JSON of `pointskin bench --report`; docs/bench.schema.json is its schema.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "bench/bench_args.hpp"
#include "bench/results.hpp"

namespace pointskin::cli {

/// @param devices  those measured
nlohmann::ordered_json to_json(const Results& results, const BenchArgs& args, const std::vector<Device>& devices);

}  // namespace pointskin::cli
