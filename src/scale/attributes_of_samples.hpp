// The attributes of some samples on their way from the disk to the space that works on them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "exec/cpu.hpp"
#include "exec/space.hpp"
#include "exec/typed_buffer.hpp"
#include "field/attributes.hpp"
#include "scale/sorted_cloud.hpp"
#include "scale/staging.hpp"

namespace pointskin::scale {

class AttributesOfSamples {
 public:
  enum class Which : std::uint8_t { all, labels };

  /// @param all    of the cloud
  /// @param count  of the samples
  AttributesOfSamples(exec::Cpu& host, const std::vector<PointAttribute>& all, std::int64_t count,
                      Which which = Which::all)
      : all_(all), which_(which), count_(count) {
    for (const PointAttribute& attribute : all) {
      const bool is_share = !attribute.is_label() && which == Which::all;
      shares_.emplace_back(host, is_share ? count : 0);
      raw_.emplace_back(host, attribute.is_label() ? count * static_cast<std::int64_t>(size_of(attribute.type)) : 0);
    }
  }

  /// Where SortedCloud::read() puts those of samples from place `at` on.
  struct Places {
    std::vector<float*> shares;
    std::vector<std::uint8_t*> raw;
  };
  [[nodiscard]] Places from(std::int64_t at) {
    Places places;
    for (std::size_t c = 0; c < all_.size(); ++c) {
      const auto bytes = static_cast<std::int64_t>(size_of(all_[c].type));
      places.shares.push_back(shares_[c].view().empty() ? nullptr : shares_[c].data() + at);
      places.raw.push_back(raw_[c].view().empty() ? nullptr : raw_[c].data() + at * bytes);
    }
    return places;
  }

  /// Once, at the end. Adds to what is there.
  template <exec::Space Exec>
  void to(Exec& ex, std::vector<field::Channel>& channels, std::vector<field::Label>& labels) {
    for (std::size_t c = 0; c < all_.size(); ++c) {
      if (all_[c].is_label())
        labels.push_back({c, {all_[c].type, count_, raw_[c].to(ex), {}}});
      else if (which_ == Which::all)
        channels.push_back({c, all_[c].type, shares_[c].to(ex), all_[c].range});
    }
  }

 private:
  const std::vector<PointAttribute>& all_;
  Which which_;
  std::int64_t count_;
  std::vector<Sent<float>> shares_;
  std::vector<Sent<std::uint8_t>> raw_;
};

}  // namespace pointskin::scale
