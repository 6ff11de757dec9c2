// Scripts of editing sessions: JSON in, operations out, and back. docs/cli.md describes the format.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/edit.hpp>
#include <pointskin/render.hpp>

namespace pointskin::cli {

/// One entry of a script.
struct ScriptStep {
  enum class Kind { apply, undo, redo };
  Kind kind = Kind::apply;
  Operation operation;  ///< with Kind::apply
};

/// A script, read and checked but for the cameras that are told as a picture's: those are known when their turn comes.
class EditScript {
 public:
  /// @throws Error invalid_input, naming the file and the place, for whatever is wrong
  explicit EditScript(const std::string& path);

  [[nodiscard]] std::size_t size() const;
  /// The files that it inserts parts of.
  [[nodiscard]] std::vector<std::string> parts() const;
  /// Step i.
  /// @param camera_of_picture  the camera of the picture that render() draws of the present surface
  /// @throws Error invalid_input; as read_cloud for a part that cannot be read
  [[nodiscard]] ScriptStep step(std::size_t i,
                                const std::function<Camera(const RenderOptions&)>& camera_of_picture) const;

 private:
  std::string path_;
  nlohmann::json json_;
};

/// The script that replays `operations`, with all cameras as matrices and parts named as seen from the folder of
/// `path`, where it is to be written.
nlohmann::ordered_json script_of(const std::vector<Operation>& operations, const std::string& path);

}  // namespace pointskin::cli
