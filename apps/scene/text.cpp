#include "scene/text.hpp"

namespace pointskin::scene {

std::string one_line(const std::string& text) {
  std::string line;
  bool broken = false;
  for (const char c : text) {
    if (c == '\n' || c == '\r') {
      broken = !line.empty();
    } else if (!(broken && c == ' ')) {
      if (broken) line += "; ";
      broken = false;
      const auto code = static_cast<unsigned char>(c);
      line += code < 0x20 || code == 0x7f ? '?' : c;  // A file name must not steer the terminal.
    }
  }
  return line;
}

}  // namespace pointskin::scene
