#include "unused_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <pointskin/formats.hpp>

#include "console.hpp"
#include "input.hpp"

namespace pointskin::cli {
namespace {

double length_of(const Vec3f& v) { return std::hypot(double{v.x}, double{v.y}, double{v.z}); }

/// True if no normal is longer than another but for rounding.
bool are_alike(const std::vector<Vec3f>& normals) {
  constexpr double kRounding = 1e-5;
  if (normals.empty()) return true;
  const double first = length_of(normals.front());
  return std::all_of(normals.begin(), normals.end(),
                     [first](const Vec3f& n) { return std::abs(length_of(n) - first) <= kRounding * first; });
}

void warn_about_format(const GivenOptions& given, const std::string& output, bool reports) {
  const FormatInfo* const format = format_of(output);
  if (format == nullptr || format->attributes == HeldAttributes::all) return;
  const bool none = format->attributes == HeldAttributes::none;
  const std::string why =
      fmt::format("in {} files, which hold {}", format->name, none ? "no properties" : "colours alone");
  warn_unused(given, {"--density"}, why);
  if (!reports) warn_unused(given, {"--weakness"}, why);
  if (none) warn_unused(given, {"--keep-attributes", "--colors", "--data"}, why);
}

}  // namespace

void warn_unused(const GivenOptions& given, std::initializer_list<const char*> options, const std::string& why) {
  for (const char* const option : options)
    if (given.has(option)) print_warning(fmt::format("{} has no effect {}", option, why));
}

void warn_about_unused(const GivenOptions& given, const Options& options, const std::string& output, bool reports) {
  if (options.field == FieldKind::distance) warn_unused(given, {"--cold"}, "with --field distance");
  if (options.screening == 0) warn_unused(given, {"--fixed-screening"}, "with --screening 0");
  if (options.boundary == Boundary::dirichlet) warn_unused(given, {"--open"}, "with --boundary dirichlet");
  if (options.trim == 0) warn_unused(given, {"--island-ratio"}, "without --trim");
  warn_about_format(given, output, reports);
}

void warn_about_ascii(const GivenOptions& given, const std::string& output) {
  const FormatInfo* const format = format_of(output);
  if (format == nullptr || format->coding == NumberCoding::either) return;
  const char* const how = format->coding == NumberCoding::text ? "are text always" : "are written as binary ones";
  warn_unused(given, {"--ascii"}, fmt::format("in {} files, which {}", format->name, how));
}

void warn_about_unused_normals(const GivenOptions& given) {
  warn_unused(given, {"--sensor", "--keep-within", "--max-rounds", "--time-limit", "--random-start", "--seed"},
              "without --estimate-normals");
}

void warn_about_unused_normals(const GivenOptions& given, NormalMethod used) {
  const std::string why = fmt::format("on normals by {}", name_of(used));
  if (used != NormalMethod::sensor) warn_unused(given, {"--sensor"}, why);
  if (used != NormalMethod::repair) warn_unused(given, {"--keep-within"}, why);
  if (used != NormalMethod::iterate)
    warn_unused(given, {"--random-start", "--seed"}, why);
  else if (!given.has("--random-start"))
    warn_unused(given, {"--seed"}, "without --random-start");
}

void warn_about_unused(const GivenOptions& given, const Options& options, const Cloud& cloud,
                       const std::string& output) {
  if (options.confidence && are_alike(cloud.normals))
    print_warning("--confidence means nothing here: all normals have the same length");
  if (!options.attributes) return;
  if (cloud.attributes.empty())
    return warn_unused(given, {"--keep-attributes", "--data"}, "on points without further properties");
  const FormatInfo* const format = format_of(output);
  if (format == nullptr || format->attributes != HeldAttributes::colours) return;
  std::string lost;
  for (const Attribute& attribute : cloud.attributes)
    if (!is_colour(attribute)) lost += (lost.empty() ? "" : ", ") + attribute.name;
  if (!lost.empty()) print_warning(fmt::format("{} files hold colours alone: {} is left out", format->name, lost));
}

std::int64_t count_outside_box(const Cloud& cloud, const Mesh& mesh) {
  const Bounds box = bounds_of(mesh.vertices);
  const std::array<float, 3> lower = {box.lower.x, box.lower.y, box.lower.z};
  const std::array<float, 3> upper = {box.upper.x, box.upper.y, box.upper.z};
  return std::count_if(cloud.positions.begin(), cloud.positions.end(), [&](const Vec3f& p) {
    const std::array<float, 3> at = {p.x, p.y, p.z};
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = cloud.origin[a] + at[a] - mesh.origin[a];
      if (x < lower[a] || x > upper[a]) return true;
    }
    return false;
  });
}

void warn_about_envelope(const EnvelopeReport& envelope, std::int64_t points) {
  if (2 * envelope.samples_outside <= points) return;
  print_warning(fmt::format("{} of {} points lie outside of --envelope; is it the mesh for these points?",
                            envelope.samples_outside, points));
}

}  // namespace pointskin::cli
