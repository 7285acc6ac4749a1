#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>

#include "any_threads.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr double kPi = std::numbers::pi;

/// Returns a convex polygon of the plane z = 0, counterclockwise, extruded to `height`.
Mesh prism(const std::vector<glm::dvec2>& polygon, double height) {
  const auto n = static_cast<uint32_t>(polygon.size());
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (const double z : {0.0, height})
    for (const glm::dvec2& q : polygon) p.emplace_back(q, z);
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t j = (i + 1) % n;
    t.insert(t.end(), {{i, j, n + j}, {i, n + j, n + i}});
    if (i > 0 && j > 0) t.insert(t.end(), {{0, j, i}, {n, n + i, n + j}});
  }
  return makeMesh(p, t);
}

/// Returns a wedge whose edge is the axis z, `angle` radians wide and `length` long.
Mesh wedge(double angle, double length) {
  const double half = length * std::tan(0.5 * angle);
  return prism({{0, 0}, {length, -half}, {length, half}}, 3.0);
}

/// Returns a ring of a square cross-section, open to both ends: a tube of n sides.
Mesh tube(double inner, double outer, double height, int n) {
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  const auto m = static_cast<uint32_t>(n);
  for (const auto& [r, z] :
       {std::pair(outer, 0.0), std::pair(outer, height), std::pair(inner, height), std::pair(inner, 0.0)})
    for (int i = 0; i < n; ++i)
      p.emplace_back(r * std::cos(2 * kPi * i / n), r * std::sin(2 * kPi * i / n), z);
  for (uint32_t ring = 0; ring < 4; ++ring)
    for (uint32_t i = 0; i < m; ++i) {
      const uint32_t a = ring * m + i, b = ring * m + (i + 1) % m, up = (ring + 1) % 4 * m;
      const uint32_t c = up + (i + 1) % m, d = up + i;
      t.insert(t.end(), {{a, b, c}, {a, c, d}});
    }
  return makeMesh(p, t);
}

struct Measured {
  std::vector<FacePoint> points;
  std::vector<Thickness> thickness;

  size_t count(Part part) const { return size_t(std::ranges::count(thickness, part, &Thickness::part)); }
  ThicknessSummary summary() const { return summarizeThickness(points, thickness); }
};

Measured measure(const Mesh& mesh, double step, const ThicknessOptions& options = {}) {
  Measured found{sampleFaces(mesh, step), {}};
  found.thickness = Surface(mesh).thickness(found.points, options);
  return found;
}

TEST(Thickness, SamplesFacesEvenly) {
  const Mesh mesh = shapes::box({1, 2, 3}, {2, 4, 6});
  const std::vector<FacePoint> points = sampleFaces(mesh, 0.5);
  double area = 0.0;
  glm::dvec3 sum(0.0);
  for (const FacePoint& p : points) {
    area += p.area, sum += p.area * p.position;
    const glm::uvec3 t = mesh.triangles[p.triangle];
    const glm::dvec3 a = mesh.position(t.x), n = glm::cross(mesh.position(t.y) - a, mesh.position(t.z) - a);
    EXPECT_NEAR(glm::dot(p.position - a, n), 0.0, 1e-6);
  }
  EXPECT_NEAR(area, 2.0 * (1 * 2 + 2 * 3 + 1 * 3), 1e-5);
  EXPECT_NEAR(glm::distance(sum / area, {1.5, 3.0, 4.5}), 0.0, 1e-6);
  EXPECT_EQ(sampleFaces(mesh, 100.0).size(), 12u);
  // Halving takes the longest side from sqrt(2) to 1, sqrt(1/2) and 1/2.
  const Mesh cube = shapes::box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(sampleFaces(cube, 0.5).size(), 12u * 8);
  EXPECT_EQ(sampleFaces(cube, 0.499).size(), 12u * 16);
  // The even cut of a sliver has a part for each square of its length.
  EXPECT_LT(sampleFaces(shapes::box({0, 0, 0}, {100, 0.01, 0.01}), 0.5).size(), 80'000u);
  EXPECT_TRUE(std::ranges::is_sorted(points, {}, &FacePoint::triangle));
}

TEST(Thickness, IsThatOfABoxBetweenEachTwoSides) {
  const Mesh box = shapes::box({0, 0, 0}, {1, 2, 3});
  for (const Mesh& mesh : {box, shapes::inverted(box), shapes::rotated(box)}) {
    const Measured found = measure(mesh, 0.21);
    for (size_t i = 0; i < found.points.size(); ++i) {
      const double expected = std::array{3.0, 2.0, 1.0}[found.points[i].triangle / 4];
      ASSERT_NEAR(double(found.thickness[i].diameter), expected, 1e-5) << i;
      ASSERT_TRUE(found.thickness[i].part == Part::Wall || found.thickness[i].part == Part::Corner);
      const glm::dvec3 middle = bounds(mesh).centre();
      ASSERT_GT(glm::dot(glm::dvec3(found.thickness[i].inward), middle - found.points[i].position), 0.0);
      ASSERT_NEAR(glm::length(found.thickness[i].inward), 1.0f, 1e-6f);
    }
    EXPECT_NEAR(found.summary().thinnest, 1.0, 1e-5);
    EXPECT_NEAR(found.summary().low, 1.0, 1e-5);
    EXPECT_TRUE(std::isnan(found.summary().sharpest));
    EXPECT_EQ(found.summary().sheetShare + found.summary().buriedShare, 0.0);
  }
}

TEST(Thickness, TellsTheMiddleOfASideFromItsRim) {
  // The ball of 1 is free of faces if its middle is 0.375 from them.
  const Measured found = measure(shapes::box({0, 0, 0}, {1, 1, 1}), 0.07);
  for (size_t i = 0; i < found.points.size(); ++i) {
    glm::dvec3 p = glm::abs(found.points[i].position - 0.5);
    const int axis = p.x > 0.49 ? 0 : p.y > 0.49 ? 1 : 2;
    p[axis] = 0.0;
    const double rim = 0.5 - std::max({p.x, p.y, p.z});
    if (std::abs(rim - 0.375) < 1e-3) continue;
    ASSERT_EQ(found.thickness[i].part, rim > 0.375 ? Part::Wall : Part::Corner) << rim;
  }
}

TEST(Thickness, IsTheDiameterOfASphere) {
  const Measured found = measure(shapes::sphere(2.0, 4, {5, 6, 7}), 1.0);
  for (const Thickness& t : found.thickness) {
    EXPECT_EQ(t.part, Part::Wall);
    EXPECT_NEAR(t.diameter, 4.0f, 0.02f);
  }
  EXPECT_NEAR(found.summary().median, 4.0, 0.01);
}

TEST(Thickness, IsThatOfATorusAcrossItsTube) {
  const Measured found = measure(shapes::rotated(shapes::torus(2.0, 0.5, 90, 48)), 1.0);
  EXPECT_EQ(found.count(Part::Wall), found.points.size());
  EXPECT_NEAR(found.summary().thinnest, 1.0, 0.01);
  EXPECT_NEAR(found.summary().low, 1.0, 0.01);
}

TEST(Thickness, IsTheWallOfATube) {
  const Mesh mesh = shapes::rotated(tube(1.9, 2.0, 3.0, 96));
  const Measured found = measure(mesh, 0.4);
  // The sides of the rings are a little less than their radii away from the axis.
  const double wall = 0.1 * std::cos(kPi / 96);
  size_t walls = 0;
  for (size_t i = 0; i < found.points.size(); ++i)
    if (found.thickness[i].diameter < 1.0) {
      ASSERT_NEAR(found.thickness[i].diameter, wall, 1e-3);
      walls += found.thickness[i].part == Part::Wall;
    }
  EXPECT_GT(walls, found.points.size() * 8 / 10);
  EXPECT_NEAR(found.summary().thinnest, wall, 1e-3);
}

TEST(Thickness, TellsTheEdgeOfAWedgeFromAWall) {
  for (const double degrees : {8.0, 20.0, 38.0}) {
    const double angle = glm::radians(degrees);
    const Mesh mesh = shapes::rotated(wedge(angle, 5.0));
    const Measured found = measure(mesh, 0.1);
    const glm::dvec3 edge = mesh.position(0), axis = glm::normalize(mesh.position(3) - edge);
    size_t edges = 0;
    for (size_t i = 0; i < found.points.size(); ++i) {
      const glm::dvec3 d = found.points[i].position - edge;
      const double away = glm::length(d - glm::dot(d, axis) * axis);
      if (found.points[i].triangle < 2 || found.thickness[i].part != Part::Edge) continue;
      ASSERT_NEAR(double(found.thickness[i].diameter), 2.0 * away * std::tan(0.5 * angle), 1e-4);
      ++edges;
    }
    EXPECT_GT(edges, found.points.size() / 16);
    EXPECT_LT(found.summary().sharpest, 0.2 * std::tan(angle));
    // Only the ends are walls, one of the other.
    EXPECT_FALSE(found.summary().thinnest < 2.999);
  }
}

TEST(Thickness, TakesNoBluntEdgeForThin) {
  for (const double degrees : {42.0, 60.0, 90.0}) {
    const Measured found = measure(shapes::rotated(wedge(glm::radians(degrees), 2.0)), 0.1);
    EXPECT_EQ(found.count(Part::Edge), 0u);
    for (const Thickness& t : found.thickness) EXPECT_TRUE(std::isinf(t.diameter) || t.diameter > 2.0f);
  }
}

TEST(Thickness, FindsABladeThatEndsBluntly) {
  // From 0.2 to 1 thick over a length of 4.
  const Mesh mesh = shapes::rotated(prism({{0, -0.1}, {4, -0.5}, {4, 0.5}, {0, 0.1}}, 6.0));
  const Measured found = measure(mesh, 0.05);
  EXPECT_EQ(found.count(Part::Edge), 0u);
  EXPECT_NEAR(found.summary().thinnest, 0.2, 0.03);
}

TEST(Thickness, KeepsSolidsApart) {
  const Mesh mesh = shapes::rotated(
      shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1.01, 0, 0}, {2.01, 1, 0.1})));
  const Measured found = measure(mesh, 0.05);
  for (size_t i = 0; i < found.points.size(); ++i) {
    const bool isPlate = found.points[i].triangle >= 12;
    if (found.thickness[i].part != Part::Wall) continue;
    ASSERT_NEAR(double(found.thickness[i].diameter), isPlate ? 0.1 : 1.0, 1e-4) << i;
  }
  EXPECT_NEAR(found.summary().thinnest, 0.1, 1e-4);
}

TEST(Thickness, TakesSolidsTogetherThatOverlapOrTouch) {
  for (const double gap : {-0.3, 0.0, 1e-7}) {
    const Mesh mesh = shapes::rotated(
        shapes::joined(shapes::box({0, 0, 0}, {2, 2, 1}), shapes::box({0, 0, 1 + gap}, {2, 2, 2})));
    const Measured found = measure(mesh, 0.1);
    for (size_t i = 0; i < found.points.size(); ++i) {
      if (found.points[i].triangle >= 2) continue;
      ASSERT_NEAR(double(found.thickness[i].diameter), 2.0, 1e-4) << gap;
    }
    EXPECT_GT(found.count(Part::Buried), 0u);
  }
}

TEST(Thickness, IsZeroForASheet) {
  const Mesh sheet =
      makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{0, 1, 2}, {0, 2, 3}});
  const Mesh mesh = shapes::rotated(shapes::joined(shapes::sphere(1.0, 3, {2, 2, 3}), sheet));
  const Measured found = measure(mesh, 0.3);
  const size_t first = mesh.triangles.size() - 2;
  for (size_t i = 0; i < found.points.size(); ++i) {
    const bool isSheet = found.points[i].triangle >= first;
    ASSERT_EQ(found.thickness[i].part, isSheet ? Part::Sheet : Part::Wall);
    if (isSheet) {
      ASSERT_EQ(found.thickness[i].diameter, 0.0f);
      ASSERT_EQ(found.thickness[i].inward, glm::vec3(0.0f));
    }
  }
  EXPECT_NEAR(found.summary().sheetShare, 16.0 / (16.0 + 4 * kPi), 0.01);
}

TEST(Thickness, HasNothingForFacesThatAreTooNarrow) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.vertices.push_back(mesh.vertices[0] + glm::vec3(0.5f, -2e-5f, 0.0f));
  mesh.triangles.emplace_back(0, 8, 1);
  mesh.triangles.emplace_back(0, 1, 1);
  mesh.triangles.emplace_back(2, 2, 2);
  const Measured found = measure(mesh, 10.0);
  ASSERT_EQ(found.points.size(), 15u);
  for (size_t i = 12; i < 15; ++i) {
    EXPECT_EQ(found.thickness[i].part, Part::Corner);
    EXPECT_TRUE(std::isinf(found.thickness[i].diameter));
    EXPECT_EQ(found.thickness[i].inward, glm::vec3(0.0f));
  }
}

TEST(Thickness, FindsNothingThickerThanTheMost) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 2, 3});
  const Measured found = measure(mesh, 0.3, {.maxThickness = 2.0});
  for (size_t i = 0; i < found.points.size(); ++i) {
    const float expected = std::array{INFINITY, 2.0f, 1.0f}[found.points[i].triangle / 4];
    ASSERT_EQ(found.thickness[i].diameter, expected);
    ASSERT_EQ(found.thickness[i].part == Part::Solid, std::isinf(expected));
  }
}

TEST(Thickness, IsTheSameForAnyNumberOfThreads) {
  const Mesh mesh = shapes::joined(shapes::torus(2.0, 0.5, 60, 30), shapes::soup(100, 3));
  const Surface surface(mesh);
  const std::vector<FacePoint> points = sampleFaces(mesh, 0.2);
  const std::vector<Thickness> one = surface.thickness(points, {}, {.threads = 1});
  const std::vector<Thickness> many = surface.thickness(points, {}, {.threads = 5});
  EXPECT_TRUE(one == many);  // Not its bytes, of which the padding may differ.
}

TEST(Thickness, IsSummarizedOverTheArea) {
  // A thick plate with a thin one beside it, which has a tenth of the area.
  const Mesh mesh = shapes::rotated(
      shapes::joined(shapes::box({0, 0, 0}, {9, 10, 1}), shapes::box({20, 0, 0}, {21, 10, 0.1})));
  const ThicknessSummary found = summarizeThickness(Surface(mesh));
  EXPECT_EQ(found.points, 100'000u);
  EXPECT_NEAR(found.thinnest, 0.1, 1e-5);
  EXPECT_NEAR(found.low, 0.1, 1e-5);
  EXPECT_NEAR(found.median, 1.0, 1e-5);
  const glm::dvec3 corner = mesh.position(8), across = mesh.position(9) - corner;
  EXPECT_GE(glm::dot(found.thinnestAt - corner, across), -1e-6);

  const ThicknessSummary none = summarizeThickness(
      Surface(makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}}, {{0, 1, 2}})));
  EXPECT_TRUE(std::isnan(none.thinnest) && std::isnan(none.sharpest) && std::isnan(none.low));
  EXPECT_EQ(none.sheetShare, 1.0);
}

TEST(Thickness, RefusesWhatMakesNoSense) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const std::vector<FacePoint> points = sampleFaces(mesh, 1.0), wrong{{{0, 0, 0}, 12}};
  EXPECT_THROW(Surface(mesh, {.sign = SignMode::None}).thickness(points), Error);
  EXPECT_THROW(Surface(mesh).thickness(points, {.maxThickness = 0.0}), Error);
  EXPECT_THROW(Surface(mesh).thickness(points, {}, {.threads = -1}), Error);
  EXPECT_THROW(Surface(mesh).thickness(wrong), Error);
}

}  // namespace
}  // namespace raymap
