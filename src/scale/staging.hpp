// Arrays on their way between the host's memory, where files are read and written, and that of a space that works on them.
#pragma once

#include <cstdint>
#include <utility>

#include "core/array_view.hpp"
#include "exec/cpu.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"

namespace pointskin::scale {

/// An array that the host fills and a space then has. Where the space is the host, it is the same one.
template <class T>
class Sent {
 public:
  Sent(exec::Cpu& host, std::int64_t size) : values_(exec::make_buffer<T>(host, size)) {}

  [[nodiscard]] T* data() { return values_.data(); }
  [[nodiscard]] ArrayView<T> view() { return values_.view(); }

  /// Once, at the end.
  template <exec::Space Exec>
  exec::Buffer<T> to(Exec& ex) {
    if constexpr (Exec::kOnHost) {
      return std::move(values_);
    } else {
      auto there = exec::make_buffer<T>(ex, values_.size());
      copy_to_device(ex, values_.data(), there.view());
      values_.reset();
      return there;
    }
  }

 private:
  exec::Buffer<T> values_;
};

/// An array of the host's where a space can read it: a copy, unless it is the host.
template <class T>
class Lent {
 public:
  template <exec::Space Exec>
  Lent(Exec& ex, ArrayView<const T> values) : values_(values) {
    if constexpr (!Exec::kOnHost) {
      copy_ = exec::make_buffer<T>(ex, values.size);
      copy_to_device(ex, values.data, copy_.view());
      values_ = copy_.cview();
    }
  }

  [[nodiscard]] ArrayView<const T> view() const { return values_; }

 private:
  exec::Buffer<T> copy_;
  ArrayView<const T> values_;
};

/// An array of a space where the host can read it: a copy, unless it can anyhow.
template <class T>
class Fetched {
 public:
  template <exec::Space Exec>
  Fetched(Exec& ex, exec::Cpu& host, ArrayView<const T> values) : values_(values) {
    if constexpr (!Exec::kOnHost) {
      copy_ = exec::make_buffer<T>(host, values.size);
      copy_to_host(ex, values, copy_.data());
      values_ = copy_.cview();
    }
  }

  [[nodiscard]] ArrayView<const T> view() const { return values_; }
  [[nodiscard]] const T* data() const { return values_.data; }

 private:
  exec::Buffer<T> copy_;
  ArrayView<const T> values_;
};

}  // namespace pointskin::scale
