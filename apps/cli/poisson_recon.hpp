// Options of PoissonRecon 18.75 that scripts give: those that mean something here under another name are defined beside
// the options they stand for; the rest is taken, said to have no meaning here, and otherwise passed over.
#pragma once

#include <string>

#include "given_options.hpp"
#include "option_table.hpp"

namespace pointskin::cli {

/// --data without a factor.
inline constexpr char kDataAlone[] = "alone";

/// The options without a meaning, hidden from --help. What would change what is written (--grid, --tree, --xForm,
/// --gridCoordinates) is not among them: it stays an error.
OptionGroup ignored_options();

/// Warns of those that were given, and of the factor of --data.
/// @param data  that factor, or kDataAlone; empty: not given
/// @throws Error usage if it is no number
void warn_about_poisson_recon(const GivenOptions& given, const std::string& data);

}  // namespace pointskin::cli
