#include <pointskin/camera.hpp>
#include <pointskin/render.hpp>

#include <algorithm>
#include <cstdint>

#include "c/convert.hpp"
#include "c/defaults.hpp"

using namespace pointskin;
using namespace pointskin::c;

psk_code psk_render(const psk_mesh* mesh, const psk_cloud* cloud, const psk_render_options* options, psk_image** image,
                    psk_render_report* report, psk_error* error) {
  return guarded(error, [&] {
    const MeshOrCloud what(mesh, cloud, "what is drawn");
    RenderReport from;
    Image drawn = what.visit([&](const auto& it) { return render(it, render_options_of(options), &from); });
    auto to = defaults<psk_render_report>();
    to.covered = from.covered;
    to.behind = from.behind;
    to.has_range = from.range ? 1 : 0;
    to.low = from.range ? from.range->low : 0;
    to.high = from.range ? from.range->high : 0;
    to.point_size_world = from.point_size_world;
    to.strays = from.strays;
    give(to, report);
    required(image, "image") = new psk_image{std::move(drawn), {}};
  });
}

void psk_image_free(psk_image* image) { delete image; }

psk_array psk_image_pixels(const psk_image* image, int32_t* width, int32_t* height) {
  if (width != nullptr) *width = image == nullptr ? 0 : image->image.width;
  if (height != nullptr) *height = image == nullptr ? 0 : image->image.height;
  psk_array pixels{};
  if (image == nullptr) return pixels;
  pixels.data = image->image.rgb.data();
  pixels.rows = static_cast<std::int64_t>(image->image.rgb.size() / 3);
  pixels.row_stride = 3;
  pixels.component_stride = 1;
  pixels.components = 3;
  pixels.type = PSK_UINT8;
  return pixels;
}

psk_code psk_image_write_png(const psk_image* image, const char* path, psk_error* error) {
  return guarded(error, [&] { write_png(&required(path, "path"), required(image, "image").image); });
}

psk_code psk_image_png(psk_image* image, const uint8_t** bytes, int64_t* count, psk_error* error) {
  return guarded(error, [&] {
    psk_image& from = required(image, "image");
    if (from.png.empty()) from.png = png_of(from.image);
    required(bytes, "bytes") = reinterpret_cast<const std::uint8_t*>(from.png.data());
    required(count, "count") = static_cast<std::int64_t>(from.png.size());
  });
}

psk_code psk_camera_of(const psk_mesh* mesh, const psk_cloud* cloud, const psk_render_options* options,
                       psk_camera* camera, psk_error* error) {
  return guarded(error, [&] {
    const MeshOrCloud what(mesh, cloud, "what is seen");
    const Camera from = what.visit([&](const auto& it) { return camera_of(it, render_options_of(options)); });
    psk_camera& to = required(camera, "camera");
    std::copy(from.view.begin(), from.view.end(), to.view);
    std::copy(from.projection.begin(), from.projection.end(), to.projection);
    to.width = from.width;
    to.height = from.height;
  });
}
