// The functions of raymap/c.h about queries at any points, and about points to train with.

#include <raymap/c.h>
#include <raymap/sample_points.h>

#include <span>
#include <vector>

#include "c_api/c_handles.h"
#include "c_api/c_struct.h"

using namespace raymap;
using raymap::c::copyTo;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

SamplePointsOptions sampleOptions(size_t count, const raymap_sample_points_options* how) {
  const raymap_sample_points_options given = c::read(how);
  SamplePointsOptions options{.count = count, .seed = given.seed, .normalize = given.normalize};
  if (given.has_shares) {
    options.surfaceShare = given.surface_share;
    options.nearShare = given.near_share;
  }
  if (given.sigmas) options.sigmas.assign(given.sigmas, given.sigmas + given.sigma_count);
  return options;
}

}  // namespace

raymap_surface* raymap_surface_create(const raymap_mesh* mesh, const raymap_options* options) {
  return create([&] {
    const raymap_options& given = c::optionsOr(options);
    return std::make_unique<raymap_surface>(Surface(need(mesh, "the mesh").view,
                                                    {.sign = given.field.sign,
                                                     .orientation = given.field.orientation,
                                                     .threshold = given.field.threshold,
                                                     .compact = given.isCompact},
                                                    given.machine));
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
    c::write(c::toC(found), stats);
  });
}

raymap_result raymap_surface_query(const raymap_surface* surface, const double* points, size_t count,
                                   double maxDistance, const raymap_options* options,
                                   const raymap_query_arrays* arrays) {
  return guard([&] {
    const Surface& queried = need(surface, "the surface").surface;
    need(arrays, "raymap_query_arrays");
    const raymap_query_arrays wanted = c::read(arrays);
    if (count > 0) need(points, "the array of points");
    const QueryOptions how{.distance = wanted.distance != nullptr,
                           .closest = wanted.closest != nullptr,
                           .triangle = wanted.triangle != nullptr,
                           .barycentric = wanted.barycentric != nullptr,
                           .direction = wanted.direction != nullptr,
                           .winding = wanted.winding != nullptr,
                           .confidence = wanted.confidence != nullptr,
                           .maxDistance = c::limitOr(maxDistance)};
    const QueryResult found = queried.query(PointsView(points, count), how, c::optionsOr(options).machine);
    copyTo(wanted.distance, found.distance);
    copyTo(wanted.closest, found.closest);
    copyTo(wanted.triangle, found.triangle);
    copyTo(wanted.barycentric, found.barycentric);
    copyTo(wanted.direction, found.direction);
    copyTo(wanted.winding, found.winding);
    copyTo(wanted.confidence, found.confidence);
  });
}

raymap_result raymap_surface_thickness(const raymap_surface* surface, const double* points,
                                       const uint32_t* triangles, size_t count, double maxThickness,
                                       const raymap_options* options, const raymap_thickness_arrays* arrays) {
  return guard([&] {
    const Surface& measured = need(surface, "the surface").surface;
    need(arrays, "raymap_thickness_arrays");
    const raymap_thickness_arrays wanted = c::read(arrays);
    if (count > 0) {
      need(points, "the array of points");
      need(triangles, "the array of triangles");
    }
    std::vector<FacePoint> places(count);
    for (size_t p = 0; p < count; ++p)
      places[p] = {{points[3 * p], points[3 * p + 1], points[3 * p + 2]}, triangles[p]};
    const std::vector<Thickness> found =
        measured.thickness(places, {.maxThickness = c::limitOr(maxThickness)}, c::optionsOr(options).machine);
    for (size_t p = 0; p < count; ++p) {
      if (wanted.diameter) wanted.diameter[p] = found[p].diameter;
      if (wanted.part) wanted.part[p] = int32_t(found[p].part);
      for (int a = 0; wanted.inward && a < 3; ++a) wanted.inward[3 * p + size_t(a)] = found[p].inward[a];
    }
  });
}

raymap_result raymap_sample_points(const raymap_surface* surface, size_t count,
                                   const raymap_sample_points_options* how, const raymap_options* options,
                                   const raymap_point_sample_arrays* arrays) {
  return guard([&] {
    const Surface& sampled = need(surface, "the surface").surface;
    need(arrays, "raymap_point_sample_arrays");
    const raymap_point_sample_arrays wanted = c::read(arrays);
    const PointSamples found =
        samplePoints(sampled, sampleOptions(count, how), c::optionsOr(options).machine);
    copyTo(wanted.points, found.points);
    copyTo(wanted.distance, found.distance);
    copyTo(wanted.gradient, found.gradient);
    if (wanted.centre) c::copyVector(found.centre, wanted.centre);
    if (wanted.scale) *wanted.scale = found.scale;
  });
}
