#include "studio_args.hpp"

namespace pointskin::cli {

OptionTable studio_options(StudioArgs& args) {
  return {{"Files",
           {option("CLOUD", "clouds to open, merged; others can be opened in the page", &args.clouds),
            option("--demo", "open a generated shape, if there is no CLOUD", &args.demo),
            option("--root DIR", "folder that pages may read and write (repeatable) [default those of CLOUD]",
                   &args.roots, {}, {.check = needs_a_name}),
            option("--session FILE", "journal of all that is done, to go on later [default a new one]", &args.session,
                   {}, {.check = needs_a_name}),
            option("--resume", "go on with --session FILE, or with the last session", &args.resume),
            option("--max-upload SIZE", "largest file that a page may send, as 4G", &args.max_upload)}},
          {"Page",
           {option("--no-browser", "only print the address of the page", &args.no_browser),
            option("--port N", "TCP port, 0 to 65535; 0: any that is free", &args.port),
            option("--host A", "listen at this address, too (repeatable) [default this machine alone]", &args.hosts, {},
                   {.check = needs_a_value})}},
          device_options(args)};
}

}  // namespace pointskin::cli
