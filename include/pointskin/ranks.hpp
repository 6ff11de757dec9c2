// Processes that work on one task together, such as those that mpirun starts on the hosts of a cluster.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// What reconstruct_files() needs of processes that work together. ranks_of_launcher() has those of MPI; a program with processes of
/// its own, or with an MPI that it started itself, derives from this.
class Ranks {
 public:
  Ranks() = default;
  virtual ~Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  [[nodiscard]] virtual int rank() const = 0;          ///< of this process: 0 to size() - 1
  [[nodiscard]] virtual int size() const = 0;          ///< at least 1
  [[nodiscard]] virtual int rank_on_host() const = 0;  ///< among those of the same host, which share its GPUs

  /// Every rank has the bytes of rank `root` when it returns. All ranks call it in the same order with the same count and root.
  /// Waits without taking the processor from others, and looks for cancelling meanwhile.
  /// @throws Error interrupted; internal if a message is lost. Nothing but end_all() may be called then
  virtual void broadcast(void* data, std::int64_t bytes, int root) = 0;

  /// Ends all ranks, wherever they are: where one meets an error, the others wait for it in vain.
  [[noreturn]] virtual void end_all(int exit_code) = 0;
};

/// The ranks of the launcher of MPI that started this process, as mpirun, mpiexec or srun; null where none did, or where it started
/// one process alone. Open MPI and MPICH are known by the variables of the environment that they set; each has a module beside the
/// program that is loaded then, so that nobody else needs MPI. Ranks that go without end_all()
/// wait for all others to go. To be called once.
/// @throws Error device_unavailable if this build has no module for the launcher, or it cannot be loaded, with the reason
std::unique_ptr<Ranks> ranks_of_launcher();

/// What the environment alone tells of the processes that a launcher of MPI started: the rank of this one, and how many there are; 0 of
/// 1 without a launcher.
struct LaunchedRank {
  int rank = 0, size = 1;
};
LaunchedRank launched_rank() noexcept;

}  // namespace pointskin PSK_EXPORT
