#include "normals/likely_signs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "exec/this_space.hpp"

namespace pointskin::normals {
namespace {

using namespace sign_graph;

/// A correlation of two values whose means are 0.
struct Correlation {
  double product = 0, first = 0, second = 0;
  PSK_HD Correlation operator+(const Correlation& other) const {
    return {product + other.product, first + other.first, second + other.second};
  }
  [[nodiscard]] double value() const { return first * second > 0 ? product / std::sqrt(first * second) : 0.0; }
};

/// What shows how often links and evidence are right: links with the evidence at their ends and around triangles, and
/// how a point's evidence differs from its neighbours' with its height above them.
struct Coherence {
  PatchVotes links, evidence, triangles;
  Correlation heights;
};
struct CountCoherent {
  LinkedLines lines;
  ArrayView<const std::int32_t> evidence;
  PSK_HD Coherence operator()(std::int64_t i) const {
    Coherence sum;
    const Vec3d p = to_double(lines.positions[i]);
    const Vec3d n = to_double(lines.normals[i]);
    double height = 0;
    double scale = 0;
    int other = 0;
    int count = 0;
    std::int32_t before = -1;
    std::int64_t vote_before = 0;
    for (int l = 0; l < kLinks; ++l) {
      const std::int32_t j = lines.ids[i * kNeighbours + l];
      if (j < 0) break;
      const std::int64_t vote = vote_of(lines, i, j);
      const std::int32_t both = evidence[i] * evidence[j];
      sum.links = sum.links + PatchVotes{vote, size_of(vote), vote != 0 ? 1 : 0};
      if (both != 0) sum.evidence = sum.evidence + PatchVotes{vote * both, size_of(vote), 1};
      if (before >= 0) sum.triangles = sum.triangles + around(vote, vote_before, vote_of(lines, j, before));
      before = j;
      vote_before = vote;
      const Vec3d d = to_double(lines.positions[j]) - p;
      height -= dot(n, d);
      scale += dot(d, d);
      other += dot(n, to_double(lines.normals[j])) < 0 ? -evidence[j] : evidence[j];
      ++count;
    }
    if (scale > 0 && evidence[i] != 0) {
      const double differs = evidence[i] - static_cast<double>(other) / count;
      const double relative = height / std::sqrt(count * scale);
      sum.heights = {differs * relative, differs * differs, relative * relative};
    }
    return sum;
  }
  PSK_HD static PatchVotes around(std::int64_t a, std::int64_t b, std::int64_t c) {
    std::int64_t least = size_of(a) < size_of(b) ? size_of(a) : size_of(b);
    if (size_of(c) < least) least = size_of(c);
    return {((a < 0) != (b < 0)) != (c < 0) ? -least : least, least, 1};
  }
};
struct AddCoherence {
  PSK_HD Coherence operator()(const Coherence& a, const Coherence& b) const {
    return {a.links + b.links, a.evidence + b.evidence, a.triangles + b.triangles, a.heights + b.heights};
  }
};

/// How much more often votes are right than wrong, in [0, 1].
double share_of(const PatchVotes& votes) {
  return votes.gross > 0 ? std::max(0.0, static_cast<double>(votes.net) / static_cast<double>(votes.gross)) : 0.0;
}

struct Spread {
  LinkedLines lines;
  ArrayView<const std::int32_t> evidence;
  float own;  // what a point's evidence weighs, in full votes
  ArrayView<const float> in;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const {
    float sum = own * static_cast<float>(evidence[i]);
    float weight = own;
    for (int l = 0; l < kLinks; ++l) {
      const std::int32_t j = lines.ids[i * kNeighbours + l];
      if (j < 0) break;
      const float vote = static_cast<float>(vote_of(lines, i, j)) * (1.0F / static_cast<float>(kFullVote));
      sum += vote * in[j];
      weight += vote < 0 ? -vote : vote;
    }
    out[i] = sum / weight;
  }
};
struct ToFloat {
  ArrayView<const std::int32_t> in;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = static_cast<float>(in[i]); }
};
struct SignOf {
  ArrayView<const float> in;
  ArrayView<std::int32_t> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = in[i] < 0 ? -1 : 1; }
};
struct TakeKnown {
  ArrayView<const std::int32_t> evidence;
  ArrayView<std::int32_t> signs;
  PSK_HD void operator()(std::int64_t i) const {
    if (evidence[i] != 0) signs[i] = evidence[i];
  }
};

}  // namespace

template <exec::Space Exec>
LikelySigns spread_evidence(Exec& ex, const LinkedLines& lines, ArrayView<const std::int32_t> evidence) {
  constexpr double kLeastCoherence = 0.04;  // a share q of wrong signs leaves (1 - 2 q)^2
  constexpr double kSurest = 0.99;
  constexpr double kSurestLinks = 0.9;  // their errors come together
  constexpr int kRounds = 6;
  constexpr double kLinksKnow = 0.9;  // of the votes, with the best signs
  constexpr double kSheets = 0.05;    // correlation of evidence and height: on one sheet there is none
  const std::int64_t n = evidence.size;
  const auto sums = exec::reduce<Coherence>(ex, "normals.coherence", n, CountCoherent{lines, evidence}, AddCoherence{});
  // Of links a share w is wrong, of evidence q, independently: triangles close with (1 - 2 w)^3, links agree with
  // evidence with (1 - 2 w) (1 - 2 q)^2.
  const double coherence = share_of(sums.evidence);
  if (coherence < kLeastCoherence) return {};
  const double of_links = std::clamp(std::cbrt(share_of(sums.triangles)), 0.1, kSurestLinks);
  const double of_evidence = std::min(kSurest, std::sqrt(coherence / of_links));
  const double own = std::atanh(of_evidence) / std::atanh(of_links);  // logarithms of odds
  auto now = exec::make_buffer<float>(ex, n);
  auto next = exec::make_buffer<float>(ex, n);
  for_each(ex, "normals.spread", n, ToFloat{evidence, now.view()});
  for (int round = 0; round < kRounds; ++round) {
    for_each(ex, "normals.spread", n, Spread{lines, evidence, static_cast<float>(own), now.cview(), next.view()});
    now.swap(next);
  }
  LikelySigns likely{exec::make_buffer<std::int32_t>(ex, n),
                     static_cast<double>(sums.links.gross) / static_cast<double>(sums.links.count * kFullVote)};
  for_each(ex, "normals.spread", n, SignOf{now.cview(), likely.signs.view()});
  const auto after =
      exec::reduce<Coherence>(ex, "normals.coherence", n, CountCoherent{lines, likely.signs.cview()}, AddCoherence{});
  if (share_of(after.evidence) >= kLinksKnow) return likely;
  if (sums.heights.value() < std::max(kSheets, 4 / std::sqrt(static_cast<double>(n)))) return likely;
  for_each(ex, "normals.spread", n, TakeKnown{evidence, likely.signs.view()});
  likely.typical = std::numeric_limits<double>::infinity();
  return likely;
}

PSK_INSTANTIATE(spread_evidence);

}  // namespace pointskin::normals
