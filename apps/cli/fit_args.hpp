// The options that every command which fits a surface to points has: what surface, and on which device.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <pointskin/device.hpp>
#include <pointskin/reconstruct.hpp>

namespace pointskin::cli {

struct DeviceArgs {
  std::string device = "auto";
  int threads = 0;

  /// @throws Error usage, device_unavailable
  [[nodiscard]] Device chosen() const;
};

/// How a field is solved for.
struct SolveArgs {
  Options options;
  std::string depth = "8";
  std::string boundary = "free";
  bool depth_given = false, no_normals = false;
};

/// And what is done with it then.
struct FitArgs : SolveArgs {
  std::string field = "poisson";
  std::string trim = "0";
  std::string confidence = "0";  ///< PoissonRecon's exponent of the normals' length: 0 or 1 here
  std::string envelope;          ///< empty: none
  bool open = false;
};

inline constexpr char kDeviceGroup[] = "Device and limits";
inline constexpr char kSurfaceGroup[] = "Surface";

void define_device_options(CLI::App& command, DeviceArgs& args);
void define_solve_options(CLI::App& command, SolveArgs& args);
/// Those of define_solve_options, and more.
void define_fit_options(CLI::App& command, FitArgs& args);

/// Adds an option with a default to the group "Surface".
template <class T>
CLI::Option* add_surface_value(CLI::App& command, const std::string& name, T& value, const std::string& description) {
  return command.add_option(name, value, description)->group(kSurfaceGroup)->capture_default_str();
}

/// Options as the library wants them, the envelope left out: see read_envelope.
/// @throws Error usage if a value is out of range
Options solve_options(const SolveArgs& args);
Options fit_options(const FitArgs& args);

/// A check for options that name a file: an empty name is an error.
std::string needs_a_name(const std::string& file);

}  // namespace pointskin::cli
