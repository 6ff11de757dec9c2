// Pictures of meshes and clouds, drawn on the CPU.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin PSK_EXPORT {

/// An sRGB picture, 8 bits a channel.
struct Image {
  int width = 0, height = 0;      ///< pixels
  std::vector<std::uint8_t> rgb;  ///< shape (height, width, 3), rows from top to bottom
};

/// The axis that points up in the picture. The front is what azimuth 0 and elevation 0 see; x points to the right there
/// wherever it does not point up or down, so `minus_y` shows what a depth camera saw (x right, y down, z away).
enum class UpAxis {
  y,        ///< the front is +z
  z,        ///< the front is -y
  x,        ///< the front is +z, and y points to the left
  minus_x,  ///< the front is +z, and y points to the right
  minus_y,  ///< the front is -z
  minus_z,  ///< the front is +y
};

enum class Projection { perspective, orthographic };

/// What the camera is fitted to.
enum class Fit {
  box,     ///< what is seen: its outline fills kRenderFill of the picture's width or height and is centred in both
  sphere,  ///< the sphere about the middle of the bounding box that holds all: the same size from every side
};

/// How values become colours. Both maps are even steps to the eye, and to eyes that do not tell red from green.
enum class ColourMap {
  automatic,   ///< diverging where the range reaches from below 0 to above it, on both sides by 1/10 of the larger side
  sequential,  ///< dark violet, blue, green, yellow: darker is less
  diverging,   ///< blue below 0, light at 0, orange above: the same distance from 0 is equally strong
};

/// Lowest and highest value of a scale.
struct ValueRange {
  double low = 0, high = 0;
};

/// A box in world coordinates.
struct WorldBox {
  Vec3d lower{}, upper{};
};

struct RenderOptions {
  int width = 1200, height = 900;  ///< pixels, each in [1, 16384]

  // The view.
  double azimuth_degrees = 30;    ///< camera about the up axis, counter-clockwise seen from above; 0 sees the front
  double elevation_degrees = 20;  ///< camera above the horizon, in [-90, 90]
  std::optional<Vec3d> target_world{};  ///< the point in the middle of the picture; none: what Fit says
  UpAxis up = UpAxis::y;
  Projection projection = Projection::perspective;
  Fit fit = Fit::box;
  /// What the camera is fitted to instead of what is drawn, so that several pictures have one camera. Nothing that is
  /// drawn should lie outside.
  std::optional<WorldBox> fit_world{};
  double zoom = 1;  ///< enlarges the picture about its middle; the viewer stays where it is; in (0, 1000]
  /// Vertical field of view of the perspective at zoom 1, in [1, 170] degrees. None: 30.3 degrees for the shorter side.
  std::optional<double> field_of_view_degrees{};

  // The surface.
  bool smooth = true;      ///< false: shade a mesh by face normals and a cloud as if it had no normals
  bool back_faces = true;  ///< true: what is seen from behind is drawn, in a clearly different tone; false: left out
  bool colours = true;     ///< true: attributes red, green and blue, if there are all three, tint the front
  bool shadows = true;     ///< true: shadows of one light, and less light of all others in creases and hollows
  bool wireframe = false;  ///< a mesh's edges over its surface, hidden ones removed
  double point_size = 0;   ///< diameter of a cloud's points in pixels, in [0, 1000]; 0: see point_size_world
  double point_size_world = 0;  ///< diameter of a cloud's points in world units, >= 0; 0: by their spacing

  // Colours by an attribute.
  std::string colour_by{};  ///< name of the attribute that colours the front, or "x", "y" or "z" (world); empty: none
  std::optional<ValueRange> range{};  ///< what the map spans, low < high, finite; none: value_range()
  ColourMap colour_map = ColourMap::automatic;
  bool colour_bar = true;  ///< true: the scale stands at the right, in pictures of 160 x 120 pixels and more

  int threads = 0;  ///< CPU threads, 0: all
};

/// What a picture shows.
struct RenderReport {
  double covered = 0;                 ///< share of the picture that is not background, in [0, 1]
  double behind = 0;                  ///< share of that which is seen from behind, in [0, 1]
  std::optional<ValueRange> range{};  ///< of the colours, with RenderOptions::colour_by
  double point_size_world = 0;        ///< diameter of a cloud's points, unless it was given in pixels
  std::int64_t strays = 0;            ///< points of a cloud that the camera was not fitted to, see find_strays()
};

/// Draws `mesh` on a light background. uint8 colours, and float colours that exceed 1, count from 0 to 255; other float
/// colours from 0 to 1. Where an attribute that colours has no value (NaN) the surface is neutral grey. Triangles with
/// a vertex that is not finite are left out; a mesh without triangles gives the empty background.
/// O(t + samples covered). Deterministic: the same bytes for any number of threads.
/// @param report  receives what the picture shows, if not null
/// @throws Error usage if an option is out of its range or there is no attribute of that name (the story lists those
///         there are), invalid_input if a triangle names a vertex that does not exist
Image render(const Mesh& mesh, const RenderOptions& options = {}, RenderReport* report = nullptr);

/// Draws `cloud` as discs: along the surface where a point has a normal, as balls that face the viewer where it has
/// none, lit by what the picture's depth says of the surface. Discs are as wide as the points are apart, and never
/// thinner than a pixel. Points turned away from the viewer have the tone of back faces. Stray points (find_strays) do
/// not count for the camera. Otherwise as for meshes. O(n log n + samples covered).
Image render(const Cloud& cloud, const RenderOptions& options = {}, RenderReport* report = nullptr);

/// The range that the colours of render() span by default: from the 1st to the 99th percentile of the finite values of
/// the attribute `name` (or "x", "y", "z", in world coordinates); from the smallest to the largest where those are
/// equal. None if no value is finite. O(n).
/// @throws Error usage, listing the attributes, if there is none of that name
std::optional<ValueRange> value_range(const Mesh& mesh, const std::string& name);
std::optional<ValueRange> value_range(const Cloud& cloud, const std::string& name);

/// The box around all that the camera of render() is fitted to, for RenderOptions::fit_world; none if that is nothing.
/// O(v + t), O(n). @throws Error invalid_input if a triangle names a vertex that does not exist
std::optional<WorldBox> fitted_box(const Mesh& mesh, int threads = 0);
std::optional<WorldBox> fitted_box(const Cloud& cloud, int threads = 0);

/// Part of the picture's width or height that the outline (Fit::box), and of its shorter side that the bounding sphere
/// (Fit::sphere) fills.
inline constexpr double kRenderFill = 0.92;

/// `image` as the bytes of an 8-bit RGB PNG.
/// @throws Error usage if the size of `rgb` is not 3 width height or there are no pixels
std::string png_of(const Image& image);

/// Writes `image` as an 8-bit RGB PNG, whatever the extension of `path`; with the promises of write_mesh (io.hpp): the
/// file appears whole or not at all.
/// @throws Error usage if the size of `rgb` is not 3 width height or there are no pixels, output_not_written
void write_png(const std::string& path, const Image& image);

}  // namespace pointskin
