// The functions of raymap/c.h about queries at any points, and about points to train with.

#include <raymap/c.h>
#include <raymap/names.h>
#include <raymap/sample_points.h>

#include <algorithm>
#include <limits>
#include <span>
#include <string>

#include "c_api/c_handles.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

SurfaceOptions surfaceOptions(const Options& given) {
  if (given.sign != SignMode::Harmonic && given.sign != SignMode::None)
    throw Error(ErrorCode::Usage, "a surface cannot use the sign '" + std::string(name(given.sign)) +
                                      "'; use harmonic or none");
  return {.sign = given.sign == SignMode::Harmonic,
          .orientation = given.orientation,
          .threshold = given.threshold,
          .threads = given.threads,
          .memoryLimit = given.memoryLimit,
          .progress = given.progress};
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

/// Returns a struct that begins with its size. Throws `Error(Usage)` if the caller did not set it.
template <class T>
T& needSized(T* pointer, const char* name) {
  T& given = need(pointer, name);
  if (given.size != sizeof(T))
    throw Error(ErrorCode::Usage, std::string(name) + ": the size is " + std::to_string(given.size) +
                                      "; set it to " + std::to_string(sizeof(T)));
  return given;
}

SamplePointsOptions sampleOptions(size_t count, const raymap_sample_points_options* how,
                                  const Options& machine) {
  SamplePointsOptions options{.count = count, .threads = machine.threads, .progress = machine.progress};
  if (!how) return options;
  const raymap_sample_points_options& given = needSized(how, "raymap_sample_points_options");
  if (given.has_shares) options.surfaceShare = given.surface_share, options.nearShare = given.near_share;
  if (given.sigmas) options.sigmas.assign(given.sigmas, given.sigmas + given.sigma_count);
  options.seed = given.seed;
  options.normalize = given.normalize;
  return options;
}

}  // namespace

raymap_surface* raymap_surface_create(const raymap_mesh* mesh, const raymap_options* options) {
  return create([&] {
    return std::make_unique<raymap_surface>(
        Surface(need(mesh, "the mesh").view, surfaceOptions(c::optionsOr(options))));
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
    const Options& given = c::optionsOr(options);
    const QueryResult found =
        queried.query(PointsView(points, count),
                      {.distance = wanted.distance != nullptr,
                       .closest = wanted.closest != nullptr,
                       .triangle = wanted.triangle != nullptr,
                       .barycentric = wanted.barycentric != nullptr,
                       .direction = wanted.direction != nullptr,
                       .winding = wanted.winding != nullptr,
                       .confidence = wanted.confidence != nullptr,
                       .maxDistance = limit != 0.0 ? limit : std::numeric_limits<double>::infinity(),
                       .threads = given.threads,
                       .progress = given.progress});
    copyTo(wanted.distance, found.distance);
    copyTo(wanted.closest, found.closest);
    copyTo(wanted.triangle, found.triangle);
    copyTo(wanted.barycentric, found.barycentric);
    copyTo(wanted.direction, found.direction);
    copyTo(wanted.winding, found.winding);
    copyTo(wanted.confidence, found.confidence);
  });
}

raymap_result raymap_sample_points(const raymap_surface* surface, size_t count,
                                   const raymap_sample_points_options* how, const raymap_options* options,
                                   const raymap_point_sample_arrays* arrays) {
  return guard([&] {
    const Surface& sampled = need(surface, "the surface").surface;
    const raymap_point_sample_arrays& wanted = needSized(arrays, "raymap_point_sample_arrays");
    const PointSamples found = samplePoints(sampled, sampleOptions(count, how, c::optionsOr(options)));
    copyTo(wanted.points, found.points);
    copyTo(wanted.distance, found.distance);
    copyTo(wanted.gradient, found.gradient);
    if (wanted.centre) copyTo(wanted.centre, found.centre);
    if (wanted.scale) *wanted.scale = found.scale;
  });
}
