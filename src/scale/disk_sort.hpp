// Sorts what memory does not hold.
#pragma once

#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "exec/cpu.hpp"
#include "exec/memory.hpp"
#include "scale/spool.hpp"
#include "scale/team.hpp"

namespace pointskin::scale {

/// Sorts records of one size by their first 16 bytes: a key and, of equal keys, a second one. Records that are the same
/// in both keep the order that they were added in.
///
/// As many records as memory holds are sorted and written, run after run; at the end all runs are merged, each thread a
/// part of the keys. The disk has twice the records meanwhile, and reads and writes them once more than they are
/// written first. The result is the same for any memory and threads. Source: Knuth, The Art of Computer Programming 3,
/// section 5.4 (external merge sort).
class DiskSort {
 public:
  struct Setup {
    std::string folder;              ///< for temporary data
    std::int64_t records = 0;        ///< at most so many are added by all; their space is reserved
    std::int64_t record_bytes = 16;  ///< at least 16
    std::int64_t memory_bytes = 0;   ///< that sorting may take; runs have 1,024 records and reads 4 KiB at least
    Team team{};                     ///< of ranks that add records, those of the first one before those of the second
    std::int64_t before = 0;         ///< at most so many records are added by the ranks before
  };

  /// Collective.
  /// @throws Error output_not_written
  DiskSort(exec::Cpu& ex, Setup setup);

  /// @param records  shape (count * record_bytes); copied
  /// @throws Error output_not_written, interrupted
  void add(const std::byte* records, std::int64_t count);

  /// All records that were added by all ranks, in order, from the first byte of a spool that may have room for more. To be called
  /// once. Collective.
  /// @throws Error output_not_written, interrupted
  std::unique_ptr<Spool> finish();

  /// Runs that were written so far.
  [[nodiscard]] std::int64_t runs() const { return static_cast<std::int64_t>(runs_.size()); }

 private:
  /// What records are sorted by.
  struct Order {
    std::uint64_t key = 0, tie = 0;
    friend auto operator<=>(const Order&, const Order&) = default;
  };
  /// Sorted records on the spool, and the order of every kSampleStep-th of them.
  struct Run {
    std::int64_t first = 0, records = 0;
    std::vector<Order> samples;
  };
  class Cursor;

  static constexpr std::int64_t kSampleStep = 4096;

  static Order order_of(const std::byte* record);
  void write_run();
  /// Those of all ranks, in their order.
  void join_runs();
  /// Positions of the records of the run in memory, in order.
  exec::Buffer<std::int32_t> sorted_positions() const;
  /// Where each of `parts` parts begins in every run, and last where the runs end: shape (parts + 1, runs).
  std::vector<std::vector<std::int64_t>> part_begins(std::int64_t parts) const;
  std::int64_t lower_bound(const Run& run, const Order& order) const;
  void merge_part(const std::vector<std::int64_t>& begins, const std::vector<std::int64_t>& ends, std::int64_t block,
                  const std::atomic<bool>* cancelled, const Spool& to) const;

  exec::Cpu& ex_;
  Setup setup_;
  std::unique_ptr<Spool> spool_;
  std::vector<Run> runs_;
  std::int64_t run_records_ = 0;    ///< that memory holds
  std::vector<std::byte> records_;  ///< of the run that is being filled
  std::int64_t held_ = 0;           ///< records in it
  std::int64_t written_ = 0;        ///< records in runs
};

}  // namespace pointskin::scale
