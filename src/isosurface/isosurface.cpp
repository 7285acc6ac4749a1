#include <raymap/error.h>
#include <raymap/isosurface.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "field/field_sampler.h"
#include "isosurface/dual_contour.h"

namespace raymap {

namespace {

// Largest change between the differences to both sides where the surface has no edge.
constexpr double kSmooth = 0.1;
// Errors of the gradient's length below this are noise.
constexpr double kExact = 0.004;
// Error of the length that curvature with a radius of 3 samples causes.
constexpr double kCurved = 0.045;
// Share of a smaller error that one-sided differences leave beside an edge between planes.
constexpr double kPlanar = 0.05;
// Weight of planes at crossings, which decide where samples have no gradient.
constexpr double kCrossing = 0.02;
// Least length of a gradient with a direction.
constexpr double kMinLength = 1e-6;

/// Derives planes of the surface from the samples of a distance field. A sample's value gives the plane's
/// distance, its gradient the direction.
class SamplePlanes {
 public:
  SamplePlanes(const Field& field, double iso)
      : field_(field), dims_(field.grid.dims), iso_(iso), scale_(1.0 / field.grid.spacing) {}

  void operator()(const glm::ivec3& inside, const glm::ivec3& outside, PlaneFit& fit) const {
    const glm::dvec3 start(inside), step(outside - inside);
    if (glm::any(glm::lessThan(outside, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(outside, dims_))) {
      fit.addCrossing(start + 0.5 * step);  // On the grid's box.
      fit.addPlane(start + 0.5 * step, step);
      return;
    }
    const double from = value(inside), to = value(outside);
    const glm::dvec3 crossing = start + step * (from / (from - to));
    fit.addCrossing(crossing);
    const glm::dvec3 g = gradient(inside), h = gradient(outside);
    fit.addPlane(start - from * g, g);
    fit.addPlane(start + step - to * h, h);
    if (const double length = glm::length(g + h); length > kMinLength)
      fit.addPlane(crossing, (g + h) / length, kCrossing);
  }

 private:
  double value(const glm::ivec3& s) const {
    return scale_ * (double(field_.distance[field_.grid.index(s)]) - iso_);
  }

  /// Returns the gradient at a sample, at length 1 like that of any distance. Central differences across an
  /// edge of the surface are shorter than 1; one-sided differences that do not cross it replace them.
  /// Curvature shortens central differences a little too, but then one-sided ones are worse, or better only
  /// by chance.
  glm::dvec3 gradient(const glm::ivec3& s) const {
    glm::dvec3 low(0.0), high(0.0);
    for (int a = 0; a < 3; ++a) {
      glm::ivec3 step(0);
      step[a] = 1;
      const double here = value(s);
      low[a] = s[a] > 0 ? here - value(s - step) : NAN;
      high[a] = s[a] + 1 < dims_[a] ? value(s + step) - here : NAN;
      if (std::isnan(low[a])) low[a] = std::isnan(high[a]) ? 0.0 : high[a];
      if (std::isnan(high[a])) high[a] = low[a];
    }
    return mostLikely(low, high);
  }

  static glm::dvec3 mostLikely(const glm::dvec3& low, const glm::dvec3& high) {
    glm::dvec3 best = 0.5 * (low + high);
    const double central = std::abs(glm::length(best) - 1.0);
    double least = central > kCurved ? central : kPlanar * central;
    // Each axis has two choices, or one if both are nearly the same.
    glm::dvec3 first = low, second = high;
    for (int a = 0; a < 3; ++a)
      if (std::abs(high[a] - low[a]) <= kSmooth) first[a] = second[a] = best[a];
    for (int choice = 0; choice < 8 && central > kExact; ++choice) {
      const glm::dvec3 g = glm::mix(first, second, glm::bvec3(choice & 1, choice & 2, choice & 4));
      const double error = std::abs(glm::length(g) - 1.0);
      if (error < least) least = error, best = g;
    }
    const double length = glm::length(best);
    return length > kMinLength ? best / length : glm::dvec3(0.0);
  }

  const Field& field_;
  glm::ivec3 dims_;
  double iso_;
  double scale_;
};

struct Range {
  float low = INFINITY, high = -INFINITY;
};

/// Returns the range of the values. Throws `Error(Input)` if a sample is not finite.
Range rangeOf(const Field& field) {
  const glm::ivec3 dims = field.grid.dims;
  const size_t sheet = size_t(dims.x) * size_t(dims.y);
  std::vector<Range> ranges(size_t(dims.z));
  parallelFor(ranges.size(), 1, [&](size_t k, size_t) {
    for (size_t i = k * sheet; i < (k + 1) * sheet; ++i) {
      const float value = field.distance[i];
      if (!std::isfinite(value))
        throw Error(ErrorCode::Input, "sample (" + std::to_string(i % dims.x) + ", " +
                                          std::to_string(i / dims.x % dims.y) + ", " + std::to_string(k) +
                                          ") of the field is " + numberText(value) +
                                          ": a surface needs finite samples; make the field again");
      ranges[k].low = std::min(ranges[k].low, value);
      ranges[k].high = std::max(ranges[k].high, value);
    }
  });
  Range all;
  for (const Range& range : ranges) all = {std::min(all.low, range.low), std::max(all.high, range.high)};
  return all;
}

/// Returns whether a sample on the sides of the grid is inside.
bool reachesBox(const Field& field, double iso) {
  const glm::ivec3 last = field.grid.dims - 1;
  for (int k = 0; k <= last.z; ++k)
    for (int j = 0; j <= last.y; ++j) {
      const bool isSide = k == 0 || k == last.z || j == 0 || j == last.y;
      for (int i = 0; i <= last.x; i += isSide ? 1 : std::max(last.x, 1))
        if (field.distance[field.grid.index({i, j, k})] < iso) return true;
    }
  return false;
}

void check(const Field& field, double iso) {
  validateField(field);
  const auto text = [](double value) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%g", value);
    return std::string(digits.data());
  };
  const Range range = rangeOf(field);
  if (!(range.low < iso))
    throw Error(ErrorCode::Usage, "there is no surface at " + text(iso) + ": the field's values go from " +
                                      text(range.low) + " to " + text(range.high) +
                                      "; choose a distance between them");
  if (field.clampDistance > 0.0 && std::abs(iso) >= field.clampDistance)
    throw Error(ErrorCode::Usage, "there is no surface at " + text(iso) +
                                      ": the field's distances are clamped at " + text(field.clampDistance));
}

}  // namespace

Mesh isosurface(const Field& field, const IsosurfaceOptions& options, const MachineOptions& machine) {
  Mesh mesh;
  isosurface(field, options, mesh, machine);
  return mesh;
}

void isosurface(const Field& field, const IsosurfaceOptions& options, Mesh& result,
                const MachineOptions& machine) {
  Progress progress(machine.progress);
  const auto contour = [&] {
    check(field, options.iso);
    dualContour(field, options.iso, SamplePlanes(field, options.iso), progress, result);
  };
  try {
    progress.stage("isosurface", [&] { withThreads(machine.threads, contour); });
  } catch (...) {
    result = {};
    throw;
  }
  if (machine.warn && reachesBox(field, options.iso))
    machine.warn(
        {WarningCode::BoxReached,
         "the solid reaches the grid's box and was closed there; a larger box would hold all of it"});
}

}  // namespace raymap
