// SPDX-License-Identifier: Zlib
#include "experiments/film/png_file.h"

#include <png.h>

#include "experiments/trial/formats/output_file.h"

namespace lpc { inline namespace LPC_PRECISION {

void writePng(const std::string& path, int width, int height, std::span<const unsigned char> rgb) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION, image.format = PNG_FORMAT_RGB;
  image.width = static_cast<png_uint_32>(width), image.height = static_cast<png_uint_32>(height);
  LPC_ASSERT(rgb.size() == PNG_IMAGE_SIZE(image));
  OutputFile out(path);
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr)) {
    throw CannotWrite(path + ": cannot be written: " + image.message);
  }
  out.stream().write(bytes.data(), static_cast<std::streamsize>(size));
  out.finish();
}

}}  // namespace lpc::LPC_PRECISION
