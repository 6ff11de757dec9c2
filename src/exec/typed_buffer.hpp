// Arrays of values whose type is known when the program runs. Include after the primitives of the spaces used.
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <pointskin/attribute.hpp>

#include "core/typed_view.hpp"
#include "exec/algorithms.hpp"
#include "exec/cpu.hpp"
#include "exec/host_array.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"

namespace pointskin::exec {

/// An owned array of attribute values in the space of its pool, each in as many bytes as its type has. Move-only.
struct TypedBuffer {
  AttributeType type = AttributeType::float32;
  std::int64_t size = 0;
  Buffer<std::uint8_t> bytes;    ///< of the values
  Buffer<std::uint8_t> missing;  ///< (n) 1 where an integer is missing, or (0): all are there

  [[nodiscard]] TypedView view() const {
    return {type, bytes.data(), missing.empty() ? nullptr : missing.data(), size};
  }
  [[nodiscard]] TypedOutput output() const { return {type, bytes.data()}; }
  /// The values themselves, which must be of type T.
  template <class T>
  [[nodiscard]] ArrayView<T> as() const {
    return {reinterpret_cast<T*>(bytes.data()), size};
  }
};

namespace typed {

/// An index below 0 leads to no value.
struct Gather {
  TypedView from;
  ArrayView<const std::int32_t> index;
  void* to;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t at = index[i];
    visit_type(from.type, [&](auto tag) {
      using T = decltype(tag);
      static_cast<T*>(to)[i] = at < 0 ? T{0} : from.value<T>(at);
    });
  }
};

struct GatherMissing {
  TypedView from;
  ArrayView<const std::int32_t> index;
  ArrayView<std::uint8_t> missing;
  PSK_HD void operator()(std::int64_t i) const { missing[i] = index[i] < 0 || from.is_missing(index[i]) ? 1 : 0; }
};

struct FillNan {
  TypedOutput out;
  PSK_HD void operator()(std::int64_t i) const { out.store(i, std::numeric_limits<double>::quiet_NaN()); }
};

}  // namespace typed

/// Uninitialised, without a mask.
template <Space Exec>
TypedBuffer make_typed_buffer(Exec& ex, AttributeType type, std::int64_t size) {
  return {type, size, make_buffer<std::uint8_t>(ex, size * static_cast<std::int64_t>(size_of(type))), {}};
}

/// Copies values to the space.
template <Space Exec>
TypedBuffer upload_typed(Exec& ex, const AttributeValues& values) {
  TypedBuffer to = make_typed_buffer(ex, values.type(), static_cast<std::int64_t>(values.size()));
  if (to.size == 0) return to;
  values.visit([&](const auto& from) {
    copy_to_device(ex, reinterpret_cast<const std::uint8_t*>(from.data()), to.bytes.view());
  });
  if (values.has_mask()) {
    to.missing = make_buffer<std::uint8_t>(ex, to.size);
    copy_to_device(ex, values.mask().data(), to.missing.view());
  }
  return to;
}

namespace typed {

/// Moves an array to the host, into the memory that `to` may have already.
template <class T, Space Exec>
void fetch(Exec& ex, Buffer<std::uint8_t>& from, std::vector<T>& to) {
  const std::size_t size = static_cast<std::size_t>(from.size()) / sizeof(T);
  if constexpr (Exec::kOnHost)
    exec::resize_to_overwrite(ex, to, size);
  else
    exec::resize_to_overwrite(to, size);
  if (size > 0) copy_to_host(ex, from.cview(), reinterpret_cast<std::uint8_t*>(to.data()));
  from.reset();
}

}  // namespace typed

/// Moves values to the host, into the memory that `to` has already if it is of their type.
template <Space Exec>
void download_typed(Exec& ex, TypedBuffer from, AttributeValues& to) {
  visit_type(from.type, [&](auto tag) {
    using T = decltype(tag);
    std::vector<T> values = to.type() == from.type ? to.take<T>() : std::vector<T>();
    typed::fetch(ex, from.bytes, values);
    std::vector<std::uint8_t> mask;
    typed::fetch(ex, from.missing, mask);
    to = AttributeValues::with_mask(std::move(values), std::move(mask));
  });
}

template <Space Exec>
AttributeValues download_typed(Exec& ex, TypedBuffer from) {
  AttributeValues to;
  download_typed(ex, std::move(from), to);
  return to;
}

/// The same values in memory of their own.
template <Space Exec>
TypedBuffer copy_typed(Exec& ex, const TypedBuffer& from) {
  TypedBuffer to = make_typed_buffer(ex, from.type, from.size);
  copy(ex, from.bytes.cview(), to.bytes.view());
  to.missing = make_buffer<std::uint8_t>(ex, from.missing.size());
  copy(ex, from.missing.cview(), to.missing.view());
  return to;
}

/// Whether an index may be below 0, which leads to a missing integer.
enum class Indices { all, some };

/// from[index[i]] for every i.
template <Space Exec>
TypedBuffer gather_typed(Exec& ex, const TypedView& from, ArrayView<const std::int32_t> index,
                         Indices present = Indices::all) {
  TypedBuffer to = make_typed_buffer(ex, from.type, index.size);
  for_each(ex, "gather", index.size, typed::Gather{from, index, to.bytes.data()});
  if (from.missing == nullptr && present == Indices::all) return to;
  to.missing = make_buffer<std::uint8_t>(ex, index.size);
  for_each(ex, "gather", index.size, typed::GatherMissing{from, index, to.missing.view()});
  return to;
}

/// Values that are all missing.
template <Space Exec>
TypedBuffer make_missing(Exec& ex, AttributeType type, std::int64_t size) {
  TypedBuffer to = make_typed_buffer(ex, type, size);
  if (!is_integer(type)) {
    for_each(ex, "fill", size, typed::FillNan{to.output()});
    return to;
  }
  fill(ex, to.bytes.view(), std::uint8_t{0});
  to.missing = make_buffer<std::uint8_t>(ex, size);
  fill(ex, to.missing.view(), std::uint8_t{1});
  return to;
}

/// `first` and `second`, which are of one type.
template <Space Exec>
TypedBuffer join_typed(Exec& ex, const TypedBuffer& first, const TypedBuffer& second) {
  TypedBuffer to = make_typed_buffer(ex, first.type, first.size + second.size);
  copy(ex, first.bytes.cview(), to.bytes.view().part(0, first.bytes.size()));
  copy(ex, second.bytes.cview(), to.bytes.view().part(first.bytes.size(), second.bytes.size()));
  if (first.missing.empty() && second.missing.empty()) return to;
  to.missing = make_buffer<std::uint8_t>(ex, to.size);
  fill(ex, to.missing.view(), std::uint8_t{0});
  copy(ex, first.missing.cview(), to.missing.view().part(0, first.missing.size()));
  copy(ex, second.missing.cview(), to.missing.view().part(first.size, second.missing.size()));
  return to;
}

}  // namespace pointskin::exec
