// Files of a sequence: "frame_{}.vtk" stands for all files whose name has a number there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pointskin::scene {

/// One frame of a sequence.
struct FrameFile {
  std::string path;
  std::string number;  ///< as it stands in the name, with its zeros; empty for a single file
};

/// True if a name stands for several files.
bool is_pattern(const std::string& name);

/// `pattern` with `number` in place of {}.
std::string with_number(const std::string& pattern, const std::string& number);

/// The file of frame `frame` of `frames`: its number has as many digits as that of the last one.
std::string frame_file(const std::string& pattern, int frame, int frames);

/// Checks that the name of an output says where the frame's number goes. An empty one passes.
/// @param option, because  for the story: of the output, and what makes several files of it
/// @throws Error usage
void check_pattern(const std::string& pattern, const char* option, const char* because);

/// Checks that an output has {} if and only if the input has it. @param option  of the output @throws Error usage
void check_patterns(const std::string& input, const std::string& output, const char* option);

/// The files that `pattern` stands for, in the order of their numbers (of equal ones, that with fewer digits first);
/// `pattern` itself if it has no {}.
/// @param first, last  only frames with these numbers and those between
/// @throws Error usage if {} stands in the folder's name or twice, invalid_input if there is no such file
std::vector<FrameFile> find_frames(const std::string& pattern, std::optional<std::int64_t> first,
                                   std::optional<std::int64_t> last);

}  // namespace pointskin::scene
