// What the public Booleans delegates to, one implementation a space.
#pragma once

#include <pointskin/boolean.hpp>

#include <memory>

namespace pointskin {

class Booleans::Impl {
 public:
  virtual ~Impl() = default;
  virtual BooleanResult combine(const BooleanOperand& a, const BooleanOperand& b, BooleanOp op,
                                const BooleanOptions& options) = 0;
};

namespace detail {

std::unique_ptr<Booleans::Impl> make_cpu_booleans(int threads);

/// @throws Error device_unavailable without a GPU; in builds without CUDA always
std::unique_ptr<Booleans::Impl> make_cuda_booleans(int index);

}  // namespace detail
}  // namespace pointskin
