// The functions of raymap/c.h that read and write files, in a build without files.

#include <raymap/c.h>

#include "c_api/c_handles.h"

namespace {

raymap_result fail() {
  return raymap::c::fail(RAYMAP_ERROR_UNSUPPORTED,
                         "raymap was built without files; build it with RAYMAP_IO=ON");
}

}  // namespace

#define REFUSE(...) \
  __VA_ARGS__ {     \
    return fail();  \
  }
#define RETURN_NULL(...)    \
  __VA_ARGS__ {             \
    return fail(), nullptr; \
  }

RETURN_NULL(raymap_mesh* raymap_mesh_load(const char*, const raymap_options*))
REFUSE(raymap_result raymap_mesh_write(const raymap_mesh*, const char*, const raymap_options*))
RETURN_NULL(raymap_field* raymap_field_load(const char*, const raymap_options*))
REFUSE(raymap_result raymap_field_write(const raymap_field*, const char*, const char*))
REFUSE(raymap_result raymap_generate_file(const raymap_mesh*, const raymap_grid*, const raymap_field_files*,
                                          const raymap_options*, char**))

#undef REFUSE
#undef RETURN_NULL
