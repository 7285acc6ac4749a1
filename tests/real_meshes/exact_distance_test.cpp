// The exact distance of every mesh of the shared folder against brute force in double precision.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <iostream>
#include <random>

#include "base/parallel.h"
#include "mesh_folder.h"
#include "reference.h"

namespace raymap {
namespace {

constexpr double kAllowed = 1e-6;  // of the diagonal of the bounds

/// Computes distances by brute force, but skips triangles whose bounding sphere is too far away.
class BruteForce {
 public:
  explicit BruteForce(const Mesh& mesh) : mesh_(mesh) {
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 a(mesh.vertices[t.x]), b(mesh.vertices[t.y]), c(mesh.vertices[t.z]);
      const glm::dvec3 centre = (a + b + c) / 3.0;
      const double radius =
          std::max({glm::distance(a, centre), glm::distance(b, centre), glm::distance(c, centre)});
      spheres_.push_back({centre, radius});
    }
  }

  double distance(const glm::dvec3& position) const {
    const glm::dvec3 p = position - mesh_.origin;
    double bound = INFINITY;
    for (const Sphere& s : spheres_) bound = std::min(bound, glm::distance(p, s.centre) + s.radius);
    for (size_t t = 0; t < spheres_.size(); ++t) {
      const glm::dvec3 away = p - spheres_[t].centre;
      const double reach = bound + spheres_[t].radius;
      if (glm::dot(away, away) > reach * reach) continue;
      const glm::uvec3& corners = mesh_.triangles[t];
      bound = std::min(bound, reference::triangleDistance(p, glm::dvec3(mesh_.vertices[corners.x]),
                                                          glm::dvec3(mesh_.vertices[corners.y]),
                                                          glm::dvec3(mesh_.vertices[corners.z])));
    }
    return bound;
  }

 private:
  struct Sphere {
    glm::dvec3 centre;
    double radius;
  };
  const Mesh& mesh_;
  std::vector<Sphere> spheres_;
};

bool contains(const Grid& grid, const glm::ivec3& s) {
  return glm::all(glm::greaterThanEqual(s, glm::ivec3(0))) && glm::all(glm::lessThan(s, grid.dims));
}

/// Returns random samples of the grid and as many, if there are any, within 1.5 spacings of the surface.
std::vector<glm::ivec3> pickSamples(const Mesh& mesh, const Grid& grid, size_t count) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<glm::ivec3> samples;
  while (samples.size() < count)
    samples.push_back({random() % uint32_t(grid.dims.x), random() % uint32_t(grid.dims.y),
                       random() % uint32_t(grid.dims.z)});
  for (size_t tries = 0; tries < 100 * count && samples.size() < 2 * count; ++tries) {
    const glm::uvec3& t = mesh.triangles[random() % mesh.triangles.size()];
    const double u = uniform(random), v = uniform(random) * (1.0 - u);
    const glm::dvec3 onSurface = mesh.position(t.x) + u * (mesh.position(t.y) - mesh.position(t.x)) +
                                 v * (mesh.position(t.z) - mesh.position(t.x));
    const glm::dvec3 at = (onSurface - grid.origin) / grid.spacing;
    const glm::ivec3 s(
        glm::floor(at + 3.0 * glm::dvec3(uniform(random), uniform(random), uniform(random)) - 1.0));
    if (glm::distance(glm::dvec3(s), at) <= 1.5 && contains(grid, s)) samples.push_back(s);
  }
  return samples;
}

/// Returns the largest error at these samples, over the diagonal of the bounds.
double largestError(const Mesh& mesh, const Grid& grid, size_t count) {
  const Field field = generate(mesh, grid).field;
  const std::vector<glm::ivec3> samples = pickSamples(mesh, grid, count);
  const BruteForce truth(mesh);
  std::vector<double> errors(samples.size());
  parallelFor(samples.size(), 4, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n)
      errors[n] = std::abs(std::abs(double(field.distance[grid.index(samples[n])])) -
                           truth.distance(grid.position(glm::dvec3(samples[n]))));
  });
  return *std::max_element(errors.begin(), errors.end()) / glm::length(bounds(mesh).size());
}

/// Returns a box of 200 x 150 x 90 samples that cuts the mesh.
Grid offCentreGrid(const Mesh& mesh) {
  const Box around = bounds(mesh);
  const glm::dvec3 size = around.size();
  GridOptions options;
  options.voxelSize = std::max({size.x, size.y, size.z}) / 220.0;
  const glm::dvec3 centre = around.centre() + glm::dvec3(0.2, -0.1, 0.15) * size;
  const glm::dvec3 half = 0.5 * options.voxelSize * glm::dvec3(199.5, 149.5, 89.5);
  options.box = Box{centre - half, centre + half};
  return fitGrid(mesh, options);
}

TEST(ExactDistance, IsExactOnEveryMesh) {
  const std::vector<std::string> names = wellFormedMeshes();
  RAYMAP_NEED_MESHES();
  double worst = 0.0;
  std::string worstName;
  const auto expectExact = [&](const std::string& name, const char* where, const Mesh& mesh,
                               const Grid& grid) {
    const size_t count = std::clamp<size_t>(20'000'000 / mesh.triangles.size(), 40, 250);
    const double error = largestError(mesh, grid, count);
    EXPECT_LE(error, kAllowed) << name << ", " << where;
    if (!(error <= worst)) worstName = name + ", " + where;
    worst = std::max(worst, error);
  };
  for (const std::string& name : names) {
    Mesh mesh = readMesh(meshFolder() / name);
    expectExact(name, "64^3", mesh, fitGrid(mesh, {.resolution = 64}));
    const Grid cutting = offCentreGrid(mesh);
    EXPECT_EQ(cutting.dims, glm::ivec3(200, 150, 90));
    expectExact(name, "200x150x90", mesh, cutting);
    const glm::dvec3 size = bounds(mesh).size();
    mesh.origin += 1e6 * std::max({size.x, size.y, size.z}) * glm::dvec3(1.0, -1.0, 1.0);
    expectExact(name, "moved", mesh, fitGrid(mesh, {.resolution = 64}));
  }
  std::cout << "largest error " << worst << " of the diagonal: " << worstName << "\n";
}

}  // namespace
}  // namespace raymap
