// Between C++ and C: exceptions become codes, and structs have the size that their caller knows.
#pragma once

#include <pointskin/c.h>
#include <pointskin/error.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

namespace pointskin::c {

/// Writes code and story, which is cut off where it is too long, between characters of UTF-8.
psk_code fail(psk_error* error, psk_code code, const char* story) noexcept;

/// Runs f; whatever it throws becomes a code and a story.
template <class F>
psk_code guarded(psk_error* error, F&& f) noexcept {
  try {
    f();
    if (error != nullptr) *error = {};
    return PSK_OK;
  } catch (const Error& e) {
    return fail(error, static_cast<psk_code>(e.code()), e.what());
  } catch (const std::bad_alloc&) {
    return fail(error, PSK_OVER_LIMIT, "out of memory");
  } catch (const std::length_error&) {
    return fail(error, PSK_OVER_LIMIT, "out of memory: an array would be too long");
  } catch (const std::exception& e) {
    return fail(error, PSK_INTERNAL, e.what());
  } catch (...) {
    return fail(error, PSK_INTERNAL, "an unknown exception");
  }
}

/// @throws Error usage, naming the argument, if it is null
template <class T>
T& required(T* pointer, const char* name) {
  if (pointer == nullptr) throw Error(ErrorCode::usage, std::string(name) + " must not be null");
  return *pointer;
}

/// The defaults of a struct, with its size; the padding between members is 0.
template <class T>
T defaults();

/// `given` as this version of the library has it: what the caller does not know has its default.
/// @param given  null: the defaults
/// @throws Error usage if the caller knows more members than the library, and sets one
template <class T>
T known(const T* given) {
  T value = defaults<T>();
  if (given == nullptr) return value;
  std::size_t size = 0;
  std::memcpy(&size, given, sizeof(size));
  if (size < sizeof(size)) throw Error(ErrorCode::usage, "a struct has the size 0; fill it by psk_init() first");
  if (size > sizeof(T)) {
    const auto* const bytes = reinterpret_cast<const unsigned char*>(given);
    if (std::any_of(bytes + sizeof(T), bytes + size, [](unsigned char byte) { return byte != 0; }))
      throw Error(ErrorCode::usage, "a struct has members that this version of the library does not know");
  }
  std::memcpy(&value, given, std::min(size, sizeof(T)));
  return value;
}

/// Copies as much of a report as the caller's struct has room for. @param to  null: nothing
/// @throws Error usage if its size was not set
template <class T>
void give(const T& report, T* to) {
  if (to == nullptr) return;
  std::size_t size = 0;
  std::memcpy(&size, to, sizeof(size));
  if (size < sizeof(size)) throw Error(ErrorCode::usage, "a report has the size 0; fill it by psk_init() first");
  std::memcpy(to, &report, std::min(size, sizeof(T)));
  std::memcpy(to, &size, sizeof(size));
}

/// The C++ enumerator of a C constant, which counts from 0 alike.
/// @throws Error usage, naming the option, unless it is at most `last`
template <class Enum>
Enum enumerator(const char* option, int value, Enum last) {
  if (value < 0 || value > static_cast<int>(last))
    throw Error(ErrorCode::usage, std::string(option) + " must be in [0, " + std::to_string(static_cast<int>(last)) +
                                      "], not " + std::to_string(value));
  return static_cast<Enum>(value);
}

}  // namespace pointskin::c
