#include "manual.hpp"

#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <pointskin/error.hpp>

#include "args.hpp"

namespace pointskin::cli {
namespace {

/// Commands that --help shows, in its order.
std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App* app) { return !app->get_group().empty(); });
}

bool is_shown(const CLI::Option& option) { return !option.get_group().empty(); }

/// "-o" and "--output", in the order in which they are shown.
std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

bool takes_value(const CLI::Option& option) { return option.get_type_size() != 0 && !option.get_type_name().empty(); }

// ---- Manual pages

/// Text as roff prints it unchanged.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'' && (out.empty() || out.back() == '\n'))
      out += "\\(aq";
    else if (c == '.' && (out.empty() || out.back() == '\n'))
      out += "\\&.";
    else
      out += c;
  }
  return out;
}

std::string described(const CLI::Option& option) {
  const std::string fallback = option.get_default_str();
  const std::string text = option.get_description();
  return roff(fallback.empty() || option.get_positional() ? text : text + " [default " + fallback + "]");
}

std::string option_entry(const CLI::Option& option) {
  std::string head;
  for (const std::string& name : names_of(option)) head += (head.empty() ? "" : ", ") + ("\\fB" + roff(name) + "\\fR");
  if (takes_value(option)) head += " \\fI" + roff(option.get_type_name()) + "\\fR";
  return ".TP\n" + head + "\n" + described(option) + "\n";
}

std::string positional_entry(const CLI::Option& option) {
  return ".TP\n\\fI" + roff(option.get_name(true)) + "\\fR\n" + described(option) + "\n";
}

std::string option_sections(const CLI::App& app) {
  std::string arguments;
  std::string options;
  for (const CLI::Option* option : app.get_options())
    if (option->get_positional() && names_of(*option).empty()) arguments += positional_entry(*option);
  for (const std::string& group : app.get_groups()) {
    std::string entries;
    for (const CLI::Option* option : app.get_options())
      if (option->get_group() == group && is_shown(*option) && !names_of(*option).empty())
        entries += option_entry(*option);
    if (!entries.empty()) options += ".SS " + roff(group) + "\n" + entries;
  }
  return (arguments.empty() ? "" : ".SH ARGUMENTS\n" + arguments) + (options.empty() ? "" : ".SH OPTIONS\n" + options);
}

std::string synopsis(const CLI::App& program, const CLI::App* command) {
  std::string line = ".B " + program.get_name() + (command != nullptr ? " " + command->get_name() : "") + "\n";
  if (command == nullptr) return line + "\\fICOMMAND\\fR [\\fIoptions\\fR] ...\n";
  line += "[\\fIoptions\\fR]";
  for (const CLI::Option* option : command->get_options())
    if (option->get_positional() && names_of(*option).empty())
      line += (option->get_required() ? " \\fI" : " [\\fI") + roff(option->get_name(true)) + "\\fR" +
              (option->get_expected_max() > 1 ? " ..." : "") + (option->get_required() ? "" : "]");
  return line + "\n";
}

std::string commands_section(const CLI::App& program) {
  std::string text = ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(program))
    text += ".TP\n\\fB" + roff(command->get_name()) + "\\fR\n" + roff(command->get_description()) + "\n";
  return text;
}

std::string see_also(const CLI::App& program, const CLI::App* command) {
  std::string list;
  if (command != nullptr) list = ".BR " + program.get_name() + " (1)\n";
  if (command == nullptr)
    for (const CLI::App* other : commands_of(program))
      list += ".BR " + program.get_name() + "\\-" + roff(other->get_name()) + " (1)\n";
  return ".SH SEE ALSO\n" + list;
}

// ---- Completion

/// "reconstruct edit info ..."
std::string command_words(const CLI::App& program) {
  std::string words;
  for (const CLI::App* command : commands_of(program)) words += (words.empty() ? "" : " ") + command->get_name();
  return words;
}

/// The names of a command's options.
std::string option_words(const CLI::App& command) {
  std::string words;
  for (const CLI::Option* option : command.get_options())
    if (is_shown(*option))
      for (const std::string& name : names_of(*option)) words += (words.empty() ? "" : " ") + name;
  return words;
}

/// What may follow a command besides files: its options, and the words of those that take no file.
std::string argument_words(const CLI::App& program, const CLI::App& command) {
  const std::string& name = command.get_name();
  const bool of_commands = name == "help" || name == "manual";
  return (of_commands            ? command_words(program) + " "
          : name == "completion" ? "bash zsh fish "
                                 : "") +
         option_words(command);
}

std::string bash_completion(const CLI::App& program) {
  std::string cases;
  for (const CLI::App* command : commands_of(program))
    cases += fmt::format("    {}) options='{}' ;;\n", command->get_name(), argument_words(program, *command));
  return fmt::format(R"(# bash completion of {0}; source it, or put it into bash_completion's folder
_{0}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} command=${{COMP_WORDS[1]}} options=
  COMPREPLY=()
  if [ "$COMP_CWORD" = 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W '{1} --help --version' -- "$current")
    return
  fi
  case $command in
{2}  esac
  if [[ $current == -* || $command == help || $command == manual || $command == completion ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  else
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}}
complete -F _{0} {0}
)",
                     program.get_name(), command_words(program), cases);
}

/// Text within single quotes, as zsh's _arguments reads it.
std::string zsh(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'')
      out += "'\\''";
    else if (c == '[' || c == ']' || c == ':')
      out += std::string("\\") + c;
    else
      out += c;
  }
  return out;
}

std::string zsh_completion(const CLI::App& program) {
  std::string commands;
  std::string cases;
  for (const CLI::App* command : commands_of(program)) {
    commands += fmt::format("    '{}:{}'\n", command->get_name(), zsh(command->get_description()));
    cases += fmt::format("    {})\n      arguments=(\n", command->get_name());
    for (const CLI::Option* option : command->get_options())
      if (is_shown(*option))
        for (const std::string& name : names_of(*option))
          cases += fmt::format("        '{}[{}]{}'\n", name, zsh(option->get_description()),
                               takes_value(*option) ? ":" + zsh(option->get_type_name()) + ":_files" : "");
    cases += "        '*:file:_files')\n      ;;\n";
  }
  return fmt::format(R"(#compdef {0}
# zsh completion of {0}; put it as _{0} into a folder of $fpath
_{0}() {{
  local -a commands arguments
  commands=(
{1}  )
  if (( CURRENT == 2 )); then
    _describe -t commands 'command' commands
    return
  fi
  case $words[2] in
{2}    *) arguments=('*:file:_files') ;;
  esac
  shift words
  (( CURRENT-- ))
  _arguments -s : $arguments
}}
if [ "$funcstack[1]" = "_{0}" ]; then _{0} "$@"; else compdef _{0} {0}; fi
)",
                     program.get_name(), commands, cases);
}

std::string fish(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out;
}

std::string fish_completion(const CLI::App& program) {
  const std::string& name = program.get_name();
  std::string out = fmt::format("# fish completion of {0}; put it as {0}.fish into ~/.config/fish/completions\n", name);
  for (const CLI::App* command : commands_of(program)) {
    out += fmt::format("complete -c {} -n __fish_use_subcommand -f -a {} -d '{}'\n", name, command->get_name(),
                       fish(command->get_description()));
    for (const CLI::Option* option : command->get_options()) {
      if (!is_shown(*option) || names_of(*option).empty()) continue;
      out += fmt::format("complete -c {} -n '__fish_seen_subcommand_from {}'", name, command->get_name());
      for (const std::string& word : option->get_snames()) out += " -s " + word;
      for (const std::string& word : option->get_lnames()) out += " -l " + word;
      out += fmt::format("{} -d '{}'\n", takes_value(*option) ? " -r" : "", fish(option->get_description()));
    }
  }
  return out;
}

}  // namespace

std::string manual_of(const CLI::App& program, const CLI::App* command) {
  const CLI::App& about = command != nullptr ? *command : program;
  const std::string name = program.get_name() + (command != nullptr ? "-" + command->get_name() : "");
  std::string title = name;
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string page = fmt::format(".TH {} 1 \"\" \"pointskin {}\" \"Pointskin\"\n", roff(title), POINTSKIN_VERSION);
  std::string summary = about.get_description();
  if (summary.ends_with('.')) summary.pop_back();
  page += ".SH NAME\n" + roff(name) + " \\- " + roff(summary) + "\n.SH SYNOPSIS\n" + synopsis(program, command);
  if (command == nullptr) page += commands_section(program);
  page += option_sections(about);
  const std::string footer = about.get_footer().empty() ? program.get_footer() : about.get_footer();
  page += ".SH NOTES\n.nf\n" + roff(footer) + "\n.fi\n";
  return page + see_also(program, command);
}

std::string completion_of(const CLI::App& program, const std::string& shell) {
  if (shell == "bash") return bash_completion(program);
  if (shell == "zsh") return zsh_completion(program);
  if (shell == "fish") return fish_completion(program);
  throw_usage(shell.empty() ? "name the shell: bash, zsh or fish"
                            : "there is completion for bash, zsh and fish, not for " + shell);
}

}  // namespace pointskin::cli
