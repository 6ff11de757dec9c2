// The field and the surface kept inside of an envelope, once for every space: between the solve and the extraction.
#pragma once

#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "envelope/envelope.hpp"
#include "exec/algorithms.hpp"
#include "exec/cpu.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "poisson/samples.hpp"

namespace pointskin::detail {

/// An array of a space on the host: itself where the space is the host, else a copy.
template <class T, exec::Space Exec>
class OnHost {
 public:
  OnHost(Exec& ex, ArrayView<T> array) : ex_(ex), array_(array) {
    if constexpr (!kIsHost) {
      copy_.resize(static_cast<std::size_t>(array.size));
      copy_to_host(ex, ArrayView<const Value>{array.data, array.size}, copy_.data());
    }
  }

  [[nodiscard]] ArrayView<T> view() {
    if constexpr (kIsHost)
      return array_;
    else
      return {copy_.data(), array_.size};
  }

  /// Takes what has been written into view() back to the space.
  void write_back() {
    if constexpr (!kIsHost) copy_to_device(ex_, copy_.data(), array_);
  }

 private:
  static constexpr bool kIsHost = Exec::kOnHost;
  using Value = std::remove_const_t<T>;
  Exec& ex_;
  ArrayView<T> array_;
  std::vector<Value> copy_;
};

/// The envelope of the options, if there is one, made ready for clouds with this origin.
/// @throws Error as envelope::Envelope
template <exec::Space Exec>
std::shared_ptr<const envelope::Envelope> make_envelope(const Exec& ex, const Options& options, const Vec3d& origin) {
  if (options.envelope == nullptr) return nullptr;
  return std::make_shared<envelope::Envelope>(options.envelope, origin, ex.host_threads());
}

/// Areas of the samples, 0 for those outside: with them only the others decide on the isovalue.
/// @param outside  receives how many lie outside
/// @throws Error empty_result if all do
template <exec::Space Exec>
exec::Buffer<float> areas_inside(Exec& ex, const envelope::Envelope& envelope, const octree::Frame& frame,
                                 const poisson::SamplesView& samples, std::int64_t& outside) {
  auto areas = exec::make_buffer<float>(ex, samples.areas.size);
  copy(ex, samples.areas, areas.view());
  OnHost<const Vec3f, Exec> positions(ex, samples.positions);
  OnHost<float, Exec> on_host(ex, areas.view());
  outside = envelope.drop_outside(frame, positions.view(), on_host.view());
  if (outside == areas.size())
    throw Error(ErrorCode::empty_result, "all points lie outside of the envelope; are both in the same coordinates?");
  on_host.write_back();
  return areas;
}

/// Clears the unknowns outside in the masks of poisson::free_unknowns.
template <exec::Space Exec>
void hold_outside(Exec& ex, const envelope::Envelope& envelope, const octree::Frame& frame,
                  const octree::OctreeView& tree, ArrayView<std::uint8_t> free_unknowns) {
  for (int d = 0; d <= tree.depth; ++d) {
    octree::LevelView level = tree.levels[d];
    OnHost<const std::uint64_t, Exec> keys(ex, {level.brick_key, level.bricks});
    OnHost<std::uint8_t, Exec> free(ex, free_unknowns.part(level.first_node / 8, level.bricks));
    level.brick_key = keys.view().data;
    envelope.hold_outside(frame, level, free.view().data);
    free.write_back();
  }
}

inline void add(const envelope::Moved& moved, EnvelopeReport& report) {
  report.vertices_moved += moved.vertices;
  report.farthest_move = std::max(report.farthest_move, moved.farthest);
}

/// For surface::ExtractOptions::move_vertices. Both must live until the surface is there.
template <exec::Space Exec>
auto clip_to(Exec& ex, const envelope::Envelope& envelope, const octree::Frame& frame, EnvelopeReport& report) {
  return [&ex, &envelope, frame, &report](ArrayView<Vec3f> vertices, ArrayView<const Vec3f> inside_ends) {
    OnHost<Vec3f, Exec> moved(ex, vertices);
    OnHost<const Vec3f, Exec> ends(ex, inside_ends);
    add(envelope.clip(frame, moved.view(), ends.view()), report);
    moved.write_back();
  };
}

/// Moves what is outside still: vertices between corners that hold interpolated values, centres of loops, and those
/// that trimming has added.
template <exec::Space Exec>
void project_onto(Exec& ex, const envelope::Envelope& envelope, const octree::Frame& frame, ArrayView<Vec3f> vertices,
                  EnvelopeReport& report) {
  OnHost<Vec3f, Exec> moved(ex, vertices);
  add(envelope.project(frame, moved.view()), report);
  moved.write_back();
}

}  // namespace pointskin::detail
