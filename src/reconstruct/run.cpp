#include "reconstruct/run.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <utility>

#include "core/announce.hpp"
#include "diagnose/warnings.hpp"
#include "reconstruct/coordinate_step.hpp"

namespace pointskin::detail {

using diagnose::NormalsVerdict;

namespace {

constexpr double kSolved = 0.8;  // what a solve calls the whole of its part, and where extraction begins

double flipped_share(const NormalReport& report) {
  return static_cast<double>(report.flipped) / std::max(1.0, static_cast<double>(report.given));
}

}  // namespace

Run::Run(const Engine& engine, const Options& options, RunReport& report)
    : engine_(engine), options_(options), engine_options_(options), report_(report) {
  if (options_.progress) engine_options_.progress = [this](const Progress& progress) { return tell(progress); };
}

void Run::next_part(double until) {
  from_ = until_;
  until_ = until;
}

bool Run::tell(const Progress& progress) {
  const double share = std::min(1.0, progress.fraction / kSolved);
  return options_.progress({progress.phase, from_ + share * (until_ - from_)});
}

std::shared_ptr<FieldImpl> Run::fit(const Input& input) {
  // What an earlier fit of this run reported is overwritten; what was said of normals stays.
  RunReport report;
  report.warnings = std::move(report_.warnings);
  report.normals = std::move(report_.normals);
  report.normals_done = report_.normals_done;
  report_ = std::move(report);
  std::shared_ptr<FieldImpl> field = engine_.solve(input, engine_options_, keep_all_, report_, core_);
  report_.fits = ++fits_;
  side_ = field->cube_size_world();
  if (!field->core()) return field;
  core_ = field->core();  // found but once: a fit that is told of a core looks for none
  field.reset();
  next_part(until_ + (kSolved - until_) / 2);
  return fit(input);
}

NormalsVerdict Run::judge(const FieldImpl& field) const {
  return diagnose::judge_normals(diagnose::findings_of(field.seen()),
                                 options_.boundary == Boundary::free && options_.envelope == nullptr);
}

std::shared_ptr<FieldImpl> Run::solve(const Input& input, bool keep_all) {
  keep_all_ = keep_all;
  std::shared_ptr<FieldImpl> field;
  switch (options_.point_normals) {
    case PointNormals::given: {
      field = fit(input);
      warn_of_normals(*field);
      break;
    }
    case PointNormals::automatic:
      field = fit_judged(input);
      break;
    case PointNormals::repair:
    case PointNormals::estimate: {
      until_ = 0.5;
      own_ = engine_.copy(input);
      const bool repairs = options_.point_normals == PointNormals::repair;
      if (repairs && !input.has_normals())
        throw Error(ErrorCode::no_normals, "there are no normals to repair; --normals estimate makes them");
      report_.normals = orient(own_, repairs ? NormalMethod::automatic : options_.normal_estimation.method);
      report_.normals_done = repairs ? NormalsDone::repaired : NormalsDone::estimated;
      next_part(0.8);
      field = fit_outwards(own_);
      break;
    }
  }
  diagnose::warn_of_strays(report_.strays, report_.farthest_strays, report_.warnings);
  if (options_.attributes) diagnose::warn_of_attributes(field->attributes_without_values(), report_.warnings);
  if (report_.normals)
    if (std::optional<Warning> doubts = warning_of_doubts(*report_.normals)) report_.warnings.push_back(*doubts);
  const diagnose::Findings findings = diagnose::findings_of(field->seen());
  const diagnose::Cube cube{side_, report_.depth};
  diagnose::warn_of_fit(findings, cube, report_.warnings);
  if (findings.spacing > 0) warn_of_digits(input, field->frame(), findings.spacing * cube.cell(cube.depth));
  return field;
}

/// The coordinates came with too few digits, or have too few relative to their origin.
void Run::warn_of_digits(const Input& input, const octree::Frame& frame, double spacing) {
  const double given = coordinate_step(input, frame, diagnose::kHarmlessStep * spacing);
  warn_of_coordinates(input.origin(), frame, given, spacing, report_.warnings);
}

/// Turns a cloud that is inside out, unless it is known where it was seen from: of a room, from inside.
std::shared_ptr<FieldImpl> Run::fit_outwards(const Input& input) {
  std::shared_ptr<FieldImpl> field = fit(input);
  if (judge(*field) != NormalsVerdict::inside_out) return field;
  if (report_.normals && report_.normals->method == NormalMethod::sensor) {
    warn_of_normals(*field);
    return field;
  }
  field.reset();
  next_part(until_ + (0.8 - until_) / 2);
  field = fit(input.with_normals(true));
  if (report_.normals_done == NormalsDone::kept) report_.normals_done = NormalsDone::turned;
  diagnose::warn_of_turning(report_.warnings);
  return field;
}

std::shared_ptr<FieldImpl> Run::fit_judged(const Input& input) {
  constexpr double kFirst = 0.6;  // more may have to follow
  constexpr double kParts = 0.05;
  until_ = kFirst;
  std::shared_ptr<FieldImpl> field = fit(input);
  switch (judge(*field)) {
    case NormalsVerdict::inside_out:
      field.reset();
      next_part(0.8);
      field = fit(input.with_normals(true));
      report_.normals_done = NormalsDone::turned;
      diagnose::warn_of_turning(report_.warnings);
      return field;
    case NormalsVerdict::suspicious: {
      const std::optional<double> parts = flipped_parts(input);
      if (parts && *parts >= kParts) return fit_repaired(input, std::move(field));
      if (parts)
        diagnose::warn_of_parts(*parts, report_.warnings);
      else
        warn_of_normals(*field);
      return field;
    }
    case NormalsVerdict::wrong:
      return fit_repaired(input, std::move(field));
    case NormalsVerdict::consistent:
      break;
  }
  return field;
}

/// What is left as it is. Of what is inside out an automatic trim leaves no more than what was scanned.
void Run::warn_of_normals(const FieldImpl& field) {
  const NormalsVerdict verdict = judge(field);
  if (verdict == NormalsVerdict::inside_out && options_.trim == Options::kAutomaticTrim) return;
  diagnose::warn_of_normals(diagnose::findings_of(field.seen()), verdict, report_.warnings);
}

/// The share of points whose normals are flipped: a few thousand of them tell, in a fraction of the time that all take.
/// @returns nothing if a limit leaves no memory for it
std::optional<double> Run::flipped_parts(const Input& input) try {
  constexpr std::int64_t kFew = 16384;
  Cloud few = engine_.thin(input, engine_options_, kFew);
  const NormalReport report = orient(few, NormalMethod::automatic);
  return flipped_share(report);
} catch (const Error& error) {
  if (options_.max_memory_bytes == 0 || error.code() != ErrorCode::over_limit) throw;
  return std::nullopt;
}

bool Run::may_take_normals(const Input& input) const {
  if (options_.max_memory_bytes == 0) return true;
  const std::int64_t own = input.size() * static_cast<std::int64_t>(2 * sizeof(Vec3f));  // a copy, to be changed
  const int threads = engine_.workspace().device().threads;
  const std::int64_t needed = input.cloud() != nullptr ? estimate_normals_device_bytes(*input.cloud(), threads)
                                                       : estimate_normals_device_bytes(engine_.copy(input), threads);
  return needed + own <= options_.max_memory_bytes;
}

/// The share of single samples whose normals contradict those around them, 0 where they are too few to count.
double Run::contradictions(const FieldImpl& field) {
  const diagnose::Findings findings = diagnose::findings_of(field.seen());
  return findings.has_many ? findings.flipped : 0;
}

/// Where two solids touch, samples of both face each other at one place and seem to contradict each other. Turned alike,
/// they no longer do, but then a whole sheet was turned for what looked like a few single normals. So a repair of single
/// normals is undone if it leaves more than kRepaired of the contradictions, or turns kTooMany times as many and a sheet besides.
/// @param field  of the normals as they came; stays if these cannot be repaired
std::shared_ptr<FieldImpl> Run::fit_repaired(const Input& input, std::shared_ptr<FieldImpl> field) {
  constexpr double kSingle = 0.05;  // from here on single normals are wrong, and not parts alone
  constexpr double kRepaired = 0.5;
  constexpr double kTooMany = 2, kSheet = 0.08;
  if (!may_take_normals(input)) {
    warn_of_normals(*field);
    return field;
  }
  const double before = contradictions(*field);
  field.reset();
  next_part(0.7);
  own_ = engine_.copy(input);
  report_.normals = orient(own_, NormalMethod::automatic);
  report_.normals_done = NormalsDone::repaired;
  next_part(0.75);
  field = fit_outwards(own_);
  const double turned = flipped_share(*report_.normals);
  if (before < kSingle ||
      (contradictions(*field) <= kRepaired * before && (turned <= kTooMany * before || turned <= before + kSheet))) {
    diagnose::warn_of_repair(*report_.normals, report_.warnings);
    return field;
  }
  field.reset();
  report_.normals.reset();
  report_.normals_done = NormalsDone::kept;
  next_part(0.8);
  field = fit(input);
  warn_of_normals(*field);
  return field;
}

NormalReport Run::orient(Cloud& cloud, NormalMethod method) {
  NormalOptions options = options_.normal_estimation;
  options.method = method;
  options.confidence = false;
  options.curvature = false;
  if (options_.progress)
    options.progress = [this](const Progress& progress) {
      return options_.progress({progress.phase, from_ + progress.fraction * (until_ - from_)});
    };
  engine_.release_memory();
  NormalEstimator estimator(engine_.workspace().device());  // its memory is gone before the solve
  estimator.orient(cloud, options);
  return estimator.report();
}

void Run::begin_extraction() {
  own_ = Cloud();
  announce(options_.progress, "extract", 0.8);
}

/// @param is_solid_around  which has been said
void Run::end_extraction(const FieldImpl& field, bool is_solid_around) {
  if (report_.normals)
    report_.device_peak_bytes = std::max(report_.device_peak_bytes, report_.normals->device_peak_bytes);
  if (is_solid_around) return;
  diagnose::warn_of_surface(diagnose::findings_of(field.seen()), {side_, report_.depth}, options_, report_.warnings);
}

void Run::extract(std::shared_ptr<FieldImpl> field, Mesh& mesh) {
  begin_extraction();
  const bool is_solid_around = judge(*field) == NormalsVerdict::inside_out;
  field->extract_and_release(mesh, report_);
  end_extraction(*field, is_solid_around);
}

DeviceMesh Run::extract(std::shared_ptr<FieldImpl> field) {
  begin_extraction();
  const bool is_solid_around = judge(*field) == NormalsVerdict::inside_out;
  DeviceMesh mesh = field->extract_and_release(report_);
  end_extraction(*field, is_solid_around);
  return mesh;
}

}  // namespace pointskin::detail
