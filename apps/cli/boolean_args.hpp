// The command line of `pointskin boolean`.
#pragma once

#include <string>

#include <pointskin/boolean.hpp>

#include "fit_args.hpp"
#include "given_options.hpp"

namespace pointskin::cli {

struct BooleanArgs : DeviceArgs {
  std::string a, b;
  BooleanOp op = BooleanOp::unite;
  std::string output;
  std::string cloud;   ///< empty: none
  std::string report;  ///< empty: none
  std::string shift = "auto";
  BooleanOptions booleans;  ///< but for the reconstruction
  FitArgs fit;
  bool overwrite = false, quiet = false;
  GivenOptions given;
};

/// The word that means an operation.
std::string word_of(BooleanOp op);

OptionTable boolean_options(BooleanArgs& args);

/// Options as the library wants them.
/// @throws Error usage if a value is out of range
BooleanOptions library_options(const BooleanArgs& args);

}  // namespace pointskin::cli
