#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "shapes.h"

namespace raymap {
namespace {

TEST(Grid, CoversThePaddedBounds) {
  const Grid grid = fitGrid(shapes::box({0, 0, 0}, {2, 1, 1}), {.resolution = 24});
  EXPECT_NEAR(grid.spacing, 2.4 / 24, 1e-12);
  EXPECT_EQ(grid.dims, glm::ivec3(24, 14, 14));
  EXPECT_NEAR(grid.origin.x, -0.2 + 0.05, 1e-12);
}

TEST(Grid, RefusesAnEmptyBox) {
  GridOptions options;
  options.box = Box{glm::dvec3(1), glm::dvec3(0)};
  EXPECT_THROW(fitGrid(shapes::box({0, 0, 0}, {1, 1, 1}), options), Error);
}

TEST(Mesh, NamesTheBadIndex) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles[3].y = 77;
  try {
    validate(mesh);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Input);
    EXPECT_NE(std::string(error.what()).find("triangle 3 uses vertex 77"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace raymap
