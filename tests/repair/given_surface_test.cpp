#include "simplify/given_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference.h"
#include "shapes.h"

namespace raymap {
namespace {

TEST(GivenSurface, KnowsWhichEdgesAreNear) {
  // Edges between vertices of a torus run inside of it, and outside in its hole.
  const Mesh torus = shapes::torus(1.0, 0.5, 12, 8);
  constexpr int kParts = 3;
  for (const double tolerance : {0.01, 0.03}) {
    const GivenSurface surface(torus, tolerance * tolerance);
    size_t near = 0, far = 0;
    for (uint32_t start = 0; start < torus.vertices.size(); ++start)
      for (uint32_t end = 0; end < torus.vertices.size(); ++end) {
        const glm::dvec3 a = torus.position(start), b = torus.position(end);
        if (start == end || glm::distance(a, b) > 0.8) continue;
        double farthest = 0.0;
        for (int k = 0; k < kParts; ++k)
          farthest = std::max(farthest, reference::distance(torus, glm::mix(a, b, (k + 0.5) / kParts)));
        EXPECT_EQ(surface.isNearEdge(start, end, kParts), farthest <= tolerance)
            << start << " " << end << " " << farthest;
        ++(farthest <= tolerance ? near : far);
      }
    EXPECT_GT(near, 300u);
    EXPECT_GT(far, 300u);
  }
}

TEST(GivenSurface, EndsAtTheTolerance) {
  // The middle of the edge from 3 to 4 is above a face; all other faces are farther away. Each has a back,
  // which closes the mesh.
  const auto isNear = [](float height) {
    const Mesh mesh{{{-10, -10, 0}, {10, -10, 0}, {0, 10, 0}, {-3, 0, height}, {3, 0, height}},
                    {{0, 1, 2}, {0, 2, 1}, {3, 0, 1}, {3, 1, 0}, {4, 0, 1}, {4, 1, 0}}};
    return GivenSurface(mesh, 1.0).isNearEdge(3, 4, 1);
  };
  EXPECT_TRUE(isNear(1.0f));
  EXPECT_TRUE(isNear(-1.0f));
  EXPECT_FALSE(isNear(std::nextafter(1.0f, 2.0f)));
  EXPECT_FALSE(isNear(std::nextafter(-1.0f, -2.0f)));
  EXPECT_FALSE(isNear(1.1f));
}

}  // namespace
}  // namespace raymap
