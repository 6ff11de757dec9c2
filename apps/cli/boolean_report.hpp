// What a Boolean did, as JSON for programs and as a line for people. The JSON's schema is docs/boolean.schema.json.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include <pointskin/boolean.hpp>
#include <pointskin/device.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin::cli {

/// Facts of one `pointskin boolean`.
struct BooleanRecord {
  Device device;
  std::string op;  ///< as on the command line
  nlohmann::ordered_json files, shown_options;
  BooleanOptions options;
  BooleanReport run;
  MeshReport mesh;
  std::string shape;  ///< of the mesh, in words
  bool a_is_mesh = false, b_is_mesh = false;
  std::int64_t a_dropped = 0, b_dropped = 0;  ///< points left out on reading
  double read_ms = 0, write_ms = 0, total_ms = 0;
  std::int64_t host_peak_bytes = 0;
};

nlohmann::ordered_json to_json(const BooleanRecord& record);

/// One line: what was kept of either, added along the crease, triangles, times and memory.
std::string summary(const BooleanRecord& record);

}  // namespace pointskin::cli
