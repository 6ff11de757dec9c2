// What the handles of the C interface stand for.
#pragma once

#include <pointskin/c.h>
#include <pointskin/pointskin.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

struct PSK_HIDDEN psk_workspace {
  pointskin::Workspace workspace;
  std::string device_name;
};

struct PSK_HIDDEN psk_cloud {
  pointskin::Cloud cloud;
  std::string assumed, warning;  ///< of psk_orient()
};

/// A mesh in the memory of a workspace's device, or on the host.
struct PSK_HIDDEN psk_mesh {
  struct OnDevice {
    pointskin::Workspace workspace;  // goes last
    pointskin::DeviceMesh mesh;
  };
  std::variant<pointskin::Mesh, OnDevice> mesh;
};

struct PSK_HIDDEN psk_reconstructor {
  pointskin::Reconstructor reconstructor;
  std::vector<psk_warning> warnings;     ///< of the last run
  std::vector<psk_level_report> levels;  ///< of the last run

  explicit psk_reconstructor(const pointskin::Workspace& workspace) : reconstructor(workspace) {}
};

struct PSK_HIDDEN psk_field {
  pointskin::Field field;
};

struct PSK_HIDDEN psk_image {
  pointskin::Image image;
  std::string png;  ///< made when it is asked for
};

struct PSK_HIDDEN psk_problems {
  std::vector<pointskin::ProblemRegion> regions;
};

struct PSK_HIDDEN psk_edit {
  pointskin::EditSession session;
};

struct PSK_HIDDEN psk_deformer {
  pointskin::Deformer deformer;
};

struct PSK_HIDDEN psk_fluid {
  pointskin::FluidSurfacer surfacer;
  pointskin::Workspace workspace;
};
