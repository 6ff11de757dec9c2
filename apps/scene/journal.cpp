#include "scene/journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <pointskin/error.hpp>

namespace pointskin::scene {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void fail(const std::string& path, const char* what) {
  throw Error(ErrorCode::output_not_written, fmt::format("{}: {}: {}", path, what, std::strerror(errno)));
}

void write_all(int file, std::string_view bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(path, "cannot be written");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// Makes sure that the folder of `path` names it.
void sync_folder(const std::string& path) {
  const std::string folder = std::filesystem::absolute(path).parent_path().string();
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) fail(folder, "cannot be opened");
  const bool synced = ::fsync(file) == 0;
  ::close(file);
  if (!synced) fail(folder, "cannot be synced");
}

std::string line_of(const Json& json) { return json_text(json, -1) + "\n"; }

/// The lines that a journal with this beginning has.
std::string lines_of(const Document& beginning) {
  Json first = to_json(beginning, "");
  first.erase("operations");
  first.erase("done");
  std::string lines = line_of(first);
  for (const Json& operation : beginning.operations) lines += line_of({{"apply", operation}});
  if (beginning.done < beginning.operations.size()) lines += line_of({{"go", beginning.done}});
  return lines;
}

/// The part that consists of whole lines.
std::string_view whole_lines(const std::string& text) {
  const std::size_t end = text.rfind('\n');
  return std::string_view(text).substr(0, end == std::string::npos ? 0 : end + 1);
}

/// @param as_written  the same, with the keys in their order
void take_line(const JsonReader& line, const Json& as_written, Document& document) {
  line.object({"apply", "go"});
  if (line.value().size() != 1) line.refuse("must have one of the keys apply and go");
  if (line.has("go")) {
    const auto count = static_cast<std::int64_t>(document.operations.size());
    document.done = static_cast<std::size_t>(line.at("go").whole_number(0, count));
    return;
  }
  const JsonReader operation = line.at("apply");
  check_operation(operation.value(), operation.place());
  if (is_undo(operation.value()) || is_redo(operation.value())) operation.refuse("is no operation of a journal");
  document.operations.resize(document.done);
  document.operations.push_back(as_written.at("apply"));
  document.done = document.operations.size();
}

Document first_line(const std::string& text, const std::string& place) {
  nlohmann::json json = parse_json(text, place);
  JsonReader(json, place).object({"version", "clouds", "shift", "options"});
  json["operations"] = nlohmann::json::array();
  return parse_document(json.dump(), place, "/");
}

}  // namespace

Journal::Journal(std::string path, int file) : path_(std::move(path)), file_(file) {}
Journal::Journal(Journal&& other) noexcept : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}
Journal& Journal::operator=(Journal&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(file_, other.file_);
  return *this;
}
Journal::~Journal() {
  if (file_ >= 0) ::close(file_);
}

Journal Journal::create(const std::string& path, const Document& beginning) {
  const std::string unfinished = path + ".new";
  std::filesystem::remove(unfinished);
  const int file =
      ::open(unfinished.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC | O_NOFOLLOW, S_IRUSR | S_IWUSR);
  if (file < 0) fail(unfinished, "cannot be created");
  Journal journal(path, file);
  write_all(file, lines_of(beginning), unfinished);
  if (::fsync(file) != 0) fail(unfinished, "cannot be synced");
  if (std::rename(unfinished.c_str(), path.c_str()) != 0) fail(path, "cannot be replaced");
  sync_folder(path);
  return journal;
}

Journal Journal::open(const std::string& path) {
  const std::size_t whole = whole_lines(read_text(path)).size();
  const int file = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (file < 0) fail(path, "cannot be opened");
  Journal journal(path, file);
  if (::ftruncate(file, static_cast<off_t>(whole)) != 0) fail(path, "cannot be cut");
  if (::fsync(file) != 0) fail(path, "cannot be synced");
  return journal;
}

void Journal::append(const Json& line) {
  struct stat before {};
  if (::fstat(file_, &before) != 0) fail(path_, "cannot be asked");
  try {
    write_all(file_, line_of(line), path_);
    if (::fsync(file_) != 0) fail(path_, "cannot be synced");
  } catch (const Error&) {
    if (::ftruncate(file_, before.st_size) != 0) fail(path_, "cannot be cut");
    throw;
  }
}

void Journal::apply(const SceneOperation& operation) { append({{"apply", to_json(operation, "")}}); }
void Journal::go(std::size_t done) { append({{"go", done}}); }

Document read_journal(const std::string& path) {
  const std::string text = read_text(path);
  std::string_view rest = whole_lines(text);
  if (rest.empty()) throw Error(ErrorCode::invalid_input, fmt::format("{}: has no whole line", path));
  Document document;
  for (int number = 1; !rest.empty(); ++number) {
    const std::string line(rest.substr(0, rest.find('\n')));
    rest.remove_prefix(line.size() + 1);
    const std::string place = fmt::format("{}:{}", path, number);
    if (number == 1) {
      document = first_line(line, place);
      continue;
    }
    const nlohmann::json json = parse_json(line, place);
    take_line(JsonReader(json, place), Json::parse(line), document);
  }
  return document;
}

}  // namespace pointskin::scene
