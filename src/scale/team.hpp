// The ranks of a run in blocks: what each does of a piece of work, and how all come to know what each has found.
#pragma once

#include <pointskin/error.hpp>
#include <pointskin/ranks.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "scale/spool.hpp"

namespace pointskin::scale {

/// A failure that all ranks have been told of, and can begin again after.
class FailedTogether : public Error {
 public:
  using Error::Error;
};

/// All of a run that is not an own part of it is done by every rank, in the same order and with the same bits. Whatever is collective
/// is called by all ranks in the same order; alone, a rank has what it found itself.
class Team {
 public:
  Team() = default;
  /// @param ranks  or null for one that is alone; they outlive the team
  explicit Team(Ranks* ranks) : ranks_(ranks != nullptr && ranks->size() > 1 ? ranks : nullptr) {}

  [[nodiscard]] bool is_alone() const { return ranks_ == nullptr; }
  [[nodiscard]] int size() const { return is_alone() ? 1 : ranks_->size(); }
  [[nodiscard]] int rank() const { return is_alone() ? 0 : ranks_->rank(); }
  [[nodiscard]] bool is_first() const { return rank() == 0; }

  /// Things begin..end - 1 of n are this rank's: ranks have runs of them, in order, that differ by one at most.
  struct Share {
    std::int64_t begin = 0, end = 0;
    [[nodiscard]] bool has(std::int64_t i) const { return i >= begin && i < end; }
  };
  [[nodiscard]] Share share_of(std::int64_t n) const { return share_of(n, rank()); }
  [[nodiscard]] Share share_of(std::int64_t n, int rank) const { return {n * rank / size(), n * (rank + 1) / size()}; }

  /// What each rank has, of every rank, by rank. Collective.
  template <class T>
  [[nodiscard]] std::vector<std::vector<T>> gather(std::vector<T> own) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<std::vector<T>> all(static_cast<std::size_t>(size()));
    all[static_cast<std::size_t>(rank())] = std::move(own);
    if (is_alone()) return all;
    for (int r = 0; r < size(); ++r) {
      std::vector<T>& values = all[static_cast<std::size_t>(r)];
      std::int64_t count = std::ssize(values);
      broadcast(&count, sizeof count, r);
      values.resize(static_cast<std::size_t>(count));
      broadcast(values.data(), count * std::int64_t{sizeof(T)}, r);
    }
    return all;
  }
  /// The same, one after another.
  template <class T>
  [[nodiscard]] std::vector<T> gather_all(std::vector<T> own) const {
    std::vector<std::vector<T>> parts = gather(std::move(own));
    std::vector<T> all = std::move(parts.front());
    for (std::size_t r = 1; r < parts.size(); ++r) all.insert(all.end(), parts[r].begin(), parts[r].end());
    return all;
  }
  /// What `join` makes of one value of each, in the order of the ranks.
  template <class T, class Join>
  [[nodiscard]] T reduce(const T& own, const Join& join) const {
    const std::vector<T> all = gather_all(std::vector<T>{own});
    T joined = all.front();
    for (std::size_t r = 1; r < all.size(); ++r) joined = join(joined, all[r]);
    return joined;
  }
  /// The value of the first rank.
  template <class T>
  [[nodiscard]] T of_first(T own) const {
    static_assert(std::is_trivially_copyable_v<T>);
    broadcast(&own, sizeof own, 0);
    return own;
  }

  [[nodiscard]] std::string of_first(const std::string& own) const {
    const std::vector<char> all = gather_all(std::vector<char>(own.begin(), is_first() ? own.end() : own.begin()));
    return {all.begin(), all.end()};
  }

  /// Until all ranks call it.
  void wait() const { (void)gather(std::vector<char>{}); }

  /// Does an own part of what all do, and waits for the others. Where memory has not been enough for any rank's part, all throw
  /// FailedTogether with that rank's words; other errors are for the one that meets them to end all.
  template <class Work>
  void together(const Work& work) const {
    if (is_alone()) return work();
    std::string failure;
    try {
      work();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::over_limit) throw;
      failure = error.what();
    }
    agree(failure);
  }
  /// A spool that all ranks read and write, after what they have called together since then. Collective.
  /// @throws Error as Spool
  [[nodiscard]] std::unique_ptr<Spool> make_spool(const std::string& folder, std::int64_t bytes) const;

  /// Spools of which each rank has made some, when_shown: all have them all then. Collective.
  /// @param folder  of all
  /// @param spools  (n) in the same order for all; null: another rank's
  /// @throws Error output_not_written if the folder is not the same for all ranks
  void share_spools(const std::string& folder, std::span<std::unique_ptr<Spool>* const> spools) const;

 private:
  void broadcast(void* data, std::int64_t bytes, int root) const {
    if (!is_alone()) ranks_->broadcast(data, bytes, root);
  }
  /// @param failure  of this rank, or empty
  void agree(const std::string& failure) const;

  Ranks* ranks_ = nullptr;
};

}  // namespace pointskin::scale
