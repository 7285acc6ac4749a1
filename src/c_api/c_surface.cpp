// The functions of raymap/c.h about queries at any points, and about points to train with.

#include <raymap/c.h>
#include <raymap/sample_points.h>

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

void copyTo(double* to, const glm::dvec3& from) {
  for (int c = 0; c < 3; ++c) to[c] = from[c];
}

void copyTo(double* to, const Buffer<glm::dvec3>& from) {
  for (size_t i = 0; to && i < from.size(); ++i) copyTo(to + 3 * i, from[i]);
}

template <class T>
void copyTo(T* to, const Buffer<T>& from) {
  if (to) std::ranges::copy(from, to);
}

const std::vector<double>& defaultSigmas() {
  static const std::vector<double> sigmas = SamplePointsOptions().sigmas;
  return sigmas;
}

/// Returns a struct that begins with its size. Throws `Error(Usage)` if the caller did not set it.
template <class T>
T& needSized(T* pointer, const char* name) {
  T& given = need(pointer, name);
  if (given.size != sizeof(T))
    throw Error(ErrorCode::Usage, std::string("the size of ") + name + " is " + std::to_string(given.size) +
                                      "; set it to " + std::to_string(sizeof(T)));
  return given;
}

SamplePointsOptions sampleOptions(const raymap_sample_points_options& given) {
  if (given.sigma_count > 0) need(given.sigmas, "the array of deviations");
  return {.count = given.count,
          .surfaceShare = given.surface_share,
          .nearShare = given.near_share,
          .sigmas = {given.sigmas, given.sigmas + given.sigma_count},
          .seed = given.seed,
          .normalize = given.normalize};
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

raymap_sample_points_options raymap_sample_points_options_default(void) {
  const SamplePointsOptions options;
  return {.size = sizeof(raymap_sample_points_options),
          .count = options.count,
          .surface_share = options.surfaceShare,
          .near_share = options.nearShare,
          .sigmas = defaultSigmas().data(),
          .sigma_count = defaultSigmas().size(),
          .seed = options.seed,
          .normalize = options.normalize};
}

raymap_result raymap_sample_points(const raymap_surface* surface, const raymap_sample_points_options* options,
                                   const raymap_options* machine, raymap_point_samples* samples) {
  return guard([&] {
    const raymap_sample_points_options defaults = raymap_sample_points_options_default();
    const auto& given = needSized(options ? options : &defaults, "the struct of options");
    raymap_point_samples& wanted = needSized(samples, "the struct of samples");
    const PointSamples found =
        samplePoints(need(surface, "the surface").surface, sampleOptions(given), c::optionsOr(machine).machine);
    copyTo(wanted.points, found.points);
    copyTo(wanted.distance, found.distance);
    copyTo(wanted.gradient, found.gradient);
    copyTo(wanted.centre, found.centre);
    wanted.scale = found.scale;
  });
}
