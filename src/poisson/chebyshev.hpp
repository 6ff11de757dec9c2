// Chebyshev iterations: steps whose coefficients follow from the part of the spectrum that they damp.
// Source: Saad, "Iterative methods for sparse linear systems", 2nd ed., algorithm 12.1.
#pragma once

#include <cstdint>
#include <vector>

#include "core/float8.hpp"
#include "core/host_device.hpp"

namespace pointskin::poisson {

/// One step:  step = momentum step + gain correction;  u = u + step. The last step is the difference of the last two u.
struct ChebyshevStep {
  float momentum, gain;

  /// @param value       u
  /// @param before      u before the last step
  /// @param correction  diagonal^-1 (b - A u), or what else estimates the error of u
  template <class Float>
  PSK_HD PSK_INLINE Float next(const Float& value, const Float& before, const Float& correction) const {
    return value + (gain * correction + momentum * (value - before));
  }
};

/// Coefficients of Chebyshev iterations on [lower, 1]: there, errors are damped evenly.
class Chebyshev {
 public:
  explicit Chebyshev(double lower) : theta_((1 + lower) / 2), delta_((1 - lower) / 2), rho_(delta_ / theta_) {}

  ChebyshevStep next() {
    if (first_) {
      first_ = false;
      return {0, static_cast<float>(1 / theta_)};
    }
    const double rho = 1 / (2 * theta_ / delta_ - rho_);
    const ChebyshevStep step{static_cast<float>(rho * rho_), static_cast<float>(2 * rho / delta_)};
    rho_ = rho;
    return step;
  }

 private:
  double theta_, delta_, rho_;
  bool first_ = true;
};

}  // namespace pointskin::poisson
