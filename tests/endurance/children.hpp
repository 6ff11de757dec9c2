// Work in forked processes.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <thread>

namespace pointskin::test {

/// Does `work` in a forked child. @returns how it ended: "well", "wrong", "hung", or by which signal
inline std::string end_of_child(const std::function<bool()>& work) {
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
