// The points of a file in the order of their keys, on a disk.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <pointskin/vector.hpp>

#include "exec/cpu.hpp"
#include "io/cloud_parts.hpp"
#include "octree/frame.hpp"
#include "scale/spool.hpp"

namespace pointskin::scale {

/// What detail::sort_into_cube() makes of a cloud without attributes, for clouds that memory does not hold: the same
/// points in the same order, with the same bits.
class SortedCloud {
 public:
  struct Setup {
    std::string folder;             ///< for temporary data, 40 bytes a point, and as much again while they are sorted
    std::int64_t memory_bytes = 0;  ///< that sorting may take, as DiskSort::Setup
    octree::Frame frame;            ///< of the unit cube
    std::span<const std::int32_t> left_out{};  ///< points of the file to leave out, ascending
    bool turned = false;                       ///< all normals the other way round
  };

  /// Points as arrays, for whoever needs them: shape (count), or null.
  struct Arrays {
    Vec3f* positions = nullptr;  ///< in the unit cube
    Vec3f* normals = nullptr;    ///< as they came
    std::uint64_t* keys = nullptr;
  };

  /// @param points  whose origin has been chosen
  /// @throws Error no_normals if they have none; output_not_written, interrupted; as CloudParts::read
  /// One pass over the file. O(n log n)
  SortedCloud(exec::Cpu& ex, const io::CloudParts& points, const Setup& setup);

  [[nodiscard]] std::int64_t size() const { return size_; }
  /// On the disk.
  [[nodiscard]] std::int64_t bytes() const { return spool_->size(); }

  /// Points first .. first + count - 1. For many threads at once.
  /// @throws Error output_not_written if the disk fails, interrupted
  void read(std::int64_t first, std::int64_t count, const Arrays& out) const;
  /// The same by all threads.
  void read(exec::Cpu& ex, std::int64_t first, std::int64_t count, const Arrays& out) const;

 private:
  std::unique_ptr<Spool> spool_;
  std::int64_t size_ = 0;
};

}  // namespace pointskin::scale
