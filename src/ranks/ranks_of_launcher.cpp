#include <pointskin/error.hpp>
#include <pointskin/ranks.hpp>

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "core/format.hpp"
#include "exec/cancel.hpp"
#include "ranks/mpi_module.hpp"

namespace pointskin {
namespace {

/// A launcher of MPI, by what it tells the processes that it starts.
struct Launcher {
  const char* name;    // of the implementation, for people
  const char* module;  // of the file
  const char* rank;    // variables of the environment
  const char* size;
};

/// The first whose variables are set. srun sets those of one or the other, as --mpi=pmix or --mpi=pmi2 says.
constexpr std::array<Launcher, 3> kLaunchers = {
    {{"Open MPI", "openmpi", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
     {"MPICH", "mpich", "PMI_RANK", "PMI_SIZE"},
     {"Open MPI", "openmpi", "PMIX_RANK", "SLURM_NTASKS"}}};

std::optional<int> number_in(const char* variable) {
  const char* const text = std::getenv(variable);
  if (text == nullptr) return std::nullopt;
  int number = 0;
  const auto [end, error] = std::from_chars(text, text + std::strlen(text), number);
  if (error != std::errc{} || *end != '\0' || number < 0) return std::nullopt;
  return number;
}

const Launcher* launcher() {
  for (const Launcher& one : kLaunchers)
    if (number_in(one.rank) && number_in(one.size)) return &one;
  return nullptr;
}

/// The folder of the file that this code is loaded from: the program, or the library that another one loads.
std::filesystem::path own_folder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&own_folder), &info) == 0 || info.dli_fname == nullptr) return {};
  std::error_code error;
  const std::filesystem::path file = std::filesystem::canonical(info.dli_fname, error);
  if (!error) return file.parent_path();
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();  // the path may be that of the call
}

/// lib/pointskin beside the program's folder or above the library's, or pointskin in it.
std::vector<std::filesystem::path> places_of(const std::string& module) {
  const std::filesystem::path name = "pointskin/pointskin_" + module + ".so";
  return {own_folder() / "../lib" / name, own_folder() / ".." / name, own_folder() / name};
}

[[noreturn]] void fail_to_load(const Launcher& launched, const std::string& why) {
  throw Error(ErrorCode::device_unavailable,
              fmt::format("started as one of several processes of {}, whose module {}", launched.name, why));
}

const PointskinMpi& load(const Launcher& launched) {
  for (const std::filesystem::path& place : places_of(launched.module)) {
    std::error_code error;
    if (!std::filesystem::exists(place, error)) continue;
    // Global: libraries of MPI load parts of themselves that look for the symbols of others.
    void* const module = dlopen(place.c_str(), RTLD_NOW | RTLD_GLOBAL);
    if (module == nullptr) fail_to_load(launched, fmt::format("cannot be loaded: {}", dlerror()));
    using Entry = const PointskinMpi* (*)();
    const auto entry = reinterpret_cast<Entry>(dlsym(module, POINTSKIN_MPI_SYMBOL));
    if (entry == nullptr || entry()->version != POINTSKIN_MPI_VERSION)
      fail_to_load(launched, fmt::format("{} is of another version", place.string()));
    return *entry();
  }
  fail_to_load(launched, fmt::format("pointskin_{}.so is not there; this build has none", launched.module));
}

class MpiRanks final : public Ranks {
 public:
  explicit MpiRanks(const PointskinMpi& mpi) : mpi_(mpi) { check(mpi_.start(&rank_, &size_, &rank_on_host_)); }
  ~MpiRanks() override { mpi_.stop(); }

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }
  [[nodiscard]] int rank_on_host() const override { return rank_on_host_; }

  void broadcast(void* data, std::int64_t bytes, int root) override {
    constexpr std::int64_t kMost = std::int64_t{1} << 30;  // counts of MPI are ints
    for (std::int64_t done = 0; done < bytes; done += kMost) {
      check(mpi_.begin_broadcast(static_cast<std::byte*>(data) + done, static_cast<int>(std::min(kMost, bytes - done)),
                                 root));
      wait();
    }
  }

  [[noreturn]] void end_all(int exit_code) override {
    mpi_.end_all(exit_code);
    std::_Exit(exit_code);
  }

 private:
  void check(int error) const {
    if (error != 0) throw Error(ErrorCode::internal, fmt::format("MPI: {}", mpi_.error_text(error)));
  }

  /// Looks again at once, and then after pauses that become longer: others may need the processor.
  void wait() {
    constexpr int kAtOnce = 200;
    constexpr std::chrono::microseconds kShortest{20}, kLongest{1000};
    auto pause = kShortest;
    for (int looks = 0;; ++looks) {
      int is_done = 0;
      check(mpi_.test(&is_done));
      if (is_done != 0) return;
      exec::throw_if_cancelled();
      if (looks < kAtOnce) continue;
      std::this_thread::sleep_for(pause);
      pause = std::min(2 * pause, kLongest);
    }
  }

  const PointskinMpi& mpi_;
  int rank_ = 0, size_ = 1, rank_on_host_ = 0;
};

}  // namespace

std::unique_ptr<Ranks> ranks_of_launcher() {
  const Launcher* const launched = launcher();
  if (launched == nullptr || *number_in(launched->size) < 2) return nullptr;
  return std::make_unique<MpiRanks>(load(*launched));
}

LaunchedRank launched_rank() noexcept {
  const Launcher* const launched = launcher();
  if (launched == nullptr) return {};
  return {*number_in(launched->rank), *number_in(launched->size)};
}

}  // namespace pointskin
