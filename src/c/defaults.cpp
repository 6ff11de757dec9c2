#include "c/defaults.hpp"

#include <pointskin/pointskin.hpp>

#include <algorithm>

namespace pointskin::c {
namespace {

template <class Enum>
int number(Enum value) {
  return static_cast<int>(value);
}

void set_defaults_of_solve(const SolveOptions& from, psk_options& to) {
  to.screening = from.screening;
  to.scale = from.scale;
  to.samples_per_node = from.samples_per_node;
  to.offset = from.offset;
  to.depth = from.depth;
  to.point_normals = number(from.point_normals);
  to.field = number(from.field);
  to.fixed_screening = from.fixed_screening;
  to.iterations = from.iterations;
  to.confidence = from.confidence;
  to.boundary = number(from.boundary);
  to.keep_strays = from.keep_strays;
}

void set_defaults_of_extract(const ExtractOptions& from, psk_options& to) {
  to.trim = from.trim;
  to.island_ratio = from.island_ratio;
  to.min_component = from.min_component;
  to.normals = from.normals;
  to.linear_fit = from.linear_fit;
  to.domain_faces = number(from.domain_faces);
  to.largest = from.largest;
  to.density = from.density;
  to.weakness = from.weakness;
  to.attributes = from.attributes;
}

}  // namespace

void set_defaults(psk_options& options) {
  const Options from;
  set_defaults_of_solve(from, options);
  set_defaults_of_extract(from, options);
  options.max_memory_bytes = from.max_memory_bytes;
  options.residuals = from.residuals;
}

void set_defaults(psk_normal_options& options) {
  const NormalOptions from;
  options.seed = from.seed;
  options.time_limit_s = from.time_limit_s;
  options.keep_within_degrees = from.keep_within_degrees;
  options.method = number(from.method);
  options.random_start = from.random_start;
  options.max_rounds = from.max_rounds;
  options.confidence = from.confidence;
  options.curvature = from.curvature;
}

void set_defaults(psk_read_options& options) { options.threads = ReadOptions{}.threads; }

void set_defaults(psk_write_options& options) {
  options.ascii = WriteOptions{}.ascii;
  options.double_coordinates = WriteOptions{}.double_coordinates;
  options.compress = WriteOptions{}.compress;
  options.threads = WriteOptions{}.threads;
}

void set_defaults(psk_compare_options& options) {
  const CompareOptions from;
  options.samples = from.samples;
  options.tau = from.tau;
  options.threads = from.threads;
}

void set_defaults(psk_render_options& options) {
  const RenderOptions from;
  options.azimuth_degrees = from.azimuth_degrees;
  options.elevation_degrees = from.elevation_degrees;
  options.zoom = from.zoom;
  options.point_size = from.point_size;
  options.point_size_world = from.point_size_world;
  options.width = from.width;
  options.height = from.height;
  options.up = number(from.up);
  options.orthographic = from.projection == Projection::orthographic;
  options.fit_sphere = from.fit == Fit::sphere;
  options.smooth = from.smooth;
  options.back_faces = from.back_faces;
  options.colours = from.colours;
  options.shadows = from.shadows;
  options.wireframe = from.wireframe;
  options.colour_map = number(from.colour_map);
  options.colour_bar = from.colour_bar;
  options.threads = from.threads;
}

void set_defaults(psk_problem_options& options) {
  const ProblemOptions from;
  options.threshold = from.threshold;
  options.least_area = from.least_area;
  options.up = number(from.up);
  options.threads = from.threads;
}

void set_defaults(psk_edit_options& options) {
  const EditOptions from;
  options.undo_bytes = from.undo_bytes;
  options.topology = from.topology;
  options.warm_start = from.warm_start;
  options.continued = from.continued;
  options.keep_attributes = from.keep_attributes;
  options.states_kept = from.states_kept;
}

void set_defaults(psk_operation& operation) {
  const Insert insert;
  const Camera camera;
  std::copy(camera.view.begin(), camera.view.end(), operation.camera.view);
  std::copy(camera.projection.begin(), camera.projection.end(), operation.camera.projection);
  operation.camera.width = camera.width;
  operation.camera.height = camera.height;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    operation.lower[axis] = insert.lower[axis];
    operation.upper[axis] = insert.upper[axis];
  }
  operation.scale = insert.placement.scale;
  std::copy(insert.placement.rotation.begin(), insert.placement.rotation.end(), operation.rotation);
  operation.inside_only = Guide{}.inside_only;
}

void set_defaults(psk_handle& handle) {
  const AffineMap map;
  handle.radius = Ball{}.radius;
  handle.b[2] = HalfSpace{}.normal.z;
  handle.axis[2] = RigidMotion{}.axis.z;
  std::copy(map.matrix.begin(), map.matrix.end(), handle.matrix);
}

void set_defaults(psk_lattice& lattice) {
  const Lattice from;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    for (std::size_t axis = 0; axis < 3; ++axis) lattice.axes[3 * edge + axis] = from.axes[edge][axis];
    lattice.spans[edge] = from.spans[edge];
  }
  lattice.stay = from.outside == Lattice::Outside::stay;
}

void set_defaults(psk_boolean_options& options) {
  const BooleanOptions from;
  options.coincidence_cells = from.coincidence_cells;
  options.creases = from.creases == Creases::sampled;
}

void set_defaults(psk_fluid_options& options) {
  const FluidOptions from;
  options.particle_radius = from.particle_radius;
  options.smoothing_length = from.smoothing_length;
  options.cube_size = from.cube_size;
  options.surface_threshold = from.surface_threshold;
  options.min_component = from.min_component;
  options.kernel = number(from.kernel);
  options.smoothing_iterations = from.smoothing_iterations;
  options.smoothing_weights = from.smoothing_weights;
  options.normals = from.normals;
  options.attributes = from.attributes;
}

void set_defaults(psk_scale_options& options) {
  const ScaleOptions from;
  options.max_memory_bytes = from.max_memory_bytes;
  options.threads = from.threads;
}

}  // namespace pointskin::c

size_t psk_struct_size(int32_t kind) {
  size_t size = 0;
  pointskin::c::visit_struct(kind, [&](auto tag) { size = sizeof(tag); });
  return size;
}

psk_code psk_init(int32_t kind, void* target, size_t bytes, psk_error* error) {
  using namespace pointskin::c;
  return guarded(error, [&] {
    if (target == nullptr) throw pointskin::Error(pointskin::ErrorCode::usage, "target must not be null");
    if (bytes < sizeof(size_t)) throw pointskin::Error(pointskin::ErrorCode::usage, "a struct begins with its size");
    const bool is_known = visit_struct(kind, [&](auto tag) {
      const auto value = defaults<decltype(tag)>();
      std::memset(target, 0, bytes);
      std::memcpy(target, &value, std::min(bytes, sizeof(value)));
      std::memcpy(target, &bytes, sizeof(bytes));
    });
    if (!is_known) throw pointskin::Error(pointskin::ErrorCode::usage, "there is no struct of that kind");
  });
}
