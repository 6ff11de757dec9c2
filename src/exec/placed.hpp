// Where several GPUs keep arrays whose parts lie beside each other in space. Other spaces have one place for all.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "exec/gpus/layout.hpp"
#include "exec/space.hpp"

namespace pointskin::exec {

/// True if work and arrays are shared by several GPUs.
template <Space Exec>
bool is_shared([[maybe_unused]] const Exec& ex) {
  if constexpr (requires { ex.group(); })
    return ex.group() != nullptr;
  else
    return false;
}

/// While it lives, arrays that are made and work that is launched consist of parts, each in the order of space: every GPU of several
/// has its share of each part. Only speed depends on it. No effect on one device.
template <Space Exec>
class Placed {
 public:
  /// @param borders  where parts end, of `total`, ascending; arrays and launches of other sizes are cut in the same proportions
  Placed(Exec& ex, const std::vector<std::int64_t>& borders, std::int64_t total) : ex_(ex) {
    if (is_shared(ex)) before_ = exchange(gpus::Layout(borders, total));
  }
  ~Placed() { end(); }
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;

  /// What follows is cut as before.
  void end() {
    if (before_) exchange(*std::exchange(before_, std::nullopt));
  }

 private:
  gpus::Layout exchange(gpus::Layout layout) {
    if constexpr (requires { ex_.group(); }) return ex_.group()->exchange_layout(std::move(layout));
    return layout;
  }

  Exec& ex_;
  std::optional<gpus::Layout> before_;
};

}  // namespace pointskin::exec
