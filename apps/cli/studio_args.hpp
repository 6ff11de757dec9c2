// The options of the studio: the same whether or not the program was built with it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fit_args.hpp"
#include "given_options.hpp"
#include "option_table.hpp"

namespace pointskin::cli {

struct StudioArgs : DeviceArgs {
  std::vector<std::string> clouds;
  std::vector<std::string> hosts;  ///< besides 127.0.0.1 and ::1
  std::vector<std::string> roots;  ///< empty: the folders of the clouds
  std::string session;             ///< empty: a new one in the user's state folder
  std::string max_upload = "4G";
  int port = 0;
  bool demo = false, resume = false, no_browser = false;
  GivenOptions given;
};

OptionTable studio_options(StudioArgs& args);

inline constexpr char kStudioDescription[] = "Edit scans in a browser: guide, erase, bend, combine, watch water.";

}  // namespace pointskin::cli
