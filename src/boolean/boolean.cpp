#include <pointskin/boolean.hpp>

#include <pointskin/error.hpp>

#include <chrono>

#include "boolean/engine.hpp"
#include "reconstruct/engine.hpp"

namespace pointskin {
namespace {

void require(bool holds, const char* story) {
  if (!holds) throw Error(ErrorCode::usage, story);
}

void check(const BooleanOptions& options) {
  detail::validate_settled(options.reconstruction);
  require(options.coincidence_cells >= 0 && options.coincidence_cells <= 100,
          "option coincidence must be in 0..100 cells");
  require(!options.reconstruction.attributes, "a Boolean does not carry attributes; leave the option unset");
  require(options.reconstruction.field == FieldKind::poisson, "a Boolean needs the field poisson");
  require(options.reconstruction.offset == 0, "a Boolean takes no offset; give its result one");
  require(options.reconstruction.envelope == nullptr, "a Boolean takes no envelope; intersect with the mesh instead");
  require(options.reconstruction.max_memory_bytes == 0, "a Boolean has no memory estimate; leave the option unset");
}

}  // namespace

Booleans::Booleans(Device device)
    : impl_(device.kind == DeviceKind::cuda ? detail::make_cuda_booleans(device.index)
                                            : detail::make_cpu_booleans(device.threads)) {}
Booleans::~Booleans() = default;
Booleans::Booleans(Booleans&&) noexcept = default;
Booleans& Booleans::operator=(Booleans&&) noexcept = default;

BooleanResult Booleans::combine(BooleanOperand a, BooleanOperand b, BooleanOp op, const BooleanOptions& options) {
  using Clock = std::chrono::steady_clock;
  check(options);
  const Clock::time_point start = Clock::now();
  BooleanResult result = impl_->combine(a, b, op, options);
  result.report.total_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return result;
}

}  // namespace pointskin
