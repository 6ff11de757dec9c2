// Files of several scans, each made from a place of its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>

#include "exec/cpu.hpp"
#include "io/point_table.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// Consecutive rows of a table that were seen from one place.
struct Scan {
  std::int64_t rows = 0;
  std::optional<Vec3d> sensor;       ///< where the scanner stood, world coordinates; unset: unknown
  std::vector<std::string> lacking;  ///< attributes of the table that the scan has no values of
};

/// Makes a cloud of all scans as assemble() does. Where a sensor is known its points get the attributes sensor_x,
/// sensor_y and sensor_z (float64), by which normals are turned; values that a scan lacks are missing. Rows whose x is
/// not a number are directions without a point: left out, but not counted as dropped.
/// @param table  x, y, z in double without gaps between them; as many rows as the scans have together
/// @throws Error as assemble
Cloud assemble_scans(exec::Cpu& ex, const Source& source, const PointTable& table, const std::vector<Scan>& scans,
                     const std::optional<Vec3d>& shift);

}  // namespace pointskin::io
