// The command line of `pointskin boolean`.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <pointskin/boolean.hpp>

namespace pointskin::cli {

struct BooleanArgs {
  std::string a, b;
  std::string op;
  std::string output;
  std::string cloud;   ///< empty: none
  std::string report;  ///< empty: none
  std::string creases = "sampled";
  std::string boundary = "free";
  std::string device = "auto";
  std::string shift = "auto";
  BooleanOptions options;
  int threads = 0;
  bool no_normals = false, quiet = false;
};

/// Defines the options on `command`, bound to `args`.
void define_boolean_options(CLI::App& command, BooleanArgs& args);

/// @throws Error usage for a word that is no operation
BooleanOp operation_of(const std::string& word);

/// Options as the library wants them.
/// @throws Error usage if a value is out of range
BooleanOptions library_options(const BooleanArgs& args);

}  // namespace pointskin::cli
