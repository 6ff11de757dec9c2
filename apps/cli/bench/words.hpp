// Command lines given as one text: split into words, without a shell.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace pointskin::cli {

/// Splits `text` at blanks. '...' keeps everything as it is; "..." keeps blanks, with \" and \\ for these two; outside
/// of quotes a backslash keeps the next character. Nothing else is special: no variables, wildcards, pipes or
/// redirections.
/// @throws Error usage for a quote that is not closed, a backslash at the end, or no word at all
std::vector<std::string> split_words(const std::string& text);

/// Replaces every {name} in every word by its value; what a value holds is not looked at again, and never splits a
/// word.
/// @throws Error usage for a {name} that `values` does not have. Braces that hold anything but letters stay.
std::vector<std::string> fill_in(std::vector<std::string> words, const std::map<std::string, std::string>& values);

/// `words` as a person would type them into a shell.
std::string quoted(const std::vector<std::string>& words);

}  // namespace pointskin::cli
