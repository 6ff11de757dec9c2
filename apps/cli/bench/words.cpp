#include "bench/words.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "args.hpp"

namespace pointskin::cli {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n'; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// Reads one text from left to right.
class Splitter {
 public:
  explicit Splitter(const std::string& text) : text_(text) {}

  std::vector<std::string> words() {
    std::vector<std::string> words;
    for (skip_blanks(); at_ < text_.size(); skip_blanks()) words.push_back(word());
    return words;
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }

  std::string word() {
    std::string word;
    while (at_ < text_.size() && !is_blank(text_[at_])) {
      const char c = text_[at_++];
      if (c == '\'' || c == '"') {
        append_quoted(word, c);
      } else {
        word += c == '\\' ? next("a backslash ends it") : c;
      }
    }
    return word;
  }

  void append_quoted(std::string& word, char quote) {
    const char* const problem = quote == '"' ? "a \" is not closed" : "a ' is not closed";
    for (char c = next(problem); c != quote; c = next(problem)) {
      const bool escape = quote == '"' && c == '\\' && at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\\');
      word += escape ? text_[at_++] : c;
    }
  }

  char next(const char* problem) {
    if (at_ == text_.size()) throw_usage(fmt::format("the command {} is no command: {}", text_, problem));
    return text_[at_++];
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

std::string filled(const std::string& word, const std::map<std::string, std::string>& values) {
  std::string result;
  for (std::size_t at = 0; at < word.size();) {
    const std::size_t end = word[at] == '{' ? word.find('}', at) : std::string::npos;
    const std::string name = end == std::string::npos ? "" : word.substr(at + 1, end - at - 1);
    if (name.empty() || !std::all_of(name.begin(), name.end(), is_letter)) {
      result += word[at++];
      continue;
    }
    const auto value = values.find(name);
    if (value == values.end()) throw_usage(fmt::format("the command names {{{}}}, which is not known", name));
    result += value->second;
    at = end + 1;
  }
  return result;
}

bool is_plain(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string("-_./:=,+@%").find(c) != std::string::npos;
}

}  // namespace

std::vector<std::string> split_words(const std::string& text) {
  std::vector<std::string> words = Splitter(text).words();
  if (words.empty()) throw_usage("the command is empty");
  return words;
}

std::vector<std::string> fill_in(std::vector<std::string> words, const std::map<std::string, std::string>& values) {
  for (std::string& word : words) word = filled(word, values);
  return words;
}

std::string quoted(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

}  // namespace pointskin::cli
