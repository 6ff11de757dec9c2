#include "boolean_args.hpp"

#include <fmt/format.h>

#include "args.hpp"

namespace pointskin::cli {
namespace {

OptionGroup file_options(BooleanArgs& args) {
  return {"Files",
          {output_row(args.output, {.required = true}),
           option("--cloud FILE", "also write the oriented points of the result, as PLY", &args.cloud, {},
                  {.check = needs_a_name}),
           report_row(args.report), overwrite_row(args.overwrite), shift_row(args.shift)}};
}

OptionGroup crease_options(BooleanArgs& args) {
  BooleanOptions& o = args.booleans;
  return {
      kSurfaceGroup,
      {option("--creases C", "where surfaces cross: sampled, or none",
              one_of<Creases>(o.creases, {{"none", Creases::none}, {"sampled", Creases::sampled}}), {"creases", 24}),
       option("--coincidence N", "surfaces that run alike coincide up to this distance, cells, 0 to 100",
              &o.coincidence_cells, {"coincidence", 25, R"({"minimum": 0, "description": "cells"})"})}};
}

Binding operation_of(BooleanOp& op) {
  return one_of<BooleanOp>(op, {{"union", BooleanOp::unite},
                                {"intersection", BooleanOp::intersect},
                                {"difference", BooleanOp::subtract},
                                {"symmetric-difference", BooleanOp::symmetric_difference}});
}

}  // namespace

std::string word_of(BooleanOp op) { return std::get<std::string>(operation_of(op).value()); }

OptionTable boolean_options(BooleanArgs& args) {
  OptionGroup surface = fit_options(args.fit);
  surface.row("--envelope").report = {};
  surface.without(kBeyondSolve);
  return {{"Options",
           {option("A", "oriented cloud or closed mesh; - reads stdin", &args.a, {}, {.required = true}),
            option("B", "oriented cloud or closed mesh; - reads stdin", &args.b, {}, {.required = true}),
            option("--op OP", "union, intersection, difference (A without B) or symmetric-difference (in exactly one)",
                   operation_of(args.op), {}, {.required = true, .no_default = true})}},
          file_options(args).unreported(),
          crease_options(args),
          surface,
          device_options(args).unreported(),
          quiet_option(args.quiet)};
}

BooleanOptions library_options(const BooleanArgs& args) {
  BooleanOptions options = args.booleans;
  options.reconstruction = args.fit.options;
  validate(options.reconstruction);
  if (!(options.coincidence_cells >= 0 && options.coincidence_cells <= 100))
    throw_usage(fmt::format("--coincidence: {} is not in [0, 100]", options.coincidence_cells));
  return options;
}

}  // namespace pointskin::cli
