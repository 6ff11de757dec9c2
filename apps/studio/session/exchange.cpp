#include "exchange.hpp"

#include <unistd.h>

#include <set>
#include <system_error>
#include <utility>

#include <pointskin/error.hpp>
#include <pointskin/formats.hpp>

#include "utf8.hpp"

namespace pointskin::studio {
namespace {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw Error(ErrorCode::output_not_written, folder.string() + ": cannot be made: " + failure.message());
  fs::permissions(folder, fs::perms::owner_all, failure);
}

/// A name that is one, of a file in a folder of its own.
std::string plain_name(const std::string& name) {
  std::string plain = fs::path(name).filename().string();
  for (char& c : plain)
    if (static_cast<unsigned char>(c) < ' ' || c == '/' || c == 127) c = '_';
  if (plain.empty() || plain == "." || plain == ".." || !is_utf8(plain)) return "upload";
  constexpr std::size_t kLongest = 200;
  return plain.size() > kLongest ? plain.substr(plain.size() - kLongest) : plain;
}

/// "frame_{}.vtk" for "frame_12.vtk"; empty for a name without a number before the extension.
std::string pattern_of(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot == 0) return "";
  std::size_t first = dot;
  while (first > 0 && name[first - 1] >= '0' && name[first - 1] <= '9') --first;
  return first == dot ? "" : name.substr(0, first) + "{}" + name.substr(dot);
}

}  // namespace

std::string kind_of_file(const std::string& name) {
  const std::string extension = extension_of(name);
  if (extension == ".json" || extension == ".jsonl") return "session";
  const FormatInfo* format = format_of(name);
  if (format == nullptr) return "other";
  return format->reads_meshes && extension != ".ply" ? "mesh" : "cloud";
}

Exchange::Exchange(fs::path folder, const Roots& roots) : folder_(std::move(folder)), roots_(roots) {
  make_folder(folder_);
  make_folder(folder_ / "uploads");
}

fs::path Exchange::upload_folder() const { return folder_ / "uploads"; }

fs::path Exchange::own_folder(const char* name) const {
  std::string place = (folder_ / name / "XXXXXX").string();
  make_folder(folder_ / name);
  if (mkdtemp(place.data()) == nullptr) throw Error(ErrorCode::output_not_written, place + ": cannot be made");
  return place;
}

std::uint64_t Exchange::uploaded(const fs::path& file, const std::string& name) {
  const fs::path kept = own_folder("uploads") / plain_name(name);
  fs::rename(file, kept);
  const std::lock_guard lock(mutex_);
  uploads_[++last_] = kept;
  return last_;
}

std::optional<Download> Exchange::download(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  const auto found = downloads_.find(id);
  if (found == downloads_.end()) return std::nullopt;
  Download download = std::move(found->second);
  downloads_.erase(found);
  return download;
}

fs::path Exchange::upload(std::int64_t id) const {
  const std::lock_guard lock(mutex_);
  const auto found = uploads_.find(static_cast<std::uint64_t>(id));
  if (found == uploads_.end()) throw Error(ErrorCode::usage, "there is no upload " + std::to_string(id));
  return found->second;
}

fs::path Exchange::readable(const std::string& path) const { return roots_.open_read(path).path(); }

scene::SolidSource Exchange::source(const scene::JsonReader& json) const {
  json.object({"path", "upload", "shape", "points"});
  scene::SolidSource source;
  constexpr std::int64_t kMostPoints = 100'000'000, kMostUploads = std::int64_t{1} << 50;
  if (json.has("points")) source.points = json.at("points").whole_number(1, kMostPoints);
  if (json.has("shape"))
    source.shape = json.at("shape").text();
  else if (json.has("upload"))
    source.file = upload(json.at("upload").whole_number(1, kMostUploads)).string();
  else
    source.file = readable(json.at("path").text()).string();
  return source;
}

Json Exchange::save_for_download(const std::string& name, const Write& write) {
  const fs::path folder = own_folder("downloads");
  const fs::path file = folder / plain_name(name);
  write(file.string(), folder);
  const auto bytes = fs::file_size(file);
  const std::lock_guard lock(mutex_);
  downloads_[++last_] = {file, file.filename().string(), true};
  return {{"download", last_}, {"bytes", bytes}};
}

Json Exchange::save(const scene::JsonReader& request, const Write& write) {
  const std::string name = request.at("name").text();
  if (request.has("download") && request.at("download").boolean()) return save_for_download(name, write);
  const std::string folder = request.has("folder") ? request.at("folder").text() : ".";
  const bool overwrite = request.has("overwrite") && request.at("overwrite").boolean();
  WritableFile file = roots_.prepare_write(folder, name, overwrite);
  try {
    write(file.pinned_path(), file.path().parent_path());
  } catch (const Error& error) {
    throw Error(error.code(), file.readable(error.what()));
  }
  const std::int64_t bytes = file.commit();
  return {{"path", file.path().string()}, {"bytes", bytes}};
}

Json Exchange::list(const std::string& folder) const {
  const fs::path asked = folder.empty() ? roots_.folders().front() : fs::path(folder);
  Json entries = Json::array();
  std::set<std::string> patterns, twice;
  const auto found = roots_.list(asked);
  for (const FolderEntry& entry : found)
    if (const std::string pattern = entry.is_folder ? "" : pattern_of(entry.name); !pattern.empty())
      (patterns.insert(pattern).second ? patterns : twice).insert(pattern);
  for (const FolderEntry& entry : found) {
    const std::string kind = entry.is_folder ? "folder" : kind_of_file(entry.name);
    if (kind != "other") entries.push_back({{"name", entry.name}, {"kind", kind}, {"bytes", entry.bytes}});
  }
  for (const std::string& pattern : twice)
    if (kind_of_file(pattern) != "other") entries.push_back({{"name", pattern}, {"kind", "sequence"}, {"bytes", 0}});
  const fs::path absolute = asked.is_absolute() ? asked : roots_.folders().front() / asked;
  return {{"folder", absolute.lexically_normal().string()}, {"entries", std::move(entries)}};
}

}  // namespace pointskin::studio
