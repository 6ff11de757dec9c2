#include "run_memory.hpp"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <string_view>

#include <fmt/format.h>

#include "console.hpp"

namespace pointskin::cli {
namespace {

/// A line of /proc/self/status, in bytes; 0 if there is none.
std::int64_t status_bytes(std::string_view name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::int64_t kibibytes = 0;
    if (word == name && status >> kibibytes) return kibibytes * 1024;
  }
  return 0;
}

/// Pages of the program, of its threads and of small blocks that the work touches first: 4.2 to 5.2 MiB measured.
constexpr std::int64_t kTouchedByWork = std::int64_t{5} << 20;

/// And of what looks for problems in the mesh: 1.2 to 1.5 MiB measured.
constexpr std::int64_t kTouchedByProblems = std::int64_t{3} << 19;

/// By how much the size of a process differs from run to run, however small it is.
constexpr std::int64_t kPagesThatComeAndGo = std::int64_t{1} << 20;

/// What measuring distances to an envelope takes beside its mesh.
std::int64_t bytes_around(const Mesh& envelope) {
  constexpr std::int64_t kTriangle = 76 + 16 + 36 + 72;  // tree, its nodes, normal and neighbours; while it is made
  constexpr std::int64_t kVertex = 24;                   // its normal
  return kTriangle * static_cast<std::int64_t>(envelope.triangles.size()) +
         kVertex * static_cast<std::int64_t>(envelope.vertices.size());
}

[[noreturn]] void refuse(const std::string& what, std::int64_t limit) {
  throw Error(ErrorCode::over_limit, fmt::format("{} is above --max-memory {}; use a smaller --depth or allow more",
                                                 what, format_bytes(static_cast<double>(limit))));
}

}  // namespace

std::int64_t process_bytes() { return status_bytes("VmRSS:"); }

std::int64_t host_peak_bytes() {
  if (const std::int64_t peak = status_bytes("VmHWM:"); peak > 0) return peak;
  struct rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

std::int64_t MemoryEstimate::total() const { return std::max(buffers + beside, so_far); }

RunMemory::RunMemory(const Device& device, const Options& options, std::int64_t limit)
    : device_(device), limit_(limit) {
  if (device_.kind != DeviceKind::cpu) return;
#ifdef __GLIBC__
  malloc_trim(0);  // what reading left behind
#endif
  beside_ = process_bytes() + kTouchedByWork;
  if (options.weakness) beside_ += kTouchedByProblems;
  if (options.envelope) beside_ += bytes_around(*options.envelope);
}

std::int64_t RunMemory::so_far() const { return device_.kind == DeviceKind::cpu ? host_peak_bytes() : 0; }

std::int64_t RunMemory::most() const { return limit_ + std::max(limit_ / 50, kPagesThatComeAndGo); }

void RunMemory::check(const Cloud& cloud) const {
  if (limit_ == 0) return;
  if (const std::int64_t read = so_far(); read > most())
    refuse(fmt::format("what reading took, {},", bytes_text(read)), limit_);
  const std::int64_t least = beside_ + cloud.size() * static_cast<std::int64_t>(2 * sizeof(Vec3f));
  if (least > most()) refuse(fmt::format("the estimate of {} or more", bytes_text(least)), limit_);
}

MemoryEstimate RunMemory::estimate(const Cloud& cloud, const Options& options) const {
  const std::int64_t peak = so_far();
  Options limited = options;
  limited.max_memory_bytes = device_.kind == DeviceKind::cpu ? limit_of_run() : 0;  // it is counted on the host
  return {within_limit([&] { return estimate_device_bytes(cloud, limited, device_.threads); }), beside_, peak};
}

void RunMemory::check(const MemoryEstimate& estimate) const {
  const std::int64_t needed = estimate.buffers + estimate.beside;
  if (limit_ > 0 && needed > most()) refuse(fmt::format("the estimate of {}", bytes_text(needed)), limit_);
}

std::int64_t RunMemory::limit_of_run() const { return limit_ == 0 ? 0 : std::max<std::int64_t>(1, most() - beside_); }

void RunMemory::limit(const Workspace& workspace) const {
  workspace.limit_memory(limit_ > 0 ? limit_of_run() : workspace.device().available_bytes() / 5 * 4);
}

void RunMemory::throw_named(const Error& error) const {
  const auto text = [](std::int64_t bytes) { return format_bytes(static_cast<double>(bytes)); };
  const std::string beside =
      beside_ > 0 ? fmt::format(", of which the program and the cloud take {}", text(beside_)) : "";
  throw Error(ErrorCode::over_limit, fmt::format("--max-memory {}{}: {}", text(limit_), beside, error.what()));
}

std::int64_t bytes_left_of(std::int64_t limit) {
  return std::max<std::int64_t>(1, limit - process_bytes() - kTouchedByWork);
}

std::string bytes_text(std::int64_t bytes) {
  return fmt::format("{} ({} bytes)", format_bytes(static_cast<double>(bytes)), bytes);
}

}  // namespace pointskin::cli
