// How --help looks.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace pointskin::cli {

/// One line per option: name and kind of value on the left, meaning and default on the right.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace pointskin::cli
