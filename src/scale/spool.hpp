// What memory does not hold, in a file without a name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "exec/cpu.hpp"
#include "io/file_descriptor.hpp"

namespace pointskin::scale {

/// Whether the file of a spool can get a name, by which other processes open it.
enum class SpoolName : std::uint8_t { never, when_shown };

/// Bytes on a disk that vanish with their owner, however that ends: the file has no name from the start, or none as
/// soon as it is there. Its space is reserved first, so that a disk that is too small is known before work begins.
class Spool {
 public:
  /// @param folder  where the file lies; it must exist
  /// @param bytes   that it has, all 0, at least 0
  /// @throws Error output_not_written with the reason of the operating system
  Spool(std::string folder, std::int64_t bytes, SpoolName named = SpoolName::never);
  ~Spool() { hide(); }
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  /// That another process has made and shown, and not hidden yet.
  static std::unique_ptr<Spool> open(const std::string& folder, const std::string& name, std::int64_t bytes);

  [[nodiscard]] std::int64_t size() const { return bytes_; }

  /// Until hide() other processes can open the file.
  /// @returns its name in the folder, of less than kNameLength characters
  /// @throws Error output_not_written
  const std::string& show();
  static constexpr std::size_t kNameLength = 40;
  void hide();

  /// Many threads may read and write at once, as long as nobody writes where another one is.
  /// @param at  of the first byte; at + count <= size()
  /// @throws Error output_not_written with the reason of the operating system, or because the file has become shorter;
  ///         interrupted
  void write(std::int64_t at, const void* data, std::int64_t count) const;
  void read(std::int64_t at, void* data, std::int64_t count) const;
  /// The same by all threads: one alone copies to and from the system's pages slower than memory does.
  void write(exec::Cpu& ex, std::int64_t at, const void* data, std::int64_t count) const;
  void read(exec::Cpu& ex, std::int64_t at, void* data, std::int64_t count) const;

 private:
  Spool(std::string folder, std::int64_t bytes, int file) : folder_(std::move(folder)), bytes_(bytes), file_(file) {}
  [[noreturn]] void fail(const char* what, int error) const;
  void reserve() const;
  [[nodiscard]] bool is_cut() const;
  /// Calls move(bytes done, bytes to do at most), which returns as pread() does, until `count` bytes are done.
  template <class Move>
  void move_all(std::int64_t count, const char* what, const Move& move) const;

  std::string folder_;
  std::string name_;  ///< of a file that is to be removed
  std::int64_t bytes_;
  io::FileDescriptor file_;
};

}  // namespace pointskin::scale
