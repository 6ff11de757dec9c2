// The options that every command which fits a surface to points has: what surface, and on which device. And those that
// many commands have.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/device.hpp>
#include <pointskin/reconstruct.hpp>

#include "option_table.hpp"

namespace pointskin::cli {

struct DeviceArgs {
  std::string device = "auto";
  int threads = 0;

  /// Of `auto`, the GPU where there is one: see leaves_device_open().
  /// @throws Error usage, device_unavailable
  [[nodiscard]] Device chosen() const;
  /// With `auto` a command that knows its work may choose the device that is done first: suggest_device().
  [[nodiscard]] bool leaves_device_open() const { return device == "auto"; }
};

/// How a field is solved for, and what is done with it then. The library's options, the envelope left out: see
/// read_envelope.
struct FitArgs {
  Options options;
  std::string envelope;  ///< empty: none
};

inline constexpr char kDeviceGroup[] = "Device and limits";
inline constexpr char kSurfaceGroup[] = "Surface";

/// What --max-memory sets, in bytes; 0: no limit.
/// @param unit  behind the text; "G" for a number of 2^30 bytes, of which 0 is no limit
Binding memory_limit(std::int64_t& bytes, const std::string& unit = "");

OptionGroup device_options(DeviceArgs& args);
/// --max-memory of commands that hold a surface from one step to the next; see RunMemory::limit.
OptionGroup memory_options(std::int64_t& bytes);
OptionGroup fit_options(FitArgs& args);
/// Those of fit_options about the mesh and not the field.
inline constexpr std::initializer_list<const char*> kBeyondSolve = {
    "--field",        "--confidence", "--open",          "--envelope", "--offset",   "--trim",
    "--island-ratio", "--largest",    "--min-component", "--density",  "--weakness", "--keep-attributes"};

/// Oriented clouds.
OptionRow clouds_row(std::vector<std::string>& files, OptionRules rules = {.required = true});
/// A mesh.
OptionRow output_row(std::string& file, OptionRules rules = {});
OptionRow threads_row(int& threads);
/// "auto", "none" or "x,y,z": see parse_shift.
OptionRow shift_row(std::string& shift, const std::string& when = "while working");
OptionRow ascii_row(bool& ascii);
/// See FilePlan.
OptionRow overwrite_row(bool& overwrite);
OptionRow report_row(std::string& file, const std::string& help = "write what was done as JSON");
OptionRow json_row(bool& json);
/// A group of its own.
OptionGroup quiet_option(bool& quiet);

/// Checks for options that name a file, or anything: an empty text is an error.
std::string needs_a_name(const std::string& file);
std::string needs_a_value(const std::string& text);

}  // namespace pointskin::cli
