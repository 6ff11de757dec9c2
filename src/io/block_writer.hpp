// Blocks made by several threads at once, in a file or a stream in their order.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "exec/cpu.hpp"
#include "io/output.hpp"

namespace pointskin::io {

/// Makes the blocks of a file in parallel. Threads take them in order; the place of a block follows from the sizes of
/// those before it, so a thread waits until these are made, but not until they are written. In a stream it waits for
/// that, too.
class BlockWriter {
 public:
  enum class Target { file, stream };

  /// @param fd     of a file that can be written at any offset, or a stream
  /// @param place  of the first block in the file
  BlockWriter(const Blocks& blocks, int fd, Target target, std::int64_t place = 0)
      : blocks_(blocks), fd_(fd), target_(target), place_(place) {}

  /// Makes and writes all blocks; at most one per thread is in memory.
  /// @throws std::system_error if the system refuses to write, or whatever Blocks::make throws
  void run(exec::Cpu& ex);

 private:
  void work(const std::atomic<bool>* cancelled);
  std::optional<std::int64_t> take();
  /// Waits until all blocks before `b` have their place. @returns the place of `b`; none if writing has stopped
  std::optional<std::int64_t> wait_for_place(std::int64_t b);
  /// Lets the block after the one with the turn have its place, `bytes` further on.
  void pass_turn(std::size_t bytes);
  void stop();
  void write_to_file(const std::string& bytes, std::int64_t place) const;
  void write_to_stream(const std::string& bytes, const std::atomic<bool>* cancelled) const;

  const Blocks& blocks_;
  const int fd_;
  const Target target_;
  std::mutex mutex_;  ///< guards what follows
  std::condition_variable turn_changed_;
  std::int64_t taken_ = 0;
  std::int64_t turn_ = 0;  ///< the block that is to get its place next
  std::int64_t place_;     ///< bytes before that block
  bool stopped_ = false;
};

}  // namespace pointskin::io
