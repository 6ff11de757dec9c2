#include "bench/clouds.hpp"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "args.hpp"
#include "console.hpp"
#include "input.hpp"
#include "shapes.hpp"

namespace pointskin::cli {
namespace {

/// A row of table I of Zhou et al. 2010, and the shape that stands in for its scan.
struct PaperRow {
  const char* name;
  const char* shape;
  std::int64_t points;
  int depth;
};
constexpr std::array kPaperRows = {PaperRow{"Bunny", "knot", 353272, 8},     PaperRow{"Buddha", "knot", 640735, 8},
                                   PaperRow{"Armadillo", "knot", 512802, 8}, PaperRow{"Elephant", "plate", 216643, 8},
                                   PaperRow{"Hand", "plate", 259560, 8},     PaperRow{"Dragon", "plate", 1565886, 9}};

constexpr double kMostPoints = 1e9;

CloudSource parse_generate(const std::string& text, const std::vector<int>& depths) {
  const std::size_t colon = text.find(':');
  const std::string shape = text.substr(0, colon);
  const double points = colon == std::string::npos ? 0 : parse_number(text.substr(colon + 1)).value_or(0);
  const auto is_shape = [&](const char* name) { return shape == name; };
  if (std::none_of(bench::kShapeNames.begin(), bench::kShapeNames.end(), is_shape) || !(points >= 1) ||
      points > kMostPoints) {
    throw_usage(
        fmt::format("--generate: '{}' is not SHAPE:N, where SHAPE is one of {} and N a number of "
                    "points up to 1e9",
                    text, fmt::join(bench::kShapeNames, ", ")));
  }
  return {text, "", shape, static_cast<std::int64_t>(points), depths};
}

std::vector<CloudSource> paper_sources(const std::vector<int>& depths) {
  std::vector<CloudSource> sources;
  for (const PaperRow& row : kPaperRows) {
    sources.push_back({fmt::format("{} ({})", row.name, row.shape), "", row.shape, row.points,
                       depths.empty() ? std::vector{row.depth} : depths});
  }
  return sources;
}

/// The file's name alone, where that tells it from the other inputs.
std::string short_path(const std::string& path, const std::vector<std::string>& inputs) {
  const auto name_of = [](const std::string& any) { return std::filesystem::path(any).filename(); };
  const auto same = [&](const std::string& other) { return name_of(other) == name_of(path); };
  return one_line(std::count_if(inputs.begin(), inputs.end(), same) > 1 ? path : name_of(path).string());
}

}  // namespace

std::vector<CloudSource> cloud_sources(const BenchArgs& args) {
  std::vector<int> depths = args.depths.empty() ? std::vector<int>{} : parse_depths(args.depths);
  if (args.inputs.empty() && args.generate.empty()) return paper_sources(depths);
  if (depths.empty()) depths = {8, 9, 10};
  std::vector<CloudSource> sources;
  for (const std::string& path : args.inputs) {
    if (path == "-") throw_usage("stdin (-) cannot be measured again and again; name a file");
    sources.push_back({short_path(path, args.inputs), path, "", 0, depths});
  }
  for (const std::string& text : args.generate) sources.push_back(parse_generate(text, depths));
  return sources;
}

Cloud load(const CloudSource& source, int threads) {
  if (source.path.empty()) {
    return bench::sample_surface(*bench::make_shape(source.shape), {.points = source.shape_points, .threads = threads});
  }
  Cloud cloud = read_clouds({source.path}, {.shift = std::nullopt, .threads = threads});
  scene::drop_zero_normals(cloud);
  return cloud;
}

}  // namespace pointskin::cli
