// Text from values, by {fmt}. It is compiled once, by format.cpp: in its header-only form every file that formats anything
// compiles all of it again. It has a namespace of its own, so that programs that link the archive may bring another {fmt}.
#pragma once

#define FMT_BEGIN_NAMESPACE \
  namespace fmt {           \
  inline namespace of_pointskin {
#define FMT_END_NAMESPACE \
  }                       \
  }
#undef FMT_HEADER_ONLY
#include <fmt/format.h>
