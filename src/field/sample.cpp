#include <raymap/sample.h>

#include "base/parallel.h"
#include "field/field_sampler.h"

namespace raymap {

namespace {

constexpr size_t kPointsPerTask = 1024;

glm::dvec3 toSamples(const Grid& grid, const glm::dvec3& point) {
  return (point - grid.origin) / grid.spacing;
}

}  // namespace

double distanceAt(const Field& field, const glm::dvec3& point) {
  validateField(field);
  return field.grid.spacing * FieldSampler(field).value(toSamples(field.grid, point));
}

glm::dvec3 gradientAt(const Field& field, const glm::dvec3& point) {
  validateField(field);
  return FieldSampler(field).gradient(toSamples(field.grid, point));
}

void sampleInto(const Field& field, std::span<const glm::dvec3> points, float* distance,
                glm::vec3* gradient) {
  validateField(field);
  const FieldSampler sampler(field);
  parallelFor(points.size(), kPointsPerTask, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const glm::dvec3 p = toSamples(field.grid, points[i]);
      if (distance) distance[i] = static_cast<float>(field.grid.spacing * sampler.value(p));
      if (gradient) gradient[i] = glm::vec3(sampler.gradient(p));
    }
  });
}

Samples sample(const Field& field, std::span<const glm::dvec3> points, const SampleOptions& options) {
  Samples result;
  sample(field, points, options, result);
  return result;
}

void sample(const Field& field, std::span<const glm::dvec3> points, const SampleOptions& options,
            Samples& result) {
  result.distance.resizeUninitialized(points.size());
  result.gradient.resizeUninitialized(options.gradients ? points.size() : 0);
  withThreads(options.threads, [&] {
    sampleInto(field, points, result.distance.data(), options.gradients ? result.gradient.data() : nullptr);
  });
}

}  // namespace raymap
