// The requests and answers are messages over a pair of sockets: log file and words with a NUL after each, an Outcome.
#include "bench/launcher.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "signals.hpp"
#include "stopwatch.hpp"

namespace pointskin::cli {
namespace {

constexpr std::size_t kLongestRequest = 128 * 1024;

/// In the new process: becomes the program, or tells errno and ends.
[[noreturn]] void become_program(std::vector<std::string>& request, int error_pipe) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGPIPE, SIG_DFL);
  std::signal(SIGXFSZ, SIG_DFL);
  const int input = open("/dev/null", O_RDONLY);
  const int output = open(request[0].c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (input >= 0 && output >= 0 && dup2(input, 0) == 0 && dup2(output, 1) == 1 && dup2(output, 2) == 2) {
    std::vector<char*> words;
    for (std::size_t i = 1; i < request.size(); ++i) words.push_back(request[i].data());
    words.push_back(nullptr);
    execvp(words[0], words.data());
  }
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(error_pipe, &error, sizeof error);
  _exit(127);
}

/// errno of a start that failed, or 0 once the program runs: its end of the pipe closes by itself.
int start_error(int error_pipe) {
  int error = 0;
  ssize_t count = 0;
  do {
    count = read(error_pipe, &error, sizeof error);
  } while (count < 0 && errno == EINTR);
  return count == sizeof error ? error : 0;
}

Outcome launch(std::vector<std::string> request) {
  Outcome outcome;
  std::array<int, 2> error_pipe{};
  if (pipe2(error_pipe.data(), O_CLOEXEC) != 0) return outcome.start_error = errno, outcome;
  const Stopwatch watch;
  const pid_t id = fork();
  if (id == 0) become_program(request, error_pipe[1]);
  outcome.start_error = id < 0 ? errno : 0;
  close(error_pipe[1]);
  if (id > 0) {
    outcome.start_error = start_error(error_pipe[0]);
    int status = 0;
    struct rusage usage = {};
    while (wait4(id, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    outcome.seconds = watch.ms() / 1000;
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    outcome.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    outcome.peak_bytes = std::int64_t{usage.ru_maxrss} * 1024;
  }
  close(error_pipe[0]);
  return outcome;
}

/// Life of the small process: until the other end of the socket is gone.
[[noreturn]] void serve(int socket) {
  setpgid(0, 0);  // a group of its own, with all that the programs start: ~Launcher() ends them together
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  std::vector<char> message(kLongestRequest);
  for (;;) {
    const ssize_t count = recv(socket, message.data(), message.size(), 0);
    if (count <= 0) _exit(0);
    std::vector<std::string> request;
    for (const char* at = message.data(); at < message.data() + count; at += request.back().size() + 1) {
      request.emplace_back(at);
    }
    const Outcome outcome = launch(std::move(request));
    if (send(socket, &outcome, sizeof outcome, MSG_NOSIGNAL) != sizeof outcome) _exit(0);
  }
}

[[noreturn]] void throw_internal(const char* what) {
  throw Error(ErrorCode::internal, fmt::format("cannot start programs: {}: {}", what, std::strerror(errno)));
}

}  // namespace

std::string describe(const Outcome& outcome) {
  if (outcome.start_error != 0) return fmt::format("cannot be started: {}", std::strerror(outcome.start_error));
  if (outcome.signal != 0) return fmt::format("signal {} ({})", outcome.signal, strsignal(outcome.signal));
  return fmt::format("exit status {}", outcome.exit_code);
}

Launcher::Launcher() {
  std::array<int, 2> sockets{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0) throw_internal("socketpair");
  id_ = fork();
  if (id_ == 0) {
    close(sockets[0]);
    serve(sockets[1]);
  }
  close(sockets[1]);
  socket_ = sockets[0];
  if (id_ < 0) throw_internal("fork");
  setpgid(id_, id_);  // both sides do it: whoever comes first
}

Launcher::~Launcher() {
  close(socket_);
  kill(-id_, SIGKILL);
  waitpid(id_, nullptr, 0);
}

Outcome Launcher::run(const std::vector<std::string>& words, const std::string& log) const {
  std::string request = log + '\0';
  for (const std::string& word : words) request += word + '\0';
  if (request.size() > kLongestRequest)
    throw Error(ErrorCode::over_limit, "the command of the other program is too long");
  if (send(socket_, request.data(), request.size(), MSG_NOSIGNAL) < 0) throw_internal("send");
  for (pollfd answer = {socket_, POLLIN, 0}; poll(&answer, 1, 100) <= 0;) throw_if_interrupted();
  Outcome outcome;
  const ssize_t count = recv(socket_, &outcome, sizeof outcome, 0);
  if (count != sizeof outcome)
    throw Error(ErrorCode::internal, "cannot start programs: the launching process has ended");
  return outcome;
}

bool is_executable(const std::string& program) {
  const auto is_program = [](const std::string& path) {
    struct stat status = {};
    return stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) && access(path.c_str(), X_OK) == 0;
  };
  if (program.find('/') != std::string::npos) return is_program(program);
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/bin:/usr/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (is_program((folder.empty() ? "." : folder) + "/" + program)) return true;
  }
  return false;
}

}  // namespace pointskin::cli
