// Texts of the command line turned into values.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/device.hpp>
#include <pointskin/vector.hpp>

#include "scene/text.hpp"

namespace pointskin::cli {

/// @throws Error usage, with this story
[[noreturn]] void throw_usage(const std::string& story);

using scene::parse_number;
using scene::parse_vector;

/// "8G", "512M", "1.5T", "4096": bytes, with K, M, G, T as powers of 1024 (also written KB or KiB).
/// @throws Error usage, naming `option`, for anything else, and for zero
std::int64_t parse_bytes(const std::string& text, const char* option);

/// "auto" (unset), "none" (zero) or "x,y,z" in world units.
/// @throws Error usage for anything else
std::optional<Vec3d> parse_shift(const std::string& text);

/// Device::parse, with a check of `threads` that does not depend on the device.
/// @param words  what may be there, for the error
/// @throws Error usage, naming `option`; device_unavailable
Device parse_device(const std::string& text, int threads, const char* option = "--device",
                    const char* words = "auto, cpu, cuda, cuda:N, cuda:N,M or cuda:all");

/// @throws Error usage unless `threads` is in [0, 4096]
void check_threads(int threads);

/// "'x' is not a, b or c".
std::string not_one_of(const std::string& text, const std::vector<std::string>& words);

/// A check for options whose value is one of `words`.
std::function<std::string(const std::string&)> is_one_of(const std::vector<std::string>& words);

/// Joins flags with an optional value, as PoissonRecon writes them, to the form that cannot be taken for a file name:
/// "--confidence 1" becomes "--confidence=1", "--linear-fit off" becomes "--linear-fit=off".
std::vector<std::string> join_optional_values(std::vector<std::string> args);

}  // namespace pointskin::cli
