// The functions of raymap/c.h about surfaces.

#include <raymap/c.h>
#include <raymap/isosurface.h>

#include "c_api/c_handles.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::need;

namespace {

template <class Handle>
raymap_mesh* isosurfaceOf(const Handle* handle, double iso, const raymap_options* options) {
  return create([&] {
    return c::ownMesh(
        isosurface(need(handle, "the field").field, {.iso = iso}, c::optionsOr(options).machine));
  });
}

}  // namespace

raymap_mesh* raymap_isosurface(const raymap_field* field, double iso, const raymap_options* options) {
  return isosurfaceOf(field, iso, options);
}

raymap_mesh* raymap_sparse_field_isosurface(const raymap_sparse_field* field, double iso,
                                            const raymap_options* options) {
  return isosurfaceOf(field, iso, options);
}
