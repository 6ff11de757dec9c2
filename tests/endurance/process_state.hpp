// What this process holds of the system: memory, open files, threads.
#pragma once

#include <gtest/gtest.h>

#include <malloc.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <ostream>
#include <sstream>
#include <string>
#include <thread>

namespace pointskin::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kOwnMalloc = false;  // the sanitizer's, which keeps what is freed
#else
constexpr bool kOwnMalloc = true;
#endif

struct ProcessState {
  std::int64_t resident_bytes = 0;   ///< in memory, of all that is mapped
  std::int64_t allocated_bytes = 0;  ///< by malloc and not freed
  std::int64_t descriptors = 0;
  std::int64_t threads = 0;
};

inline std::int64_t entries_of(const char* folder) {
  return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}

inline ProcessState process_state() {
  if (kOwnMalloc) ::malloc_trim(0);
  ProcessState state;
  std::int64_t mapped_pages = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> mapped_pages >> resident_pages;
  state.resident_bytes = resident_pages * ::sysconf(_SC_PAGESIZE);
  const struct mallinfo2 blocks = ::mallinfo2();
  state.allocated_bytes = static_cast<std::int64_t>(blocks.uordblks + blocks.hblkhd);
  state.descriptors = entries_of("/proc/self/fd");
  state.threads = entries_of("/proc/self/task");
  return state;
}

inline std::ostream& operator<<(std::ostream& out, const ProcessState& state) {
  return out << state.resident_bytes << " bytes resident, " << state.allocated_bytes << " allocated, "
             << state.descriptors << " descriptors, " << state.threads << " threads";
}

/// The system's record of every thread of this process, a line each.
inline std::string threads_of_process() {
  std::ostringstream out;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task"))
    out << std::ifstream(thread.path() / "stat").rdbuf() << "  in system call "
        << std::ifstream(thread.path() / "syscall").rdbuf();
  return out.str();
}

/// Threads once those that are ending have gone: the system lists a thread for a moment longer than join() waits for it.
inline std::int64_t settled_threads(std::int64_t expected) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  std::int64_t threads = entries_of("/proc/self/task");
  while (threads > expected && std::chrono::steady_clock::now() < give_up) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    threads = entries_of("/proc/self/task");
  }
  return threads;
}

/// Nothing has grown, but for what threads of the pool keep to themselves, and pages that blocks lie across.
inline void expect_no_growth(const ProcessState& before, const ProcessState& after) {
  std::cout << "before: " << before << "\nafter:  " << after << "\n";
  EXPECT_LE(after.descriptors, before.descriptors);
  EXPECT_LE(settled_threads(before.threads), before.threads) << threads_of_process();
  if (!kOwnMalloc) return;
  EXPECT_LE(after.allocated_bytes, before.allocated_bytes + (std::int64_t{64} << 10));
  EXPECT_LE(after.resident_bytes, before.resident_bytes + (std::int64_t{2} << 20));
}

}  // namespace pointskin::test
