#include "io/cloud_parts.hpp"

#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>

#include <algorithm>
#include <utility>

#include "core/format.hpp"
#include "core/rebase.hpp"

namespace pointskin::io {
namespace {

/// Values of another type that holds them; missing ones where there are none.
AttributeValues converted(const std::vector<Attribute>& from, const Attribute& to, std::size_t size) {
  const auto found =
      std::find_if(from.begin(), from.end(), [&](const Attribute& attribute) { return attribute.name == to.name; });
  return found == from.end() ? AttributeValues::missing(to.type(), size) : found->values.converted(to.type());
}

}  // namespace

std::unique_ptr<CloudParts> CloudParts::open(exec::Cpu& ex, const std::vector<std::string>& paths) {
  if (paths.empty() || paths.size() > kMostFiles)
    throw Error(ErrorCode::usage,
                fmt::format("1 to {} files can be read in parts together, not {}", kMostFiles, paths.size()));
  auto cloud = std::make_unique<CloudParts>();
  std::int64_t rows = 0;
  for (const std::string& path : paths) {
    std::unique_ptr<FileParts> parts = FileParts::open(ex, path);
    if (parts == nullptr) return nullptr;
    cloud->files_.push_back({std::move(parts), rows});
    rows += cloud->files_.back().parts->rows();
  }
  return cloud;
}

void CloudParts::choose_origin(exec::Cpu& ex, const std::optional<Vec3d>& shift) {
  for (File& file : files_) file.parts->choose_origin(ex, shift);
  origin_ = files_.front().parts->origin();
  if (files_.size() == 1) return;
  settle_origins(ex);
  settle_schema(ex);
}

/// What merge_into() does with origins.
void CloudParts::settle_origins(exec::Cpu& ex) {
  PointsAround all;
  for (File& file : files_) {
    file.moves.clear();
    PointsAround more = file.parts->extent(ex);
    file.is_used = more.points > 0;
    if (!file.is_used) continue;
    if (all.points == 0) {
      all = more;
      continue;
    }
    if (all.origin != more.origin && all.takes_origin_of(more)) {
      for (File* before = files_.data(); before != &file; ++before) before->moves.push_back(all.origin - more.origin);
      all.rebase(more.origin);
    } else if (all.origin != more.origin) {
      file.moves.push_back(more.origin - all.origin);
      more.rebase(all.origin);
    }
    all.add(more.box, more.points);
  }
  origin_ = all.origin;
}

Cloud CloudParts::merged_sample(exec::Cpu& ex) const {
  Cloud all;
  for (const File& file : files_) {
    if (!file.is_used) continue;
    Cloud one;
    one.positions.resize(1);
    if (file.parts->has_normals(ex)) one.normals.resize(1);
    for (const Attribute& attribute : file.parts->attributes(ex))
      one.attributes.push_back({attribute.name, AttributeValues(attribute.type(), 1)});
    merge_into(all, std::move(one));
  }
  return all;
}

void CloudParts::settle_schema(exec::Cpu& ex) {
  const Cloud sample = merged_sample(ex);
  has_normals_ = sample.has_normals();
  schema_.clear();
  for (const Attribute& attribute : sample.attributes)
    schema_.push_back({attribute.name, AttributeValues(attribute.type())});
}

std::vector<Attribute> CloudParts::attributes(exec::Cpu& ex) const {
  if (files_.size() == 1) return files_.front().parts->attributes(ex);
  std::vector<Attribute> attributes = merged_sample(ex).attributes;
  for (Attribute& attribute : attributes) attribute.values = AttributeValues(attribute.type());
  return attributes;
}

std::vector<std::string> CloudParts::integers_with_gaps(exec::Cpu& ex) const {
  std::vector<std::string> names;
  for (const Attribute& attribute : merged_sample(ex).attributes)
    if (attribute.values.has_mask()) names.push_back(attribute.name);
  return names;
}

void CloudParts::leave_out_zero_normals() {
  for (File& file : files_) file.parts->leave_out_zero_normals();
}

void CloudParts::merge(const File& file, Cloud& cloud) const {
  if (files_.size() == 1) return;
  for (const Vec3d& move : file.moves)
    for (Vec3f& p : cloud.positions) p = rebased(p, move);
  cloud.origin = origin_;
  if (!has_normals_) cloud.normals.clear();
  std::vector<Attribute> attributes;
  for (const Attribute& attribute : schema_)
    attributes.push_back({attribute.name, converted(cloud.attributes, attribute, cloud.positions.size())});
  cloud.attributes = std::move(attributes);
}

template <class Use>
void CloudParts::for_files(std::int64_t begin, std::int64_t end, const Use& use) const {
  for (const File& file : files_) {
    const std::int64_t first = std::max(begin - file.first_row, std::int64_t{0});
    const std::int64_t last = std::min(end - file.first_row, file.parts->rows());
    if (first < last) use(file, first, last - first);
  }
}

Cloud CloudParts::read(exec::Cpu& ex, std::int64_t first, std::int64_t count, Bytes& buffer) const {
  if (files_.size() == 1) return files_.front().parts->read(ex, first, count, buffer);
  Cloud all;
  for_files(first, first + count, [&](const File& file, std::int64_t begin, std::int64_t some) {
    Cloud cloud = file.parts->read(ex, begin, some, buffer);
    merge(file, cloud);
    merge_into(all, std::move(cloud));
  });
  return all;
}

void CloudParts::for_parts(exec::Cpu& ex, std::int64_t begin, std::int64_t end,
                           const std::function<void(Cloud&)>& use) const {
  for_files(begin, end, [&](const File& file, std::int64_t first, std::int64_t count) {
    file.parts->for_parts(ex, first, first + count, [&](Cloud& cloud) {
      merge(file, cloud);
      use(cloud);
    });
  });
}

}  // namespace pointskin::io
