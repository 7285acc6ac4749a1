#include <raymap/sample_points.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "base/require.h"
#include "base/text.h"
#include "measure/random_numbers.h"
#include "mesh/model.h"
#include "mesh/triangle.h"

namespace raymap {

namespace {

/// Length of the steps to both sides of a face, as a share of the bounding sphere's radius. The mesh is
/// rounded by less, and thinner solids do not matter.
constexpr double kBeside = 2e-6;

/// Sphere about the centre of a mesh's bounds that reaches its farthest vertex.
struct BoundingSphere {
  glm::dvec3 centre;
  double radius = 0.0;

  explicit BoundingSphere(const PackedMesh& mesh) : centre(bounds(mesh).centre()) {
    for (const glm::uvec3& face : mesh.triangles)
      for (int c = 0; c < 3; ++c) radius = std::max(radius, glm::length(mesh.position(face[c]) - centre));
  }
};

/// A point chosen on a face.
struct ChosenPoint {
  glm::dvec3 position;
  uint32_t triangle;
};

/// Chooses points of a mesh evenly by area, but none of faces that are left out.
class AreaSampler {
 public:
  AreaSampler(const PackedMesh& mesh, const Stats& stats)
      : mesh_(mesh), turnedFaces_(stats.turnedFaces), areas_(mesh.triangles.size()) {
    for (uint32_t f = 0; f < areas_.size(); ++f) areas_[f] = glm::length(longNormalOf(f));
    for (const uint32_t face : stats.leftOutFaces) areas_[face] = 0.0;
    std::partial_sum(areas_.begin(), areas_.end(), areas_.begin());
    if (!(areas_.back() > 0.0))
      throw Error(ErrorCode::Input, "the mesh has no area: all of its faces are degenerate");
  }

  std::vector<ChosenPoint> choose(size_t count, RandomNumbers& random) const {
    const std::vector<double> places = random.uniforms(count), roots = random.uniforms(count),
                              shares = random.uniforms(count);
    std::vector<ChosenPoint> chosen(count);
    parallelFor(count, kCheapGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const auto at = std::ranges::upper_bound(areas_, places[i] * areas_.back());
        chosen[i].triangle = uint32_t(at - areas_.begin());
        const auto [a, b, c] = cornersOf(chosen[i].triangle);
        const double root = std::sqrt(roots[i]), share = shares[i];
        chosen[i].position = a * (1.0 - root) + b * (root * (1.0 - share)) + c * (root * share);
      }
    });
    return chosen;
  }

  /// Returns the unit normal of a face; of a reversed one, that of its other side.
  glm::dvec3 normalAt(uint32_t face) const {
    const glm::dvec3 normal = longNormalOf(face);
    const double sign = std::ranges::binary_search(turnedFaces_, face) ? -1.0 : 1.0;
    return normal * (sign / glm::length(normal));
  }

 private:
  glm::dvec3 longNormalOf(uint32_t face) const {
    const auto [a, b, c] = cornersOf(face);
    return doubleAreaNormal(a, b, c);
  }
  std::array<glm::dvec3, 3> cornersOf(uint32_t face) const {
    const glm::uvec3& t = mesh_.triangles[face];
    return {mesh_.position(t.x), mesh_.position(t.y), mesh_.position(t.z)};
  }

  const PackedMesh& mesh_;
  std::span<const uint32_t> turnedFaces_;  ///< Ascending.
  std::vector<double> areas_;              ///< Sum of the doubled areas of all faces up to each.
};

/// Reverses normals at points of a surface that point to the inside, as `samplePoints` says.
void turnOutwards(const Surface& surface, const MachineOptions& machine, std::span<const ChosenPoint> at,
                  double step, std::span<glm::dvec3> normals) {
  std::vector<glm::dvec3> sides;  // Above and below each point.
  sides.reserve(2 * at.size());
  for (size_t i = 0; i < at.size(); ++i)
    for (const double along : {step, -step}) sides.push_back(at[i].position + along * normals[i]);
  const QueryResult found = surface.query(sides, {}, machine);
  std::vector<size_t> unsure;
  std::vector<glm::dvec3> unsureSides;
  for (size_t i = 0; i < at.size(); ++i) {
    const bool isAboveInside = found.distance[2 * i] < 0.0, isBelowInside = found.distance[2 * i + 1] < 0.0;
    if (isAboveInside && !isBelowInside) normals[i] = -normals[i];
    if (isAboveInside != isBelowInside) continue;
    unsure.push_back(i);
    unsureSides.insert(unsureSides.end(), {sides[2 * i], sides[2 * i + 1]});
  }
  const QueryResult numbers = surface.query(unsureSides, {.distance = false, .winding = true}, machine);
  for (size_t k = 0; k < unsure.size(); ++k) {
    const float above = std::abs(numbers.winding[2 * k]), below = std::abs(numbers.winding[2 * k + 1]);
    // Across a face the number changes by 1, else by much less.
    if (above - below > 0.5f) normals[unsure[k]] = -normals[unsure[k]];
  }
}

/// Returns whether the steps of single precision are short beside a deviation, up to a distance from 0.
bool isSingleEnough(double reach, double deviation) {
  const auto rounded = static_cast<float>(reach);
  return std::nextafter(rounded, INFINITY) - rounded <= deviation / 16.0;
}

glm::dvec3 toSingle(const glm::dvec3& point) {
  return glm::dvec3(glm::vec3(point));
}

void requireShare(const char* name, double share) {
  require(share >= 0.0 && share <= 1.0,
          std::string(name) + " must be a share from 0 to 1, not " + numberText(share));
}

double reachOf(const SamplePointsOptions& options, const BoundingSphere& sphere) {
  return options.radius > 0.0 ? options.radius : sphere.radius;
}

/// Returns the length of the mesh that becomes 1.
double unitOf(const SamplePointsOptions& options, const BoundingSphere& sphere) {
  if (options.unit > 0.0) return options.unit;
  return options.normalize ? sphere.radius : 1.0;
}

/// Chooses points near a surface, then all around, in the mesh's units.
void chooseOthers(const std::vector<size_t>& counts, const SamplePointsOptions& options,
                  const AreaSampler& areas, const BoundingSphere& sphere, RandomNumbers& random,
                  glm::dvec3* to) {
  for (size_t k = 0; k < options.sigmas.size(); ++k) {
    const std::vector<ChosenPoint> chosen = areas.choose(counts[k + 1], random);
    const std::vector<double> normals = random.normals(3 * chosen.size());
    const double deviation = options.sigmas[k] * sphere.radius;
    for (size_t i = 0; i < chosen.size(); ++i) {
      const glm::dvec3 offset(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
      *to++ = chosen[i].position + offset * deviation;
    }
  }
  const double reach = reachOf(options, sphere);
  if (!options.inCube) {
    for (const glm::dvec3& point : random.inBall<3>(counts.back())) *to++ = sphere.centre + point * reach;
    return;
  }
  for (size_t i = 0; i < counts.back(); ++i) {
    glm::dvec3 point;
    for (int c = 0; c < 3; ++c) point[c] = 2.0 * random.uniform() - 1.0;
    *to++ = sphere.centre + point * reach;
  }
}

/// Moves points in place from the mesh's units to those of the samples, and rounds them. Returns their
/// positions in the mesh.
std::vector<glm::dvec3> store(const SamplePointsOptions& options, const BoundingSphere& sphere,
                              PointSamples& samples) {
  const double unit = unitOf(options, sphere);
  if (options.normalize || options.unit > 0.0) samples.centre = sphere.centre;
  samples.scale = 1.0 / unit;
  const glm::dvec3 away = glm::abs(sphere.centre - samples.centre);
  const double reach = std::max(reachOf(options, sphere), sphere.radius);
  const bool isSingle = isSingleEnough((std::max({away.x, away.y, away.z}) + reach) / unit,
                                       *std::ranges::min_element(options.sigmas) * sphere.radius / unit);
  std::vector<glm::dvec3> positions;
  positions.reserve(samples.points.size());
  for (glm::dvec3& point : samples.points) {
    const glm::dvec3 moved = (point - samples.centre) / unit;
    // Not in place: GCC 12 with -O3 then keeps x and y as they were (-fno-tree-slp-vectorize shows it).
    const glm::dvec3 stored = isSingle ? toSingle(moved) : moved;
    positions.push_back(stored * unit + samples.centre);
    point = stored;
  }
  return positions;
}

/// Fills distances and gradients of the points from `first` on.
void measureOthers(const Surface& surface, const MachineOptions& machine,
                   std::span<const glm::dvec3> positions, size_t first, double unit, PointSamples& samples) {
  const QueryResult found = surface.query(positions.subspan(first), {.direction = true}, machine);
  for (size_t i = first; i < positions.size(); ++i) {
    const double distance = found.distance[i - first];
    const glm::dvec3& direction = found.direction[i - first];
    samples.distance[i] = distance / unit;
    samples.gradient[i] = (distance < 0.0 ? direction : -direction) + 0.0;  // No number is -0.
  }
}

/// Returns the rows of the points on one side.
template <class Vector>
SampleRows rowsOf(const PointSamples& samples, bool areInside) {
  std::vector<Vector> rows;
  for (size_t i = 0; i < samples.points.size(); ++i)
    if ((samples.distance[i] < 0.0) == areInside) rows.emplace_back(samples.points[i], samples.distance[i]);
  return rows;
}

}  // namespace

std::vector<size_t> samplePointCounts(const SamplePointsOptions& options) {
  requireShare("near", options.nearShare);
  requireShare("surface", options.surfaceShare);
  require(!options.sigmas.empty(), "sigma must be numbers from 0 on, but there is none");
  for (const double sigma : options.sigmas)
    require(sigma >= 0.0 && std::isfinite(sigma),
            "sigma must be numbers from 0 on, not " + numberText(sigma));
  for (const auto& [name, length] : {std::pair("unit", options.unit), {"radius", options.radius}})
    require(length >= 0.0 && std::isfinite(length),
            std::string(name) + " must be a length from 0 on, not " + numberText(length));
  const auto countOf = [&](double share) {
    return static_cast<size_t>(std::nearbyint(double(options.count) * share));
  };
  const size_t onSurface = countOf(options.surfaceShare), close = countOf(options.nearShare);
  require(onSurface + close <= options.count, "near and surface must be at most 1 together, not " +
                                                  numberText(options.nearShare) + " and " +
                                                  numberText(options.surfaceShare));
  const size_t kinds = options.sigmas.size();
  std::vector<size_t> counts{onSurface};
  for (size_t k = 0; k < kinds; ++k) counts.push_back(close / kinds + (k < close % kinds ? 1 : 0));
  counts.push_back(options.count - onSurface - close);
  return counts;
}

PointSamples samplePoints(const Surface& surface, const SamplePointsOptions& options,
                          const MachineOptions& machine) {
  const std::vector<size_t> counts = samplePointCounts(options);
  require(surface.isSigned(), "the surface was made without a sign, so its points have no sign");
  PointSamples samples{.points = Buffer<glm::dvec3>(options.count),
                       .distance = Buffer<double>(options.count),
                       .gradient = Buffer<glm::dvec3>(options.count)};
  const Model mesh(surface.mesh());
  const BoundingSphere sphere(mesh);
  const AreaSampler areas(mesh, surface.stats());
  RandomNumbers random(options.seed);
  std::vector<ChosenPoint> onSurface;
  withThreads(machine.threads, [&] {
    onSurface = areas.choose(counts[0], random);
    chooseOthers(counts, options, areas, sphere, random, samples.points.data() + onSurface.size());
  });
  for (size_t i = 0; i < onSurface.size(); ++i) {
    samples.points[i] = onSurface[i].position;
    samples.distance[i] = 0.0;
    samples.gradient[i] = areas.normalAt(onSurface[i].triangle);
  }
  const std::span gradient(samples.gradient.data(), onSurface.size());
  turnOutwards(surface, machine, onSurface, kBeside * sphere.radius, gradient);
  for (glm::dvec3& normal : gradient) normal += 0.0;  // No number is -0.
  const std::vector<glm::dvec3> positions = store(options, sphere, samples);
  measureOthers(surface, machine, positions, onSurface.size(), unitOf(options, sphere), samples);
  return samples;
}

SampleRows sampleRows(const PointSamples& samples, bool areInside) {
  const bool isSingle =
      std::ranges::all_of(samples.points, [](const glm::dvec3& point) { return point == toSingle(point); });
  return isSingle ? rowsOf<glm::vec4>(samples, areInside) : rowsOf<glm::dvec4>(samples, areInside);
}

}  // namespace raymap
