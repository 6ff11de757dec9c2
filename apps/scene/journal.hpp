// What was done to a scene, on disk before anybody is told that it was done: JSON lines that are appended to.
//
//   {"version": 1, "clouds": [..], "shift": "auto", "options": {..}}    the beginning, as in a document
//   {"apply": {"op": ..}}                                               after those done so far; the undone are forgotten
//   {"go": 3}                                                           the first 3 are done now
//
// Files in it have absolute paths.
#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "scene/document.hpp"

namespace pointskin::scene {

/// A journal that is open for writing. Not safe for two threads at once.
class Journal {
 public:
  /// Creates the file `path`, readable and writable by its owner alone (mode 0600), with `beginning` as its first lines
  /// (its operations too, if it has any), and syncs it and its folder. A file that is there is replaced at once.
  /// @throws Error output_not_written
  static Journal create(const std::string& path, const Document& beginning);

  /// Opens a journal to go on with it; a torn last line is cut off. @throws Error output_not_written
  static Journal open(const std::string& path);

  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&& other) noexcept;
  ~Journal();

  /// Both return when the line is on the disk (fsync). @throws Error output_not_written; what part of the line was
  /// written is cut off again
  void apply(const SceneOperation& operation);
  void go(std::size_t done);

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  Journal(std::string path, int file);
  void append(const nlohmann::ordered_json& line);

  std::string path_;
  int file_ = -1;
};

/// What a journal says: its beginning, all operations that are not forgotten, and how many are done. A last line that
/// is not whole does not count.
/// @throws Error invalid_input, naming file and line, if it cannot be read or another line is not as above
Document read_journal(const std::string& path);

}  // namespace pointskin::scene
