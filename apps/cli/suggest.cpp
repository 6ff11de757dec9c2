#include "suggest.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace pointskin::cli {
namespace {

constexpr int kFar = std::numeric_limits<int>::max();

std::string bare(const std::string& word) {
  std::string letters;
  for (const char c : word) {
    if (c == '-' || c == '_') continue;
    letters += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return letters;
}

/// 0 for the same letters, kFar for words that have nothing to do with each other. Both are bare.
int strangeness(const std::string& word, const std::string& candidate) {
  constexpr std::size_t kTelling = 3;  // letters that a beginning needs
  constexpr std::size_t kLetters = 3;  // in so many, about one may be wrong
  const int distance = spelling_distance(word, candidate);
  if (distance <= static_cast<int>((word.size() + 1) / kLetters)) return distance;
  if (word.size() >= kTelling && candidate.starts_with(word)) return 1;
  if (candidate.size() > kTelling && word.starts_with(candidate)) return 2;
  return kFar;
}

}  // namespace

int spelling_distance(const std::string& a, const std::string& b) {
  std::vector<int> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int exchanged = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, exchanged});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string nearest(const std::string& word, const std::vector<std::string>& words) {
  const std::string letters = bare(word);
  std::string best;
  int least = kFar;
  for (const std::string& candidate : words) {
    const int distance = strangeness(letters, bare(candidate));
    if (distance >= least) continue;
    least = distance;
    best = candidate;
  }
  return best;
}

}  // namespace pointskin::cli
