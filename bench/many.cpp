// pointskin_many: thousands of small clouds, one by one and all at once.
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "shapes.hpp"

namespace {

using namespace pointskin;

constexpr const char* kUsage =
    "usage: pointskin_many [--clouds 4096] [--points 10000] [--depth 6] [--repeat 3] [--device auto|cpu|cuda]\n"
    "                      [--threads 0]\n"
    "\n"
    "Reconstructs so many clouds of shapes of pointskin_generate, from host memory to host memory: some of them one "
    "by\n"
    "one, then all of them with Reconstructor::reconstruct_many. Prints clouds per second, medians of the repeats.\n";

/// Median clouds per second of `work`, which is done once more before.
template <class Work>
double median_rate(int repeats, std::size_t clouds, const Work& work) {
  std::vector<double> rates;
  for (int i = -1; i < std::max(1, repeats); ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (i >= 0) rates.push_back(static_cast<double>(clouds) / took.count());
  }
  std::sort(rates.begin(), rates.end());
  return rates[rates.size() / 2];
}

int run(const std::vector<std::string>& words) {
  bench::SamplingOptions sampling;
  sampling.points = 10'000;
  std::string device = "auto";
  std::int64_t count = 4096;
  int repeats = 3;
  Options options;
  options.depth = 6;
  bench::Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "--clouds")
      count = arguments.whole_number();
    else if (*word == "--points")
      sampling.points = arguments.whole_number();
    else if (*word == "--depth")
      options.depth = static_cast<int>(arguments.whole_number());
    else if (*word == "--repeat")
      repeats = static_cast<int>(arguments.whole_number());
    else if (*word == "--device")
      device = arguments.value();
    else if (*word == "--threads")
      sampling.threads = static_cast<int>(arguments.whole_number());
    else
      arguments.refuse();
  }
  const char* const shapes[] = {"knot", "torus", "sphere", "gyroid"};
  std::vector<Cloud> clouds;
  for (std::int64_t i = 0; i < count; ++i) {
    constexpr std::int64_t kDifferent = 64;  // more would only take longer to make
    if (i < kDifferent) {
      sampling.seed = static_cast<std::uint64_t>(i);
      clouds.push_back(bench::sample_surface(*bench::make_shape(shapes[i % 4]), sampling));
    } else {
      clouds.push_back(clouds[static_cast<std::size_t>(i % kDifferent)]);
    }
  }
  Reconstructor reconstructor(Device::parse(device, sampling.threads));
  const std::span<const Cloud> some(clouds.data(), std::min<std::size_t>(clouds.size(), 256));
  Mesh mesh;
  const double one_by_one = median_rate(repeats, some.size(), [&] {
    for (const Cloud& cloud : some) reconstructor.reconstruct(cloud, options, mesh);
  });
  const double at_once =
      median_rate(repeats, clouds.size(), [&] { (void)reconstructor.reconstruct_many(clouds, options); });
  std::printf("%zu clouds of %lld points, depth %d: one by one %.0f a second, at once %.0f a second\n", clouds.size(),
              static_cast<long long>(sampling.points), options.depth, one_by_one, at_once);
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return pointskin::bench::run_main("pointskin_many", argc, argv, run); }
