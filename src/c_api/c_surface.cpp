// The functions of raymap/c.h about queries at any points.

#include <raymap/c.h>

#include <algorithm>
#include <limits>
#include <span>

#include "c_api/c_handles.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

SurfaceOptions surfaceOptions(const FieldOptions& given) {
  return {.sign = given.sign, .orientation = given.orientation, .threshold = given.threshold};
}

void copyTo(double* to, const Buffer<glm::dvec3>& from) {
  for (size_t i = 0; to && i < from.size(); ++i)
    for (int c = 0; c < 3; ++c) to[3 * i + size_t(c)] = from[i][c];
}

template <class T>
void copyTo(T* to, const Buffer<T>& from) {
  if (to) std::ranges::copy(from, to);
}

}  // namespace

raymap_surface* raymap_surface_create(const raymap_mesh* mesh, const raymap_options* options) {
  return create([&] {
    const raymap_options& given = c::optionsOr(options);
    return std::make_unique<raymap_surface>(
        Surface(need(mesh, "the mesh").view, surfaceOptions(given.field), given.machine));
  });
}

void raymap_surface_free(raymap_surface* surface) {
  delete surface;
}

size_t raymap_surface_bytes(const raymap_surface* surface) {
  return surface ? surface->surface.bytes() : 0;
}

raymap_result raymap_surface_stats(const raymap_surface* surface, raymap_stats* stats) {
  return guard([&] {
    const Stats& found = need(surface, "the surface").surface.stats();
    need(stats, "the struct of statistics") = c::toC(found);
  });
}

raymap_result raymap_surface_query(const raymap_surface* surface, const double* points, size_t count,
                                   double limit, const raymap_options* options,
                                   const raymap_query_arrays* arrays) {
  return guard([&] {
    const Surface& queried = need(surface, "the surface").surface;
    const raymap_query_arrays& wanted = need(arrays, "the struct of arrays");
    if (count > 0) need(points, "the array of points");
    const QueryResult found =
        queried.query(PointsView(points, count),
                      {.distance = wanted.distance != nullptr,
                       .closest = wanted.closest != nullptr,
                       .triangle = wanted.triangle != nullptr,
                       .barycentric = wanted.barycentric != nullptr,
                       .direction = wanted.direction != nullptr,
                       .winding = wanted.winding != nullptr,
                       .confidence = wanted.confidence != nullptr,
                       .maxDistance = limit != 0.0 ? limit : std::numeric_limits<double>::infinity()},
                      c::optionsOr(options).machine);
    copyTo(wanted.distance, found.distance);
    copyTo(wanted.closest, found.closest);
    copyTo(wanted.triangle, found.triangle);
    copyTo(wanted.barycentric, found.barycentric);
    copyTo(wanted.direction, found.direction);
    copyTo(wanted.winding, found.winding);
    copyTo(wanted.confidence, found.confidence);
  });
}
