// Immutable byte arrays under numbers, for pages to fetch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "studio/session/application.hpp"

namespace pointskin::studio {

/// What is kept of each kind ("mesh", "points", ...) is the newest few: pages fetch what was announced last. Compressed
/// forms are made when somebody first asks for one. All functions may be called from any thread.
class BlobStore {
 public:
  /// @param data  as wire encodes it, not compressed
  /// @param kept  blobs of this kind that stay, this one included
  /// @returns its number
  std::uint64_t add(const std::string& kind, std::vector<std::byte> data, std::size_t kept);

  /// @returns null for a number that there is not, or no longer
  std::shared_ptr<const Bytes> get(std::uint64_t id, bool compressed);

  /// Forgets all of a kind.
  void forget(const std::string& kind);

 private:
  struct Entry {
    Bytes raw;
    std::once_flag compressing;
    Bytes compressed;
  };

  std::mutex mutex_;
  std::uint64_t last_ = 0;
  std::map<std::uint64_t, std::shared_ptr<Entry>> entries_;
  std::map<std::string, std::deque<std::uint64_t>> kinds_;
};

}  // namespace pointskin::studio
