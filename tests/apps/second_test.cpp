#include "view/second.h"

#include <gtest/gtest.h>

#include "analytic_fields.h"
#include "shapes.h"

namespace raymap::view {
namespace {

using analytic::cube;
using analytic::sampled;

Field ball(int n, double side, double radius) {
  Field field = sampled(cube(n, side), [&](const glm::dvec3& p) { return analytic::sphere(p, radius); });
  field.surfaceBounds = {glm::dvec3(-radius), glm::dvec3(radius)};
  return field;
}

TEST(ViewSecond, MeshesGetTheBoundsOfBoth) {
  Content first = contentOf(shapes::sphere(1.0, 2)),
          second = contentOf(shapes::sphere(0.5, 2, {1.0, 0.0, 0.0}));
  makeComparable(first, second);
  EXPECT_EQ(first.bounds.min, second.bounds.min);
  EXPECT_EQ(first.bounds.max, second.bounds.max);
  EXPECT_NEAR(first.bounds.min.x, -1.0, 1e-6);
  EXPECT_NEAR(first.bounds.max.x, 1.5, 1e-6);
  EXPECT_FALSE(first.grid || second.grid);
}

TEST(ViewSecond, AMeshTakesTheGridOfAField) {
  for (const bool isFieldFirst : {true, false}) {
    Content field = contentOf(ball(20, 3.0, 0.8)), mesh = contentOf(shapes::sphere(1.0, 2));
    makeComparable(isFieldFirst ? field : mesh, isFieldFirst ? mesh : field);
    ASSERT_TRUE(mesh.grid);
    EXPECT_EQ(*mesh.grid, field.field->grid);
    EXPECT_FALSE(field.grid);
    EXPECT_NEAR(field.bounds.max.x, 1.0, 1e-6);
  }
}

TEST(ViewSecond, AFieldOnAnotherGridIsSampledOnThatOfTheFirst) {
  Content first = contentOf(ball(20, 3.0, 0.8)), second = contentOf(ball(41, 2.6, 0.9));
  second.field->clampDistance = 7.0;
  makeComparable(first, second);
  const Field& field = *second.field;
  EXPECT_EQ(field.grid, first.field->grid);
  EXPECT_EQ(field.clampDistance, 7.0);
  ASSERT_EQ(field.distance.size(), field.grid.sampleCount());
  for (const glm::ivec3& s : {glm::ivec3(10, 10, 10), glm::ivec3(4, 12, 7), glm::ivec3(15, 3, 9)})
    EXPECT_NEAR(field.distance[field.grid.index(s)], analytic::sphere(field.grid.position(s), 0.9), 0.03);
  // One on the same grid is left as it is.
  Content same = contentOf(ball(20, 3.0, 0.9));
  const float before = same.field->distance[0];
  makeComparable(first, same);
  EXPECT_EQ(same.field->distance[0], before);
  EXPECT_EQ(first.field->grid, same.field->grid);
}

}  // namespace
}  // namespace raymap::view
