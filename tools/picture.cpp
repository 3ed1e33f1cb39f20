#include "tools/picture.h"

#include <png.h>

namespace prcage {

bool encode_png(const Picture& picture, std::vector<std::uint8_t>& bytes, std::string& error) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  bytes.resize(size);
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr) == 0) {
    error = std::string("cannot encode the picture: ") + image.message;
    return false;
  }
  bytes.resize(size);
  return true;
}

}  // namespace prcage
