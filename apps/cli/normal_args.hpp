// The options of what gives a cloud its normals, and the report of it.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <pointskin/normals.hpp>

namespace pointskin::cli {

struct NormalArgs {
  NormalOptions options;
  std::string method = "auto";
  std::vector<std::string> sensors;
};

inline constexpr char kNormalGroup[] = "Normals";

/// --sensor, --random-start, --seed, --max-rounds, --time-limit, --keep-within.
void define_normal_options(CLI::App& command, NormalArgs& args);

/// "auto", "sensor", "propagate", "iterate" or "repair". @throws Error usage, naming `option`
NormalMethod normal_method_of(const std::string& name, const std::string& option);

/// Options as the library wants them. @param option  that names the method
/// @throws Error usage if a value is out of range
NormalOptions normal_options(const NormalArgs& args, const std::string& option);

/// What the reports of both commands say of the normals.
nlohmann::ordered_json to_json(const NormalOptions& options);
nlohmann::ordered_json to_json(const NormalReport& report);

/// One line: method, what changed, doubts and times.
std::string summary(const NormalReport& report);

/// Warns of signs that had not settled when rounds or time ran out.
void warn_about_unsettled(const NormalReport& report);

/// Gives `cloud` normals, with progress on a terminal unless `quiet`, and says what was assumed and what is doubtful.
/// @throws Error as NormalEstimator::orient; interrupted after a signal
NormalReport estimate_normals(Cloud& cloud, const NormalOptions& options, const Device& device, bool quiet);

}  // namespace pointskin::cli
