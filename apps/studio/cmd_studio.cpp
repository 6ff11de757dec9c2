// pointskin studio: a page in a browser, and the server behind it.
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <stop_token>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "signals.hpp"
#include "studio/browser.hpp"
#include "studio/page.hpp"
#include "studio/server/addresses.hpp"
#include "studio/server/server.hpp"
#include "studio/session/studio.hpp"
#include "studio_args.hpp"

namespace pointskin::cli {
namespace {

namespace fs = std::filesystem;

/// Whoever types a name wrong learns it here, and not in a page.
void check_clouds(const std::vector<std::string>& clouds) {
  for (const std::string& cloud : clouds) {
    if (access(cloud.c_str(), R_OK) != 0)
      throw Error(ErrorCode::invalid_input,
                  fmt::format("{}: cannot be read, {}; check the path", cloud, std::generic_category().message(errno)));
    if (fs::is_directory(cloud))
      throw Error(ErrorCode::invalid_input, fmt::format("{}: is a folder; name a file in it", cloud));
  }
}

void check_options(const StudioArgs& args) {
  constexpr int kMostPort = 65535;
  if (args.port < 0 || args.port > kMostPort)
    throw_usage(fmt::format("--port: {} is not in [0, {}]", args.port, kMostPort));
  if (args.resume && !args.clouds.empty()) throw_usage("--resume: a session knows its clouds; name none");
  if (args.demo && (args.resume || !args.clouds.empty()))
    print_warning("--demo has no effect: there is something else to open");
  check_clouds(args.clouds);
}

/// --root, or else the folders of the clouds, or else the working folder.
std::vector<fs::path> roots_of(const StudioArgs& args) {
  std::vector<fs::path> roots(args.roots.begin(), args.roots.end());
  if (!roots.empty()) return roots;
  for (const std::string& cloud : args.clouds) roots.push_back(fs::absolute(cloud).parent_path());
  if (roots.empty()) roots.push_back(fs::current_path());
  return roots;
}

studio::StudioOptions session_options(const StudioArgs& args) {
  studio::StudioOptions options;
  options.device = args.chosen();
  for (const std::string& cloud : args.clouds) options.clouds.push_back(fs::absolute(cloud));
  options.demo = args.demo;
  options.roots = roots_of(args);
  options.folder = studio::default_folder();
  if (!args.session.empty()) options.session = fs::absolute(args.session);
  options.resume = args.resume;
  options.version = POINTSKIN_VERSION;
  options.max_upload = parse_bytes(args.max_upload, "--max-upload");
  return options;
}

studio::server::ServerOptions server_options(const StudioArgs& args) {
  studio::server::ServerOptions options;
  options.hosts.insert(options.hosts.end(), args.hosts.begin(), args.hosts.end());
  options.port = args.port;
  options.max_upload = parse_bytes(args.max_upload, "--max-upload");
  options.assets = studio::page_file;
  return options;
}

void warn_about_hosts(const StudioArgs& args) {
  for (const std::string& address : studio::server::addresses_of(args.hosts))
    if (!studio::server::is_loopback(address))
      print_warning(
          fmt::format("--host {}: other machines reach the studio, and the network sees the token and the scan; "
                      "ssh -L is safer",
                      address));
}

int run(const StudioArgs& args) {
  check_options(args);
  studio::Studio session(session_options(args));
  studio::server::Server server(server_options(args), session);
  warn_about_hosts(args);
  on_interrupt(OnInterrupt::announce);
  write_stdout(server.url() + "\n");
  if (!args.no_browser) studio::open_browser(server.url_for_browser());
  // A signal handler may do no more than to set a flag.
  const std::jthread watch([&server](const std::stop_token& done) {
    while (!done.stop_requested() && !interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    server.stop();
  });
  server.run();
  return 0;
}

}  // namespace

Command studio_command() {
  return make_command({"studio", kStudioDescription,
                       "Prints the address of the page, which holds a secret, and opens it. Ends with Ctrl-C: exit "
                       "code 0.\nFrom elsewhere: ssh -L 8123:127.0.0.1:8123 HOST pointskin studio --port 8123 "
                       "--no-browser"},
                      studio_options, run);
}

}  // namespace pointskin::cli
