// The device on which one reconstruction is done first.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/device.hpp>
#include <pointskin/export.hpp>
#include <pointskin/reconstruct.hpp>

namespace pointskin PSK_EXPORT {

/// Where a process that reconstructs this cloud, and ends, is done first. To begin with a GPU takes about 0.35 s, in
/// which 16 cores are done with a million points at depth 8; so a GPU is asked for only where it wins. A process that
/// uses a GPU anyway, or keeps one for many clouds, wants Device::automatic(), which prefers it.
/// From a model of the times on an NVIDIA H200 and on the cores of its host, by the number of points and a guess at the
/// octree's nodes; several GPUs as one only where one has not enough memory for so many nodes. The choice costs little
/// where times are alike. What options but `depth` cost does not count.
/// @param options  those of the run; a depth of Options::kAutomaticDepth is guessed at
/// @param threads  of the CPU, also where it is chosen; 0: all
/// @returns the CPU in a build without CUDA, where no GPU answers, and for points that no run can use
/// @throws Error usage (an option out of range)
/// Looks at 2^18 points at most: O(1) beyond, milliseconds, and where a GPU wins the quarter of a second that its start
/// takes, because its free memory decides whether one is enough. Deterministic for one machine and that memory,
/// whatever the threads do.
Device suggest_device(const Cloud& cloud, const Options& options = {}, int threads = 0);

}  // namespace pointskin
