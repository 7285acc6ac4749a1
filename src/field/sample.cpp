#include <raymap/sample.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "base/require.h"
#include "field/field_sampler.h"
#include "field/outside_bound.h"

namespace raymap {

namespace {

bool isNaN(Outside outside) {
  requireKnown(outside, Outside::NaN, "kind of outside");
  return outside == Outside::NaN;
}

constexpr size_t kPointsPerTask = 1024;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Rounds a bound down.
float roundDown(double bound) {
  const auto rounded = static_cast<float>(bound);
  return double(rounded) > bound ? std::nextafter(rounded, -INFINITY) : rounded;
}

// Functions that a sampler calls on dense fields and narrow bands alike.

FieldSampler samplerOf(const Field& field) {
  return FieldSampler(field);
}
SparseSampler samplerOf(const SparseField& band) {
  return SparseSampler(band);
}

double clampDistanceOf(const Field& field) {
  return field.clampDistance;
}

float valueAt(const Field& field, const glm::ivec3& sample) {
  return field.distance[field.grid.index(sample)];
}
float valueAt(const SparseField& band, const glm::ivec3& sample) {
  return band.distanceAt(sample);
}

/// Samples in the box and outside it. `AnyField` is a dense field or a narrow band.
template <class AnyField>
class PointSampler {
 public:
  PointSampler(const AnyField& field, Outside outside)
      : grid_(field.grid),
        isNaN_(isNaN(outside)),
        between_(samplerOf(field)),
        bound_(field.grid, field.surfaceBounds, clampDistanceOf(field)),
        read_([&field](const glm::ivec3& sample) { return valueAt(field, sample); }) {}

  double distance(const glm::dvec3& point) const {
    const glm::dvec3 p = toSamples(point);
    if (!bound_.isOutside(p)) return grid_.spacing * between_.value(p);
    return isNaN_ ? kNaN : grid_.spacing * bound_.at(p, read_);
  }
  float shortDistance(const glm::dvec3& point) const {
    const double distance = this->distance(point);
    return bound_.isOutside(toSamples(point)) ? roundDown(distance) : static_cast<float>(distance);
  }
  glm::dvec3 gradient(const glm::dvec3& point) const {
    const glm::dvec3 p = toSamples(point);
    return isNaN_ && bound_.isOutside(p) ? glm::dvec3(kNaN) : between_.gradient(p);
  }

 private:
  glm::dvec3 toSamples(const glm::dvec3& point) const { return (point - grid_.origin) / grid_.spacing; }

  const Grid& grid_;
  bool isNaN_;
  decltype(samplerOf(std::declval<const AnyField&>())) between_;
  OutsideBound bound_;
  OutsideBound::Read read_;
};

template <class AnyField>
void samplePoints(const AnyField& field, std::span<const glm::dvec3> points, Outside outside, float* distance,
                  glm::vec3* gradient) {
  validateField(field);
  const PointSampler sampler(field, outside);
  parallelFor(points.size(), kPointsPerTask, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (distance) distance[i] = sampler.shortDistance(points[i]);
      if (gradient) gradient[i] = glm::vec3(sampler.gradient(points[i]));
    }
  });
}

template <class AnyField>
void sampleAll(const AnyField& field, std::span<const glm::dvec3> points, const SampleOptions& options,
               Samples& result, const MachineOptions& machine) {
  result.distance.resizeUninitialized(points.size());
  result.gradient.resizeUninitialized(options.gradients ? points.size() : 0);
  withThreads(machine.threads, [&] {
    samplePoints(field, points, options.outside, result.distance.data(),
                 options.gradients ? result.gradient.data() : nullptr);
  });
}

}  // namespace

double distanceAt(const Field& field, const glm::dvec3& point, Outside outside) {
  validateField(field);
  return PointSampler(field, outside).distance(point);
}

double distanceAt(const SparseField& band, const glm::dvec3& point, Outside outside) {
  validateField(band);
  return PointSampler(band, outside).distance(point);
}

glm::dvec3 gradientAt(const Field& field, const glm::dvec3& point, Outside outside) {
  validateField(field);
  return PointSampler(field, outside).gradient(point);
}

glm::dvec3 gradientAt(const SparseField& band, const glm::dvec3& point, Outside outside) {
  validateField(band);
  return PointSampler(band, outside).gradient(point);
}

void sampleInto(const Field& field, std::span<const glm::dvec3> points, Outside outside, float* distance,
                glm::vec3* gradient) {
  samplePoints(field, points, outside, distance, gradient);
}

void sampleInto(const SparseField& band, std::span<const glm::dvec3> points, Outside outside, float* distance,
                glm::vec3* gradient) {
  samplePoints(band, points, outside, distance, gradient);
}

Samples sample(const SparseField& band, std::span<const glm::dvec3> points, const SampleOptions& options,
               const MachineOptions& machine) {
  Samples result;
  sample(band, points, options, result, machine);
  return result;
}

void sample(const SparseField& band, std::span<const glm::dvec3> points, const SampleOptions& options,
            Samples& result, const MachineOptions& machine) {
  sampleAll(band, points, options, result, machine);
}

Samples sample(const Field& field, std::span<const glm::dvec3> points, const SampleOptions& options,
               const MachineOptions& machine) {
  Samples result;
  sample(field, points, options, result, machine);
  return result;
}

void sample(const Field& field, std::span<const glm::dvec3> points, const SampleOptions& options,
            Samples& result, const MachineOptions& machine) {
  sampleAll(field, points, options, result, machine);
}

}  // namespace raymap
