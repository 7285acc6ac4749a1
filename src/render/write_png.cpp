#include <png.h>
#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/render.h>

#include <ostream>
#include <string>

#include "render/encode_png.h"

namespace raymap {

std::vector<uint8_t> encodePng(const std::filesystem::path& path, const Picture& picture) {
  const auto isValid = [](int side) { return side >= 1 && side <= kMaxPictureSide; };
  if (!isValid(picture.width) || !isValid(picture.height) ||
      picture.rgb.size() != 3 * size_t(picture.width) * size_t(picture.height))
    throw Error(ErrorCode::Usage, path.string() + ": a picture of " + std::to_string(picture.width) + " x " +
                                      std::to_string(picture.height) + " pixels with " +
                                      std::to_string(picture.rgb.size()) + " bytes cannot be written");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(picture.width);
  image.height = png_uint_32(picture.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<uint8_t> bytes(size);
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr) == 0)
    throw Error(ErrorCode::File, path.string() + ": the picture cannot be encoded: " + image.message);
  bytes.resize(size);
  return bytes;
}

void writePng(const std::filesystem::path& path, const Picture& picture) {
  const std::vector<uint8_t> bytes = encodePng(path, picture);
  writeAtomically(path, [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  });
}

}  // namespace raymap
