#include "scale/kth_value.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <vector>

namespace pointskin::scale {
namespace {

constexpr int kHalf = 16;  // of the bits

/// Calls visit(bits) with all values.
template <class Visit>
void for_bits(const SampleValues& values, SampleValues::Column column, std::int64_t part, const Visit& visit) {
  std::vector<float> some;
  for (std::int64_t first = 0; first < values.samples(); first += std::ssize(some)) {
    some.resize(static_cast<std::size_t>(std::min(part, values.samples() - first)));
    values.read(column, first, {some.data(), std::ssize(some)});
    for (const float value : some) visit(std::bit_cast<std::uint32_t>(value));
  }
}

/// Where place k lies, and its place there.
std::uint32_t find_place(const std::vector<std::int64_t>& counts, std::int64_t& k) {
  std::uint32_t at = 0;
  while (k >= counts[at]) k -= counts[at++];
  return at;
}

}  // namespace

float kth_value(const SampleValues& values, SampleValues::Column column, std::int64_t k, std::int64_t part) {
  std::vector<std::int64_t> counts(std::size_t{1} << kHalf, 0);
  for_bits(values, column, part, [&](std::uint32_t bits) { ++counts[bits >> kHalf]; });
  const std::uint32_t upper = find_place(counts, k);
  std::fill(counts.begin(), counts.end(), 0);
  for_bits(values, column, part, [&](std::uint32_t bits) {
    if (bits >> kHalf == upper) ++counts[bits & ((1U << kHalf) - 1)];
  });
  return std::bit_cast<float>(upper << kHalf | find_place(counts, k));
}

}  // namespace pointskin::scale
