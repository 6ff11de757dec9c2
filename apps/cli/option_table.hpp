// Options of the command line, a row each: how one is spelled, what it means, which variable it sets, and how reports
// show it. Parsing, --help, the `options` of the JSON reports and of their schemas all follow from these tables.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <pointskin/vector.hpp>

#include "args.hpp"

namespace pointskin::cli {

/// The variable that a value is read into.
using Target = std::variant<bool*, int*, std::int64_t*, std::uint64_t*, double*, std::string*, std::optional<double>*,
                            std::optional<std::int64_t>*, std::vector<std::string>*>;

/// A value as reports show it.
using Shown = std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string,
                           std::vector<std::string>, std::vector<Vec3d>>;

/// What an option sets, and what it is now.
struct Binding {
  Target target;
  std::function<Shown()> value;
  /// Where the text stands for something else: called once the whole command line has been understood, if the option
  /// was given. Returns what is wrong with it, to be told behind its name; empty: nothing.
  std::function<std::string()> settle{};
  std::vector<std::string> words{};  ///< all that reports may show; empty: anything

  /// A variable that takes the value as it stands. It must outlive the binding.
  template <class T>
  Binding(T* variable) : target(variable), value([variable] { return shown(*variable); }) {}  // NOLINT: a row names it

 private:
  static Shown shown(int value) { return std::int64_t{value}; }
  template <class T>
  static Shown shown(const std::optional<T>& value) {
    return value ? Shown(*value) : Shown(nullptr);
  }
  template <class T>
  static Shown shown(const T& value) {
    return value;
  }
};

/// How the `options` of a report show an option.
struct ReportEntry {
  std::string name{};       ///< empty: not at all
  int place = 1000;         ///< entries stand in the order of their places, those of one place in that of the table
  std::string schema = {};  ///< JSON: what the schema says beside the type, or instead of it: {"minimum": 0}
};

/// What else is asked of an option.
struct OptionRules {
  bool required = false;
  bool no_default = false;                                 ///< --help does not tell it
  std::string excludes{};                                  ///< an option that cannot be given as well
  std::function<std::string(const std::string&)> check{};  ///< returns what is wrong with a text; empty: nothing
};

struct OptionRow {
  /// "-o,--output OUT": names, and what the value is called. Without that a flag, without dashes an argument; empty:
  /// the command has no such option, its reports show it all the same.
  std::string spelling;
  std::string help;  ///< with unit and range
  Binding binding;
  ReportEntry report{};
  OptionRules rules{};

  [[nodiscard]] std::string names() const { return spelling.substr(0, spelling.find(' ')); }
  [[nodiscard]] bool has(const std::string& name) const;  ///< @param name  with its dashes
};

/// A row; of this form, so that tables stay narrow.
inline OptionRow option(std::string spelling, std::string help, Binding binding, ReportEntry report = {},
                        OptionRules rules = {}) {
  return {std::move(spelling), std::move(help), std::move(binding), std::move(report), std::move(rules)};
}

/// Schemas that many entries have.
inline constexpr char kFromZero[] = R"({"minimum": 0})";
inline constexpr char kFromOne[] = R"({"minimum": 1})";
inline constexpr char kNeverNull[] = R"({"type": "string"})";

/// Rows that --help lists together.
struct OptionGroup {
  std::string name;  ///< empty: --help does not list them
  std::vector<OptionRow> rows;
  std::string object{};  ///< reports show them as an object of this name

  /// The row with this name, which there must be.
  OptionRow& row(const std::string& name);
  /// The options remain in reports alone.
  OptionGroup& without(std::initializer_list<const char*> names);
  OptionGroup& unreported();
};

/// All options of a command.
using OptionTable = std::vector<OptionGroup>;

/// The `options` of a report: what all rows with a name there are now.
nlohmann::ordered_json report_of(const OptionTable& table);

/// The same of the table of a command's arguments.
template <class Args, class Json = nlohmann::ordered_json>
Json report_of(OptionTable (*table)(Args&), Args args) {
  return report_of(table(args));
}

/// The JSON schema of that. @param table  before anything is parsed: a text that is empty then may be null
nlohmann::ordered_json schema_of(const OptionTable& table);

/// `binding`, which reports show in another way.
Binding shown_as(Binding binding, std::function<Shown()> value);

/// A text of which `settle` makes something. @param text  the default
Binding text_for(const std::string& text, std::function<std::string(const std::string&)> settle,
                 std::function<Shown()> value);

/// A flag that makes `value` false.
Binding negated(bool& value);

/// A flag that makes `value` what is `on`; reports show whether it is.
template <class E>
Binding turned(E& value, E on) {
  const auto given = std::make_shared<bool>(false);
  Binding binding = given.get();
  binding.value = [&value, on] { return value == on; };
  binding.settle = [&value, on, given] {
    if (*given) value = on;
    return std::string();
  };
  return binding;
}

/// Words, and what each stands for; of two words for the same, reports show the first.
template <class E>
Binding one_of(E& value, const std::vector<std::pair<std::string, E>>& meanings) {
  std::vector<std::string> words;
  for (const auto& [word, meaning] : meanings) words.push_back(word);
  const auto word_now = [&value, meanings] {
    for (const auto& [word, meaning] : meanings)
      if (meaning == value) return word;
    return std::string();
  };
  Binding binding = text_for(
      word_now(),
      [&value, meanings, words](const std::string& text) {
        for (const auto& [word, meaning] : meanings)
          if (word == text) return value = meaning, std::string();
        return not_one_of(text, words);
      },
      word_now);
  for (std::size_t i = 0; i < words.size(); ++i) {
    bool first = true;
    for (std::size_t j = 0; j < i; ++j) first = first && meanings[j].second != meanings[i].second;
    if (first) binding.words.push_back(words[i]);
  }
  return binding;
}

}  // namespace pointskin::cli
