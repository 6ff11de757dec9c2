#include <pointskin/device.hpp>
#include <pointskin/error.hpp>
#include <pointskin/workspace.hpp>

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <memory>
#include <numeric>
#include <sstream>

#include "core/format.hpp"
#include "exec/any_space.hpp"

namespace pointskin {
namespace {

#ifdef POINTSKIN_HAS_CUDA
int gpu_count() { return exec::cuda_device_count(); }
std::string gpu_name(int index) { return exec::cuda_device_name(index); }
std::int64_t gpu_free_bytes(int index) { return exec::cuda_free_bytes(index); }
#else
int gpu_count() { return 0; }
std::string gpu_name(int /*index*/) { return "GPU"; }
std::int64_t gpu_free_bytes(int /*index*/) { return 0; }
#endif

/// What the kernel would give to new programs without swapping; free pages alone leave out its caches.
std::int64_t available_host_bytes() {
  std::ifstream info("/proc/meminfo");
  std::string name;
  std::int64_t kibibytes = 0;
  std::string unit;
  while (info >> name >> kibibytes) {
    if (name == "MemAvailable:") return 1024 * kibibytes;
    std::getline(info, unit);
  }
  return static_cast<std::int64_t>(sysconf(_SC_AVPHYS_PAGES)) * sysconf(_SC_PAGESIZE);
}

/// As Device::cuda(std::vector) needs them: without any, GPU 0, which tells why there is none.
std::vector<int> all_gpus() {
  std::vector<int> gpus(static_cast<std::size_t>(std::max(1, gpu_count())));
  std::iota(gpus.begin(), gpus.end(), 0);
  return gpus;
}

/// The numbers of "0,2"; none if it is something else.
std::vector<int> parse_gpus(const std::string& text) {
  std::vector<int> gpus;
  std::istringstream in(text + ",");
  for (std::string part; std::getline(in, part, ',');) {
    int gpu = -1;
    const char* end = part.data() + part.size();
    const auto [stop, error] = std::from_chars(part.data(), end, gpu);
    if (error != std::errc() || stop != end || gpu < 0) return {};
    gpus.push_back(gpu);
  }
  return gpus;
}

}  // namespace

bool built_with_cuda() noexcept {
#ifdef POINTSKIN_HAS_CUDA
  return true;
#else
  return false;
#endif
}

Device Device::cpu(int threads) {
  if (threads < 0) throw Error(ErrorCode::usage, "the number of threads must not be negative");
  return {DeviceKind::cpu, 0, threads, {}};
}

Device Device::cuda(int index) {
  if (!built_with_cuda())
    throw Error(ErrorCode::device_unavailable,
                "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON or choose the CPU");
  if (index < 0 || index >= gpu_count())
    throw Error(ErrorCode::device_unavailable, fmt::format("no GPU number {} answers; choose the CPU instead", index));
  return {DeviceKind::cuda, index, 0, {}};
}

Device Device::cuda(const std::vector<int>& gpus) {
  if (gpus.empty()) throw Error(ErrorCode::usage, "a device needs at least one GPU");
  for (std::size_t i = 0; i < gpus.size(); ++i)
    if (std::find(gpus.begin(), gpus.begin() + static_cast<std::ptrdiff_t>(i), gpus[i]) !=
        gpus.begin() + static_cast<std::ptrdiff_t>(i))
      throw Error(ErrorCode::usage, fmt::format("GPU {} is named twice", gpus[i]));
  for (const int gpu : gpus) (void)cuda(gpu);  // throws: says why there is none
  Device device = cuda(gpus.front());
  device.further.assign(gpus.begin() + 1, gpus.end());
  return device;
}

Device Device::automatic(int threads) {
  if (built_with_cuda() && gpu_count() > 0) return {DeviceKind::cuda, 0, threads, {}};
  return {DeviceKind::cpu, 0, threads > 0 ? threads : 0, {}};
}

Device Device::parse(const std::string& text, int threads) {
  if (text == "auto") return automatic(threads);
  if (text == "cpu") return cpu(threads);
  if (text == "cuda") return cuda(0);
  if (text == "cuda:all") return cuda(all_gpus());
  if (text.starts_with("cuda:"))
    if (const std::vector<int> gpus = parse_gpus(text.substr(5)); !gpus.empty()) return cuda(gpus);
  throw Error(ErrorCode::usage,
              fmt::format("unknown device \"{}\"; choose auto, cpu, cuda, cuda:N, cuda:N,M or cuda:all", text));
}

std::vector<int> Device::gpus() const {
  std::vector<int> all;
  if (kind == DeviceKind::cpu) return all;
  all.push_back(index);
  all.insert(all.end(), further.begin(), further.end());
  return all;
}

std::string Device::text() const {
  return kind == DeviceKind::cpu ? "cpu" : fmt::format("cuda:{}", fmt::join(gpus(), ","));
}

std::string Device::name() const {
  if (kind == DeviceKind::cuda) {
    std::vector<std::string> names;
    for (const int gpu : gpus()) names.push_back(gpu_name(gpu));
    if (names.size() == 1) return names.front();
    const bool alike =
        std::all_of(names.begin(), names.end(), [&](const std::string& n) { return n == names.front(); });
    return alike ? fmt::format("{} x {}", names.size(), names.front()) : fmt::format("{}", fmt::join(names, " + "));
  }
  const int count = threads > 0 ? threads : exec::Cpu().threads();
  return fmt::format("CPU, {} thread{}", count, count == 1 ? "" : "s");
}

std::int64_t Device::available_bytes() const {
  if (kind == DeviceKind::cuda) {
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (const int gpu : gpus()) least = std::min(least, gpu_free_bytes(gpu));
    return least * static_cast<std::int64_t>(1 + further.size());
  }
  return available_host_bytes();
}

namespace exec {

bool can_work_together([[maybe_unused]] const Device& device) {
#ifdef POINTSKIN_HAS_CUDA
  return gpus::work_together(device.gpus());
#else
  return true;
#endif
}

AnySpace::AnySpace(const Device& device) {
  if (device.kind == DeviceKind::cpu) {
    space_ = std::make_shared<Cpu>(device.threads);
    return;
  }
#ifdef POINTSKIN_HAS_CUDA
  space_ = std::make_shared<Cuda>(device.gpus());
#else
  (void)Device::cuda(device.index);  // throws: says why there is none
#endif
}

AnySpace::AnySpace(const Device& device, [[maybe_unused]] void* stream) {
  if (device.kind == DeviceKind::cpu) throw Error(ErrorCode::usage, "the CPU has no streams; choose a GPU");
  if (!device.further.empty()) throw Error(ErrorCode::usage, "a stream belongs to one GPU; choose one");
#ifdef POINTSKIN_HAS_CUDA
  space_ = std::make_shared<Cuda>(device.index, stream);
#else
  (void)Device::cuda(device.index);  // throws: says why there is none
#endif
}

}  // namespace exec

Workspace::Workspace(const Device& device)
    : data_(std::make_shared<detail::WorkspaceData>(detail::WorkspaceData{device, exec::AnySpace(device)})) {}
Workspace::Workspace(const Device& device, void* cuda_stream)
    : data_(
          std::make_shared<detail::WorkspaceData>(detail::WorkspaceData{device, exec::AnySpace(device, cuda_stream)})) {
}

const Device& Workspace::device() const { return data_->device; }
void* Workspace::stream() const {
  return exec::visit(data_->space, [](auto& ex) { return ex.stream(); });
}
void Workspace::synchronize() const {
  exec::visit(data_->space, [](auto& ex) { ex.synchronize(); });
}
void Workspace::release_memory() const {
  exec::visit(data_->space, [](auto& ex) { ex.pool()->trim(); });
}
void Workspace::limit_memory(std::int64_t bytes) const {
  if (bytes < 0) throw Error(ErrorCode::usage, "a limit of memory must not be negative");
  data_->space.pool()->set_lasting_limit(bytes);
}
std::int64_t Workspace::held_bytes() const { return data_->space.pool()->held_bytes(); }

}  // namespace pointskin
