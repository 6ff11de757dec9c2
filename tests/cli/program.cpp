#include "cli/program.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace pointskin::test {
namespace {

using Clock = std::chrono::steady_clock;

struct Pipe {
  int read = -1, write = -1;
  Pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe2 failed");
    read = ends[0];
    write = ends[1];
  }
};

void close_end(int& end) {
  if (end >= 0) close(end);
  end = -1;
}

/// Both ends of a pseudo terminal in place of a pipe.
void open_terminal(Pipe& pipe) {
  close_end(pipe.read);
  close_end(pipe.write);
  pipe.read = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (pipe.read < 0 || grantpt(pipe.read) != 0 || unlockpt(pipe.read) != 0) throw std::runtime_error("no terminal");
  std::array<char, 128> name{};
  if (ptsname_r(pipe.read, name.data(), name.size()) != 0) throw std::runtime_error("no terminal");
  pipe.write = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
}

/// A running program and our ends of its pipes.
class Process {
 public:
  explicit Process(const Start& start) : start_(start) {
    if (start.terminal) open_terminal(err_);
    std::vector<std::string> args = start.args;
    args.insert(args.begin(), start.program.empty() ? POINTSKIN_PROGRAM : start.program);
    std::vector<char*> argv;
    for (std::string& arg : args) argv.push_back(arg.data());
    argv.push_back(nullptr);
    id_ = fork();
    if (id_ < 0) throw std::runtime_error("fork failed");
    if (id_ == 0) become_program(argv.data());
    close_end(in_.read);
    close_end(out_.write);
    close_end(err_.write);
    if (start.close_stdout) close_end(out_.read);
    fcntl(in_.write, F_SETFL, O_NONBLOCK);
    if (start.input.empty() && !start.keep_stdin_open) close_end(in_.write);
  }
  ~Process() {
    for (int* end : {&in_.write, &out_.read, &err_.read}) close_end(*end);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  Result wait() {
    while (out_.read >= 0 || err_.read >= 0) {
      step();
      int status = 0;
      // With stdin kept open or stdout closed the pipes tell nothing reliable; the process does.
      if (!reaped_ && waitpid(id_, &status, WNOHANG) == id_) {
        reaped_ = true;
        status_ = status;
      }
    }
    if (!reaped_) waitpid(id_, &status_, 0);
    result_.exit_code = WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
    result_.signal = WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
    result_.seconds = elapsed();
    return std::move(result_);
  }

 private:
  [[noreturn]] void become_program(char** argv) {
    dup2(in_.read, STDIN_FILENO);
    dup2(out_.write, STDOUT_FILENO);
    dup2(err_.write, STDERR_FILENO);
    if (!start_.folder.empty() && chdir(start_.folder.c_str()) != 0) _exit(126);
    for (const std::string& variable : start_.environment) putenv(const_cast<char*>(variable.c_str()));
    std::signal(SIGPIPE, SIG_DFL);
    execv(argv[0], argv);
    _exit(127);
  }

  [[nodiscard]] double elapsed() const { return std::chrono::duration<double>(Clock::now() - started_).count(); }

  [[nodiscard]] bool may_signal() const {
    if (elapsed() * 1000 < static_cast<double>(start_.signal_after.count())) return false;
    if (start_.signal_once_read && !all_read()) return false;
    std::error_code missing;
    const std::string& file = start_.signal_once_written;
    return file.empty() || (std::filesystem::file_size(file, missing) > 0 && !missing);
  }

  [[nodiscard]] bool all_read() const {
    int waiting = 0;
    return sent_ == start_.input.size() && ioctl(in_.write, FIONREAD, &waiting) == 0 && waiting == 0;
  }

  /// Moves bytes for at most 5 ms and sends what is due.
  void step() {
    std::array<pollfd, 3> ends = {pollfd{out_.read, POLLIN, 0}, pollfd{err_.read, POLLIN, 0},
                                  pollfd{sent_ < start_.input.size() ? in_.write : -1, POLLOUT, 0}};
    poll(ends.data(), ends.size(), 5);
    if (ends[0].revents != 0) receive(out_.read, result_.out);
    if (ends[1].revents != 0) receive(err_.read, result_.err);
    if (ends[2].revents != 0) feed();
    if (start_.signal != 0 && !signalled_ && may_signal()) {
      signalled_ = true;
      if (!reaped_) kill(id_, start_.signal);
    }
    if (elapsed() > static_cast<double>(start_.limit.count()) && !result_.timed_out) {
      result_.timed_out = true;
      if (!reaped_) kill(id_, SIGKILL);
    }
  }

  static void receive(int& end, std::string& to) {
    std::array<char, 65536> block;
    const ssize_t count = read(end, block.data(), block.size());
    if (count > 0) {
      to.append(block.data(), static_cast<std::size_t>(count));
    } else if (count == 0 || errno != EINTR) {  // A terminal answers EIO when the other side is gone.
      close_end(end);
    }
  }

  void feed() {
    const ssize_t count = write(in_.write, start_.input.data() + sent_, start_.input.size() - sent_);
    if (count > 0) sent_ += static_cast<std::size_t>(count);
    if (count < 0 && errno != EAGAIN && errno != EINTR) sent_ = start_.input.size();
    if (sent_ == start_.input.size() && !start_.keep_stdin_open) close_end(in_.write);
  }

  const Start& start_;
  Clock::time_point started_ = Clock::now();
  Pipe in_, out_, err_;
  pid_t id_ = -1;
  Result result_;
  std::size_t sent_ = 0;
  bool signalled_ = false, reaped_ = false;
  int status_ = 0;
};

}  // namespace

Result run_program(const Start& start) {
  std::signal(SIGPIPE, SIG_IGN);  // A program that does not read its stdin must not end the test.
  return Process(start).wait();
}

Result run_shell(const std::string& script, const std::string& folder) {
  Start start;
  start.program = "/bin/sh";
  start.args = {"-c", script};
  start.environment = {std::string("P=") + POINTSKIN_PROGRAM};
  start.folder = folder;
  return run_program(start);
}

Result pointskin_run(const std::vector<std::string>& args) {
  Start start;
  start.args = args;
  return run_program(start);
}

void expect_error(const Result& result, int code, const std::string& part) {
  EXPECT_EQ(result.exit_code, code) << result.err;
  EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
}

bool is_one_error_line(const std::string& text) {
  return text.starts_with("pointskin: ") && text.find('\n') == text.size() - 1;
}

std::int64_t bytes_after(const std::string& words, const std::string& text) {
  const std::size_t first = text.find(words);
  const std::size_t open = text.find('(', first);
  if (first == std::string::npos || open == std::string::npos) return 0;
  return std::stoll(text.substr(open + 1));
}

}  // namespace pointskin::test
