// Words that the last lines of the commands have in common: which file, what mesh, how much memory.
#pragma once

#include <cstdint>
#include <string>

#include <pointskin/components.hpp>
#include <pointskin/device.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin::cli {

/// "out.ply: ", "stdout: " for "-", nothing for no file.
std::string file_words(const std::string& file);

/// "1 component", "3 components".
std::string counted(std::int64_t count, const std::string& word);

/// "closed, 1 component" or "open, 3 components", at a glance (glance_at): O(triangles), about a hundredth of what a
/// reconstruction takes.
std::string shape_words(const Mesh& mesh, int threads);
std::string shape_words(const MeshGlance& glance);

/// The same of a mesh that was measured: "watertight" where it is.
std::string shape_words(const MeshReport& mesh);

/// "memory 1.2 GiB device, 340.0 MiB host"; on the CPU, whose buffers are in the process's own memory, "memory 340.0
/// MiB, 120.0 MiB of it buffers".
std::string memory_words(const Device& device, std::int64_t device_peak_bytes, std::int64_t host_peak_bytes);

}  // namespace pointskin::cli
