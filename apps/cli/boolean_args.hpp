// The command line of `pointskin boolean`.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <pointskin/boolean.hpp>

#include "fit_args.hpp"
#include "given_options.hpp"

namespace pointskin::cli {

struct BooleanArgs : DeviceArgs {
  std::string a, b;
  std::string op;
  std::string output;
  std::string cloud;   ///< empty: none
  std::string report;  ///< empty: none
  std::string creases = "sampled";
  std::string shift = "auto";
  BooleanOptions booleans;  ///< but for the reconstruction
  SolveArgs solve;
  bool overwrite = false, quiet = false;
  GivenOptions given;
};

/// Defines the options on `command`, bound to `args`.
void define_boolean_options(CLI::App& command, BooleanArgs& args);

/// @throws Error usage for a word that is no operation
BooleanOp operation_of(const std::string& word);

/// Options as the library wants them.
/// @throws Error usage if a value is out of range
BooleanOptions library_options(const BooleanArgs& args);

}  // namespace pointskin::cli
