// What somebody may have meant who misspelt a command or an option.
#pragma once

#include <string>
#include <vector>

namespace pointskin::cli {

/// How many letters must be inserted, left out, exchanged for others, or swapped with their neighbours to make `b` of
/// `a`. Source: Damerau, "A technique for computer detection and correction of spelling errors", Communications of the
/// ACM 7(3), 1964, with the table of Wagner & Fischer 1974 (no letter is touched twice). O(|a| |b|).
int spelling_distance(const std::string& a, const std::string& b);

/// The one of `words` that is spelt most like `word`; the first of several alike, empty if none is near. Dashes,
/// underscores and capitals do not count, so that camelCase names find ours; the beginning of a word is near to it.
std::string nearest(const std::string& word, const std::vector<std::string>& words);

}  // namespace pointskin::cli
