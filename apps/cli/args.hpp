// Texts of the command line turned into values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/device.hpp>
#include <pointskin/vector.hpp>

namespace pointskin::cli {

/// `text` as a finite number; unset if it is anything else. Does not depend on the locale.
std::optional<double> parse_number(const std::string& text);

/// "8G", "512M", "1.5T", "4096": bytes, with K, M, G, T as powers of 1024 (also written KB or KiB).
/// @throws Error usage for anything else, and for zero
std::int64_t parse_bytes(const std::string& text);

/// "auto" (unset), "none" (zero) or "x,y,z" in world units.
/// @throws Error usage for anything else
std::optional<Vec3d> parse_shift(const std::string& text);

/// Device::parse, with a check of `threads` that does not depend on the device.
/// @throws Error usage, device_unavailable
Device parse_device(const std::string& text, int threads);

/// @throws Error usage unless `threads` is in [0, 4096]
void check_threads(int threads);

/// Joins flags with an optional value, as PoissonRecon writes them, to the form that cannot be taken for a file name:
/// "--confidence 1" becomes "--confidence=1", "--linear-fit off" becomes "--linear-fit=off".
std::vector<std::string> join_optional_values(std::vector<std::string> args);

/// True if `path` ends in `extension` (with its dot, lower case), whatever the case of its letters.
bool has_extension(const std::string& path, const std::string& extension);

}  // namespace pointskin::cli
