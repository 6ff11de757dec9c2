#include "reconstruct/pack.hpp"

#include <cstddef>
#include <cstdint>

#include "core/vec3.hpp"
#include "exec/this_space.hpp"

namespace pointskin::detail {
namespace {

/// Where elements lie.
struct Strides {
  const std::uint8_t* data;
  std::int64_t row, component;

  explicit Strides(const StridedArray& array)
      : data(static_cast<const std::uint8_t*>(array.data)),
        row(array.row_stride_bytes),
        component(array.component_stride_bytes) {}

  /// Byte by byte: elements need not be aligned.
  template <class T>
  [[nodiscard]] PSK_HD T load(std::int64_t i, int j) const {
    T value;
    auto* const to = reinterpret_cast<std::uint8_t*>(&value);
    const std::uint8_t* const from = data + i * row + j * component;
    for (std::size_t b = 0; b < sizeof(T); ++b) to[b] = from[b];
    return value;
  }
};

template <class T>
struct PackTriple {
  Strides from;
  ArrayView<Vec3f> to;
  PSK_HD void operator()(std::int64_t i) const {
    to[i] = {static_cast<float>(from.load<T>(i, 0)), static_cast<float>(from.load<T>(i, 1)),
             static_cast<float>(from.load<T>(i, 2))};
  }
};

template <class T>
struct PackValue {
  Strides from;
  std::uint8_t* to;
  PSK_HD void operator()(std::int64_t i) const { reinterpret_cast<T*>(to)[i] = from.load<T>(i, 0); }
};

}  // namespace

template <exec::Space Exec>
exec::Buffer<Vec3f> pack_triples(Exec& ex, const StridedArray& array) {
  auto packed = exec::make_buffer<Vec3f>(ex, array.rows);
  visit_type(array.type, [&](auto tag) {
    for_each(ex, "upload.pack", array.rows, PackTriple<decltype(tag)>{Strides(array), packed.view()});
  });
  return packed;
}

template <exec::Space Exec>
exec::Buffer<std::uint8_t> pack_column(Exec& ex, const StridedArray& array) {
  auto packed = exec::make_buffer<std::uint8_t>(ex, array.rows * static_cast<std::int64_t>(size_of(array.type)));
  visit_type(array.type, [&](auto tag) {
    for_each(ex, "upload.pack", array.rows, PackValue<decltype(tag)>{Strides(array), packed.data()});
  });
  return packed;
}

PSK_INSTANTIATE(pack_triples);
PSK_INSTANTIATE(pack_column);

}  // namespace pointskin::detail
