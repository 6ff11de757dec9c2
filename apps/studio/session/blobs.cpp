#include "blobs.hpp"

#include <utility>

#include "studio/wire/wire.hpp"

namespace pointskin::studio {

std::uint64_t BlobStore::add(const std::string& kind, std::vector<std::byte> data, std::size_t kept) {
  auto entry = std::make_shared<Entry>();
  entry->raw.data = std::move(data);
  const std::lock_guard lock(mutex_);
  const std::uint64_t id = ++last_;
  entries_[id] = std::move(entry);
  std::deque<std::uint64_t>& ids = kinds_[kind];
  ids.push_back(id);
  for (; ids.size() > kept; ids.pop_front()) entries_.erase(ids.front());
  return id;
}

std::shared_ptr<const Bytes> BlobStore::get(std::uint64_t id, bool compressed) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(id);
    if (found == entries_.end()) return nullptr;
    entry = found->second;
  }
  if (!compressed) return {entry, &entry->raw};
  std::call_once(entry->compressing, [&entry] { entry->compressed.data = wire::compressed(entry->raw.data); });
  return {entry, &entry->compressed};
}

void BlobStore::forget(const std::string& kind) {
  const std::lock_guard lock(mutex_);
  for (const std::uint64_t id : kinds_[kind]) entries_.erase(id);
  kinds_.erase(kind);
}

}  // namespace pointskin::studio
