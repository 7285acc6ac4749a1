// The functions of raymap/c.h about surfaces: queries, points to train with, regions and narrow bands.

#include <raymap/c.h>
#include <raymap/sample_points.h>

#include <span>
#include <vector>

#include "c_api/c_handles.h"
#include "c_api/c_report.h"
#include "c_api/c_struct.h"

using namespace raymap;
using raymap::c::copyTo;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

/// Returns the vector behind a pointer to three numbers. Throws `Error(Usage)` that names it if that is null.
glm::ivec3 samplesOf(const int32_t* numbers, const char* name) {
  need(numbers, name);
  return {numbers[0], numbers[1], numbers[2]};
}

Region regionOf(const int32_t* low, const int32_t* extent) {
  return {.low = samplesOf(low, "the first sample of the region"),
          .size = samplesOf(extent, "the extent of the region")};
}

}  // namespace

raymap_surface* raymap_surface_create(const raymap_mesh* mesh, const raymap_options* options) {
  return create([&] {
    const AllOptions& given = c::optionsOr(options);
    return std::make_unique<raymap_surface>(
        Surface(need(mesh, "the mesh").view, given.surface, given.machine));
  });
}

void raymap_surface_free(raymap_surface* surface) {
  delete surface;
}

size_t raymap_surface_bytes(const raymap_surface* surface) {
  return surface ? surface->surface.bytes() : 0;
}

char* raymap_surface_json(const raymap_surface* surface) {
  return c::report([&] { return toJson(need(surface, "the surface").surface.stats()); });
}

raymap_result raymap_surface_query(const raymap_surface* surface, const double* points, size_t count,
                                   const raymap_options* options, const raymap_query_arrays* arrays) {
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
                           .maxDistance = c::optionsOr(options).query.maxDistance};
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
                                       const uint32_t* triangles, size_t count, const raymap_options* options,
                                       const raymap_thickness_arrays* arrays) {
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
        measured.thickness(places, c::optionsOr(options).thickness, c::optionsOr(options).machine);
    for (size_t p = 0; p < count; ++p) {
      if (wanted.diameter) wanted.diameter[p] = found[p].diameter;
      if (wanted.part) wanted.part[p] = int32_t(found[p].part);
      for (int a = 0; wanted.inward && a < 3; ++a) wanted.inward[3 * p + size_t(a)] = found[p].inward[a];
    }
  });
}

raymap_result raymap_sample_points(const raymap_surface* surface, size_t count, const raymap_options* options,
                                   const raymap_point_sample_arrays* arrays) {
  return guard([&] {
    const Surface& sampled = need(surface, "the surface").surface;
    need(arrays, "raymap_point_sample_arrays");
    const raymap_point_sample_arrays wanted = c::read(arrays);
    SamplePointsOptions how = c::optionsOr(options).samples;
    how.count = count;
    const PointSamples found = samplePoints(sampled, how, c::optionsOr(options).machine);
    copyTo(wanted.points, found.points);
    copyTo(wanted.distance, found.distance);
    copyTo(wanted.gradient, found.gradient);
    if (wanted.centre) c::copyVector(found.centre, wanted.centre);
    if (wanted.scale) *wanted.scale = found.scale;
  });
}

raymap_result raymap_surface_distance(const raymap_surface* surface, const raymap_surface* other,
                                      const double pose[16], const raymap_options* options,
                                      raymap_surface_pair* found) {
  return guard([&] {
    const AllOptions& how = c::optionsOr(options);
    need(found, "the result") =
        c::toC(need(surface, "the surface")
                   .surface.distanceTo(need(other, "the other surface").surface,
                                       {c::poseOf(pose), how.query.maxDistance}, how.machine));
  });
}

raymap_result raymap_surface_hausdorff(const raymap_surface* surface, const raymap_surface* other,
                                       const double pose[16], double tolerance, bool bothWays,
                                       const raymap_options* options, raymap_surface_pair* found) {
  return guard([&] {
    need(found, "the result") =
        c::toC(need(surface, "the surface")
                   .surface.hausdorff(need(other, "the other surface").surface,
                                      {c::poseOf(pose), tolerance, bothWays}, c::optionsOr(options).machine));
  });
}

raymap_field* raymap_surface_generate_region(const raymap_surface* surface, const raymap_grid* lattice,
                                             const int32_t low[3], const int32_t extent[3],
                                             const raymap_options* options) {
  return create([&] {
    const Surface& made = need(surface, "the surface").surface;
    return c::ownField(made.generateRegion(c::fromC(need(lattice, "the lattice")), regionOf(low, extent),
                                           c::optionsOr(options).region, c::optionsOr(options).machine));
  });
}

raymap_result raymap_surface_far_distance(const raymap_surface* surface, const raymap_grid* lattice,
                                          const int32_t low[3], const int32_t extent[3],
                                          const raymap_options* options, double* distance) {
  return guard([&] {
    const Surface& made = need(surface, "the surface").surface;
    need(distance, "the distance") = made.farDistance(c::fromC(need(lattice, "the lattice")),
                                                      regionOf(low, extent), c::optionsOr(options).region)
                                         .value_or(NAN);
  });
}

raymap_result raymap_surface_region_bytes(const raymap_surface* surface, const int32_t extent[3],
                                          const raymap_options* options, size_t* bytes) {
  return guard([&] {
    need(bytes, "the number of bytes") =
        need(surface, "the surface")
            .surface.regionBytes(samplesOf(extent, "the extent of the region"), c::optionsOr(options).region,
                                 c::optionsOr(options).machine);
  });
}

raymap_field* raymap_surface_generate_band(const raymap_surface* surface, const raymap_grid* grid,
                                           const raymap_options* options) {
  return create([&] {
    return c::ownField(need(surface, "the surface")
                           .surface.generateBand(c::fromC(need(grid, "the grid")), c::optionsOr(options).band,
                                                 c::optionsOr(options).machine));
  });
}
