#include "cpu/distance/exact_distance.h"

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "exact_cases.h"

namespace raymap {

using namespace cpu;
namespace {

TEST(ExactDistance, IsExact) {
  FieldOptions options;
  options.sign = SignMode::None;
  options.triangle = true;
  for (const ExactCase& c : exactCases(64)) {
    const Field field = generate(c.mesh, c.grid, options).field;
    EXPECT_LT(largestExactError(c.mesh, c.grid, field.distance, field.triangle, 1000), 1e-6) << c.name;
  }
}

TEST(ExactDistance, ScalesWithTheMesh) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 80, 40);
  const Field field = generate(mesh, fitGrid(mesh, {.resolution = 33})).field;
  for (const float scale : {0x1p-60f, 0x1p60f}) {
    Mesh scaled = mesh;
    for (glm::vec3& v : scaled.vertices) v *= scale;
    scaled.origin *= scale;
    const Field other = generate(scaled, fitGrid(scaled, {.resolution = 33})).field;
    for (size_t k = 0; k < field.distance.size(); ++k)
      ASSERT_EQ(field.distance[k] * scale, other.distance[k]);
  }
}

}  // namespace
}  // namespace raymap
