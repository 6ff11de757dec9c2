// A library to be preloaded (LD_PRELOAD) that counts the program's calls into the C library by kind and makes some fail.
//
//   FAULT_STATE  file of 8 bytes a kind, and 16 more: the counts, how many calls were made to fail, and whether SIGTERM
//                has a handler yet. It is mapped, so that the numbers outlive a killed process. Nothing is counted
//                without it.
//   FAULT_KIND   kind of call that fails, a name of kKinds; none if absent
//   FAULT_AT     number of the first call that fails, from 1
//   FAULT_MODE   once (default), from (that call and all that follow), short (reads and writes from that call on move
//                half of what was asked for, which is no error) or truncate (before that call, which succeeds, FAULT_FILE
//                loses half of its bytes)
//   FAULT_FILE   for truncate
//   FAULT_ERRNO  number of the error; by default what suits the kind
//
// Calls count from the beginning of main(), in all threads. What the C library calls itself, as fwrite() does write(), is
// not seen, and writes to stderr are left alone: what the program says is judged. Child processes start without it.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "calls.hpp"

namespace {

using namespace faults;

struct KindInfo {
  const char* name;
  int error;
};

/// Errors of the driver are a CUresult: out of memory, out of resources for a launch, unspecified launch failure.
constexpr KindInfo kKindInfos[kKinds] = {{"alloc", ENOMEM}, {"map", ENOMEM},   {"thread", EAGAIN}, {"open", EACCES},
                                         {"read", EIO},     {"write", ENOSPC}, {"sync", EIO},      {"rename", EIO},
                                         {"close", EIO},    {"stat", EACCES},  {"mode", EPERM},    {"device-alloc", 2},
                                         {"pinned", 2},     {"launch", 701},   {"copy", 719},      {"wait", 719}};

enum class Mode { once, from, shorten, truncate };

using Counter = std::atomic<std::uint64_t>;

struct State {
  Counter counts[kKinds];
  Counter failed;
  Counter has_handler;
};
static_assert(Counter::is_always_lock_free && sizeof(State) == 8 * (kKinds + 2));

State* state = nullptr;  ///< null until main() begins
int bad_kind = -1;
std::uint64_t bad_call = 0;
Mode mode = Mode::once;
int error_number = 0;
const char* cut_file = nullptr;

/// The function of that name which the program would have called without this library.
template <class F>
F* next(F* /*type*/, const char* name) {
  return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

void cut() {
  struct stat status {};
  if (cut_file == nullptr || next(&::lstat, "lstat")(cut_file, &status) != 0 ||
      truncate(cut_file, status.st_size / 2) != 0)
    _exit(99);
}

/// Counts a call. @returns true if it is to fail, or to be shortened
bool hits(Kind kind) {
  State* const counted = state;
  if (counted == nullptr) return false;
  const std::uint64_t call = ++counted->counts[kind];
  if (kind != bad_kind) return false;
  const bool hit = mode == Mode::from || mode == Mode::shorten ? call >= bad_call : call == bad_call;
  if (hit) ++counted->failed;
  if (hit && mode == Mode::truncate) cut();
  return hit && mode != Mode::truncate;
}

/// As fails(), and makes the call a short one in that mode.
bool fails_or_shortens(Kind kind, std::size_t& size) {
  if (!hits(kind)) return false;
  if (mode == Mode::shorten) {
    if (size > 1) size /= 2;
    return false;
  }
  errno = error_number;
  return true;
}

void begin() {
  const char* const file = std::getenv("FAULT_STATE");
  if (file == nullptr) return;
  const int fd = next(&::open, "open")(file, O_RDWR | O_CLOEXEC);
  if (fd < 0) return;
  void* const at = next(&::mmap, "mmap")(nullptr, sizeof(State), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  next(&::close, "close")(fd);
  if (at == MAP_FAILED) return;
  if (const char* const kind = std::getenv("FAULT_KIND"))
    for (int k = 0; k < kKinds; ++k)
      if (std::strcmp(kind, kKindInfos[k].name) == 0) bad_kind = k;
  if (const char* const call = std::getenv("FAULT_AT")) bad_call = std::strtoull(call, nullptr, 10);
  if (const char* const word = std::getenv("FAULT_MODE")) {
    if (std::strcmp(word, "from") == 0) mode = Mode::from;
    if (std::strcmp(word, "short") == 0) mode = Mode::shorten;
    if (std::strcmp(word, "truncate") == 0) mode = Mode::truncate;
  }
  cut_file = std::getenv("FAULT_FILE");
  const char* const error = std::getenv("FAULT_ERRNO");
  if (bad_kind >= 0) error_number = error == nullptr ? kKindInfos[bad_kind].error : std::atoi(error);
  state = static_cast<State*>(at);
}

using Main = int (*)(int, char**, char**);
Main true_main = nullptr;

int my_main(int argc, char** argv, char** environment) {
  unsetenv("LD_PRELOAD");
  begin();
  return true_main(argc, argv, environment);
}

/// The third argument of open() is there only with flags that create a file.
bool has_mode(int flags) { return (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE; }

}  // namespace

bool faults::fails(Kind kind) {
  if (!hits(kind) || mode == Mode::shorten) return false;
  errno = error_number;
  return true;
}

int faults::error() { return error_number; }

extern "C" {

// glibc's own names of what it exports, so that nothing of it need go through dlsym(), which allocates.
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(), void (*rtld_fini)(),
                      void* end) {
  using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  true_main = main;
  return reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"))(my_main, argc, argv, init, fini, rtld_fini,
                                                                        end);
}

void* malloc(std::size_t size) { return fails(kAlloc) ? nullptr : __libc_malloc(size); }

void* calloc(std::size_t count, std::size_t size) { return fails(kAlloc) ? nullptr : __libc_calloc(count, size); }

void* realloc(void* at, std::size_t size) { return fails(kAlloc) ? nullptr : __libc_realloc(at, size); }

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return fails(kAlloc) ? nullptr : __libc_memalign(alignment, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  return fails(kAlloc) ? nullptr : __libc_memalign(alignment, size);
}

int posix_memalign(void** to, std::size_t alignment, std::size_t size) {
  if (fails(kAlloc)) return error_number;
  void* const at = __libc_memalign(alignment, size);
  if (at == nullptr) return ENOMEM;
  *to = at;
  return 0;
}

void* mmap(void* at, std::size_t size, int protection, int flags, int fd, off_t offset) {
  static auto* const real = next(&::mmap, "mmap");
  return fails(kMap) ? MAP_FAILED : real(at, size, protection, flags, fd, offset);
}

void* mmap64(void* at, std::size_t size, int protection, int flags, int fd, off64_t offset) {
  return mmap(at, size, protection, flags, fd, offset);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*), void* argument) {
  static auto* const real = next(&::pthread_create, "pthread_create");
  return fails(kThread) ? error_number : real(thread, attributes, run, argument);
}

int open(const char* path, int flags, ...) {
  static auto* const real = next(&::open, "open");
  mode_t permissions = 0;
  if (has_mode(flags)) {
    va_list rest;
    va_start(rest, flags);
    permissions = va_arg(rest, mode_t);
    va_end(rest);
  }
  return fails(kOpen) ? -1 : real(path, flags, permissions);
}

int open64(const char* path, int flags, ...) {
  mode_t permissions = 0;
  if (has_mode(flags)) {
    va_list rest;
    va_start(rest, flags);
    permissions = va_arg(rest, mode_t);
    va_end(rest);
  }
  return open(path, flags, permissions);
}

int openat(int folder, const char* path, int flags, ...) {
  static auto* const real = next(&::openat, "openat");
  mode_t permissions = 0;
  if (has_mode(flags)) {
    va_list rest;
    va_start(rest, flags);
    permissions = va_arg(rest, mode_t);
    va_end(rest);
  }
  return fails(kOpen) ? -1 : real(folder, path, flags, permissions);
}

int openat64(int folder, const char* path, int flags, ...) {
  mode_t permissions = 0;
  if (has_mode(flags)) {
    va_list rest;
    va_start(rest, flags);
    permissions = va_arg(rest, mode_t);
    va_end(rest);
  }
  return openat(folder, path, flags, permissions);
}

FILE* fopen(const char* path, const char* how) {
  static auto* const real = next(&::fopen, "fopen");
  return fails(kOpen) ? nullptr : real(path, how);
}

FILE* fopen64(const char* path, const char* how) { return fopen(path, how); }

int mkostemp(char* name, int flags) {
  static auto* const real = next(&::mkostemp, "mkostemp");
  return fails(kOpen) ? -1 : real(name, flags);
}

int mkstemp(char* name) { return mkostemp(name, 0); }

ssize_t read(int fd, void* to, std::size_t size) {
  static auto* const real = next(&::read, "read");
  return fails_or_shortens(kRead, size) ? -1 : real(fd, to, size);
}

ssize_t pread(int fd, void* to, std::size_t size, off_t place) {
  static auto* const real = next(&::pread, "pread");
  return fails_or_shortens(kRead, size) ? -1 : real(fd, to, size, place);
}

ssize_t pread64(int fd, void* to, std::size_t size, off64_t place) { return pread(fd, to, size, place); }

ssize_t write(int fd, const void* from, std::size_t size) {
  static auto* const real = next(&::write, "write");
  return fd != STDERR_FILENO && fails_or_shortens(kWrite, size) ? -1 : real(fd, from, size);
}

ssize_t pwrite(int fd, const void* from, std::size_t size, off_t place) {
  static auto* const real = next(&::pwrite, "pwrite");
  return fails_or_shortens(kWrite, size) ? -1 : real(fd, from, size, place);
}

ssize_t pwrite64(int fd, const void* from, std::size_t size, off64_t place) { return pwrite(fd, from, size, place); }

ssize_t writev(int fd, const iovec* parts, int count) {
  static auto* const real = next(&::writev, "writev");
  return fd != STDERR_FILENO && fails(kWrite) ? -1 : real(fd, parts, count);
}

std::size_t fwrite(const void* from, std::size_t size, std::size_t count, FILE* file) {
  static auto* const real = next(&::fwrite, "fwrite");
  return file != stderr && fails(kWrite) ? 0 : real(from, size, count, file);
}

/// Not made to fail; tells when signals begin to be handled.
int sigaction(int signal, const struct sigaction* action, struct sigaction* old) {
  static auto* const real =
      reinterpret_cast<int (*)(int, const struct sigaction*, struct sigaction*)>(dlsym(RTLD_NEXT, "sigaction"));
  const int result = real(signal, action, old);
  if (signal == SIGTERM && state != nullptr) state->has_handler = 1;
  return result;
}

int fsync(int fd) {
  static auto* const real = next(&::fsync, "fsync");
  return fails(kSync) ? -1 : real(fd);
}

int fdatasync(int fd) {
  static auto* const real = next(&::fdatasync, "fdatasync");
  return fails(kSync) ? -1 : real(fd);
}

int rename(const char* from, const char* to) {
  static auto* const real = next(&::rename, "rename");
  return fails(kRename) ? -1 : real(from, to);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  static auto* const real = next(&::renameat, "renameat");
  return fails(kRename) ? -1 : real(from_folder, from, to_folder, to);
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  static auto* const real = next(&::linkat, "linkat");
  return fails(kRename) ? -1 : real(from_folder, from, to_folder, to, flags);
}

/// Closes in any case, as Linux does.
int close(int fd) {
  static auto* const real = next(&::close, "close");
  if (!fails(kClose)) return real(fd);
  const int error = errno;
  real(fd);
  errno = error;
  return -1;
}

int stat(const char* path, struct stat* to) {
  static auto* const real = reinterpret_cast<int (*)(const char*, struct stat*)>(dlsym(RTLD_NEXT, "stat"));
  return fails(kStat) ? -1 : real(path, to);
}

int lstat(const char* path, struct stat* to) {
  static auto* const real = next(&::lstat, "lstat");
  return fails(kStat) ? -1 : real(path, to);
}

int fstat(int fd, struct stat* to) {
  static auto* const real = next(&::fstat, "fstat");
  return fails(kStat) ? -1 : real(fd, to);
}

int fchmod(int fd, mode_t permissions) {
  static auto* const real = next(&::fchmod, "fchmod");
  return fails(kMode) ? -1 : real(fd, permissions);
}

int ftruncate(int fd, off_t size) {
  static auto* const real = next(&::ftruncate, "ftruncate");
  return fails(kMode) ? -1 : real(fd, size);
}

}  // extern "C"
