#include "io/block_writer.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "exec/cancel.hpp"

namespace pointskin::io {
namespace {

constexpr int kLookEveryMs = 100;
constexpr std::size_t kLargestStreamWrite = std::size_t{1} << 20;

/// Calls write(data, size) until all bytes are written.
template <class Write>
void write_all(const std::string& bytes, const Write& write) {
  constexpr std::size_t kLargestWrite = std::size_t{1} << 30;  // Linux writes at most 2 GiB at once
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t wrote = write(bytes.data() + done, std::min(kLargestWrite, bytes.size() - done), done);
    if (wrote < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (wrote < 0) throw std::system_error(errno, std::generic_category());
    done += static_cast<std::size_t>(wrote);
  }
}

}  // namespace

void BlockWriter::run(exec::Cpu& ex) {
  ex.run_blocks(std::min<std::int64_t>(ex.threads(), blocks_.count),
                [this, cancelled = exec::cancel_flag()](std::int64_t /*lane*/) {
                  try {
                    work(cancelled);
                  } catch (...) {
                    stop();  // others may be waiting for the block that failed
                    throw;
                  }
                });
}

void BlockWriter::work(const std::atomic<bool>* cancelled) {
  std::string bytes;
  while (const auto block = take()) {
    exec::throw_if_cancelled(cancelled);
    bytes.clear();
    blocks_.make(*block, bytes);
    const auto place = wait_for_place(*block);
    if (!place) return;
    if (target_ == Target::stream) write_to_stream(bytes, cancelled);
    pass_turn(bytes.size());
    if (target_ == Target::file) write_to_file(bytes, *place);
  }
}

std::optional<std::int64_t> BlockWriter::take() {
  const std::lock_guard lock(mutex_);
  if (stopped_ || taken_ == blocks_.count) return std::nullopt;
  return taken_++;
}

std::optional<std::int64_t> BlockWriter::wait_for_place(std::int64_t b) {
  std::unique_lock lock(mutex_);
  turn_changed_.wait(lock, [&] { return stopped_ || turn_ == b; });
  if (stopped_) return std::nullopt;
  return place_;
}

void BlockWriter::pass_turn(std::size_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    ++turn_;
    place_ += static_cast<std::int64_t>(bytes);
  }
  turn_changed_.notify_all();
}

void BlockWriter::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  turn_changed_.notify_all();
}

void BlockWriter::write_to_file(const std::string& bytes, std::int64_t place) const {
  write_all(bytes, [&](const char* data, std::size_t size, std::size_t done) {
    return ::pwrite(fd_, data, size, place + static_cast<std::int64_t>(done));
  });
  // The disk starts now, so that little is left to wait for at the end. No more than a wish: fsync reports errors.
  static_cast<void>(::sync_file_range(fd_, place, static_cast<off_t>(bytes.size()), SYNC_FILE_RANGE_WRITE));
}

void BlockWriter::write_to_stream(const std::string& bytes, const std::atomic<bool>* cancelled) const {
  write_all(bytes, [&](const char* data, std::size_t size, std::size_t /*done*/) {
    // Whoever reads may let us wait for long. A stream that never blocks is waited for here alone.
    pollfd stream = {fd_, POLLOUT, 0};
    while (::poll(&stream, 1, kLookEveryMs) <= 0) exec::throw_if_cancelled(cancelled);
    exec::throw_if_cancelled(cancelled);
    return ::write(fd_, data, std::min(size, kLargestStreamWrite));
  });
}

}  // namespace pointskin::io
