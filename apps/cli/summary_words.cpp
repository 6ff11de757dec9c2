#include "summary_words.hpp"

#include <fmt/format.h>

#include "console.hpp"

namespace pointskin::cli {

std::string file_words(const std::string& file) {
  if (file.empty()) return "";
  return (file == "-" ? "stdout" : one_line(file)) + ": ";
}

std::string counted(std::int64_t count, const std::string& word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string shape_words(const Mesh& mesh, int threads) { return shape_words(glance_at(mesh, threads)); }

std::string shape_words(const MeshGlance& glance) {
  const char* const closed = !glance.closed ? "open" : glance.oriented ? "closed" : "closed but not oriented";
  return fmt::format("{}, {}", closed, counted(glance.components, "component"));
}

std::string shape_words(const MeshReport& mesh) {
  const char* const closed = mesh.watertight() ? "watertight" : mesh.closed() ? "closed" : "open";
  return fmt::format("{}, {}", closed, counted(mesh.components, "component"));
}

std::string memory_words(const Device& device, std::int64_t device_peak_bytes, std::int64_t host_peak_bytes) {
  const std::string buffers = format_bytes(static_cast<double>(device_peak_bytes));
  const std::string host = format_bytes(static_cast<double>(host_peak_bytes));
  return device.kind == DeviceKind::cuda ? fmt::format("memory {} device, {} host", buffers, host)
                                         : fmt::format("memory {}, {} of it buffers", host, buffers);
}

}  // namespace pointskin::cli
