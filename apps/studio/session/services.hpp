// What all parts of the engine work with.
#pragma once

#include <cstdint>
#include <filesystem>

#include <pointskin/device.hpp>
#include <pointskin/workspace.hpp>

#include "audience.hpp"
#include "blobs.hpp"
#include "job_queue.hpp"
#include "roots.hpp"

namespace pointskin::studio {

struct Services {
  Device device;
  Workspace workspace;  ///< of the engine's thread: every object that computes shares its memory
  Audience& audience;
  BlobStore& blobs;
  JobQueue& queue;
  const Roots& roots;            ///< where files may be read and written
  std::filesystem::path folder;  ///< of the program's own files: journals, uploads
  std::int64_t most_shown = 0;   ///< triangles, and points, that pages are shown at most
};

}  // namespace pointskin::studio
