// SHA-256: by which a session file knows its clouds again.
// Source: NIST FIPS 180-4, "Secure Hash Standard", 2015.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pointskin::scene {

/// Takes bytes piece by piece.
class Sha256 {
 public:
  void add(std::string_view bytes);
  /// 64 lower-case hexadecimal digits. Nothing may be added any more.
  [[nodiscard]] std::string finish();

 private:
  void take_block(const unsigned char* block);

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, 64> block_{};
  std::uint64_t bytes_ = 0;
};

/// Of a whole file. @throws Error invalid_input, naming it, if it cannot be read
std::string sha256_of_file(const std::string& path);

}  // namespace pointskin::scene
