// One run of a Reconstructor: what is done about the points' normals, the solve, and what is said of both.
#pragma once

#include <pointskin/reconstruct.hpp>

#include <memory>
#include <optional>

#include "diagnose/verdict.hpp"
#include "reconstruct/engine.hpp"

namespace pointskin::detail {

/// Solves with the normals that Options::point_normals asks for, and writes warnings into the report. What a run finds
/// out about normals it finds out from the field: a second solve follows where they have to be others.
class Run {
 public:
  /// @param options  with a depth that is settled
  /// @param report   of the run; empty but for what was said before
  Run(const Engine& engine, const Options& options, RunReport& report);

  /// @param keep_all  FitSetup::keep_all: for a Field, that is extracted later
  /// @throws Error as Reconstructor::solve
  std::shared_ptr<FieldImpl> solve(const Input& input, bool keep_all);

  /// The mesh of that field, which is gone then.
  /// @throws Error as Field::extract
  void extract(std::shared_ptr<FieldImpl> field, Mesh& mesh);
  /// The same, where the field is.
  DeviceMesh extract(std::shared_ptr<FieldImpl> field);

 private:
  /// The part of the whole run that comes next. Options::progress sees no fraction twice.
  void next_part(double until);
  bool tell(const Progress& progress);

  std::shared_ptr<FieldImpl> fit(const Input& input);
  std::shared_ptr<FieldImpl> fit_outwards(const Input& input);
  std::shared_ptr<FieldImpl> fit_judged(const Input& input);
  std::shared_ptr<FieldImpl> fit_repaired(const Input& input, std::shared_ptr<FieldImpl> field);
  void begin_extraction();
  void end_extraction(const FieldImpl& field, bool is_solid_around);
  void warn_of_normals(const FieldImpl& field);
  void warn_of_digits(const Input& input, const octree::Frame& frame, double spacing);
  NormalReport orient(Cloud& cloud, NormalMethod method);
  [[nodiscard]] std::optional<double> flipped_parts(const Input& input);
  [[nodiscard]] bool may_take_normals(const Input& input) const;
  [[nodiscard]] static double contradictions(const FieldImpl& field);
  [[nodiscard]] diagnose::NormalsVerdict judge(const FieldImpl& field) const;

  const Engine& engine_;
  const Options& options_;  // the caller's
  Options engine_options_;  // these, with a progress of the part that runs
  RunReport& report_;
  double from_ = 0, until_ = 0.8;
  double side_ = 0;             // of the working cube
  std::optional<Bounds> core_;  // FitSetup::core
  Cloud own_;                   // with normals that are not the caller's; or empty
  bool keep_all_ = false;
  int fits_ = 0;
};

}  // namespace pointskin::detail
