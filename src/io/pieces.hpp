// Files that hold several pieces of points and triangles, as one cloud or mesh.
#pragma once

#include <cstdint>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "exec/cpu.hpp"
#include "io/point_table.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// Joins pieces in their order. Attributes that a piece lacks are missing there.
class Pieces {
 public:
  Pieces(exec::Cpu& ex, const Source& source, const ReadOptions& options)
      : ex_(ex), source_(source), options_(options) {}

  /// @param triangles  of rows of the table
  /// @throws Error invalid_input for a vertex that is not finite where there are triangles; over_limit if 32-bit ids do not
  ///         reach
  void add(const PointTable& table, const std::vector<Triangle>& triangles);

  Cloud take_cloud() { return std::move(vertices_); }
  /// Normals get unit length.
  Mesh take_mesh();

 private:
  exec::Cpu& ex_;
  const Source& source_;
  const ReadOptions& options_;
  Cloud vertices_;
  std::vector<Triangle> triangles_;
};

}  // namespace pointskin::io
