// The options of what gives a cloud its normals, and the report of it.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <pointskin/normals.hpp>

#include "option_table.hpp"

namespace pointskin::cli {

struct NormalArgs {
  NormalOptions options;
  std::vector<std::string> sensors;
};

inline constexpr char kNormalGroup[] = "Normals";

/// The words that mean a method.
Binding method_of(NormalMethod& method);

/// --sensor, --random-start, --seed, --max-rounds, --time-limit, --keep-within; reports show the method, too.
OptionGroup normal_options(NormalArgs& args);

/// Options as the library wants them.
/// @throws Error usage if a value is out of range
NormalOptions library_options(const NormalArgs& args);

/// What the reports of both commands say of the normals.
nlohmann::ordered_json to_json(const NormalReport& report);

/// One line: method, what changed, doubts and times.
std::string summary(const NormalReport& report);

/// Warns of signs that had not settled when rounds or time ran out.
void warn_about_unsettled(const NormalReport& report);

/// Gives `cloud` normals, with progress on a terminal unless `quiet`, and says what was assumed and what is doubtful.
/// @throws Error as NormalEstimator::orient; interrupted after a signal
NormalReport estimate_normals(Cloud& cloud, const NormalOptions& options, const Device& device, bool quiet);

}  // namespace pointskin::cli
