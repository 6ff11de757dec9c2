#include "args.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include <pointskin/error.hpp>

namespace pointskin::cli {
namespace {

std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

/// Power of 1024 that a suffix stands for, or -1.
int power_of(const std::string& suffix) {
  if (suffix.empty() || suffix == "b") return 0;
  const auto letter = std::string_view("kmgt").find(suffix[0]);
  const std::string rest = suffix.substr(1);
  const bool known = letter != std::string_view::npos && (rest.empty() || rest == "b" || rest == "ib");
  return known ? static_cast<int>(letter) + 1 : -1;
}

}  // namespace

void throw_usage(const std::string& story) { throw Error(ErrorCode::usage, story); }

std::int64_t parse_bytes(const std::string& text, const char* option) {
  std::string_view rest = text;
  const std::optional<double> number = scene::take_number(rest);
  const int power = power_of(lower_case(std::string(rest)));
  const double bytes = number.value_or(0) * std::pow(1024.0, std::max(power, 0));
  if (!number || power < 0 || !(bytes >= 1) || !(bytes < 9e18)) {
    throw_usage(
        fmt::format("{}: '{}' is no amount of memory; write for example 8G, 512M or a number of bytes", option, text));
  }
  return static_cast<std::int64_t>(bytes);
}

std::optional<Vec3d> parse_shift(const std::string& text) {
  if (text == "auto") return std::nullopt;
  if (text == "none") return Vec3d{0, 0, 0};
  const std::optional<Vec3d> shift = parse_vector(text);
  if (!shift) throw_usage("--shift: " + not_one_of(text, {"auto", "none", "x,y,z"}));
  return shift;
}

std::string not_one_of(const std::string& text, const std::vector<std::string>& words) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i)
    list += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return fmt::format("'{}' is not {}", text, list);
}

std::function<std::string(const std::string&)> is_one_of(const std::vector<std::string>& words) {
  return [words](const std::string& text) {
    return std::find(words.begin(), words.end(), text) == words.end() ? not_one_of(text, words) : std::string();
  };
}

void check_threads(int threads) {
  constexpr int kMost = 4096;
  if (threads < 0 || threads > kMost) {
    throw_usage(fmt::format("--threads: {} is not in [0, {}]; 0 means all", threads, kMost));
  }
}

Device parse_device(const std::string& text, int threads, const char* option, const char* words) {
  check_threads(threads);
  try {
    return Device::parse(text, threads);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage) throw;
    const bool is_unknown = std::string(error.what()).starts_with("unknown device");
    throw_usage(is_unknown ? fmt::format("{}: '{}' is not {}", option, text, words)
                           : fmt::format("{}: {}", option, error.what()));
  }
}

std::vector<std::string> join_optional_values(std::vector<std::string> args) {
  std::vector<std::string> joined;
  for (std::size_t i = 0; i < args.size(); ++i) {
    joined.push_back(std::move(args[i]));
    if (i + 1 == args.size()) break;
    const std::string& next = args[i + 1];
    const bool confidence = joined.back() == "--confidence" && parse_number(next).has_value();
    const bool data = joined.back() == "--data" && parse_number(next).has_value();
    const bool linear_fit = joined.back() == "--linear-fit" && (next == "on" || next == "off");
    if (confidence || data || linear_fit) joined.back() += "=" + args[++i];
  }
  return joined;
}

}  // namespace pointskin::cli
