#include <pointskin/boolean.hpp>

#include <pointskin/error.hpp>

#include <memory>

#include "boolean/combine.hpp"
#include "core/stopwatch.hpp"
#include "exec/any_space.hpp"
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

class PSK_HIDDEN Booleans::Impl {
 public:
  Workspace workspace;
};

Booleans::Booleans(Workspace workspace) : impl_(std::make_unique<Impl>(Impl{std::move(workspace)})) {}
Booleans::~Booleans() = default;
Booleans::Booleans(Booleans&&) noexcept = default;
Booleans& Booleans::operator=(Booleans&&) noexcept = default;

BooleanResult Booleans::combine(BooleanOperand a, BooleanOperand b, BooleanOp op, const BooleanOptions& options) {
  check(options);
  const Stopwatch watch;
  BooleanResult result =
      exec::visit(impl_->workspace.data().space, [&](auto& ex) { return boolean::combine(ex, a, b, op, options); });
  result.report.total_ms = watch.milliseconds();
  return result;
}

}  // namespace pointskin
