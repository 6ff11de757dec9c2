// Pictures of meshes, drawn on the CPU.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/mesh.hpp>

namespace pointskin {

/// An sRGB picture, 8 bits a channel.
struct Image {
  int width = 0, height = 0;      ///< pixels
  std::vector<std::uint8_t> rgb;  ///< shape (height, width, 3), rows from top to bottom
};

/// The axis of the mesh that points up in the picture.
enum class UpAxis {
  y,  ///< the front of the mesh is +z
  z,  ///< the front of the mesh is -y
};

enum class Projection { perspective, orthographic };

struct RenderOptions {
  int width = 1200, height = 900;  ///< pixels, each in [1, 16384]
  double azimuth_degrees = 30;     ///< camera about the up axis, counter-clockwise seen from above; 0 sees the front
  double elevation_degrees = 20;   ///< camera above the horizon, in [-90, 90]
  std::optional<Vec3d> target_world{};  ///< the point in the middle of the picture; none: the bounding box's centre
  UpAxis up = UpAxis::y;
  Projection projection = Projection::perspective;
  bool smooth = true;      ///< true: shade by vertex normals where the mesh has them; false: by face normals
  bool back_faces = true;  ///< true: triangles seen from behind are drawn, in a clearly different tone; false: left out
  bool colours = true;     ///< true: attributes red, green and blue, if the mesh has them, tint the front faces
  int threads = 0;         ///< CPU threads, 0: all
};

/// Draws `mesh` on a light background. The camera is fitted to the sphere about the centre of the mesh's bounding box,
/// or about RenderOptions::target_world,
/// that just holds the mesh: its outline is a circle in the middle of the picture with kRenderFill of the shorter side
/// as its diameter. uint8 colours, and float colours that exceed 1, count from 0 to 255; other float colours from 0
/// to 1. Triangles with a vertex that is not finite are left out; a mesh without triangles gives the empty background.
/// O(t height / 32 + pixels covered). Deterministic: the same bytes for any number of threads.
/// @throws Error usage if an option is out of its range, invalid_input if a triangle names a vertex that does not exist
Image render(const Mesh& mesh, const RenderOptions& options = {});

/// Part of the picture's shorter side that the mesh's bounding sphere fills.
inline constexpr double kRenderFill = 0.92;

/// Writes `image` as an 8-bit RGB PNG, whatever the extension of `path`; with the promises of write_mesh (io.hpp): the
/// file appears whole or not at all.
/// @throws Error usage if the size of `rgb` is not 3 width height or there are no pixels, output_not_written
void write_png(const std::string& path, const Image& image);

}  // namespace pointskin
