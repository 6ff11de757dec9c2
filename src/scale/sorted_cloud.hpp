// The points of a file in the order of their keys, on a disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <pointskin/attribute.hpp>
#include <pointskin/vector.hpp>

#include "exec/cpu.hpp"
#include "field/attributes.hpp"
#include "io/cloud_parts.hpp"
#include "octree/frame.hpp"
#include "scale/disk_sort.hpp"
#include "scale/spool.hpp"
#include "scale/team.hpp"

namespace pointskin::scale {

/// Which attributes of the points are kept.
enum class KeptAttributes : std::uint8_t { none, colours, all };

/// An attribute of the points of a cloud.
struct PointAttribute {
  std::string name;
  AttributeType type = AttributeType::float32;
  field::ValueRange range;  ///< of the points that are not left out

  [[nodiscard]] bool is_label() const { return pointskin::is_label(name, type); }
};

/// The attributes of the points of a file that are kept, in its order, without ranges. The header is read.
std::vector<PointAttribute> attributes_of(exec::Cpu& ex, const io::CloudParts& points, KeptAttributes kept);

/// What detail::sort_into_cube() makes of a cloud, for clouds that memory does not hold: the same points in the same order, with
/// the same bits.
class SortedCloud {
 public:
  struct Setup {
    /// For temporary data, 40 bytes a point and what its attributes have, and as much again while they are sorted.
    std::string folder;
    std::int64_t memory_bytes = 0;             ///< that sorting may take, as DiskSort::Setup
    octree::Frame frame;                       ///< of the unit cube
    std::span<const std::int32_t> left_out{};  ///< points of the file to leave out, ascending
    bool turned = false;                       ///< all normals the other way round
    KeptAttributes attributes = KeptAttributes::none;
    Team team{};              ///< of ranks that read the file, each its share of the rows
    std::int64_t before = 0;  ///< points in the rows before this rank's (CloudExtent)
  };

  /// Points as arrays, for whoever needs them: shape (count), or null.
  struct Arrays {
    Vec3f* positions = nullptr;  ///< in the unit cube
    Vec3f* normals = nullptr;    ///< as they came
    std::uint64_t* keys = nullptr;
    std::span<float* const> shares{};      ///< of each of attributes() as field::Channel has them, or null; or none
    std::span<std::uint8_t* const> raw{};  ///< values of each of attributes() in its type, or null; or none
  };

  /// @param points  whose origin has been chosen
  /// @throws Error no_normals if they have none; output_not_written, interrupted; as CloudParts::read
  /// One pass over the file. O(n log n). Collective.
  SortedCloud(exec::Cpu& ex, const io::CloudParts& points, const Setup& setup);

  [[nodiscard]] std::int64_t size() const { return size_; }
  /// On the disk.
  [[nodiscard]] std::int64_t bytes() const { return spool_->size(); }

  /// Those that any point has a finite value of; and the names of the others.
  [[nodiscard]] const std::vector<PointAttribute>& attributes() const { return attributes_; }
  [[nodiscard]] const std::vector<std::string>& without_values() const { return without_values_; }

  /// Points first .. first + count - 1. For many threads at once.
  /// @throws Error output_not_written if the disk fails, interrupted
  void read(std::int64_t first, std::int64_t count, const Arrays& out) const;
  /// The same by all threads.
  void read(exec::Cpu& ex, std::int64_t first, std::int64_t count, const Arrays& out) const;

 private:
  /// Where an attribute lies in a record.
  struct Place {
    std::int64_t at = 0;
    AttributeType type = AttributeType::float32;
    field::ToShare to_share{};  ///< unless it is a label
  };
  /// Adds what is found of some rows of the file to `attributes` and to the size.
  void add_rows(exec::Cpu& ex, const io::CloudParts& points, const Setup& setup, Team::Share rows, DiskSort& sort,
                std::vector<PointAttribute>& attributes);
  void settle_attributes(std::vector<PointAttribute> all);
  void read_shares(const std::byte* records, std::int64_t count, std::int64_t at, std::span<float* const> shares) const;
  void read_raw(const std::byte* records, std::int64_t count, std::int64_t at,
                std::span<std::uint8_t* const> raw) const;

  std::unique_ptr<Spool> spool_;
  std::int64_t record_bytes_ = 0;
  std::int64_t size_ = 0;
  std::vector<PointAttribute> attributes_;
  std::vector<Place> places_;  ///< of these
  std::vector<std::string> without_values_;
};

}  // namespace pointskin::scale
