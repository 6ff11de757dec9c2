#include "io/mapped_file.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <mutex>

namespace pointskin::io {
namespace {

/// What the handler may look at: addresses of whole pages. Free if `end` is 0.
struct Range {
  std::atomic<std::uintptr_t> begin{0}, end{0};
  std::atomic<bool> lost{false};
};
static_assert(std::atomic<std::uintptr_t>::is_always_lock_free, "a signal handler must not take a lock");

constexpr int kMostRanges = 64;
std::array<Range, kMostRanges> ranges;

std::mutex changing;  // guards what follows, and which ranges are free
int used_ranges = 0;
struct sigaction before = {};  // what handled SIGBUS before

Range* range_of(std::uintptr_t address) {
  for (Range& range : ranges)
    if (address < range.end.load() && address >= range.begin.load()) return &range;
  return nullptr;
}

/// Puts zeros where the bytes are missing, from that page to the end, and lets the instruction run again.
bool put_zeros(std::uintptr_t address) {
  Range* const range = range_of(address);
  if (range == nullptr) return false;
  const std::uintptr_t page = address & ~(static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE)) - 1);
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the system tells where it was as a number
  void* const at = reinterpret_cast<void*>(page);
  range->lost.store(true);
  return ::mmap(at, range->end.load() - page, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == at;
}

void handle(int signal, siginfo_t* info, void* /*context*/) {
  const int error = errno;
  const bool is_fault = info->si_code > 0;  // not sent by a process
  if (!is_fault || !put_zeros(reinterpret_cast<std::uintptr_t>(info->si_addr))) {
    ::sigaction(SIGBUS, &before, nullptr);  // a fault comes again, and finds it there
    if (!is_fault) ::raise(signal);
  }
  errno = error;
}

void install() {
  struct sigaction action = {};
  action.sa_sigaction = handle;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGBUS, &action, &before);
}

/// Leaves a handler that came after this one where it is.
void uninstall() {
  struct sigaction now = {};
  ::sigaction(SIGBUS, nullptr, &now);
  if ((now.sa_flags & SA_SIGINFO) != 0 && now.sa_sigaction == handle) ::sigaction(SIGBUS, &before, nullptr);
}

std::uintptr_t end_of_pages(std::uintptr_t end) {
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  return (end + page - 1) / page * page;
}

/// @returns the number of the range, or -1 if none is free
int watch(std::uintptr_t begin, std::uintptr_t end) {
  const std::lock_guard lock(changing);
  for (int i = 0; i < kMostRanges; ++i) {
    Range& range = ranges[static_cast<std::size_t>(i)];
    if (range.end.load() != 0) continue;
    if (used_ranges++ == 0) install();
    range.lost.store(false);
    range.begin.store(begin);
    range.end.store(end_of_pages(end));
    return i;
  }
  return -1;
}

void forget(int slot) {
  const std::lock_guard lock(changing);
  ranges[static_cast<std::size_t>(slot)].end.store(0);
  if (--used_ranges == 0) uninstall();
}

}  // namespace

bool MappedFile::map(int fd, std::size_t size) {
  unmap();
  void* const at = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  if (at == MAP_FAILED) return false;
  const auto begin = reinterpret_cast<std::uintptr_t>(at);
  slot_ = watch(begin, begin + size);
  if (slot_ < 0) return ::munmap(at, size), false;
  begin_ = static_cast<const char*>(at);
  size_ = size;
  return true;
}

bool MappedFile::lost_bytes() const noexcept {
  return slot_ >= 0 && ranges[static_cast<std::size_t>(slot_)].lost.load();
}

void MappedFile::release(std::string_view some) const noexcept {
  if (some.empty()) return;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t begin = static_cast<std::size_t>(some.data() - begin_) / page * page;
  const std::size_t end = std::min(size_, static_cast<std::size_t>(some.data() - begin_) + some.size());
  ::madvise(const_cast<char*>(begin_) + begin, end - begin, MADV_DONTNEED);
}

void MappedFile::unmap() noexcept {
  if (slot_ < 0) return;
  forget(slot_);
  ::munmap(const_cast<char*>(begin_), size_);
  begin_ = nullptr;
  size_ = 0;
  slot_ = -1;
}

}  // namespace pointskin::io
