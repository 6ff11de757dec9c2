// Options of PoissonRecon 18.75 that scripts give: those that mean something here under another name are defined beside
// the options they stand for; the rest is taken, said to have no meaning here, and otherwise passed over.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include <CLI/CLI.hpp>

#include "given_options.hpp"

namespace pointskin::cli {

/// Those without a meaning here. What would change what is written (--grid, --tree, --xForm, --gridCoordinates) is not
/// among them: it stays an error.
inline constexpr std::size_t kIgnoredOptions = 22;

struct PoissonReconArgs {
  std::string data;                                    ///< pull factor of --data, or kDataAlone; empty: not given
  std::array<std::string, kIgnoredOptions> ignored{};  ///< values that nobody reads
};

/// --data without a factor.
inline constexpr char kDataAlone[] = "alone";

/// Defines the options without a meaning on `command`, hidden from its help.
void define_ignored_options(CLI::App& command, PoissonReconArgs& args);

/// Warns of those that were given, and of the factor of --data.
/// @throws Error usage if that factor is no number
void warn_about_poisson_recon(const GivenOptions& given, const PoissonReconArgs& args);

}  // namespace pointskin::cli
