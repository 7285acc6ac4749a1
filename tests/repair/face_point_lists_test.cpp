#include "simplify/face_point_lists.h"

#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace raymap
