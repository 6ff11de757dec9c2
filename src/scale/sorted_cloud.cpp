#include "scale/sorted_cloud.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "octree/keys.hpp"
#include "reconstruct/point_hash.hpp"
#include "scale/disk_sort.hpp"

namespace pointskin::scale {
namespace {

/// A point as DiskSort takes it.
struct Record {
  std::uint64_t key = 0, hash = 0;
  Vec3f position, normal;
};
static_assert(sizeof(Record) == 40 && std::is_trivially_copyable_v<Record>);

/// Indices of the points of a part that are not left out.
class UsedOf {
 public:
  explicit UsedOf(std::span<const std::int32_t> left_out) : left_out_(left_out) {}

  /// @returns (n) of the next part, which has `count` points, ascending
  const std::vector<std::int32_t>& next(std::int64_t count) {
    used_.clear();
    for (std::int64_t i = 0; i < count; ++i) {
      if (!left_out_.empty() && left_out_.front() == before_ + i)
        left_out_ = left_out_.subspan(1);
      else
        used_.push_back(static_cast<std::int32_t>(i));
    }
    before_ += count;
    return used_;
  }

 private:
  std::span<const std::int32_t> left_out_;  // those not met yet
  std::int64_t before_ = 0;                 // points of the parts before
  std::vector<std::int32_t> used_;
};

/// Makes the records of a part.
struct MakeRecord {
  const Cloud& cloud;
  const octree::Frame& frame;
  std::span<const std::int32_t> used;
  std::span<const std::uint64_t> hashes;
  std::span<Record> out;

  void operator()(std::int64_t k) const {
    const auto at = static_cast<std::size_t>(k);
    const auto from = static_cast<std::size_t>(used[at]);
    const Vec3f unit = frame.to_unit(cloud.positions[from]);
    out[at] = {octree::point_key(unit.x, unit.y, unit.z), hashes[at], unit, cloud.normals[from]};
  }
};

}  // namespace

SortedCloud::SortedCloud(exec::Cpu& ex, const io::CloudParts& points, const Setup& setup) {
  DiskSort sort(ex, {setup.folder, points.rows(), sizeof(Record), setup.memory_bytes});
  UsedOf used_of(setup.left_out);
  std::vector<std::uint64_t> hashes;
  std::vector<Record> records;
  points.for_parts(ex, [&](Cloud& cloud) {
    if (cloud.positions.empty()) return;
    if (!cloud.has_normals())
      throw Error(ErrorCode::no_normals, "the points have no normals; a surface needs oriented points");
    if (setup.turned)
      std::transform(cloud.normals.begin(), cloud.normals.end(), cloud.normals.begin(), [](const Vec3f& n) {
        return Vec3f{-n.x, -n.y, -n.z};
      });
    const std::vector<std::int32_t>& used = used_of.next(cloud.size());
    const std::int64_t count = std::ssize(used);
    hashes.resize(used.size());
    records.resize(used.size());
    for_each(ex, "scale.hash", count,
             detail::HashPoint{{cloud.positions.data(), cloud.size()},
                               {cloud.normals.data(), cloud.size()},
                               {hashes.data(), count},
                               {{used.data(), count}}});
    for_each(ex, "scale.records", count, MakeRecord{cloud, setup.frame, used, hashes, records});
    sort.add(reinterpret_cast<const std::byte*>(records.data()), count);
    size_ += count;
  });
  spool_ = sort.finish();
}

void SortedCloud::read(std::int64_t first, std::int64_t count, const Arrays& out) const {
  constexpr std::int64_t kAtOnce = 8192;
  std::vector<Record> records(static_cast<std::size_t>(std::min(kAtOnce, count)));
  for (std::int64_t done = 0; done < count;) {
    const std::int64_t some = std::min(kAtOnce, count - done);
    spool_->read((first + done) * std::int64_t{sizeof(Record)}, records.data(), some * std::int64_t{sizeof(Record)});
    for (std::int64_t i = 0; i < some; ++i, ++done) {
      const Record& record = records[static_cast<std::size_t>(i)];
      if (out.positions != nullptr) out.positions[done] = record.position;
      if (out.normals != nullptr) out.normals[done] = record.normal;
      if (out.keys != nullptr) out.keys[done] = record.key;
    }
  }
}

void SortedCloud::read(exec::Cpu& ex, std::int64_t first, std::int64_t count, const Arrays& out) const {
  constexpr std::int64_t kPart = 64 << 10;
  const auto from = [](auto* array, std::int64_t i) { return array != nullptr ? array + i : nullptr; };
  ex.run_blocks((count + kPart - 1) / kPart, [&](std::int64_t part) {
    const std::int64_t done = part * kPart;
    read(first + done, std::min(kPart, count - done),
         {from(out.positions, done), from(out.normals, done), from(out.keys, done)});
  });
}

}  // namespace pointskin::scale
