// What a run in blocks finds of every sample.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/array_view.hpp"
#include "scale/spool.hpp"
#include "scale/team.hpp"

namespace pointskin::scale {

/// Columns of a float a sample, on the disk, in the order of the samples.
class SampleValues {
 public:
  /// `spacing` is there where the surface is to be cut.
  enum Column : std::uint8_t { area, depth, trust, own_side, examined_depth, spacing };
  static constexpr std::int64_t columns(bool trims) { return trims ? 6 : 5; }

  /// Of all ranks. Collective.
  /// @throws Error as Spool
  SampleValues(const Team& team, const std::string& folder, std::int64_t samples, bool trims)
      : samples_(samples), spool_(team.make_spool(folder, columns(trims) * samples * std::int64_t{sizeof(float)})) {}

  [[nodiscard]] std::int64_t samples() const { return samples_; }

  /// Of samples first .. first + size - 1; for many threads at once.
  /// @throws Error as Spool
  void read(Column column, std::int64_t first, ArrayView<float> out) const {
    spool_->read(at(column, first), out.data, out.size * std::int64_t{sizeof(float)});
  }
  void write(Column column, std::int64_t first, ArrayView<const float> values) const {
    spool_->write(at(column, first), values.data, values.size * std::int64_t{sizeof(float)});
  }

 private:
  [[nodiscard]] std::int64_t at(Column column, std::int64_t first) const {
    return (column * samples_ + first) * std::int64_t{sizeof(float)};
  }
  std::int64_t samples_;
  std::unique_ptr<Spool> spool_;
};

}  // namespace pointskin::scale
