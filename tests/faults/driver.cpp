// Calls into the driver of an NVIDIA GPU, counted and made to fail like those into the C library in shim.cpp.
//
// The CUDA runtime, linked into the program, finds the driver's functions with dlsym(), at first the one that finds all
// others. Both are stood in for here. No header of CUDA is needed: arguments are passed on as they come.
#include <dlfcn.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "calls.hpp"

namespace {

using namespace faults;
using Address = unsigned long long;  ///< CUdeviceptr

struct Function {
  const char* name;
  Kind kind;
  void* ours;
  void* drivers;  ///< as last found
};
extern Function functions[];

template <int kFunction, class... Arguments>
int call(Arguments... arguments) {
  const Function& function = functions[kFunction];
  if (fails(function.kind)) return error();
  return reinterpret_cast<int (*)(Arguments...)>(function.drivers)(arguments...);
}

template <int kFunction, class... Arguments>
void* ours() {
  return reinterpret_cast<void*>(&call<kFunction, Arguments...>);
}

using Size = std::size_t;
using Pointer = void*;
using Number = unsigned int;

Function functions[] = {
    {"cuMemAlloc", kDeviceAlloc, ours<0, Pointer, Size>(), nullptr},
    {"cuMemAllocAsync", kDeviceAlloc, ours<1, Pointer, Size, Pointer>(), nullptr},
    {"cuMemAllocFromPoolAsync", kDeviceAlloc, ours<2, Pointer, Size, Pointer, Pointer>(), nullptr},
    {"cuMemAllocHost", kPinned, ours<3, Pointer, Size>(), nullptr},
    {"cuMemHostAlloc", kPinned, ours<4, Pointer, Size, Number>(), nullptr},
    {"cuLaunchKernel", kLaunch,
     ours<5, Pointer, Number, Number, Number, Number, Number, Number, Number, Pointer, Pointer, Pointer>(), nullptr},
    {"cuLaunchKernelEx", kLaunch, ours<6, Pointer, Pointer, Pointer, Pointer>(), nullptr},
    {"cuMemcpyAsync", kCopy, ours<7, Address, Address, Size, Pointer>(), nullptr},
    {"cuMemcpyHtoDAsync", kCopy, ours<8, Address, Pointer, Size, Pointer>(), nullptr},
    {"cuMemcpyDtoHAsync", kCopy, ours<9, Pointer, Address, Size, Pointer>(), nullptr},
    {"cuMemcpyDtoDAsync", kCopy, ours<10, Address, Address, Size, Pointer>(), nullptr},
    {"cuMemcpy", kCopy, ours<11, Address, Address, Size>(), nullptr},
    {"cuMemcpyHtoD", kCopy, ours<12, Address, Pointer, Size>(), nullptr},
    {"cuMemcpyDtoH", kCopy, ours<13, Pointer, Address, Size>(), nullptr},
    {"cuMemsetD8Async", kCopy, ours<14, Address, unsigned char, Size, Pointer>(), nullptr},
    {"cuMemsetD32Async", kCopy, ours<15, Address, Number, Size, Pointer>(), nullptr},
    {"cuStreamSynchronize", kWait, ours<16, Pointer>(), nullptr},
    {"cuEventSynchronize", kWait, ours<17, Pointer>(), nullptr},
};

/// Version of the oldest symbols of glibc on this processor, which dlvsym() finds in every later one.
#ifdef __x86_64__
constexpr char kFirstGlibc[] = "GLIBC_2.2.5";
#else
constexpr char kFirstGlibc[] = "GLIBC_2.17";
#endif

using Find = int (*)(const char* name, void** function, int version, std::uint64_t flags, void* status);
Find drivers_find = nullptr;

/// The driver's cuGetProcAddress, which gives our functions in place of its own.
int find(const char* name, void** to, int version, std::uint64_t flags, void* status) {
  const int result = drivers_find(name, to, version, flags, status);
  if (result != 0 || to == nullptr || *to == nullptr) return result;
  if (std::strcmp(name, "cuGetProcAddress") == 0) {
    drivers_find = reinterpret_cast<Find>(*to);
    *to = reinterpret_cast<void*>(&find);
  }
  for (Function& function : functions)
    if (std::strcmp(name, function.name) == 0) {
      function.drivers = *to;
      *to = function.ours;
    }
  return result;
}

}  // namespace

extern "C" void* dlsym(void* handle, const char* name) noexcept {
  using True = void* (*)(void*, const char*);
  static const auto real = reinterpret_cast<True>(dlvsym(RTLD_NEXT, "dlsym", kFirstGlibc));
  void* const found = real(handle, name);
  if (found == nullptr || std::strncmp(name, "cuGetProcAddress", std::strlen("cuGetProcAddress")) != 0) return found;
  drivers_find = reinterpret_cast<Find>(found);
  return reinterpret_cast<void*>(&find);
}
