#include "scale/examine_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "core/array_view.hpp"
#include "exec/exact_sum.hpp"
#include "exec/memory.hpp"
#include "poisson/in_blocks.hpp"
#include "poisson/mean_length.hpp"
#include "poisson/spacing.hpp"

namespace pointskin::scale {
namespace {

using poisson::Samples;

class Examination {
 public:
  Examination(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options, SampleValues& values)
      : ex_(ex), cloud_(cloud), options_(options), team_(options.team), values_(values) {}

  ExaminedSamples run() {
    ExaminedSamples found;
    if (options_.confidence) found.mean_length = mean_length();
    poisson::LookAtCloud look;
    for_parts([&](const poisson::PartOfCloud& part, const Samples& samples, const exec::Buffer<float>& own_side) {
      look.add(poisson::look_at_part(ex_, options_.depth, part, own_side.cview(), samples));
    });
    look = joined(look);
    for_parts([&](const poisson::PartOfCloud& part, Samples& samples, exec::Buffer<float> own_side) {
      auto bends = exec::make_buffer<float>(ex_, samples.areas.size());
      values_.read(SampleValues::trust, part.first - part.before, bends.view());
      poisson::examine_part(ex_, options_.depth, poisson::coarsest_splat_depth(cloud_.size(), options_.depth), part,
                            look, std::move(own_side), std::move(bends), samples);
      if (options_.confidence) scale_areas(part, found.mean_length, samples.areas.view());
      found.lonely += *samples.lonely.data();
      for (std::int64_t i = part.before; i < part.before + part.count; ++i)
        if (samples.areas.data()[i] > 0) found.inliers.add(samples.positions.data()[i]);
      const auto own = [&](const exec::Buffer<float>& column) { return column.cview().part(part.before, part.count); };
      values_.write(SampleValues::area, part.first, own(samples.areas));
      values_.write(SampleValues::examined_depth, part.first, own(samples.splat_depths));
      values_.write(SampleValues::trust, part.first, own(samples.trust));
    });
    found.lonely = team_.reduce(found.lonely, std::plus<>{});
    found.inliers = team_.reduce(found.inliers, [](BoxOfPoints a, const BoxOfPoints& b) {
      if (b.is_empty) return a;
      a.add(b.box.lower);
      a.add(b.box.upper);
      return a;
    });
    return found;
  }

 private:
  [[nodiscard]] poisson::LookAtCloud joined(const poisson::LookAtCloud& own) const {
    poisson::LookAtCloud all;
    for (const std::vector<std::uint64_t>& words : team_.gather(own.words)) all.add({words});
    return all;
  }

  /// Calls step(part, samples, own_side) for this rank's parts of the samples in their order, with those before and after, of which
  /// only what no rank changes is read.
  template <class Step>
  void for_parts(const Step& step) {
    const std::int64_t n = cloud_.size();
    const Team::Share parts = team_.share_of((n + options_.part_samples - 1) / options_.part_samples);
    for (std::int64_t number = parts.begin; number < parts.end; ++number) {
      const std::int64_t first = number * options_.part_samples;
      const std::int64_t begin = std::max<std::int64_t>(0, first - poisson::kExamineReach);
      const std::int64_t end = std::min(n, first + options_.part_samples + poisson::kExamineReach);
      const poisson::PartOfCloud part{first, std::min(options_.part_samples, n - first), first - begin, n};
      const auto column = [&](SampleValues::Column which) {
        auto values = exec::make_buffer<float>(ex_, end - begin);
        values_.read(which, begin, values.view());
        return values;
      };
      Samples samples;
      samples.positions = exec::make_buffer<Vec3f>(ex_, end - begin);
      samples.normals = exec::make_buffer<Vec3f>(ex_, end - begin);
      cloud_.read(ex_, begin, end - begin, {samples.positions.data(), samples.normals.data()});
      poisson::normalise_normals(ex_, samples.normals.view());
      samples.areas = column(SampleValues::area);
      samples.splat_depths = column(SampleValues::depth);
      step(part, samples, column(SampleValues::own_side));
    }
  }

  /// Calls visit(normal) with all normals as they were given.
  template <class Visit>
  void for_normals(std::int64_t first, std::int64_t count, const Visit& visit) const {
    std::vector<Vec3f> normals;
    for (const std::int64_t end = first + count; first < end; first += std::ssize(normals)) {
      normals.resize(static_cast<std::size_t>(std::min(options_.part_samples, end - first)));
      cloud_.read(ex_, first, std::ssize(normals), {nullptr, normals.data()});
      for (const Vec3f& normal : normals) visit(normal);
    }
  }

  /// As poisson::mean_length() has it.
  [[nodiscard]] double mean_length() const {
    double largest = 0;
    const auto sum_in = [&](int fraction) {
      exec::ExactSum sum;
      const Team::Share own = team_.share_of(cloud_.size());
      for_normals(own.begin, own.end - own.begin, [&](const Vec3f& normal) {
        const double length = poisson::length_of(normal);
        largest = exec::Largest{}(largest, length);
        sum = exec::AddExactly{}(sum, exec::exact_term(length, fraction));
      });
      largest = team_.reduce(largest, exec::Largest{});
      return team_.reduce(sum, exec::AddExactly{});
    };
    const auto n = static_cast<double>(cloud_.size());
    const exec::ExactSum sum = sum_in(poisson::kLengthFraction);
    if (sum.reliable(cloud_.size())) return sum.value(poisson::kLengthFraction) / n;
    if (!std::isfinite(largest)) return std::numeric_limits<double>::quiet_NaN();
    if (largest == 0) return 0;
    const int fraction = exec::fraction_for(largest);
    return sum_in(fraction).value(fraction) / n;
  }

  /// By the lengths of the normals, over their mean.
  void scale_areas(const poisson::PartOfCloud& part, double mean, ArrayView<float> areas) const {
    std::int64_t i = part.before;
    for_normals(part.first, part.count,
                [&](const Vec3f& normal) { areas[i++] *= static_cast<float>(poisson::length_of(normal) / mean); });
  }

  exec::Cpu& ex_;
  const SortedCloud& cloud_;
  const BlockOptions& options_;
  const Team& team_;
  SampleValues& values_;
};

}  // namespace

ExaminedSamples examine_samples(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options,
                                SampleValues& values) {
  return Examination(ex, cloud, options, values).run();
}

}  // namespace pointskin::scale
