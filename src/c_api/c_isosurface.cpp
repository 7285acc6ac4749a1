// The functions of raymap/c.h about surfaces.

#include <raymap/c.h>
#include <raymap/isosurface.h>

#include "c_api/c_handles.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::need;

raymap_mesh* raymap_isosurface(const raymap_field* field, double iso, const raymap_options* options) {
  return create([&] {
    return c::ownMesh(
        isosurface(need(field, "the field").field, c::onMachine(IsosurfaceOptions{.iso = iso}, options)));
  });
}
