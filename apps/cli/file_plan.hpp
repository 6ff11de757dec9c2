// What a command reads and writes, compared before it begins: no file of the user's is replaced unasked, and none is
// written twice.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pointskin::cli {

/// A file that belongs to no frame of a sequence.
inline constexpr std::int64_t kNoFrame = -1;

struct InputFile {
  std::string file;               ///< "-": stdin. May be missing: the reader tells
  std::int64_t frame = kNoFrame;  ///< that alone is made of it; kNoFrame: all are
};

enum class OutputKind {
  result,  ///< may go to stdout
  file,    ///< may not
  report,  ///< may not, and replaces no input, whatever was asked
};

struct OutputFile {
  const char* option;  ///< that names it
  std::string file;    ///< "-": stdout; empty: not asked for
  OutputKind kind = OutputKind::result;
  std::int64_t frame = kNoFrame;
};

/// All files of a run. Names of sequences are written out, a file a frame.
struct FilePlan {
  std::vector<InputFile> inputs;
  std::vector<OutputFile> outputs;
  bool overwrite = false;  ///< --overwrite: results may replace inputs, those of a frame the frame's own

  /// Adds a frame of a sequence: what is read and, with -o, written.
  void add_frame(const std::string& input, const std::string& output, OutputKind kind);
};

/// Compares all outputs with all inputs and with each other, by what their names stand for (see FileIdentity).
/// @throws Error usage if two outputs are one file, an output would replace an input and that is not allowed, stdin is
///         read twice, or stdout would carry two things
/// O(n log n). The file system is asked once a file.
void check_files(const FilePlan& plan);

/// The same where there is one run, not a sequence.
void check_distinct(const std::vector<std::string>& inputs, const std::vector<OutputFile>& outputs,
                    bool overwrite = false);

}  // namespace pointskin::cli
