// Work in forked processes.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

namespace pointskin::test {

/// True if every thread of this process but the calling one sleeps. Those of oneTBB look for work for a while after the
/// last of it, longer where others want the processors, and take locks on their way to sleep.
inline bool others_sleep() {
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    if (task.path().filename() == std::to_string(::gettid())) continue;
    std::ifstream file(task.path() / "stat");
    std::string line;
    std::getline(file, line);
    const std::size_t name_ends = line.rfind(')');
    if (name_ends != std::string::npos && line.size() > name_ends + 2 && line[name_ends + 2] != 'S') return false;
  }
  return true;
}

/// Waits until they have slept for a while: a process must not fork while one of its threads works.
inline void wait_for_others() {
  constexpr int kLooks = 5;
  int asleep = 0;
  for (int look = 0; look < 5000 && asleep < kLooks; ++look) {
    asleep = others_sleep() ? asleep + 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Does `work` in a forked child, once all other threads sleep. @returns how it ended: "well", "wrong", "hung", or by which signal
inline std::string end_of_child(const std::function<bool()>& work) {
  wait_for_others();
  const ::pid_t child = ::fork();
  if (child < 0) return "no child";
  if (child == 0) {
    bool well = false;
    try {
      well = work();
    } catch (...) {
    }
    ::_exit(well ? 0 : 1);
  }
  constexpr std::chrono::seconds kPatience(60);
  int status = 0;
  const auto patience_ends = std::chrono::steady_clock::now() + kPatience;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > patience_ends) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      return "hung";
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? "well" : "wrong";
}

}  // namespace pointskin::test
