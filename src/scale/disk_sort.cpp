#include "scale/disk_sort.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "exec/algorithms.hpp"
#include "exec/cancel.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::scale {
namespace {

constexpr std::int64_t kScratch = 24;        // bytes a record, for keys and places and what sorts them
constexpr std::int64_t kFewestInRun = 1024;  // records
constexpr std::int64_t kSmallestBlock = std::int64_t{4} << 10;  // bytes that are read at once
constexpr std::int64_t kLargestBlock = std::int64_t{1} << 20;   // and written

std::size_t as_size(std::int64_t n) { return static_cast<std::size_t>(n); }

}  // namespace

/// The records of a run from one place to another, read in blocks.
class DiskSort::Cursor {
 public:
  Cursor(const DiskSort& sort, const Run& run, std::int64_t begin, std::int64_t end, std::int64_t block)
      : sort_(&sort), next_(run.first + begin), end_(run.first + end), block_(block) {}

  /// The next record; null at the end.
  const std::byte* record() {
    if (at_ == held_ && !fill()) return nullptr;
    return bytes_.data() + as_size(at_ * sort_->setup_.record_bytes);
  }
  void advance() { ++at_; }

 private:
  bool fill() {
    held_ = std::min(block_, end_ - next_);
    at_ = 0;
    if (held_ == 0) return false;
    const std::int64_t bytes = sort_->setup_.record_bytes;
    bytes_.resize(as_size(held_ * bytes));
    sort_->spool_->read(next_ * bytes, bytes_.data(), held_ * bytes);
    next_ += held_;
    return true;
  }

  const DiskSort* sort_;
  std::int64_t next_, end_;  // records of the spool
  std::int64_t block_;       // records
  std::int64_t at_ = 0, held_ = 0;
  std::vector<std::byte> bytes_;
};

DiskSort::DiskSort(exec::Cpu& ex, Setup setup)
    : ex_(ex),
      setup_(std::move(setup)),
      spool_(setup_.team.make_spool(setup_.folder, setup_.records * setup_.record_bytes)),
      written_(setup_.before) {
  const std::int64_t fits = setup_.memory_bytes / (setup_.record_bytes + kScratch);
  run_records_ = std::clamp<std::int64_t>(fits, kFewestInRun, std::numeric_limits<std::int32_t>::max());
  run_records_ = std::min(run_records_, std::max<std::int64_t>(setup_.records, 1));
  records_.resize(as_size(run_records_ * setup_.record_bytes));
}

DiskSort::Order DiskSort::order_of(const std::byte* record) {
  Order order;
  std::memcpy(&order.key, record, sizeof order.key);
  std::memcpy(&order.tie, record + sizeof order.key, sizeof order.tie);
  return order;
}

void DiskSort::add(const std::byte* records, std::int64_t count) {
  const std::int64_t bytes = setup_.record_bytes;
  while (count > 0) {
    const std::int64_t taken = std::min(count, run_records_ - held_);
    std::memcpy(records_.data() + as_size(held_ * bytes), records, as_size(taken * bytes));
    held_ += taken;
    records += as_size(taken * bytes);
    count -= taken;
    if (held_ == run_records_) write_run();
  }
}

exec::Buffer<std::int32_t> DiskSort::sorted_positions() const {
  const std::int64_t bytes = setup_.record_bytes;
  auto keys = exec::make_buffer<std::uint64_t>(ex_, held_);
  exec::for_each(ex_, "scale.sort", held_,
                 [&](std::int64_t i) { keys.data()[i] = order_of(records_.data() + as_size(i * bytes)).key; });
  exec::Buffer<std::int32_t> order = exec::iota(ex_, held_);
  exec::sort_pairs(ex_, "scale.sort", keys, order, 64, 0);
  const ArrayView<const std::uint64_t> sorted = keys.cview();
  const auto before = [&](std::int32_t a, std::int32_t b) {
    const Order first = order_of(records_.data() + as_size(a * bytes));
    const Order second = order_of(records_.data() + as_size(b * bytes));
    return first.tie != second.tie ? first.tie < second.tie : a < b;
  };
  exec::for_each(ex_, "scale.sort", held_, [&](std::int64_t i) {  // the first of equal keys sorts all of them
    if ((i > 0 && sorted[i - 1] == sorted[i]) || i + 1 == held_ || sorted[i + 1] != sorted[i]) return;
    std::int64_t end = i + 1;
    while (end < held_ && sorted[end] == sorted[i]) ++end;
    std::sort(order.data() + i, order.data() + end, before);
  });
  return order;
}

void DiskSort::write_run() {
  if (held_ == 0) return;
  const std::int64_t bytes = setup_.record_bytes;
  const exec::Buffer<std::int32_t> positions = sorted_positions();
  const ArrayView<const std::int32_t> order = positions.cview();
  Run run{written_, held_, {}};
  for (std::int64_t i = 0; i < held_; i += kSampleStep)
    run.samples.push_back(order_of(records_.data() + as_size(order[i] * bytes)));
  const std::int64_t block = std::max<std::int64_t>(kLargestBlock / bytes, 1);
  const std::atomic<bool>* const cancelled = exec::cancel_flag();
  ex_.run_blocks((held_ + block - 1) / block, [&](std::int64_t b) {
    exec::throw_if_cancelled(cancelled);
    const std::int64_t first = b * block;
    const std::int64_t count = std::min(block, held_ - first);
    std::vector<std::byte> sorted(as_size(count * bytes));
    for (std::int64_t i = 0; i < count; ++i)
      std::memcpy(sorted.data() + as_size(i * bytes), records_.data() + as_size(order[first + i] * bytes),
                  as_size(bytes));
    spool_->write((written_ + first) * bytes, sorted.data(), count * bytes);
  });
  runs_.push_back(std::move(run));
  written_ += held_;
  held_ = 0;
}

std::int64_t DiskSort::lower_bound(const Run& run, const Order& order) const {
  const auto sample = std::lower_bound(run.samples.begin(), run.samples.end(), order) - run.samples.begin();
  if (sample == 0) return 0;
  const std::int64_t begin = (sample - 1) * kSampleStep;  // the record there is below
  const std::int64_t end = std::min(begin + kSampleStep, run.records);
  const std::int64_t bytes = setup_.record_bytes;
  std::vector<std::byte> between(as_size((end - begin) * bytes));
  spool_->read((run.first + begin) * bytes, between.data(), (end - begin) * bytes);
  std::int64_t low = begin;
  std::int64_t high = end;
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    if (order_of(between.data() + as_size((middle - begin) * bytes)) < order)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

std::vector<std::vector<std::int64_t>> DiskSort::part_begins(std::int64_t parts) const {
  std::vector<Order> samples;
  for (const Run& run : runs_) samples.insert(samples.end(), run.samples.begin(), run.samples.end());
  std::sort(samples.begin(), samples.end());
  std::vector<std::vector<std::int64_t>> begins(as_size(parts) + 1);
  for (std::int64_t p = 0; p <= parts; ++p)
    for (const Run& run : runs_) {
      std::int64_t at = p == 0 ? 0 : run.records;
      if (p > 0 && p < parts) at = lower_bound(run, samples[as_size(p) * samples.size() / as_size(parts)]);
      begins[as_size(p)].push_back(at);
    }
  return begins;
}

void DiskSort::merge_part(const std::vector<std::int64_t>& begins, const std::vector<std::int64_t>& ends,
                          std::int64_t block, const std::atomic<bool>* cancelled, const Spool& to) const {
  const std::int64_t bytes = setup_.record_bytes;
  struct Next {
    Order order;
    std::size_t run;
  };
  const auto later = [](const Next& a, const Next& b) {
    return a.order != b.order ? b.order < a.order : b.run < a.run;
  };
  std::vector<Cursor> cursors;
  std::vector<Next> heap;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    cursors.emplace_back(*this, runs_[r], begins[r], ends[r], block);
    if (const std::byte* record = cursors.back().record()) heap.push_back({order_of(record), r});
  }
  std::make_heap(heap.begin(), heap.end(), later);
  std::int64_t place = std::accumulate(begins.begin(), begins.end(), std::int64_t{0}) * bytes;
  std::vector<std::byte> merged;
  const std::int64_t most = std::max<std::int64_t>(kLargestBlock / bytes, 1) * bytes;
  const auto flush = [&] {
    exec::throw_if_cancelled(cancelled);
    to.write(place, merged.data(), static_cast<std::int64_t>(merged.size()));
    place += static_cast<std::int64_t>(merged.size());
    merged.clear();
  };
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end(), later);
    Cursor& cursor = cursors[heap.back().run];
    const std::byte* const record = cursor.record();
    merged.insert(merged.end(), record, record + as_size(bytes));
    if (static_cast<std::int64_t>(merged.size()) == most) flush();
    cursor.advance();
    if (const std::byte* next = cursor.record()) {
      heap.back().order = order_of(next);
      std::push_heap(heap.begin(), heap.end(), later);
    } else {
      heap.pop_back();
    }
  }
  flush();
}

void DiskSort::join_runs() {
  std::vector<std::int64_t> sizes;  // first record, records, samples
  std::vector<Order> samples;
  for (const Run& run : runs_) {
    sizes.insert(sizes.end(), {run.first, run.records, std::ssize(run.samples)});
    samples.insert(samples.end(), run.samples.begin(), run.samples.end());
  }
  sizes = setup_.team.gather_all(std::move(sizes));
  samples = setup_.team.gather_all(std::move(samples));
  runs_.clear();
  auto sample = samples.begin();
  for (std::size_t i = 0; i < sizes.size(); i += 3) {
    runs_.push_back({sizes[i], sizes[i + 1], {sample, sample + sizes[i + 2]}});
    sample += sizes[i + 2];
  }
}

std::unique_ptr<Spool> DiskSort::finish() {
  const Team& team = setup_.team;
  team.together([&] { write_run(); });
  records_ = {};
  if (!team.is_alone()) join_runs();
  if (runs_.size() <= 1 && team.is_alone()) return std::move(spool_);
  std::int64_t all = 0;
  for (const Run& run : runs_) all += run.records;
  std::unique_ptr<Spool> to = team.make_spool(setup_.folder, all * setup_.record_bytes);
  const int threads = team.reduce(ex_.threads(), [](int a, int b) { return std::max(a, b); });
  const std::int64_t parts = std::int64_t{threads} * team.size();
  const Team::Share own = team.share_of(parts);
  const std::int64_t cursors = ex_.threads() * static_cast<std::int64_t>(runs_.size());
  const std::int64_t block_bytes = std::clamp(setup_.memory_bytes / cursors, kSmallestBlock, kLargestBlock);
  const std::int64_t block = std::max<std::int64_t>(block_bytes / setup_.record_bytes, 1);
  const std::vector<std::vector<std::int64_t>> begins = part_begins(parts);
  const std::atomic<bool>* const cancelled = exec::cancel_flag();
  team.together([&] {
    ex_.run_blocks(own.end - own.begin, [&](std::int64_t p) {
      const std::size_t part = as_size(own.begin + p);
      merge_part(begins[part], begins[part + 1], block, cancelled, *to);
    });
  });
  spool_.reset();
  return to;
}

}  // namespace pointskin::scale
