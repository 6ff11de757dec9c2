#include "scale/sorted_cloud.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/typed_view.hpp"
#include "exec/cpu_primitives.hpp"
#include "octree/keys.hpp"
#include "reconstruct/point_hash.hpp"

namespace pointskin::scale {
namespace {

/// A point as DiskSort takes it; the values of its attributes follow, in their types.
struct Record {
  std::uint64_t key = 0, hash = 0;
  Vec3f position, normal;
};
static_assert(sizeof(Record) == 40 && std::is_trivially_copyable_v<Record>);

bool is_kept(const Attribute& attribute, KeptAttributes kept) {
  if (kept != KeptAttributes::colours) return kept == KeptAttributes::all;
  return attribute.name == "red" || attribute.name == "green" || attribute.name == "blue";
}

/// Of a part of the points.
std::vector<const Attribute*> kept_of(const std::vector<Attribute>& attributes, KeptAttributes kept) {
  std::vector<const Attribute*> some;
  for (const Attribute& attribute : attributes)
    if (is_kept(attribute, kept)) some.push_back(&attribute);
  return some;
}

TypedView view_of(const Attribute& attribute) {
  const void* const data =
      attribute.values.visit([](const auto& values) { return static_cast<const void*>(values.data()); });
  return {attribute.type(), data, nullptr, static_cast<std::int64_t>(attribute.values.size())};
}

/// Indices of the points of a part that are not left out.
class UsedOf {
 public:
  /// @param before  points of the file that come before the first part
  UsedOf(std::span<const std::int32_t> left_out, std::int64_t before)
      : left_out_(
            left_out.subspan(static_cast<std::size_t>(std::ranges::lower_bound(left_out, before) - left_out.begin()))),
        before_(before) {}

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
  std::int64_t before_;                     // points of the parts before
  std::vector<std::int32_t> used_;
};

/// Makes the records of a part.
struct MakeRecord {
  const Cloud& cloud;
  const octree::Frame& frame;
  std::span<const std::int32_t> used;
  std::span<const std::uint64_t> hashes;
  std::span<const TypedView> attributes;
  std::int64_t record_bytes;
  std::byte* out;

  void operator()(std::int64_t k) const {
    const auto at = static_cast<std::size_t>(k);
    const auto from = static_cast<std::size_t>(used[at]);
    const Vec3f unit = frame.to_unit(cloud.positions[from]);
    const Record record{octree::point_key(unit.x, unit.y, unit.z), hashes[at], unit, cloud.normals[from]};
    std::byte* to = out + k * record_bytes;
    std::memcpy(to, &record, sizeof record);
    to += sizeof record;
    for (const TypedView& values : attributes) {
      const std::size_t bytes = size_of(values.type);
      std::memcpy(to, static_cast<const std::byte*>(values.data) + from * bytes, bytes);
      to += bytes;
    }
  }
};

}  // namespace

std::vector<PointAttribute> attributes_of(exec::Cpu& ex, const io::CloudParts& points, KeptAttributes kept) {
  std::vector<PointAttribute> kept_ones;
  if (kept == KeptAttributes::none) return kept_ones;
  const std::vector<Attribute> all = points.attributes(ex);
  for (const Attribute* const attribute : kept_of(all, kept))
    kept_ones.push_back({attribute->name, attribute->type(), {}});
  return kept_ones;
}

SortedCloud::SortedCloud(exec::Cpu& ex, const io::CloudParts& points, const Setup& setup)
    : record_bytes_(sizeof(Record)) {
  std::vector<PointAttribute> attributes = attributes_of(ex, points, setup.attributes);
  for (const PointAttribute& attribute : attributes)
    record_bytes_ += static_cast<std::int64_t>(size_of(attribute.type));
  const Team::Share rows = setup.team.share_of(points.rows());
  DiskSort sort(ex, {setup.folder, points.rows(), record_bytes_, setup.memory_bytes, setup.team, rows.begin});
  setup.team.together([&] { add_rows(ex, points, setup, rows, sort, attributes); });
  spool_ = sort.finish();
  size_ = setup.team.reduce(size_, std::plus<>{});
  for (PointAttribute& attribute : attributes)
    attribute.range = setup.team.reduce(
        attribute.range, [](const field::ValueRange& a, const field::ValueRange& b) { return a.united(b); });
  settle_attributes(std::move(attributes));
}

void SortedCloud::add_rows(exec::Cpu& ex, const io::CloudParts& points, const Setup& setup, Team::Share rows,
                           DiskSort& sort, std::vector<PointAttribute>& attributes) {
  UsedOf used_of(setup.left_out, setup.before);
  std::vector<std::uint64_t> hashes;
  std::vector<std::byte> records;
  points.for_parts(ex, rows.begin, rows.end, [&](Cloud& cloud) {
    if (cloud.positions.empty()) return;
    if (!cloud.has_normals())
      throw Error(ErrorCode::no_normals, "the points have no normals; a surface needs oriented points");
    if (setup.turned)
      std::transform(cloud.normals.begin(), cloud.normals.end(), cloud.normals.begin(), [](const Vec3f& n) {
        return Vec3f{-n.x, -n.y, -n.z};
      });
    const std::vector<std::int32_t>& used = used_of.next(cloud.size());
    const std::int64_t count = std::ssize(used);
    if (count == 0) return;
    const ArrayView<const std::int32_t> selected{used.data(), count};
    hashes.resize(used.size());
    records.resize(static_cast<std::size_t>(count * record_bytes_));
    for_each(ex, "scale.hash", count,
             detail::HashPoint{{cloud.positions.data(), cloud.size()},
                               {cloud.normals.data(), cloud.size()},
                               {hashes.data(), count},
                               {selected}});
    std::vector<TypedView> values;
    for (const Attribute* const attribute : kept_of(cloud.attributes, setup.attributes)) {
      const TypedView view = view_of(*attribute);
      for_each(ex, "scale.hash", count, detail::HashAttribute{view, {hashes.data(), count}, {selected}});
      field::ValueRange& range = attributes[values.size()].range;
      range = range.united(field::find_range(ex, view, selected));
      values.push_back(view);
    }
    for_each(ex, "scale.records", count,
             MakeRecord{cloud, setup.frame, used, hashes, values, record_bytes_, records.data()});
    sort.add(records.data(), count);
    size_ += count;
  });
}

void SortedCloud::settle_attributes(std::vector<PointAttribute> all) {
  std::int64_t at = sizeof(Record);
  for (PointAttribute& attribute : all) {
    const std::int64_t here = at;
    at += static_cast<std::int64_t>(size_of(attribute.type));
    if (attribute.range.counted == 0) {
      without_values_.push_back(attribute.name);
      continue;
    }
    places_.push_back(
        {here, attribute.type, attribute.is_label() ? field::ToShare{} : field::ToShare(attribute.range)});
    attributes_.push_back(std::move(attribute));
  }
}

void SortedCloud::read(std::int64_t first, std::int64_t count, const Arrays& out) const {
  constexpr std::int64_t kAtOnce = 8192;
  std::vector<std::byte> records(static_cast<std::size_t>(std::min(kAtOnce, count) * record_bytes_));
  for (std::int64_t done = 0; done < count;) {
    const std::int64_t some = std::min(kAtOnce, count - done);
    spool_->read((first + done) * record_bytes_, records.data(), some * record_bytes_);
    read_shares(records.data(), some, done, out.shares);
    read_raw(records.data(), some, done, out.raw);
    for (std::int64_t i = 0; i < some; ++i, ++done) {
      Record record;
      std::memcpy(&record, records.data() + i * record_bytes_, sizeof record);
      if (out.positions != nullptr) out.positions[done] = record.position;
      if (out.normals != nullptr) out.normals[done] = record.normal;
      if (out.keys != nullptr) out.keys[done] = record.key;
    }
  }
}

/// Of `count` records, to places from `at` on.
void SortedCloud::read_shares(const std::byte* records, std::int64_t count, std::int64_t at,
                              std::span<float* const> shares) const {
  for (std::size_t c = 0; c < shares.size(); ++c) {
    if (shares[c] == nullptr) continue;
    const Place& place = places_[c];
    visit_type(place.type, [&](auto tag) {
      decltype(tag) value;
      for (std::int64_t i = 0; i < count; ++i) {
        std::memcpy(&value, records + i * record_bytes_ + place.at, sizeof value);
        shares[c][at + i] = place.to_share(static_cast<double>(value));
      }
    });
  }
}

void SortedCloud::read_raw(const std::byte* records, std::int64_t count, std::int64_t at,
                           std::span<std::uint8_t* const> raw) const {
  for (std::size_t c = 0; c < raw.size(); ++c) {
    if (raw[c] == nullptr) continue;
    const std::size_t bytes = size_of(places_[c].type);
    std::uint8_t* to = raw[c] + static_cast<std::size_t>(at) * bytes;
    for (std::int64_t i = 0; i < count; ++i, to += bytes)
      std::memcpy(to, records + i * record_bytes_ + places_[c].at, bytes);
  }
}

void SortedCloud::read(exec::Cpu& ex, std::int64_t first, std::int64_t count, const Arrays& out) const {
  constexpr std::int64_t kPart = 64 << 10;
  const auto from = [](auto* array, std::int64_t i) { return array != nullptr ? array + i : nullptr; };
  ex.run_blocks((count + kPart - 1) / kPart, [&](std::int64_t part) {
    const std::int64_t done = part * kPart;
    std::vector<float*> shares;
    for (float* const values : out.shares) shares.push_back(from(values, done));
    std::vector<std::uint8_t*> raw;
    for (std::size_t c = 0; c < out.raw.size(); ++c)
      raw.push_back(from(out.raw[c], done * static_cast<std::int64_t>(size_of(places_[c].type))));
    read(first + done, std::min(kPart, count - done),
         {from(out.positions, done), from(out.normals, done), from(out.keys, done), shares, raw});
  });
}

}  // namespace pointskin::scale
