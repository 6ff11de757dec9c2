#include <pointskin/edit.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

#include "c/convert.hpp"
#include "c/defaults.hpp"

using namespace pointskin;
using namespace pointskin::c;

namespace {

std::vector<Pixel> pixels_of(const double* pixels, std::int64_t count, const char* what) {
  if (count < 0 || (count > 0 && pixels == nullptr))
    throw Error(ErrorCode::usage, std::string(what) + " must be as many pixels as its count says");
  std::vector<Pixel> to(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = {pixels[2 * i], pixels[2 * i + 1]};
  return to;
}

Camera camera_of_struct(const psk_camera& from) {
  Camera to;
  std::copy(std::begin(from.view), std::end(from.view), to.view.begin());
  std::copy(std::begin(from.projection), std::end(from.projection), to.projection.begin());
  to.width = from.width;
  to.height = from.height;
  return to;
}

Area area_of(const psk_operation& from) {
  Area area;
  if (from.area_count > 0) required(from.area, "area");
  for (std::int64_t i = 0; i < from.area_count; ++i)
    area.push_back(pixels_of(from.area[i].pixels, from.area[i].count, "a polygon"));
  return area;
}

Guide guide_of(const psk_operation& from) {
  Guide to;
  to.camera = camera_of_struct(from.camera);
  to.stroke = pixels_of(from.stroke, from.stroke_count, "the stroke");
  to.area = area_of(from);
  to.interval = from.interval;
  to.normals = from.stroke_normals != 0 ? GuideNormals::stroke : GuideNormals::cloud;
  to.inside_only = from.inside_only != 0;
  return to;
}

Insert insert_of(const psk_operation& from) {
  Insert to;
  to.part = std::make_shared<const Cloud>(required(from.part, "part").cloud);
  to.lower = vector_of(from.lower);
  to.upper = vector_of(from.upper);
  to.camera = camera_of_struct(from.camera);
  to.area = area_of(from);
  to.placement.scale = from.scale;
  std::copy(std::begin(from.rotation), std::end(from.rotation), to.placement.rotation.begin());
  to.placement.translation = vector_of(from.translation);
  to.snap = from.snap != 0;
  return to;
}

Operation operation_of(const psk_operation* given) {
  const psk_operation from = known(&required(given, "operation"));
  switch (from.kind) {
    case PSK_GUIDE:
      return guide_of(from);
    case PSK_REMOVE:
      return Remove{camera_of_struct(from.camera), area_of(from), from.originals != 0, from.front_layer != 0};
    case PSK_INSERT:
      return insert_of(from);
    case PSK_FLIP:
      return Flip{camera_of_struct(from.camera), area_of(from), from.front_layer != 0};
    default:
      throw Error(ErrorCode::usage, "kind must be in [0, 3], not " + std::to_string(from.kind));
  }
}

psk_step_report step_of(const StepReport& from) {
  auto to = defaults<psk_step_report>();
  to.added = from.added;
  to.removed = from.removed;
  to.flipped = from.flipped;
  to.points = from.points;
  to.triangles = from.triangles;
  to.components_before = from.before.components;
  to.genus_before = from.before.genus;
  to.euler_before = from.before.euler;
  to.components_after = from.after.components;
  to.genus_after = from.after.genus;
  to.euler_after = from.after.euler;
  to.edit_ms = from.edit_ms;
  to.reconstruct_ms = from.reconstruct_ms;
  to.total_ms = from.total_ms;
  to.snapped = from.snapped ? 1 : 0;
  to.warm = from.warm ? 1 : 0;
  return to;
}

EditOptions edit_options_of(const psk_edit_options* given) {
  const psk_edit_options from = known(given);
  EditOptions to;
  to.reconstruction = options_of(from.reconstruction);
  to.topology = from.topology != 0;
  to.warm_start = from.warm_start != 0;
  to.continued = from.continued != 0;
  to.keep_attributes = from.keep_attributes != 0;
  to.states_kept = from.states_kept;
  to.undo_bytes = from.undo_bytes;
  return to;
}

}  // namespace

psk_code psk_edit_create(psk_workspace* workspace, const psk_cloud* base, const psk_edit_options* options,
                         psk_edit** edit, psk_error* error) {
  return guarded(error, [&] {
    required(edit, "edit") = new psk_edit{EditSession(required(base, "base").cloud, edit_options_of(options),
                                                      required(workspace, "workspace").workspace)};
  });
}

void psk_edit_free(psk_edit* edit) { delete edit; }

psk_code psk_edit_apply(psk_edit* edit, const psk_operation* operation, psk_step_report* report, psk_error* error) {
  return guarded(error, [&] { give(step_of(required(edit, "edit").session.apply(operation_of(operation))), report); });
}

psk_code psk_edit_preview(const psk_edit* edit, const psk_operation* operation, psk_cloud** added, psk_cloud** removed,
                          psk_error* error) {
  return guarded(error, [&] {
    EditPreview preview = required(edit, "edit").session.preview(operation_of(operation));
    required(added, "added");
    required(removed, "removed");
    std::unique_ptr<psk_cloud> first(new_cloud(std::move(preview.added)));
    *removed = new_cloud(std::move(preview.removed));
    *added = first.release();
  });
}

psk_code psk_edit_undo(psk_edit* edit, int32_t* done, psk_error* error) {
  return guarded(error, [&] {
    const bool was = required(edit, "edit").session.undo();
    if (done != nullptr) *done = was ? 1 : 0;
  });
}

psk_code psk_edit_redo(psk_edit* edit, int32_t* done, psk_error* error) {
  return guarded(error, [&] {
    const bool was = required(edit, "edit").session.redo();
    if (done != nullptr) *done = was ? 1 : 0;
  });
}

psk_code psk_edit_mesh(const psk_edit* edit, psk_mesh** mesh, psk_error* error) {
  return guarded(error, [&] { required(mesh, "mesh") = new_mesh(required(edit, "edit").session.mesh()); });
}

psk_code psk_edit_cloud(const psk_edit* edit, psk_cloud** cloud, psk_error* error) {
  return guarded(error, [&] { required(cloud, "cloud") = new_cloud(required(edit, "edit").session.cloud()); });
}
