// The points of a run: of a cloud on the host, or where the space works.
#pragma once

#include <cstdint>

#include <pointskin/cloud.hpp>
#include <pointskin/device_data.hpp>

namespace pointskin::detail {

/// Refers to the caller's points.
class Input {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor)
  Input(const Cloud& cloud, bool turned = false) : cloud_(&cloud), turned_(turned) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  Input(const DevicePoints& points, bool turned = false) : points_(&points), turned_(turned) {}

  /// The same with all normals the other way round, or as they are.
  [[nodiscard]] Input with_normals(bool turned) const {
    Input input = *this;
    input.turned_ = turned;
    return input;
  }

  [[nodiscard]] const Cloud* cloud() const { return cloud_; }           ///< null: they are where the space works
  [[nodiscard]] const DevicePoints* points() const { return points_; }  ///< null: they are on the host
  [[nodiscard]] bool turned() const { return turned_; }

  [[nodiscard]] std::int64_t size() const { return cloud_ != nullptr ? cloud_->size() : points_->positions.size; }
  [[nodiscard]] const Vec3d& origin() const { return cloud_ != nullptr ? cloud_->origin : points_->origin; }
  [[nodiscard]] bool has_normals() const {
    if (cloud_ != nullptr) return cloud_->has_normals();
    return !points_->positions.empty() && points_->normals.size == points_->positions.size;
  }

 private:
  const Cloud* cloud_ = nullptr;
  const DevicePoints* points_ = nullptr;
  bool turned_ = false;
};

}  // namespace pointskin::detail
