#include "command_line.hpp"

#include <memory>
#include <new>
#include <type_traits>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "console.hpp"
#include "exhaustion.hpp"
#include "manual.hpp"
#include "ranks.hpp"
#include "usage_errors.hpp"

namespace pointskin::cli {
namespace {

constexpr char kFooter[] =
    "Exit codes: 0 ok, 1 internal error, 2 usage, 3 input unreadable or invalid, 4 no usable normals,\n"
    "5 result empty, mesh not watertight or peer failed, 6 over the memory or index limit, 7 device unavailable,\n"
    "8 output not written, 130 interrupted.\n"
    "Help on a command: pointskin COMMAND --help";

constexpr std::size_t kHelpColumn = 28, kHelpWidth = 120;

/// `text` in lines that fit to the right of the options' names.
std::string in_lines(const std::string& text) {
  constexpr std::size_t kWidth = kHelpWidth - kHelpColumn;
  std::string lines;
  std::size_t at = 0;
  while (text.size() - at > kWidth) {
    const std::size_t space = text.rfind(' ', at + kWidth);
    if (space == std::string::npos || space <= at) break;
    lines += text.substr(at, space - at) + '\n';
    at = space + 1;
  }
  return lines + text.substr(at);
}

/// How --help looks: name and kind of value on the left, meaning and default on the right.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    column_width(kHelpColumn);
    label("Positionals", "Arguments");
    label("Subcommands", "Commands");
    label("SUBCOMMAND", "COMMAND");
  }
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    const std::string text = CLI::detail::find_and_replace(Formatter::make_help(app, name, mode), "\n\n\n", "\n\n");
    // It is put together by streams, which leave text out where they find no memory, and tell nobody.
    if (memory_ran_out()) throw std::bad_alloc();
    return text;
  }
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    const std::string name =
        CLI::detail::find_and_replace(Formatter::make_option_name(option, is_positional), ",", ", ");
    return name.substr(0, name.find('{'));  // what a flag stands for without a value is the description's to tell
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    const bool has_value = option->get_type_size() != 0 && !option->get_positional();
    return has_value ? " " + option->get_type_name() : "";
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    const std::string fallback = option->get_default_str();
    return in_lines(fallback.empty() ? option->get_description()
                                     : option->get_description() + " [default " + fallback + "]");
  }
};

template <class T>
constexpr bool kHasDefault = std::is_arithmetic_v<T> || std::is_same_v<T, std::string>;

/// @param variable  that the row sets
template <class T>
CLI::Option* define(CLI::App& app, const OptionRow& row, T& variable) {
  const std::size_t space = row.spelling.find(' ');
  if (!row.spelling.starts_with('-')) return app.add_option(row.spelling, variable, row.help);
  if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>)
    if (space == std::string::npos) return app.add_flag(row.spelling, variable, row.help);
  CLI::Option* const option = app.add_option(row.names(), variable, row.help);
  option->type_name(row.spelling.substr(space + 1));
  if constexpr (kHasDefault<T>)
    if (!row.rules.no_default) option->capture_default_str();
  if constexpr (std::is_same_v<T, std::vector<std::string>>) option->allow_extra_args(false);
  return option;
}

/// A row of a table, as the parser knows it.
struct Defined {
  const OptionRow* row;
  CLI::Option* option;
};

std::vector<Defined> define_options(CLI::App& app, const OptionTable& table) {
  std::vector<Defined> defined;
  for (const OptionGroup& group : table)
    for (const OptionRow& row : group.rows) {
      if (row.spelling.empty()) continue;
      CLI::Option* const option =
          std::visit([&](auto* variable) { return define(app, row, *variable); }, row.binding.target);
      if (row.spelling.starts_with('-')) option->group(group.name);
      option->required(row.rules.required);
      if (row.rules.check) option->check(row.rules.check);
      defined.push_back({&row, option});
    }
  for (const auto& [row, option] : defined)
    if (!row->rules.excludes.empty()) option->excludes(app.get_option(row->rules.excludes));
  return defined;
}

/// Turns texts into what they stand for. @throws Error usage
void settle(const std::vector<Defined>& defined) {
  for (const auto& [row, option] : defined) {
    if (option->count() == 0 || !row->binding.settle) continue;
    const std::string wrong = row->binding.settle();
    if (!wrong.empty()) throw_usage(option->get_name() + ": " + wrong);
  }
}

GivenOptions given_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    if (option->count() > 0)
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return GivenOptions(std::move(names));
}

std::string version_text() { return std::string("pointskin ") + POINTSKIN_VERSION; }

/// The parser of all commands, and which of them was chosen.
class Program {
 public:
  explicit Program(const std::vector<Command>& commands) : app_("Oriented points in, watertight triangle mesh out.") {
    app_.formatter(std::make_shared<HelpFormatter>());
    app_.name("pointskin");
    app_.require_subcommand(1);
    app_.set_version_flag("--version", version_text(), "print the version");
    app_.set_help_flag("-h,--help", "print this help");
    app_.footer(kFooter);
    for (const Command& command : commands) add(command);
    add(help_);
    add(manual_);
    add(completion_);
    add(version_);
  }

  /// @returns the exit code @throws Error, CLI::Error
  int run(const std::vector<std::string>& args) {
    app_.parse(std::vector<std::string>(args.rbegin(), args.rend()));
    return job_();
  }

  [[nodiscard]] const CLI::App& app() const { return app_; }

 private:
  void add(const Command& command) {
    CLI::App* const app = app_.add_subcommand(command.texts.name, command.texts.description);
    app->group("Commands");
    if (!command.texts.footer.empty()) app->footer(command.texts.footer);  // else that of the program
    const std::vector<Defined> defined = define_options(*app, command.options);
    app->set_help_flag("-h,--help", "print this help")->group("Help");
    app->callback([this, app, &command, defined] {
      job_ = [app, &command, defined] {
        settle(defined);
        return command.run(given_of(*app));
      };
    });
  }

  /// Null for none. @throws Error usage if there is no such command
  [[nodiscard]] const CLI::App* find(const std::string& topic) const {
    const CLI::App* const command = topic.empty() ? nullptr : command_of(app_, {topic});
    if (command == nullptr && !topic.empty()) throw_usage(no_such_command(app_, topic));
    return command;
  }

  /// The help on `topic`, or on the program for none. @throws Error usage if there is no such command
  [[nodiscard]] std::string help_on(const std::string& topic) const {
    const CLI::App* const command = find(topic);
    const std::string name = app_.get_name() + (topic.empty() ? "" : " " + topic);
    return app_.get_formatter()->make_help(command == nullptr ? &app_ : command, name, CLI::AppFormatMode::Normal);
  }

  CLI::App app_;
  std::function<int()> job_;
  std::string topic_, shell_;
  const Command help_{{"help", "Print the help on the program, or on a command."},
                      {{"", {option("COMMAND", "the command [default the program]", &topic_)}}},
                      [this](const GivenOptions&) { return write_stdout(help_on(topic_)), 0; }};
  const Command manual_{{"manual", "Print a manual page: pointskin manual reconstruct | man -l -"},
                        {{"", {option("COMMAND", "the command [default the program]", &topic_)}}},
                        [this](const GivenOptions&) { return write_stdout(manual_of(app_, find(topic_))), 0; }};
  const Command completion_{{"completion", "Print what a shell needs to complete commands and options."},
                            {{"", {option("SHELL", "bash, zsh or fish", &shell_)}}},
                            [this](const GivenOptions&) { return write_stdout(completion_of(app_, shell_)), 0; }};
  const Command version_{{"version", "Print the version."}, {}, [](const GivenOptions&) {
                           return write_stdout(version_text() + "\n"), 0;
                         }};
};

/// A usage error, with where to look.
int report_usage(const CLI::App& program, const std::vector<std::string>& args, const std::string& story) {
  const char* const separator = story.ends_with('?') ? "" : ";";
  const bool known = command_of(program, args) != nullptr && args[0] != "help";
  if (tells_for_all())
    print_error(fmt::format("{}{} try 'pointskin{} --help'", story, separator, known ? " " + args[0] : ""));
  return static_cast<int>(ErrorCode::usage);
}

}  // namespace

int run_command_line(const std::vector<Command>& commands, const std::vector<std::string>& args) {
  Program program(commands);
  try {
    return program.run(args);
  } catch (const CLI::CallForHelp&) {
    write_stdout(program.app().help());
  } catch (const CLI::CallForVersion& version) {
    write_stdout(version.what() + std::string("\n"));
  } catch (const CLI::Error& error) {
    return report_usage(program.app(), args, story_of(program.app(), args, error));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage) throw;
    return report_usage(program.app(), args, story_of(command_of(program.app(), args), error.what()));
  }
  return 0;
}

}  // namespace pointskin::cli
