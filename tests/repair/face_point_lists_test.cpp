#include "simplify/face_point_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shapes.h"

namespace raymap {
namespace {

TEST(FacePointLists, HoldPointsAlongSharpEdges) {
  const Mesh box = shapes::box({0, 0, 0}, {8, 8, 8});
  const CollapsibleMesh mesh(box);
  for (const double step : {0.5, 2.0}) {
    const FacePointLists lists(box, mesh, step, 0.01);
    // In the middles of parts as long as a step.
    for (double x = 0.5 * step; x < 8.0; x += step) {
      const glm::vec3 expected(glm::dvec3(x, 0, 0) - box.origin);
      EXPECT_TRUE(std::ranges::any_of(lists.points(),
                                      [&](const glm::vec3& p) { return glm::distance(p, expected) < 1e-5f; }))
          << step << " " << x;
    }
  }
}

/// Returns how many points in squares of a step and along sides it means.
double pointsAt(const FaceSums& sums, double step) {
  return sums.area / (step * step) + sums.sides / step;
}

TEST(FacePointLists, AreaAndSidesAreThoseOfAllFaces) {
  const FaceSums sums = sumFaces(shapes::box({0, 0, 0}, {3, 3, 4}));
  EXPECT_NEAR(sums.area, 66.0, 1e-9);
  // Twelve edges are sides of two faces each, and so are six diagonals.
  EXPECT_NEAR(sums.sides, 2 * (8 * 3.0 + 4 * 4.0 + 2 * std::sqrt(18.0) + 4 * 5.0), 1e-6);
}

TEST(FacePointLists, StepsAreEnlargedWhereThereWouldBeTooManyPoints) {
  for (const Mesh& mesh : {shapes::box({0, 0, 0}, {8, 8, 8}), shapes::sphere(1.0, 5)}) {
    const FaceSums sums = sumFaces(mesh);
    const double least = boundedStep(mesh, 0.0), most = 1e6 + 32.0 * double(mesh.triangles.size());
    EXPECT_NEAR(pointsAt(sums, least), most, 1e-6 * most);
    EXPECT_EQ(boundedStep(mesh, 0.9 * least), least);
    EXPECT_EQ(boundedStep(mesh, 1.1 * least), 1.1 * least);
  }
}

TEST(FacePointLists, AFarVertexTakesNoMorePoints) {
  Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  box.vertices[6] = {1, 1, 1e19f};
  const FacePointLists lists(box, CollapsibleMesh(box), boundedStep(box, 0.1), 0.01);
  EXPECT_GT(lists.points().size(), 100'000u);
  EXPECT_LT(lists.points().size(), 1'500'000u);
}

}  // namespace
}  // namespace raymap
