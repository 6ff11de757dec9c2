// Project, find what every sample of a band of rows sees, shade it, average to pixels. A first pass with one sample a
// pixel gives the depth from which light in hollows, and normals that points lack, follow.
#include "render/picture.hpp"
#include "core/vec3.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "render/band_lists.hpp"
#include "render/cell_values.hpp"
#include "render/depth_map.hpp"
#include "render/picture_scale.hpp"
#include "render/shading.hpp"

namespace pointskin::render_detail {
namespace {

/// How far hollows are looked for, pixels at scale 1.
constexpr double kHollow = 150;
constexpr std::int64_t kMostCells = std::int64_t{1} << 19;

/// The colour of a mesh's edges.
Colour edge_colour() { return from_srgb(0.10, 0.12, 0.15); }

/// Samples of a band.
struct Shares {
  std::int64_t covered = 0, behind = 0;
};

struct PixelPlace {
  std::int32_t column, row;
};

/// The samples of a pixel that see the same part: they are shaded once, in their middle.
struct PixelPart {
  std::int32_t id;
  std::int32_t samples;
  std::int64_t x, y;  ///< sums of places
  float nearness;     ///< of one of them
};

struct PixelParts {
  PixelPart parts[SampleGrid::kSamples] = {};
  int count = 0, covered = 0;

  PixelParts(const Band& band, const SampleGrid& grid, std::int32_t column, std::int32_t row) {
    for (std::int32_t s = 0; s < SampleGrid::kSamples; ++s) {
      const std::int32_t sample_row = row * SampleGrid::kSamples + s;
      const std::size_t sample = band.index(column, sample_row);
      if (band.ids[sample] < 0) continue;
      ++covered;
      add({band.ids[sample], 1, grid.x_of(column, sample_row), grid.y_of(sample_row), band.nearness[sample]});
    }
  }

 private:
  void add(const PixelPart& more) {
    for (int k = 0; k < count; ++k) {
      if (parts[k].id != more.id) continue;
      ++parts[k].samples;
      parts[k].x += more.x;
      parts[k].y += more.y;
      return;
    }
    parts[count++] = more;
  }
};

class Painter {
 public:
  Painter(exec::Cpu& ex, const Drawing& drawing, const Camera& camera, const RenderOptions& options,
          const DepthLight& light)
      : drawing_(drawing),
        options_(options),
        grid_(SampleGrid::picture(camera.step_bits())),
        lighting_{camera.up_in_view(), light.even},
        lists_(ex, drawing, options.height, camera.step_bits()),
        map_(ex, drawing, lists_, camera, {options.width, options.height, kMostCells}) {
    if (options.shadows || !drawing.knows_normals()) normals_ = normals_of(ex, map_, light.normal_reach);
    const double cells = kHollow * picture_scale(options) / (1 << map_.cell_bits());
    if (options.shadows) open_ = openness_of(ex, map_, normals_, static_cast<float>(cells));
    if (light.shadows) key_ = key_light_of(ex, map_, normals_, *light.shadows);
  }

  Shares draw(exec::Cpu& ex, Image& image) const {
    std::vector<Shares> shares(static_cast<std::size_t>(lists_.bands()));
    ex.run_blocks(lists_.bands(), [&](std::int64_t b) {
      const auto first = static_cast<std::int32_t>(b) * kBandPixels;
      const std::int32_t pixels = std::min(kBandPixels, options_.height - first);
      Band band(grid_, options_.width, first * grid_.rows_per_cell(), pixels * grid_.rows_per_cell());
      for (const std::int32_t id : lists_.parts(b)) drawing_.draw(id, band);
      Shares sum;
      for (std::int32_t row = first; row < first + pixels; ++row) resolve(band, row, image, sum);
      shares[static_cast<std::size_t>(b)] = sum;
    });
    Shares all;
    for (const Shares& part : shares) all = {all.covered + part.covered, all.behind + part.behind};
    return all;
  }

 private:
  /// Averages the samples of pixel row `row`.
  void resolve(const Band& band, std::int32_t row, Image& image, Shares& shares) const {
    const Colour behind_all = background(1 - (row + 0.5) / options_.height);
    const std::array<std::uint8_t, 3> empty = background_bytes(behind_all, row);
    std::uint8_t* out =
        image.rgb.data() + std::size_t{3} * static_cast<std::size_t>(row) * static_cast<std::size_t>(options_.width);
    for (std::int32_t column = 0; column < options_.width; ++column, out += 3) {
      const PixelParts parts(band, grid_, column, row);
      const std::array<std::uint8_t, 3> rgb =
          parts.covered == 0 ? empty : encoded(colour_of(parts, {column, row}, behind_all, shares));
      std::copy(rgb.begin(), rgb.end(), out);
    }
  }

  /// Rows round at four places in turn, so that the tones of the background pass into each other without bands.
  [[nodiscard]] static std::array<std::uint8_t, 3> background_bytes(const Colour& colour, std::int32_t row) {
    constexpr std::array<double, 4> kRound = {0.125, 0.625, 0.375, 0.875};
    std::array<std::uint8_t, 3> bytes{};
    for (std::size_t k = 0; k < 3; ++k)
      bytes[k] = static_cast<std::uint8_t>(255 * encode_srgb(colour[k]) + kRound[static_cast<std::size_t>(row) & 3U]);
    return bytes;
  }

  [[nodiscard]] std::array<std::uint8_t, 3> encoded(const Colour& colour) const {
    return {encode_(colour[0]), encode_(colour[1]), encode_(colour[2])};
  }

  [[nodiscard]] Colour colour_of(const PixelParts& parts, const PixelPlace& pixel, const Colour& background,
                                 Shares& shares) const {
    Colour sum = (SampleGrid::kSamples - parts.covered) * background;
    for (int k = 0; k < parts.count; ++k) sum += colour_of(parts.parts[k], pixel, shares);
    return 1.0 / SampleGrid::kSamples * sum;
  }

  /// Times the number of its samples.
  [[nodiscard]] Colour colour_of(const PixelPart& part, const PixelPlace& pixel, Shares& shares) const {
    const Seen seen = drawing_.seen(part.id, part.x / part.samples, part.y / part.samples);
    shares.covered += part.samples;
    shares.behind += seen.front ? 0 : part.samples;
    const CellBlend cells(map_, pixel.column, pixel.row, part.nearness);
    const Light light{open_.empty() ? 1.0 : static_cast<double>(cells.of(open_, 1.0F)),
                      key_.empty() ? 1.0 : static_cast<double>(cells.of(key_, 1.0F))};
    const Colour lit = shade(seen.albedo, normal_of(seen, cells), light, lighting_);
    return part.samples * (seen.line > 0 ? mix(lit, edge_, seen.line) : lit);
  }

  [[nodiscard]] Vec3d normal_of(const Seen& seen, const CellBlend& cells) const {
    if (seen.relief >= 1 || normals_.empty()) return seen.normal;
    const Vec3f smooth = cells.of(normals_, Vec3f{0, 0, 1});
    return normalized(seen.relief * seen.normal + (1 - seen.relief) * Vec3d{smooth.x, smooth.y, smooth.z});
  }

  const Drawing& drawing_;
  const RenderOptions& options_;
  SampleGrid grid_;
  Lighting lighting_;
  BandLists lists_;
  DepthMap map_;
  std::vector<Vec3f> normals_;  // of the map; empty: not needed
  CellFloats open_, key_;       // of the map; empty: 1
  Colour edge_ = edge_colour();
  SrgbEncoder encode_;
};

}  // namespace

Image draw_picture(exec::Cpu& ex, const Drawing& drawing, const Camera& camera, const RenderOptions& options,
                   const DepthLight& light, RenderReport& report) {
  Image image{options.width, options.height, {}};
  image.rgb.resize(std::size_t{3} * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
  const Shares shares = Painter(ex, drawing, camera, options, light).draw(ex, image);
  const double samples = SampleGrid::kSamples * static_cast<double>(options.width) * options.height;
  report.covered = static_cast<double>(shares.covered) / samples;
  report.behind = shares.covered > 0 ? static_cast<double>(shares.behind) / static_cast<double>(shares.covered) : 0;
  return image;
}

}  // namespace pointskin::render_detail
