// Faces on the same corners and in the same winding order count once.

#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/generate.h>
#include <raymap/repair.h>
#include <raymap/surface.h>

#include <cmath>

#include "broken_meshes.h"
#include "cpu_run.h"
#include "shapes.h"

namespace raymap {
namespace {

/// A mesh with repeated faces, and how it should be.
struct Case {
  const char* name;
  Mesh single, repeated;
};

/// Returns a unit box with an open hollow, whose ten inner faces come last.
Mesh cup() {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  std::vector<glm::dvec3> p;
  for (uint32_t v = 0; v < 8; ++v) p.push_back(mesh.position(v));
  for (const glm::dvec3 corner : {glm::dvec3(0.2, 0.2, 0.2),
                                  {0.8, 0.2, 0.2},
                                  {0.8, 0.8, 0.2},
                                  {0.2, 0.8, 0.2},
                                  {0.2, 0.2, 1.0},
                                  {0.8, 0.2, 1.0},
                                  {0.8, 0.8, 1.0},
                                  {0.2, 0.8, 1.0}})
    p.push_back(corner);
  std::vector<glm::uvec3> faces = mesh.triangles;
  std::erase_if(faces, [](const glm::uvec3& t) { return t.x > 3 && t.y > 3 && t.z > 3; });
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    faces.insert(faces.end(), {{a, b, c}, {a, c, d}});
  };
  quad(4, 5, 13, 12), quad(5, 7, 14, 13), quad(7, 6, 15, 14), quad(6, 4, 12, 15);  // The brim.
  quad(8, 9, 10, 11);
  quad(8, 12, 13, 9), quad(9, 13, 14, 10), quad(10, 14, 15, 11), quad(11, 15, 12, 8);
  return makeMesh(p, std::move(faces));
}

/// Adds copies of the faces from `first` on, each as a rotation of the face.
Mesh withRepeated(Mesh mesh, size_t first, int copies) {
  const std::vector<glm::uvec3> given(mesh.triangles.begin() + ptrdiff_t(first), mesh.triangles.end());
  for (int copy = 0; copy < copies; ++copy)
    for (const glm::uvec3& t : given) mesh.triangles.emplace_back(t.y, t.z, t.x);
  return mesh;
}

Mesh withReversed(Mesh mesh, const std::vector<uint32_t>& faces) {
  for (const uint32_t f : faces) {
    const glm::uvec3 t = mesh.triangles[f];
    mesh.triangles.emplace_back(t.x, t.z, t.y);
  }
  return mesh;
}

std::vector<Case> cases() {
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1}), ball = shapes::sphere(0.5, 2, {0.5, 0.5, 0.5});
  const Mesh holed = keepTriangles(ball, [&](const glm::uvec3& t) { return ball.position(t.x).z < 0.8; });
  return {{"the inside of a cup twice", cup(), withRepeated(cup(), cup().triangles.size() - 10, 1)},
          {"two faces of a box three times", box, withRepeated(box, 10, 2)},
          {"all faces of a box twice", box, withRepeated(box, 0, 1)},
          {"two faces forwards and one back", box, withReversed(withRepeated(box, 8, 1), {8, 9, 10, 11})},
          {"half of an open ball twice", holed, withRepeated(holed, holed.triangles.size() / 2, 1)},
          {"all of an open ball twice", holed, withRepeated(holed, 0, 1)}};
}

void expectSameSigns(const Generated& a, const Generated& b) {
  ASSERT_EQ(a.field.distance.size(), b.field.distance.size());
  EXPECT_EQ(countUnlike(a, b), 0u);
  for (size_t s = 0; s < a.field.distance.size(); ++s) {
    ASSERT_NEAR(std::abs(a.field.distance[s]), std::abs(b.field.distance[s]), 1e-6) << s;
    ASSERT_NEAR(a.field.winding[s], b.field.winding[s], 1e-5) << s;
  }
}

TEST(RepeatedFaces, CountOnceInEverySignMode) {
  for (const auto& [name, single, repeated] : cases())
    for (const SignMode sign : {SignMode::Ray, SignMode::Rays, SignMode::Paths, SignMode::Evolution,
                                SignMode::Harmonic, SignMode::Exact})
      for (const Orientation orientation : {Orientation::Keep, Orientation::Auto, Orientation::Repair}) {
        SCOPED_TRACE(::testing::Message() << name << ", sign " << int(sign) << ", " << int(orientation));
        const Grid grid = fitGrid(single, {.resolution = 14});
        const Generated right = runOf(single, grid, orientation, sign),
                        run = runOf(repeated, grid, orientation, sign);
        expectSameSigns(right, run);
        EXPECT_EQ(run.stats.leftOutFaces.size(), repeated.triangles.size() - single.triangles.size());
        EXPECT_EQ(run.stats.doubtfulShare, right.stats.doubtfulShare);
        EXPECT_TRUE(right.stats.leftOutFaces.empty());
      }
}

TEST(RepeatedFaces, CountOnceWithEveryDistance) {
  for (const auto& [name, single, repeated] : cases())
    for (const DistanceMode distance : {DistanceMode::Exact, DistanceMode::Cell, DistanceMode::Raster}) {
      SCOPED_TRACE(::testing::Message() << name << ", distance " << int(distance));
      const Grid grid = fitGrid(single, {.resolution = 14});
      for (const bool closes : {false, true}) {
        const FieldOptions options{.distance = distance, .closeHoles = closes};
        expectSameSigns(runOf(single, grid, options), runOf(repeated, grid, options));
      }
    }
}

TEST(RepeatedFaces, CountOnceAtPoints) {
  for (const auto& [name, single, repeated] : cases())
    for (const Orientation orientation : {Orientation::Keep, Orientation::Auto})
      for (const bool compact : {false, true}) {
        SCOPED_TRACE(::testing::Message() << name << ", " << int(orientation) << compact);
        const SurfaceOptions options{.orientation = orientation, .compact = compact};
        const Surface right(single, options), surface(repeated, options);
        std::vector<glm::dvec3> points;
        for (int i = 0; i < 1000; ++i)
          points.emplace_back(0.13 * (i % 10) - 0.1, 0.127 * (i / 10 % 10) - 0.1, 0.131 * (i / 100) - 0.1);
        const QueryOptions asked{.triangle = true, .winding = true};
        const QueryResult expected = right.query(points, asked), found = surface.query(points, asked);
        for (size_t i = 0; i < points.size(); ++i) {
          ASSERT_NEAR(found.distance[i], expected.distance[i], 1e-6) << i;
          ASSERT_NEAR(found.winding[i], expected.winding[i], 2e-6) << i;
          ASSERT_LT(found.triangle[i], repeated.triangles.size());
        }
        EXPECT_EQ(surface.stats().leftOutFaces.size(), repeated.triangles.size() - single.triangles.size());
        const Grid grid = fitGrid(single, {.resolution = 20});
        EXPECT_EQ(surface.generateBand(grid, {}).distance.size(),
                  right.generateBand(grid, {}).distance.size());
        EXPECT_EQ(countUnlike(surface.generate(grid, {}), right.generate(grid, {})), 0u);
      }
}

TEST(RepeatedFaces, KeepTheNumbersOfTheGivenFaces) {
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  const Generated run = runOf(withReversed(withRepeated(box, 10, 1), {10, 11}),
                              fitGrid(box, {.resolution = 8}), Orientation::Keep);
  EXPECT_EQ(run.stats.leftOutFaces, std::vector<uint32_t>({12, 13, 14, 15}));
  EXPECT_TRUE(run.stats.turnedFaces.empty());
}

TEST(RepeatedFaces, HaveTheReportedDistances) {
  const Case hollow = cases()[0], thrice = cases()[1];
  const auto distance = [](const Mesh& mesh, const glm::dvec3& p) {
    return double(Surface(mesh).query(std::vector{p}).distance[0]);
  };
  EXPECT_NEAR(distance(hollow.repeated, {0.5, 0.5, 0.5}), 0.3, 1e-6);
  EXPECT_NEAR(distance(hollow.repeated, {0.1, 0.5, 0.5}), -0.1, 1e-6);
  EXPECT_NEAR(distance(thrice.repeated, {1.05, 0.5, 0.5}), 0.05, 1e-6);
  EXPECT_NEAR(distance(thrice.repeated, {0.95, 0.5, 0.5}), -0.05, 1e-6);
}

TEST(RepeatedFaces, AreNoSecondSurfaceInARepair) {
  const Mesh mesh = cases()[0].repeated;
  const Repaired repaired = repair(mesh, fitRepairGrid(mesh, {.resolution = 40}, {}));
  EXPECT_NEAR(diagnose(repaired.mesh).signedVolume, 0.712, 0.002);
}

}  // namespace
}  // namespace raymap
