#include "arguments.hpp"

#include <pointskin/error.hpp>

#include <charconv>
#include <cstdio>
#include <exception>

namespace pointskin::bench {
namespace {

template <class T>
T parse(const std::string& text, const std::string& option) {
  T number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size())
    throw Error(ErrorCode::usage, "'" + text + "' after " + option + " is no such number");
  return number;
}

}  // namespace

std::optional<std::string> Arguments::next() {
  if (at_ == words_.size()) return std::nullopt;
  return words_[at_++];
}

std::string Arguments::value() {
  if (at_ == words_.size()) throw Error(ErrorCode::usage, words_[at_ - 1] + " needs a value");
  return words_[at_++];
}

std::int64_t Arguments::whole_number() {
  const std::string text = value();
  return parse<std::int64_t>(text, words_[at_ - 2]);
}

double Arguments::number() {
  const std::string text = value();
  return parse<double>(text, words_[at_ - 2]);
}

void Arguments::refuse() const { throw Error(ErrorCode::usage, "'" + words_[at_ - 1] + "' is not known; see --help"); }

int run_main(const char* program, int argc, char** argv, int (*body)(const std::vector<std::string>&)) {
  try {
    return body({argv + 1, argv + argc});
  } catch (const Error& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: internal error: %s\n", program, error.what());
    return static_cast<int>(ErrorCode::internal);
  }
}

}  // namespace pointskin::bench
