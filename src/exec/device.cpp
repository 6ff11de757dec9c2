#include <pointskin/device.hpp>
#include <pointskin/error.hpp>
#include <pointskin/workspace.hpp>

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <fstream>
#include <memory>

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
  return {DeviceKind::cpu, 0, threads};
}

Device Device::cuda(int index) {
  if (!built_with_cuda())
    throw Error(ErrorCode::device_unavailable,
                "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON or choose the CPU");
  if (index < 0 || index >= gpu_count())
    throw Error(ErrorCode::device_unavailable, fmt::format("no GPU number {} answers; choose the CPU instead", index));
  return {DeviceKind::cuda, index, 0};
}

Device Device::automatic(int threads) {
  if (built_with_cuda() && gpu_count() > 0) return {DeviceKind::cuda, 0, threads};
  return {DeviceKind::cpu, 0, threads > 0 ? threads : 0};
}

Device Device::parse(const std::string& text, int threads) {
  if (text == "auto") return automatic(threads);
  if (text == "cpu") return cpu(threads);
  if (text == "cuda") return cuda(0);
  if (text.starts_with("cuda:")) {
    int index = -1;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + 5, end, index);
    if (error == std::errc() && stop == end && index >= 0) return cuda(index);
  }
  throw Error(ErrorCode::usage, fmt::format("unknown device \"{}\"; choose auto, cpu, cuda or cuda:N", text));
}

std::string Device::name() const {
  if (kind == DeviceKind::cuda) return gpu_name(index);
  const int count = threads > 0 ? threads : exec::Cpu().threads();
  return fmt::format("CPU, {} thread{}", count, count == 1 ? "" : "s");
}

std::int64_t Device::available_bytes() const {
  if (kind == DeviceKind::cuda) return gpu_free_bytes(index);
  return available_host_bytes();
}

namespace exec {

AnySpace::AnySpace(const Device& device) {
  if (device.kind == DeviceKind::cpu) {
    space_ = std::make_shared<Cpu>(device.threads);
    return;
  }
#ifdef POINTSKIN_HAS_CUDA
  space_ = std::make_shared<Cuda>(device.index);
#else
  (void)Device::cuda(device.index);  // throws: says why there is none
#endif
}

AnySpace::AnySpace(const Device& device, [[maybe_unused]] void* stream) {
  if (device.kind == DeviceKind::cpu) throw Error(ErrorCode::usage, "the CPU has no streams; choose a GPU");
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
