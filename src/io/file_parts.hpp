// A cloud in a file, read in parts: for clouds that memory does not hold.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>

#include "core/rebase.hpp"
#include "exec/cpu.hpp"
#include "io/input.hpp"
#include "io/point_rows.hpp"

namespace pointskin::io {

/// The points that read_cloud() reads, in its order and with its origin, part by part.
class FileParts {
 public:
  using Bytes = PointRows::Bytes;

  /// True for text (PLY too), and for binary PLY and NPY files whose points lie at equal distances; false for pipes, compressed data,
  /// binary PLY with lists of vertices or faces, as it cannot be known that the file is whole, meshes whose vertices have no normals,
  /// and other formats.
  /// @throws Error invalid_input if it cannot be read, or its header is garbled
  static bool can_open(const std::string& path);

  /// Of text all lines are read.
  /// @returns null where can_open() is false
  /// @throws Error invalid_input if it cannot be read, or is garbled
  static std::unique_ptr<FileParts> open(exec::Cpu& ex, const std::string& path);

  /// Rows of the file; some may hold no point.
  [[nodiscard]] std::int64_t rows() const { return rows_->rows(); }
  /// About that of a row in the file.
  [[nodiscard]] std::int64_t row_bytes() const { return rows_->row_bytes(); }

  /// Chooses the origin, as ReadOptions::shift says: where that is unset one pass over the coordinates, or two; 48
  /// bytes for 64 rows, and kBufferBytes.
  /// @throws Error invalid_input without x, y, z, or if the file has become shorter; usage if `shift` is not finite
  void choose_origin(exec::Cpu& ex, const std::optional<Vec3d>& shift);

  /// Names and types of the points' attributes, without values; before an origin is chosen, too.
  [[nodiscard]] std::vector<Attribute> attributes(exec::Cpu& ex) const;

  /// True if its points have normals, even if there are none.
  [[nodiscard]] bool has_normals(exec::Cpu& ex) const;

  /// Where the finite points lie, once an origin has been chosen: one pass over the coordinates.
  /// @throws Error as read
  [[nodiscard]] PointsAround extent(exec::Cpu& ex) const;

  /// What positions are relative to, once it has been chosen.
  [[nodiscard]] const Vec3d& origin() const { return origin_; }

  /// Points whose normal is zero are left out from now on, like those that are not finite, but not counted in Cloud::dropped.
  void leave_out_zero_normals() { keeps_zero_normals_ = false; }

  /// The points of rows first .. first + count - 1, in parallel. The origin must have been chosen. Where rows have no
  /// finite coordinates there are fewer, and Cloud::dropped says how many.
  /// @throws Error invalid_input if the file has become shorter, or cannot be read
  Cloud read(exec::Cpu& ex, std::int64_t first, std::int64_t count, Bytes& buffer) const;

  /// Reads all rows, kBufferBytes at a time, and hands their points on, in order, to be changed at will.
  /// @throws Error as read, or whatever `use` throws
  void for_parts(exec::Cpu& ex, const std::function<void(Cloud&)>& use) const { for_parts(ex, 0, rows(), use); }
  /// The same of rows begin..end - 1.
  void for_parts(exec::Cpu& ex, std::int64_t begin, std::int64_t end, const std::function<void(Cloud&)>& use) const;

  static constexpr std::int64_t kBufferBytes = std::int64_t{4} << 20;

 private:
  explicit FileParts(const std::string& path) : input_(path) {}
  [[nodiscard]] const PointRows& coordinates() const { return coordinates_ ? *coordinates_ : *rows_; }
  /// Calls use(part) for all parts, with coordinates and perhaps more.
  template <class Use>
  void for_coordinates(exec::Cpu& ex, const Use& use) const;

  Input input_;                                    // the header is read from the mapping, the rest is not
  std::unique_ptr<PointRows> rows_, coordinates_;  ///< where coordinates cannot be read alone, these are null
  Vec3d origin_{0, 0, 0};
  bool keeps_zero_normals_ = true;
};

}  // namespace pointskin::io
