// Kinds of calls that the preloaded library counts and makes fail; shim.cpp says how it is told to.
#pragma once

namespace faults {

/// Calls into the C library, and, from kDeviceAlloc on, into the driver of a GPU.
enum Kind {
  kAlloc,
  kMap,
  kThread,
  kOpen,
  kRead,
  kWrite,
  kSync,
  kRename,
  kClose,
  kStat,
  kMode,
  kDeviceAlloc,
  kPinned,
  kLaunch,
  kCopy,
  kWait,
  kKinds
};

/// Counts a call. @returns true, with errno set to error(), if it is to fail
bool fails(Kind kind);

/// What a call that fails ends with.
int error();

}  // namespace faults
