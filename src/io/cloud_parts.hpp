// A cloud in one file or several, read in parts: for clouds that memory does not hold.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>

#include "exec/cpu.hpp"
#include "io/file_parts.hpp"

namespace pointskin::io {

/// The points that read_cloud() reads of each file, merged by merge_into(): in the order of the files, with the same origin,
/// positions and attributes, part by part.
class CloudParts {
 public:
  using Bytes = FileParts::Bytes;

  static constexpr std::size_t kMostFiles = 200;  ///< that are open at once

  /// @returns null if FileParts::can_open() is false for a file
  /// @throws Error invalid_input as FileParts::open(); usage for none, or more than kMostFiles
  static std::unique_ptr<CloudParts> open(exec::Cpu& ex, const std::vector<std::string>& paths);
  static std::unique_ptr<CloudParts> open(exec::Cpu& ex, const std::string& path) {
    return open(ex, std::vector<std::string>{path});
  }

  /// Rows of the files; some may hold no point.
  [[nodiscard]] std::int64_t rows() const { return files_.back().first_row + files_.back().parts->rows(); }

  /// Chooses the origins of the files as FileParts does, and that of the merged cloud; for several files with origins of
  /// their own one pass more over their coordinates.
  /// @throws Error as FileParts::choose_origin
  void choose_origin(exec::Cpu& ex, const std::optional<Vec3d>& shift);

  /// Names and types of the points' attributes, without values; before an origin is chosen, too.
  [[nodiscard]] std::vector<Attribute> attributes(exec::Cpu& ex) const;
  /// Names of those of integers that some files lack.
  [[nodiscard]] std::vector<std::string> integers_with_gaps(exec::Cpu& ex) const;

  /// What positions are relative to, once it has been chosen.
  [[nodiscard]] const Vec3d& origin() const { return origin_; }

  /// As FileParts.
  void leave_out_zero_normals();

  /// As FileParts::read.
  Cloud read(exec::Cpu& ex, std::int64_t first, std::int64_t count, Bytes& buffer) const;

  /// As FileParts::for_parts.
  void for_parts(exec::Cpu& ex, const std::function<void(Cloud&)>& use) const { for_parts(ex, 0, rows(), use); }
  void for_parts(exec::Cpu& ex, std::int64_t begin, std::int64_t end, const std::function<void(Cloud&)>& use) const;

 private:
  struct File {
    std::unique_ptr<FileParts> parts;
    std::int64_t first_row = 0;  ///< among those of all
    bool is_used = true;         ///< false without points: then it adds no attributes, and has a say in nothing
    std::vector<Vec3d> moves{};  ///< of its positions, one after the other
  };

  void settle_origins(exec::Cpu& ex);
  void settle_schema(exec::Cpu& ex);
  /// A cloud of one point that has the merged attributes.
  [[nodiscard]] Cloud merged_sample(exec::Cpu& ex) const;
  void merge(const File& file, Cloud& cloud) const;
  /// Calls use(file, first, count) for the files that rows begin..end - 1 lie in.
  template <class Use>
  void for_files(std::int64_t begin, std::int64_t end, const Use& use) const;

  std::vector<File> files_;
  Vec3d origin_{0, 0, 0};
  bool has_normals_ = true;        ///< all files that have points
  std::vector<Attribute> schema_;  ///< of several files: what each point gets, without values
};

}  // namespace pointskin::io
