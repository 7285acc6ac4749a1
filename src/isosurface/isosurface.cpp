#include <raymap/isosurface.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/progress.h"
#include "field/sparse_reader.h"
#include "isosurface/contour_rows.h"
#include "isosurface/dual_contour.h"
#include "isosurface/field_values.h"

namespace raymap {

namespace {

// Largest change between the differences to both sides where the surface has no edge.
constexpr double kSmooth = 0.1;
// Errors of the gradient's length below this are noise.
constexpr double kExact = 0.004;
// Gradients whose errors differ less than this are equally likely.
constexpr double kTied = 1e-4;
// Error of the length that curvature with a radius of 3 samples causes.
constexpr double kCurved = 0.045;
// Share of a smaller error that one-sided differences leave beside an edge between planes.
constexpr double kPlanar = 0.05;
// Weight of planes at crossings, which decide where samples have no gradient.
constexpr double kCrossing = 0.02;
// Least length of a gradient with a direction.
constexpr double kMinLength = 1e-6;

/// Reads the samples of a dense field, as `SparseReader` those of a narrow band.
class DenseReader {
 public:
  DenseReader(const Field& field, const glm::ivec3&) : field_(field) {}

  float operator()(const glm::ivec3& sample) const { return field_.distance[field_.grid.index(sample)]; }

 private:
  const Field& field_;
};

/// Derives planes of the surface from the samples of a distance field, which a `Reader` reads. A sample's
/// value gives the plane's distance, its gradient the direction.
template <class Reader>
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
    Reader read(field_, inside);
    const double from = value(read, inside), to = value(read, outside);
    const glm::dvec3 crossing = start + step * (from / (from - to));
    fit.addCrossing(crossing);
    const Gradients g = gradients(read, inside), h = gradients(read, outside);
    g.addPlanes(fit, start, from);
    h.addPlanes(fit, start + step, to);
    const glm::dvec3 normal = g.mean() + h.mean();
    if (const double length = glm::length(normal); length > kMinLength)
      fit.addPlane(crossing, normal / length, kCrossing);
  }

 private:
  double value(Reader& read, const glm::ivec3& s) const { return scale_ * (double(read(s)) - iso_); }

  /// The likely gradients at a sample, at length 1 like those of any distance. There are several where the
  /// sample is as far from several parts of the surface, as beside the edge of a box.
  class Gradients {
   public:
    /// Adds a gradient unless others are likelier. Rounding does not decide between equally likely ones.
    void add(const glm::dvec3& gradient, double error) {
      const double length = glm::length(gradient);
      if (!(length > kMinLength) || error > least_ + kTied) return;
      if (error < least_ - kTied) count_ = 0;
      least_ = std::min(least_, error);
      items_[count_++] = gradient / length;
    }
    /// Adds the planes at this distance from the sample. Their weights sum to 1.
    void addPlanes(PlaneFit& fit, const glm::dvec3& sample, double distance) const {
      for (size_t i = 0; i < count_; ++i)
        fit.addPlane(sample - distance * items_[i], items_[i], 1.0 / double(count_));
    }
    glm::dvec3 mean() const {
      glm::dvec3 sum(0.0);
      for (size_t i = 0; i < count_; ++i) sum += items_[i] / double(count_);
      return sum;
    }

   private:
    std::array<glm::dvec3, 9> items_;
    size_t count_ = 0;
    double least_ = INFINITY;
  };

  /// Returns the gradients at a sample. Central differences across an edge of the surface are shorter than 1;
  /// one-sided differences that do not cross it replace them. Curvature shortens central differences a little
  /// too, but then one-sided ones are worse, or better only by chance.
  Gradients gradients(Reader& read, const glm::ivec3& s) const {
    glm::dvec3 low(0.0), high(0.0);
    for (int a = 0; a < 3; ++a) {
      glm::ivec3 step(0);
      step[a] = 1;
      const double here = value(read, s);
      low[a] = s[a] > 0 ? here - value(read, s - step) : NAN;
      high[a] = s[a] + 1 < dims_[a] ? value(read, s + step) - here : NAN;
      if (std::isnan(low[a])) low[a] = std::isnan(high[a]) ? 0.0 : high[a];
      if (std::isnan(high[a])) high[a] = low[a];
    }
    return mostLikely(low, high);
  }

  static Gradients mostLikely(const glm::dvec3& low, const glm::dvec3& high) {
    const glm::dvec3 central = 0.5 * (low + high);
    const double error = std::abs(glm::length(central) - 1.0);
    Gradients likely;
    likely.add(central, error > kCurved ? error : kPlanar * error);
    if (error <= kExact) return likely;
    // Each axis has two choices, or one if both are nearly the same.
    int choices = 0;
    for (int a = 0; a < 3; ++a)
      if (std::abs(high[a] - low[a]) > kSmooth) choices |= 1 << a;
    for (int choice = 0; choice < 8; ++choice) {
      if (choice & ~choices) continue;
      const glm::bvec3 one(choices & 1, choices & 2, choices & 4), up(choice & 1, choice & 2, choice & 4);
      const glm::dvec3 g = glm::mix(central, glm::mix(low, high, up), one);
      likely.add(g, std::abs(glm::length(g) - 1.0));
    }
    return likely;
  }

  const Field& field_;
  glm::ivec3 dims_;
  double iso_;
  double scale_;
};

template <class Reader>
void contour(const Field& field, double iso, Progress& progress, Mesh& result) {
  checkValues(field, iso);
  progress.part(0.0, 0.2);
  ContourRows cubes = findCubes(field, iso, progress);
  const auto value = [&](const glm::ivec3& sample) { return double(Reader(field, sample)(sample)) - iso; };
  dualContour(field.grid, std::move(cubes), value, SamplePlanes<Reader>(field, iso), progress, result);
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
  try {
    progress.stage("isosurface", [&] {
      withThreads(machine.threads, [&] {
        const auto make = field.narrow ? contour<SparseReader> : contour<DenseReader>;
        make(field, options.iso, progress, result);
      });
    });
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
