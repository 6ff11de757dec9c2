// A document of a scene and the command line of `edit`, joined: what the command line says counts.
#pragma once

#include <string>
#include <vector>

#include "given_options.hpp"
#include "option_table.hpp"
#include "scene/document.hpp"

namespace pointskin::cli {

/// The options of the document, but for those that the command line gives, whose values are those of `options`.
/// @param table  of the command, which says under which names options are given
void take_options(const scene::Document& document, const OptionTable& table, const GivenOptions& given,
                  Options& options);

/// The long name, with its dashes, of the option that reports show as `key`; empty if there is none.
std::string option_of(const OptionTable& table, const std::string& key);

/// All files that a document reads: its clouds, and what its operations name.
std::vector<std::string> files_of(const scene::Document& document);

/// True if the document gives a cloud normals before anything else, so that it needs none.
bool begins_with_normals(const scene::Document& document);

}  // namespace pointskin::cli
