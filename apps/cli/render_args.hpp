// The command line of `pointskin render`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include <pointskin/render.hpp>

namespace pointskin::cli {

struct RenderArgs {
  std::string input, picture;
  std::string size = "1200x900";
  std::string up = "y";
  std::string fit = "box";
  std::string target;  ///< empty: the middle
  std::string range;   ///< empty: of the values
  std::string colour_map = "auto";
  std::optional<double> field_of_view;
  std::optional<std::int64_t> first, last;
  RenderOptions options;
  bool orthographic = false, flat = false, cull = false, no_colours = false, no_shadows = false, no_bar = false;
  bool overwrite = false, quiet = false;
};

void define_render_options(CLI::App& command, RenderArgs& args);

/// The library's options. @throws Error usage, naming the option, for what is out of range
RenderOptions library_options(const RenderArgs& args);

/// "y", "-z", "+x" and so on. @param option  that names it @throws Error usage for anything else
UpAxis parse_up(const std::string& text, const char* option);

}  // namespace pointskin::cli
