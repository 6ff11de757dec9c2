// Cameras, areas and placements in documents.
#pragma once

#include <functional>

#include <nlohmann/json.hpp>

#include <pointskin/camera.hpp>
#include <pointskin/edit.hpp>
#include <pointskin/render.hpp>

#include "scene/json_reader.hpp"

namespace pointskin::scene {

/// The camera of the picture that render() draws of the present surface.
using CameraOfPicture = std::function<Camera(const RenderOptions&)>;

/// Matrices, or options as those of `pointskin render`, which `camera_of_picture` turns into a camera.
/// All functions that read throw Error invalid_input, in one line with the place.
Camera read_camera(const JsonReader& json, const CameraOfPicture& camera_of_picture);
nlohmann::ordered_json camera_json(const Camera& camera);

/// A list of [x, y].
std::vector<Pixel> read_pixels(const JsonReader& json);

/// "area": polygons, or "rectangle": two opposite corners; empty for none.
Area read_area(const JsonReader& json);

/// "scale", "rotation" (nine numbers row by row, or an axis and degrees) and "translation", each where it is there.
Similarity read_placement(const JsonReader& json);
/// Adds the three keys.
void write_placement(const Similarity& placement, nlohmann::ordered_json& json);

}  // namespace pointskin::scene
