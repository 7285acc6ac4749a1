// The functions of raymap/c.h about pictures, in a build without pictures.

#include <raymap/c.h>

#include "c_api/c_handles.h"

namespace {

raymap_result refusePictures() {
  return raymap::c::fail(RAYMAP_ERROR_UNSUPPORTED,
                         "raymap was built without pictures; build it with RAYMAP_RENDER=ON");
}

}  // namespace

#define REFUSE(...)           \
  raymap_result __VA_ARGS__ { \
    return refusePictures();  \
  }
#define RETURN_NULL(...)              \
  raymap_picture* __VA_ARGS__ {       \
    return refusePictures(), nullptr; \
  }

RETURN_NULL(raymap_render_field(const raymap_field*, const raymap_options*))
RETURN_NULL(raymap_render_defects(const raymap_mesh*, const raymap_options*))
RETURN_NULL(raymap_render_slice(const raymap_field*, int32_t, int32_t, const raymap_options*))
REFUSE(raymap_picture_write_png(const raymap_picture*, const char*))
REFUSE(raymap_write_page(const raymap_field*, const char*, const raymap_mesh*, const raymap_field*,
                         const raymap_options*))

// There is no picture to ask.
void raymap_picture_free(raymap_picture*) {}
int32_t raymap_picture_width(const raymap_picture*) {
  return 0;
}
int32_t raymap_picture_height(const raymap_picture*) {
  return 0;
}
const uint8_t* raymap_picture_rgb(const raymap_picture*) {
  return nullptr;
}

#undef REFUSE
#undef RETURN_NULL
