// Several GPUs of one host as one space: one stream of work, of which large pieces are shared, and one memory, whose large arrays lie
// on all of them. What lies on another GPU is read by the plain pointer. This header needs no CUDA.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "exec/gpus/layout.hpp"
#include "exec/gpus/order.hpp"
#include "exec/memory.hpp"

namespace pointskin::exec::gpus {

/// From where on work and memory are worth sharing.
struct WorthSharing {
  std::int64_t threads = 1 << 20;   ///< of a launch: before the next one the GPUs wait for each other, 30 to 40 us
  std::int64_t elements = 1 << 20;  ///< of a sort, a scan or a choice
  std::size_t bytes = std::size_t{16} << 20;  ///< of an array: a GPU's share is whole pages of 2 MiB
};

/// Whether all of them read and write each other's memory, also by atomic operations. @throws Error device_unavailable
bool work_together(std::span<const int> gpus);

/// What counts for groups that are made from now on. Tests lower it, so that small clouds are shared.
WorthSharing& worth_sharing();

class Members;

/// Used from one thread at a time. GPU 0 of the group is its lead.
class Group {
 public:
  /// @param gpus  two or more, each once
  /// @throws Error device_unavailable if one of them does not answer, or two do not reach each other's memory: it names them
  explicit Group(std::span<const int> gpus);
  ~Group();
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  [[nodiscard]] int count() const noexcept { return count_; }
  /// The number that the CUDA runtime gives to GPU `g` of the group, and its stream, a cudaStream_t.
  [[nodiscard]] int gpu(int g) const;
  [[nodiscard]] void* stream(int g) const;
  [[nodiscard]] const WorthSharing& worth() const noexcept { return worth_; }

  /// Large blocks lie on all GPUs, as layout() has it, small ones on the lead; all reach both.
  [[nodiscard]] const std::shared_ptr<MemoryPool>& pool() const noexcept { return pool_; }
  /// Memory of GPU `g`, the current one, for what only work on its stream uses. @throws Error over_limit if it has none left
  [[nodiscard]] Buffer<std::byte> own_scratch(int g, std::size_t bytes) const;

  /// How arrays that are made and work that is launched are cut from now on (exec/placed.hpp). @returns how it was before
  Layout exchange_layout(Layout layout) { return std::exchange(*layout_, std::move(layout)); }
  [[nodiscard]] const Layout& layout() const noexcept { return *layout_; }

  /// Makes what is enqueued on the lead's stream from now on wait for all before.
  void to_lead();
  /// Waits for all GPUs. @throws Error device_unavailable if some of the work failed
  void synchronize();

  /// Calls launch(g, stream) for every GPU, which is then the thread's current one. All that is enqueued there waits for all before.
  /// In the end the lead is the current one.
  template <class Launch>
  void spread(const Launch& launch) {
    to_all();
    try {
      for (int g = 0; g < count_; ++g) {
        choose(g);
        launch(g, stream(g));
        mark(g);
      }
    } catch (...) {
      settle();
      throw;
    }
    choose(0);
  }

  /// Makes GPU `g` the calling thread's current one.
  void choose(int g) const;

 private:
  void to_all();
  void mark(int g);
  /// After an error: waits for all GPUs, so that no work is under way whose end nothing marks.
  void settle() noexcept;

  int count_;
  WorthSharing worth_;
  std::shared_ptr<Members> members_;
  std::shared_ptr<Layout> layout_;  // the pool asks for it
  std::shared_ptr<MemoryPool> pool_;
  Order order_;
};

}  // namespace pointskin::exec::gpus
