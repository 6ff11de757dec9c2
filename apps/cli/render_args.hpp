// The command line of `pointskin render`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <pointskin/render.hpp>

#include "option_table.hpp"

namespace pointskin::cli {

struct RenderArgs {
  std::string input, picture;
  std::string size = "1200x900";
  std::string up = "y";
  std::string target;  ///< empty: the middle
  std::string range;   ///< empty: of the values
  std::optional<std::int64_t> first, last;
  RenderOptions options;
  bool overwrite = false, quiet = false;
};

OptionTable render_options(RenderArgs& args);

/// The library's options. @throws Error usage, naming the option, for what is out of range
RenderOptions library_options(const RenderArgs& args);

/// "y", "-z", "+x" and so on. @param option  that names it @throws Error usage for anything else
UpAxis parse_up(const std::string& text, const char* option);

}  // namespace pointskin::cli
