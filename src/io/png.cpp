// PNG files through libpng's simplified interface, which needs no setjmp.
// Source: libpng manual, "The simplified API" (libpng 1.6).
#include <png.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/render.hpp>

#include <cstddef>
#include <cstdint>
#include <new>
#include <string>

namespace pointskin {
namespace {

std::string encode(const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;

  // The bound on the size saves compressing twice to learn it.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0) {
    const std::string reason = header.message;
    png_image_free(&header);
    if (reason.find("memory") != std::string::npos) throw std::bad_alloc();  // libpng tells in three ways
    throw Error(ErrorCode::internal, "libpng could not encode a picture: " + reason);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

std::string png_of(const Image& image) {
  constexpr int kLargestSide = 1 << 20;  // keeps the encoder's 32-bit row sizes in range
  const bool in_range =
      image.width > 0 && image.height > 0 && image.width <= kLargestSide && image.height <= kLargestSide;
  const std::uint64_t pixels =
      in_range ? std::uint64_t{3} * static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height)
               : 0;
  if (!in_range || image.rgb.size() != pixels)
    throw Error(ErrorCode::usage, "a picture of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                                      " pixels cannot be written from " + std::to_string(image.rgb.size()) + " bytes");
  return encode(image);
}

void write_png(const std::string& path, const Image& image) { write_file_atomically(path, png_of(image)); }

}  // namespace pointskin
