#include "exec/wide.hpp"

#include <cstdlib>
#include <string_view>

namespace pointskin::exec {

bool has_wide_vectors() {
#if PSK_WIDE
  static const bool has = [] {
    const char* wanted = std::getenv("POINTSKIN_VECTORS");
    return __builtin_cpu_supports("avx2") != 0 && (wanted == nullptr || std::string_view(wanted) != "plain");
  }();
  return has;
#else
  return false;
#endif
}

}  // namespace pointskin::exec
