#include "measures.hpp"

#include <algorithm>
#include <utility>

#include <pointskin/error.hpp>
#include <pointskin/problems.hpp>
#include <pointskin/reconstruct.hpp>

#include "scene/options.hpp"
#include "scene/vector_json.hpp"

namespace pointskin::studio {
namespace {

ComparedSurface surface_of(const scene::Solid& solid) {
  if (const auto* mesh = std::get_if<Mesh>(&solid)) return *mesh;
  return std::get<Cloud>(solid);
}

std::vector<float> to_floats(const std::vector<double>& values) { return {values.begin(), values.end()}; }

const Attribute* find(const Mesh& mesh, const std::string& name) {
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.name == name) return &attribute;
  return nullptr;
}

std::vector<float> floats_of(const AttributeValues& values) {
  std::vector<float> floats(values.size());
  for (std::size_t i = 0; i < floats.size(); ++i) floats[i] = static_cast<float>(values.at(i));
  return floats;
}

}  // namespace

Mesh Measures::reconstructed(Options options) const {
  options.depth = desk_.shown_depth();
  options.point_normals = PointNormals::given;
  options.keep_strays = true;
  ProgressTeller progress(services_, "measure");
  options.progress = [&progress](const Progress& now) { return progress(now); };
  Reconstructor reconstructor(services_.workspace);
  return reconstructor.reconstruct(desk_.present().cloud(), options);
}

const Mesh& Measures::annotated() {
  if (annotated_state_ == desk_.state_number()) return annotated_;
  Options options = desk_.present().options();
  options.density = true;
  options.weakness = options.field == FieldKind::poisson;
  options.trim = 0;
  annotated_ = reconstructed(options);
  annotated_state_ = desk_.state_number();
  return annotated_;
}

void Measures::show(const Mesh& mesh, wire::Values values) {
  MeshFacts facts;
  facts.depth = desk_.shown_depth();
  facts.full_triangles = static_cast<std::int64_t>(desk_.present().mesh().triangles.size());
  facts.values.push_back(std::move(values));
  teller_.show(mesh, facts);
}

Json Measures::problems() {
  const Mesh& mesh = annotated();
  if (find(mesh, "weakness") == nullptr)
    throw Error(ErrorCode::usage, "problems are found in surfaces of the field poisson alone");
  return {{"regions", problems_json(find_problems(mesh, {.threads = services_.device.threads}))}};
}

Json Measures::compare(const scene::SolidSource& reference, const std::string& name) {
  const Mesh& mesh = desk_.present().mesh();
  const std::shared_ptr<const scene::Solid> solid = sources_.solid(reference);
  const ComparedSurface other = surface_of(*solid);
  const int threads = services_.device.threads;
  constexpr std::int64_t kSamples = 200'000;
  const CompareOptions options{.samples = kSamples, .threads = threads};
  const MeshComparison comparison = pointskin::compare(mesh, other, options);
  show(desk_.shown(), {"distance", to_floats(distances(desk_.shown(), other, {.threads = threads}))});
  Json table = comparison_json(comparison);
  table["reference"] = name;
  table["tau"] = options.tau;
  return table;
}

Json Measures::values(const std::string& name) {
  if (name == "distance") {
    const Mesh& mesh = desk_.shown();
    const Cloud cloud = desk_.present().cloud();
    show(mesh, {name, to_floats(distances(mesh, cloud, {.threads = services_.device.threads}))});
    return Json::object();
  }
  if (name == "density" || name == "weakness") {
    const Attribute* values = find(annotated(), name);
    if (values == nullptr) throw Error(ErrorCode::usage, "the surface has no " + name);
    show(annotated(), {name, floats_of(values->values)});
    return Json::object();
  }
  Options options = desk_.present().options();
  options.attributes = true;
  const Mesh mesh = reconstructed(options);
  const Attribute* values = find(mesh, name);
  if (values == nullptr) throw Error(ErrorCode::usage, "the points have no number '" + name + "'");
  show(mesh, {name, floats_of(values->values)});
  return Json::object();
}

Json Measures::histogram() { return density_histogram(annotated(), desk_.present().cloud()); }

Json Measures::estimate(const nlohmann::json& patch) {
  const Cloud cloud = desk_.present().cloud();
  const int threads = services_.device.threads;
  if (learned_state_ != desk_.state_number()) {
    times_.learn(estimate_device_bytes(cloud, desk_.present().options(), threads), desk_.last_ms());
    learned_state_ = desk_.state_number();
  }
  const Options options = scene::read_options({patch, "options"}, desk_.present().options());
  return estimate_json(cloud, options, times_, threads, [this] { return services_.queue.should_stop(); });
}

Json Measures::pick(const Vec3d& origin, const Vec3d& direction) const {
  const auto hit = first_hit(desk_.present().mesh(), origin, direction);
  if (!hit) return {{"point", nullptr}};
  return {{"point", hit->point}, {"normal", hit->normal}, {"distance", hit->distance}};
}

}  // namespace pointskin::studio
