#include "frame_files.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>

#include <pointskin/error.hpp>

namespace pointskin::scene {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kPlace = "{}";

[[noreturn]] void refuse(const std::string& story) { throw Error(ErrorCode::usage, story); }

/// The digits of `name` where {} stands, or none if it is another file.
std::optional<std::string> number_in(const std::string& name, std::string_view before, std::string_view after) {
  if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) return {};
  const std::string number = name.substr(before.size(), name.size() - before.size() - after.size());
  const bool digits = std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
  return digits && number.size() <= 18 ? std::optional(number) : std::nullopt;
}

std::int64_t value_of(const std::string& number) {
  std::int64_t value = 0;
  std::from_chars(number.data(), number.data() + number.size(), value);
  return value;
}

}  // namespace

bool is_pattern(const std::string& name) { return name.find(kPlace) != std::string::npos; }

std::string with_number(const std::string& pattern, const std::string& number) {
  const std::size_t place = pattern.find(kPlace);
  return place == std::string::npos ? pattern : pattern.substr(0, place) + number + pattern.substr(place + 2);
}

std::string frame_file(const std::string& pattern, int frame, int frames) {
  const std::size_t digits = std::to_string(frames - 1).size();
  std::string number = std::to_string(frame);
  number.insert(0, digits - number.size(), '0');
  return with_number(pattern, number);
}

void check_pattern(const std::string& pattern, const char* option, const char* because) {
  if (pattern.empty() || is_pattern(pattern)) return;
  refuse(fmt::format("{}: {} needs {{}}, where the frame's number goes, because of {}", option, pattern, because));
}

void check_patterns(const std::string& input, const std::string& output, const char* option) {
  if (!is_pattern(input) && is_pattern(output))
    refuse(fmt::format("{}: {} has {{}}, but the input has none", option, output));
  if (is_pattern(input) && !is_pattern(output))
    refuse(fmt::format("{}: {} needs {{}}, where the frame's number goes, as the input has it", option, output));
}

std::vector<FrameFile> find_frames(const std::string& pattern, std::optional<std::int64_t> first,
                                   std::optional<std::int64_t> last) {
  if (!is_pattern(pattern)) {
    if (first || last) refuse("--first and --last need {} in the name of the input");
    return {{pattern, ""}};
  }
  const fs::path path(pattern);
  const std::string name = path.filename().string();
  const std::size_t place = name.find(kPlace);
  if (place == std::string::npos || name.find(kPlace, place + 2) != std::string::npos ||
      is_pattern(path.parent_path().string()))
    refuse(fmt::format("{}: {{}} must stand once, in the name of the file", pattern));
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::vector<FrameFile> frames;
  std::error_code failure;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure)) {
    const auto number = number_in(entry->path().filename().string(), std::string_view(name).substr(0, place),
                                  std::string_view(name).substr(place + 2));
    if (!number || (first && value_of(*number) < *first) || (last && value_of(*number) > *last)) continue;
    frames.push_back({with_number(pattern, *number), *number});
  }
  if (failure)
    throw Error(ErrorCode::invalid_input, fmt::format("{}: cannot be listed: {}", folder.string(), failure.message()));
  if (frames.empty())
    throw Error(ErrorCode::invalid_input,
                fmt::format("{}: there is no such file{}; is the name right?", pattern,
                            first || last ? " between --first and --last" : " with a number in place of {}"));
  std::sort(frames.begin(), frames.end(), [](const FrameFile& a, const FrameFile& b) {
    const std::int64_t x = value_of(a.number);
    const std::int64_t y = value_of(b.number);
    return x != y ? x < y : a.number.size() < b.number.size();
  });
  return frames;
}

}  // namespace pointskin::scene
