#include "usage_errors.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "suggest.hpp"

namespace pointskin::cli {
namespace {

using Names = std::vector<std::string>;

Names names_of_commands(const CLI::App& program) {
  Names names;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

/// All names of all options, with their dashes, in the order of --help.
Names options_of(const CLI::App& command) {
  Names names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

bool has_option(const CLI::App& command, const std::string& name) {
  const Names names = options_of(command);
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "a", "a and b", "a, b and c".
std::string listed(const Names& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

/// The commands that have the option `name`.
Names owners_of(const CLI::App& program, const std::string& name) {
  Names owners;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    if (has_option(*command, name)) owners.push_back(command->get_name());
  return owners;
}

/// "--depth" of "--depth=8".
std::string name_of(const std::string& arg) { return arg.substr(0, arg.find('=')); }

bool is_option(const std::string& arg) { return arg.size() > 1 && arg.front() == '-'; }

std::string no_such_option(const CLI::App& program, const CLI::App& command, const std::string& name) {
  std::string story = fmt::format("there is no option {}", name);
  const std::string meant = nearest(name, options_of(command));
  const Names owners = owners_of(program, name);
  if (!owners.empty()) story += fmt::format(" of {}; {} has it", command.get_name(), listed(owners));
  if (owners.size() > 1) story.replace(story.rfind(" has it"), 7, " have it");
  if (!meant.empty()) story += fmt::format("{} did you mean {}?", owners.empty() ? ";" : ", or", meant);
  return story;
}

/// The arguments begin with something that is no command.
std::string no_command(const CLI::App& program, const Names& args) {
  if (args.empty()) return "a command is missing: " + listed(names_of_commands(program));
  const std::string& first = args.front();
  std::error_code ignored;
  const bool is_file = first == "-" || std::filesystem::exists(first, ignored) || first.find('.') != std::string::npos;
  const bool belongs = is_option(first) && !owners_of(program, name_of(first)).empty();
  if (is_file || belongs)
    return fmt::format("a command is missing before {}; did you mean 'pointskin reconstruct {}'?", first, first);
  if (!is_option(first)) return no_such_command(program, first);
  const std::string meant = nearest(name_of(first), options_of(program));
  return fmt::format("there is no option {} before a command{}", name_of(first),
                     meant.empty() ? "" : fmt::format("; did you mean {}?", meant));
}

/// An unknown option is told even where something else is wrong as well: that may come from it.
std::string unknown_argument(const CLI::App& program, const CLI::App& command, const Names& unknown) {
  const auto option = std::find_if(unknown.begin(), unknown.end(), is_option);
  if (option != unknown.end()) return no_such_option(program, command, name_of(*option));
  return fmt::format("'{}' is one argument too many", unknown.front());
}

/// The parser's own words made ours; `text` itself where they will do.
std::string in_our_words(const std::string& text) {
  constexpr std::string_view kConvert = "Could not convert: ";
  constexpr std::string_view kEquals = " = ";
  if (const std::size_t equals = text.find(kEquals); text.starts_with(kConvert) && equals != std::string::npos)
    return fmt::format("{}: '{}' is no valid number", text.substr(kConvert.size(), equals - kConvert.size()),
                       text.substr(equals + kEquals.size()));
  constexpr std::string_view kTwice = ": At Most 1 required but received ";
  if (const std::size_t at = text.find(kTwice); at != std::string::npos)
    return fmt::format("{} is given {} times", text.substr(0, at), text.substr(at + kTwice.size()));
  constexpr std::string_view kRequired = ": 1 required ";
  constexpr std::string_view kMissing = " missing";
  if (const std::size_t at = text.find(kRequired); at != std::string::npos && text.ends_with(kMissing)) {
    const std::size_t type = at + kRequired.size();
    return fmt::format("{}: its value {} is missing", text.substr(0, at),
                       text.substr(type, text.size() - kMissing.size() - type));
  }
  return text;
}

/// Options whose names in the library are others.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kOtherNames = {
    {{"attributes", "--keep-attributes"},
     {"smoothing_iterations", "--mesh-smoothing-iters"},
     {"domain_faces", "--open"}}};

std::string option_named(const std::string& in_library) {
  for (const auto& [theirs, ours] : kOtherNames)
    if (theirs == in_library) return std::string(ours);
  std::string name = "--" + in_library;
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

/// What was given for the option, or for another name of it; empty if nothing.
std::string value_given(const CLI::App& command, const std::string& option) {
  for (const CLI::Option* candidate : command.get_options()) {
    const bool same = candidate->check_name(option) || candidate->get_description() == "same as " + option;
    if (same && candidate->count() > 0 && !candidate->results().empty()) return candidate->results().back();
  }
  return "";
}

}  // namespace

const CLI::App* command_of(const CLI::App& program, const Names& args) {
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    if (!args.empty() && command->get_name() == args.front()) return command;
  return nullptr;
}

std::string no_such_command(const CLI::App& program, const std::string& name) {
  const Names commands = names_of_commands(program);
  const std::string meant = nearest(name, commands);
  return fmt::format("there is no command '{}'; {}", name,
                     meant.empty() ? "there are " + listed(commands) : fmt::format("did you mean '{}'?", meant));
}

std::string story_of(const CLI::App& program, const Names& args, const CLI::Error& error) {
  const CLI::App* const command = command_of(program, args);
  if (command == nullptr) return no_command(program, args);
  const Names unknown = program.remaining(true);
  const bool extras = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !unknown.empty();
  if (extras || std::any_of(unknown.begin(), unknown.end(), is_option))
    return unknown_argument(program, *command, unknown);
  return in_our_words(error.what());
}

std::string story_of(const CLI::App* command, const std::string& library_story) {
  constexpr std::string_view kOption = "option ";
  if (command == nullptr || !library_story.starts_with(kOption)) return library_story;
  const std::size_t end = library_story.find(' ', kOption.size());
  const std::string option = option_named(library_story.substr(kOption.size(), end - kOption.size()));
  if (end == std::string::npos || !has_option(*command, option)) return library_story;
  const std::string rest = library_story.substr(end);
  const std::string value = value_given(*command, option);
  const bool tells = value.empty() || !rest.starts_with(" must be ") || rest.find("but is") != std::string::npos;
  return option + rest + (tells ? "" : ", but is " + value);
}

}  // namespace pointskin::cli
