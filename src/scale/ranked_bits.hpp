// A bit for each of many elements, and how many are set before any of them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pointskin::scale {

/// 12 bytes for 64 elements, of which at most 2^32 may be set.
class RankedBits {
 public:
  explicit RankedBits(std::int64_t size) : words_(static_cast<std::size_t>(size / 64) + 1), before_(words_.size()) {}

  void set(std::int64_t i) { words_[word_of(i)] |= bit_of(i); }
  void reset(std::int64_t i) { words_[word_of(i)] &= ~bit_of(i); }
  [[nodiscard]] bool at(std::int64_t i) const { return (words_[word_of(i)] & bit_of(i)) != 0; }

  /// Once all bits are set.
  void count() {
    std::uint32_t sum = 0;
    for (std::size_t w = 0; w < words_.size(); ++w) {
      before_[w] = sum;
      sum += static_cast<std::uint32_t>(std::popcount(words_[w]));
    }
  }

  /// Set bits; after count().
  [[nodiscard]] std::int64_t ones() const { return std::int64_t{before_.back()} + std::popcount(words_.back()); }

  /// Set bits before element i, in [0, size]; after count(). O(1)
  [[nodiscard]] std::int64_t before(std::int64_t i) const {
    const std::size_t w = word_of(i);
    return std::int64_t{before_[w]} + std::popcount(words_[w] & (bit_of(i) - 1));
  }

 private:
  static std::size_t word_of(std::int64_t i) { return static_cast<std::size_t>(i / 64); }
  static std::uint64_t bit_of(std::int64_t i) { return std::uint64_t{1} << (i % 64); }

  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;
};

}  // namespace pointskin::scale
