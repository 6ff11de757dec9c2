#include <cstdint>
#include <memory>

#include "c/convert.hpp"

using namespace pointskin::c;
using pointskin::Device;
using pointskin::DeviceKind;
using pointskin::Workspace;

namespace {

void create(psk_workspace** out, const Workspace& workspace) {
  required(out, "workspace") = new psk_workspace{workspace, workspace.device().name()};
}

}  // namespace

#define PSK_STRING_OF(x) #x
#define PSK_STRING(x) PSK_STRING_OF(x)
const char* psk_version(void) {
  return PSK_STRING(PSK_VERSION_MAJOR) "." PSK_STRING(PSK_VERSION_MINOR) "." PSK_STRING(PSK_VERSION_PATCH);
}

int32_t psk_c_abi(void) { return PSK_C_ABI; }

int32_t psk_built_with_cuda(void) { return pointskin::built_with_cuda() ? 1 : 0; }

psk_code psk_workspace_create(const char* device, int32_t threads, psk_workspace** workspace, psk_error* error) {
  return guarded(error,
                 [&] { create(workspace, Workspace(Device::parse(device == nullptr ? "auto" : device, threads))); });
}

psk_code psk_workspace_create_on_stream(int32_t gpu, void* cuda_stream, psk_workspace** workspace, psk_error* error) {
  return guarded(error, [&] { create(workspace, Workspace(Device::cuda(gpu), cuda_stream)); });
}

void psk_workspace_free(psk_workspace* workspace) { delete workspace; }

int32_t psk_workspace_gpu(const psk_workspace* workspace) {
  if (workspace == nullptr) return -1;
  const Device& device = workspace->workspace.device();
  return device.kind == DeviceKind::cuda ? device.index : -1;
}

const char* psk_workspace_device_name(const psk_workspace* workspace) {
  return workspace == nullptr ? "" : workspace->device_name.c_str();
}

void* psk_workspace_stream(const psk_workspace* workspace) {
  return workspace == nullptr ? nullptr : workspace->workspace.stream();
}

int64_t psk_workspace_available_bytes(const psk_workspace* workspace) {
  std::int64_t bytes = 0;
  if (workspace != nullptr) guarded(nullptr, [&] { bytes = workspace->workspace.device().available_bytes(); });
  return bytes;
}

int64_t psk_workspace_held_bytes(const psk_workspace* workspace) {
  std::int64_t bytes = 0;
  if (workspace != nullptr) guarded(nullptr, [&] { bytes = workspace->workspace.held_bytes(); });
  return bytes;
}

psk_code psk_workspace_synchronize(psk_workspace* workspace, psk_error* error) {
  return guarded(error, [&] { required(workspace, "workspace").workspace.synchronize(); });
}

void psk_workspace_release_memory(psk_workspace* workspace) {
  if (workspace != nullptr) guarded(nullptr, [&] { workspace->workspace.release_memory(); });
}
