#include <raymap/sample.h>

#include <cmath>
#include <limits>

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

/// Samples in the box and outside it. `Between` interpolates a dense field or a narrow band.
template <class Between>
class PointSampler {
 public:
  PointSampler(const Field& field, Outside outside)
      : grid_(field.grid),
        isNaN_(isNaN(outside)),
        between_(field),
        bound_(field.grid, field.surfaceBounds, field.clamp()),
        read_([&field](const glm::ivec3& sample) { return field.distanceAt(sample); }) {}

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
  Between between_;
  OutsideBound bound_;
  OutsideBound::Read read_;
};

/// Checks a field, and calls `use` with its sampler.
template <class Use>
auto withSampler(const Field& field, Outside outside, Use&& use) {
  validateField(field);
  return field.narrow ? use(PointSampler<SparseSampler>(field, outside))
                      : use(PointSampler<FieldSampler>(field, outside));
}

}  // namespace

double distanceAt(const Field& field, const glm::dvec3& point, Outside outside) {
  return withSampler(field, outside, [&](const auto& sampler) { return sampler.distance(point); });
}

glm::dvec3 gradientAt(const Field& field, const glm::dvec3& point, Outside outside) {
  return withSampler(field, outside, [&](const auto& sampler) { return sampler.gradient(point); });
}

void sampleInto(const Field& field, std::span<const glm::dvec3> points, Outside outside, float* distance,
                glm::vec3* gradient) {
  withSampler(field, outside, [&](const auto& sampler) {
    parallelFor(points.size(), kPointsPerTask, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        if (distance) distance[i] = sampler.shortDistance(points[i]);
        if (gradient) gradient[i] = glm::vec3(sampler.gradient(points[i]));
      }
    });
  });
}

Samples sample(const Field& field, std::span<const glm::dvec3> points, const SampleOptions& options,
               const MachineOptions& machine) {
  Samples result;
  sample(field, points, options, result, machine);
  return result;
}

void sample(const Field& field, std::span<const glm::dvec3> points, const SampleOptions& options,
            Samples& result, const MachineOptions& machine) {
  result.distance.resizeUninitialized(points.size());
  result.gradient.resizeUninitialized(options.gradients ? points.size() : 0);
  withThreads(machine.threads, [&] {
    sampleInto(field, points, options.outside, result.distance.data(),
               options.gradients ? result.gradient.data() : nullptr);
  });
}

}  // namespace raymap
