// Files that go to and from pages: uploads, downloads, and what is saved below the roots.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "scene/json_reader.hpp"
#include "scene/operations.hpp"
#include "services.hpp"
#include "studio/session/application.hpp"

namespace pointskin::studio {

/// All functions may be called from any thread.
class Exchange {
 public:
  /// @param folder  of the program's own files; folders in it are made
  explicit Exchange(std::filesystem::path folder, const Roots& roots);

  [[nodiscard]] std::filesystem::path upload_folder() const;
  std::uint64_t uploaded(const std::filesystem::path& file, const std::string& name);
  std::optional<Download> download(std::uint64_t id);

  /// The file that a message names: {"path": below a root}, {"upload": id}, or a shape {"shape": name, "points": n}.
  /// @throws Error usage, or invalid_input for a path that leads out of the roots
  [[nodiscard]] scene::SolidSource source(const scene::JsonReader& json) const;
  /// @throws Error invalid_input
  [[nodiscard]] std::filesystem::path readable(const std::string& path) const;
  /// @throws Error usage
  [[nodiscard]] std::filesystem::path upload(std::int64_t id) const;

  /// Puts a file where the request `save` says: `write` is called with the path to write to, and with the folder that
  /// the file will be in. @returns {"path"} or {"download"}, and {"bytes"}
  using Write = std::function<void(const std::string& path, const std::filesystem::path& folder)>;
  Json save(const scene::JsonReader& request, const Write& write);

  /// The request `files`: what is in a folder, by kinds.
  [[nodiscard]] Json list(const std::string& folder) const;

 private:
  [[nodiscard]] std::filesystem::path own_folder(const char* name) const;
  Json save_for_download(const std::string& name, const Write& write);

  std::filesystem::path folder_;
  const Roots& roots_;
  mutable std::mutex mutex_;
  std::uint64_t last_ = 0;
  std::map<std::uint64_t, std::filesystem::path> uploads_;
  std::map<std::uint64_t, Download> downloads_;
};

/// "cloud", "mesh", "session", "sequence" or "other", by the name of a file.
std::string kind_of_file(const std::string& name);

}  // namespace pointskin::studio
