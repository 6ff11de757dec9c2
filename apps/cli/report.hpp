// What a reconstruction did, as JSON for programs and as lines for people. The JSON's schema is
// docs/report.schema.json.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/device.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/normals.hpp>
#include <pointskin/problems.hpp>
#include <pointskin/reconstruct.hpp>

#include "problem_pictures.hpp"

namespace pointskin::cli {

/// Facts of one `pointskin reconstruct`.
struct Record {
  Device device;
  std::int64_t points = 0;               ///< in the files
  std::int64_t dropped = 0;              ///< of them, left out: not finite, or a normal of zero length
  Options options;                       ///< after defaults
  nlohmann::ordered_json shown_options;  ///< with those that Options does not hold
  RunReport run;
  MeshReport mesh;
  std::string command = "reconstruct";
  std::string shape;                    ///< of the mesh, in words: closed or not, components
  std::vector<ProblemRegion> problems;  ///< with Options::weakness
  std::vector<PictureNames> pictures;   ///< of their views; empty: none are drawn
  double read_ms = 0, write_ms = 0, total_ms = 0;
  std::vector<double> repeat_ms;
  int blocks = 0, coarse_level = 0;  ///< FilesReport's, where the whole did not fit; else 0
  std::int64_t host_peak_bytes = 0;
};

nlohmann::ordered_json to_json(const Record& record);

/// What the reports of all commands have in common.
nlohmann::ordered_json to_json(const Device& device);
nlohmann::ordered_json to_json(const MeshReport& mesh);
/// The name of a file that may be left out.
nlohmann::ordered_json or_null(const std::string& file);

/// One line: points, depth, triangles, the times of the paper's table (octree, function, surface, total) and memory;
/// with repeated runs also their median and frames per second.
std::string summary(const Record& record);

/// A table of the regions whose topology is doubtful, the worst first.
std::string problem_table(const std::vector<ProblemRegion>& problems);

/// A table of the solve's levels, with residuals.
std::string level_table(const Record& record);

}  // namespace pointskin::cli
