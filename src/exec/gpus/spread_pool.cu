// Memory that lies on several GPUs: one range of addresses, whose pages are on one GPU after another.
// Source: CUDA driver API, "Virtual Memory Management".
#include <cuda.h>
#include <cuda_runtime_api.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "exec/gpus/layout.hpp"
#include "exec/gpus/members.cuh"
#include "exec/gpus/shares.hpp"

namespace pointskin::exec::gpus {
namespace {

void driver_check(CUresult status, const char* doing) {
  if (status == CUDA_SUCCESS) return;
  if (status == CUDA_ERROR_OUT_OF_MEMORY) cuda_check(cudaErrorMemoryAllocation, doing);
  throw Error(ErrorCode::device_unavailable,
              "CUDA: driver error " + std::to_string(static_cast<int>(status)) + "; while " + doing);
}

/// The driver's functions, which the runtime finds: nothing links to the driver.
struct Driver {
  decltype(&cuMemGetAllocationGranularity) granularity = nullptr;
  decltype(&cuMemAddressReserve) reserve = nullptr;
  decltype(&cuMemAddressFree) free = nullptr;
  decltype(&cuMemCreate) create = nullptr;
  decltype(&cuMemRelease) release = nullptr;
  decltype(&cuMemMap) map = nullptr;
  decltype(&cuMemUnmap) unmap = nullptr;
  decltype(&cuMemSetAccess) set_access = nullptr;

  Driver() {
    find("cuMemGetAllocationGranularity", granularity);
    find("cuMemAddressReserve", reserve);
    find("cuMemAddressFree", free);
    find("cuMemCreate", create);
    find("cuMemRelease", release);
    find("cuMemMap", map);
    find("cuMemUnmap", unmap);
    find("cuMemSetAccess", set_access);
  }

 private:
  template <class Function>
  static void find(const char* name, Function& function) {
    void* found = nullptr;
    cudaDriverEntryPointQueryResult result{};
    constexpr unsigned kVersion = 12000;
    cuda_check(cudaGetDriverEntryPointByVersion(name, &found, kVersion, cudaEnableDefault, &result),
               "asking the driver for its functions");
    if (found == nullptr)
      throw Error(ErrorCode::device_unavailable, std::string("the driver of the GPUs has no ") + name + "; renew it");
    function = reinterpret_cast<Function>(found);
  }
};

CUmemAllocationProp memory_of(int gpu) {
  CUmemAllocationProp where{};
  where.type = CU_MEM_ALLOCATION_TYPE_PINNED;
  where.location.type = CU_MEM_LOCATION_TYPE_DEVICE;
  where.location.id = gpu;
  return where;
}

/// Mapped addresses. Pages go back when it is unmapped.
class Mapping {
 public:
  Mapping(const Driver& driver, const Members& members, const std::vector<Owned>& pages, std::size_t page,
          std::size_t bytes)
      : driver_(&driver), bytes_(bytes) {
    driver_check(driver.reserve(&base_, bytes, page, 0, 0), "reserving addresses");
    try {
      for (const Owned& run : pages) map(members[run.gpu].gpu, static_cast<std::size_t>(run.interval.size()) * page);
      std::vector<CUmemAccessDesc> access(static_cast<std::size_t>(members.count()));
      for (int g = 0; g < members.count(); ++g) {
        CUmemAccessDesc& to = access[static_cast<std::size_t>(g)];
        to.location = memory_of(members[g].gpu).location;
        to.flags = CU_MEM_ACCESS_FLAGS_PROT_READWRITE;
      }
      driver_check(driver.set_access(base_, bytes, access.data(), access.size()), "giving all GPUs access to memory");
    } catch (...) {
      unmap();
      throw;
    }
  }
  ~Mapping() {
    if (driver_ != nullptr) unmap();
  }
  Mapping(Mapping&& other) noexcept
      : driver_(std::exchange(other.driver_, nullptr)),
        base_(other.base_),
        bytes_(other.bytes_),
        mapped_(other.mapped_) {}
  Mapping& operator=(Mapping&&) = delete;

  [[nodiscard]] void* data() const { return reinterpret_cast<void*>(base_); }

 private:
  void map(int gpu, std::size_t share) {
    const CUmemAllocationProp where = memory_of(gpu);
    CUmemGenericAllocationHandle pages{};
    driver_check(driver_->create(&pages, share, &where, 0), "allocating memory of a GPU");
    const CUresult status = driver_->map(base_ + mapped_, share, 0, pages, 0);
    driver_->release(pages);  // the mapping keeps them
    driver_check(status, "mapping memory of a GPU");
    mapped_ += share;
  }
  void unmap() noexcept {
    if (mapped_ > 0) driver_->unmap(base_, mapped_);
    driver_->free(base_, bytes_);
  }

  const Driver* driver_;
  CUdeviceptr base_ = 0;
  std::size_t bytes_;
  std::size_t mapped_ = 0;
};

std::size_t page_bytes(const Driver& driver, const Members& members) {
  std::size_t page = 0;
  for (int g = 0; g < members.count(); ++g) {
    const CUmemAllocationProp where = memory_of(members[g].gpu);
    std::size_t own = 0;
    driver_check(driver.granularity(&own, &where, CU_MEM_ALLOC_GRANULARITY_RECOMMENDED),
                 "asking for the size of pages");
    page = std::max(page, own);
  }
  return page;
}

/// Mapping takes far longer than a kernel, so what is freed stays mapped, and stands in for what is a little smaller. All work of
/// a group is ordered: a block may be handed out while its last user is still running.
class SpreadPool final : public MemoryPool {
 public:
  SpreadPool(std::shared_ptr<Members> members, std::shared_ptr<const Layout> layout, std::size_t least_spread_bytes)
      : members_(std::move(members)),
        layout_(std::move(layout)),
        page_(page_bytes(driver_, *members_)),
        least_spread_bytes_(least_spread_bytes) {}
  ~SpreadPool() override { SpreadPool::trim(); }
  SpreadPool(const SpreadPool&) = delete;
  SpreadPool& operator=(const SpreadPool&) = delete;

  void trim() noexcept override {
    members_->synchronize();
    for (const auto& [kind, block] : kept_) mapped_.erase(block);
    kept_.clear();
    for (int g = 0; g < members_->count(); ++g) (*members_)[g].pool->trim();
  }

 private:
  void* take(std::size_t bytes) override {
    if (bytes < least_spread_bytes_) return take_small(bytes);
    const std::size_t rounded = whole_pages(bytes, page_);
    const auto kept = kept_.lower_bound({*layout_, rounded});
    if (kept != kept_.end() && kept->first.layout == *layout_ && may_stand_in(kept->first.bytes, rounded)) {
      void* block = kept->second;
      kept_.erase(kept);
      return block;
    }
    try {
      return add(rounded);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::over_limit) throw;
    }
    trim();
    try {
      return add(rounded);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::over_limit) throw;
      throw Error(ErrorCode::over_limit, "out of memory on the GPUs; while allocating " + std::to_string(bytes) +
                                             " bytes with " + std::to_string(held_bytes()) +
                                             " held; choose a smaller depth or more GPUs");
    }
  }
  void* take_small(std::size_t bytes) {
    try {
      return small().allocate(bytes);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::over_limit) throw;
    }
    trim();  // what is free in large ranges is the same memory
    return small().allocate(bytes);
  }
  void give_back(void* block, std::size_t bytes) noexcept override {
    if (bytes < least_spread_bytes_) return small().deallocate(block, bytes);
    const auto mapping = mapped_.find(block);
    try {
      kept_.emplace(mapping->second.kind, block);
    } catch (...) {  // no room to remember the block, so it is unmapped
      members_->synchronize();
      mapped_.erase(mapping);
    }
  }

  void* add(std::size_t bytes) {
    const auto pages = static_cast<std::int64_t>(bytes / page_);
    Block block{{*layout_, bytes},
                Mapping(driver_, *members_, owners_of(*layout_, members_->count(), pages), page_, bytes)};
    void* data = block.mapping.data();
    mapped_.emplace(data, std::move(block));
    return data;
  }

  /// What decides whether a block may stand in for another.
  struct Kind {
    Layout layout;
    std::size_t bytes;
    bool operator<(const Kind& other) const {
      return layout == other.layout ? bytes < other.bytes : layout < other.layout;
    }
  };
  struct Block {
    Kind kind;
    Mapping mapping;
  };

  [[nodiscard]] MemoryPool& small() const { return *(*members_)[0].pool; }

  std::shared_ptr<Members> members_;
  std::shared_ptr<const Layout> layout_;
  Driver driver_;
  std::size_t page_;
  std::size_t least_spread_bytes_;
  std::unordered_map<void*, Block> mapped_;  // all, by their addresses
  std::multimap<Kind, void*> kept_;          // those that are free
};

}  // namespace

std::shared_ptr<MemoryPool> make_spread_pool(std::shared_ptr<Members> members, std::shared_ptr<const Layout> layout,
                                             std::size_t least_spread_bytes) {
  return std::make_shared<SpreadPool>(std::move(members), std::move(layout), least_spread_bytes);
}

}  // namespace pointskin::exec::gpus
