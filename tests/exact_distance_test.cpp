#include "cpu/exact_distance.h"

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <random>

#include "reference.h"
#include "shapes.h"

namespace raymap {
namespace {

/// The unsigned field against brute force at random samples; the largest error over the diagonal of the
/// bounds.
double largestError(const Mesh& mesh, const Grid& grid, int samples) {
  Options options;
  options.sign = SignMode::None;
  options.triangleIds = true;
  const Field field = generate(mesh, grid, options);
  std::mt19937 random(7);
  double largest = 0.0;
  for (int n = 0; n < samples; ++n) {
    const glm::ivec3 s(random() % grid.dims.x, random() % grid.dims.y, random() % grid.dims.z);
    const glm::dvec3 p = grid.position(glm::dvec3(s));
    const double truth = reference::distance(mesh, p);
    const glm::uvec3 t = mesh.triangles[field.triangle[grid.index(s)]];
    const double named =
        reference::triangleDistance(p, mesh.position(t.x), mesh.position(t.y), mesh.position(t.z));
    largest = std::max({largest, std::abs(truth - field.distance[grid.index(s)]), std::abs(truth - named)});
  }
  return largest / glm::length(bounds(mesh).size());
}

TEST(ExactDistance, IsExactOnShapes) {
  const Mesh meshes[] = {shapes::box({0, 0, 0}, {1, 2, 3}),
                         shapes::sphere(1.0, 4),
                         shapes::torus(1.0, 0.3, 80, 40),
                         shapes::soup(500, 1),
                         shapes::soup(1, 2),
                         shapes::joined(shapes::sphere(1.0, 3), shapes::sphere(0.01, 4, {3, 0, 0}))};
  for (const Mesh& mesh : meshes) {
    EXPECT_LT(largestError(mesh, fitGrid(mesh, {.resolution = 64}), 1000), 1e-6);
    EXPECT_LT(largestError(mesh, fitGrid(mesh, {.resolution = 5}), 100), 1e-6);
  }
}

TEST(ExactDistance, IsExactInABoxThatCutsOrMissesTheMesh) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 80, 40);
  for (const Box& box : {Box{{0.5, 0.1, -0.2}, {1.9, 1.2, 0.6}}, Box{{3, 3, 3}, {4, 4.5, 3.7}}}) {
    GridOptions options;
    options.box = box;
    options.resolution = 50;
    EXPECT_LT(largestError(mesh, fitGrid(mesh, options), 1000), 1e-6);
  }
}

TEST(ExactDistance, SurvivesDegenerateTriangles) {
  const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0, 1, 0}, {0, 1, 1e-12}, {1, 1, 1}};
  const Mesh mesh = makeMesh(p, {{0, 0, 0}, {0, 1, 2}, {3, 4, 5}, {5, 5, 1}, {2, 1, 0}});
  EXPECT_LT(largestError(mesh, fitGrid(mesh, {.resolution = 40}), 2000), 1e-6);
}

TEST(ExactDistance, SurvivesTrianglesThatAreLines) {
  // Two corners the same, or all on one line in no special direction: their normals are all rounding.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<glm::dvec3> p{{-1, -1, -1}, {1, 1, 1}};  // so that rounding does not move them much
  std::vector<glm::uvec3> triangles;
  for (uint32_t n = 0; n < 40; ++n) {
    const glm::dvec3 a(uniform(random), uniform(random), uniform(random));
    const glm::dvec3 b = a + 0.2 * glm::dvec3(uniform(random), uniform(random), uniform(random));
    p.insert(p.end(), {a, b, 0.5 * (a + b)});
    const uint32_t i = 3 * n + 2;
    const glm::uvec3 kinds[] = {{i, i + 1, i}, {i, i, i + 1}, {i, i + 1, i + 1}, {i, i + 1, i + 2}};
    triangles.push_back(kinds[n % 4]);
  }
  const Mesh mesh = makeMesh(p, triangles);
  EXPECT_LT(largestError(mesh, fitGrid(mesh, {.resolution = 40}), 2000), 1e-6);
}

TEST(ExactDistance, LosesNothingFarFromTheOrigin) {
  Mesh mesh = shapes::torus(1.0, 0.3, 80, 40);
  mesh.origin += glm::dvec3(1e6, -2e6, 3e6);
  EXPECT_LT(largestError(mesh, fitGrid(mesh, {.resolution = 64}), 1000), 1e-6);
}

TEST(ExactDistance, ScalesWithTheMesh) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 80, 40);
  const Field field = generate(mesh, fitGrid(mesh, {.resolution = 33}));
  for (const float scale : {0x1p-60f, 0x1p60f}) {
    Mesh scaled = mesh;
    for (glm::vec3& v : scaled.vertices) v *= scale;
    scaled.origin *= scale;
    const Field other = generate(scaled, fitGrid(scaled, {.resolution = 33}));
    for (size_t k = 0; k < field.distance.size(); ++k)
      ASSERT_EQ(field.distance[k] * scale, other.distance[k]);
  }
}

}  // namespace
}  // namespace raymap
