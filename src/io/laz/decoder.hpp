// LAZ: the points of a LAS file, compressed in chunks.
#pragma once

#include <string>

#include "exec/cpu.hpp"
#include "io/las/header.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// The points as a LAS file has them, one after the other; chunks are decoded in parallel. O(n), the result in memory; the
/// same bytes for any number of threads. Waveforms of the formats 9 and 10 are those of the first point of their chunk.
/// @throws Error invalid_input for garbled points, LASzip before version 2, and compressed waveforms of formats 4 and 5
std::string unpack_laz(exec::Cpu& ex, const Source& source, const LasHeader& header);

}  // namespace pointskin::io
