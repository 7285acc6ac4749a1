#include "repair/topology/cut_away.h"

#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/repair.h>

#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "closed_mesh.h"
#include "error_code.h"
#include "mesh/diagnostics.h"
#include "mesh/triangle.h"
#include "repair/topology/mend.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::joined;

Plane reversed(const Plane& plane) {
  return {-plane.normal, -plane.offset};
}

/// Returns the height of a position over a plane.
double heightOver(const Plane& plane, const glm::dvec3& p) {
  return (glm::dot(plane.normal, p) - plane.offset) / glm::length(plane.normal);
}

/// Returns the area of the faces in a plane.
double areaIn(const Mesh& mesh, const Plane& plane) {
  double area = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    double height = 0.0;
    for (int c = 0; c < 3; ++c) height = std::max(height, std::abs(heightOver(plane, mesh.position(t[c]))));
    if (height > 1e-6) continue;
    area += 0.5 * glm::length(doubleAreaNormal(mesh.position(t.x), mesh.position(t.y), mesh.position(t.z)));
  }
  return area;
}

Mesh cutAway(const Mesh& solid, const Plane& plane) {
  std::vector<uint32_t> sources;
  return cutAway(solid, plane, sources);
}

/// Expects two sound halves that make up the solid, with new faces of this area in the plane on each.
void expectHalves(const Mesh& solid, const Plane& plane, double cap) {
  const Mesh below = cutAway(solid, plane), above = cutAway(solid, reversed(plane));
  const double flat = areaIn(solid, plane);
  for (const Mesh* half : {&below, &above}) {
    EXPECT_TRUE(isAllRight(Model(*half)));
    EXPECT_TRUE(isClosed(*half));
    const double side = half == &below ? 1.0 : -1.0;
    double farthest = 0.0;
    for (const glm::vec3& v : half->vertices)
      farthest = std::max(farthest, side * heightOver(plane, half->origin + glm::dvec3(v)));
    const glm::dvec3 n = glm::abs(plane.normal);
    const bool isAlongAxis = n.x + n.y + n.z == std::max({n.x, n.y, n.z});
    // Along an axis, all vertices have the plane's coordinate, in single precision.
    EXPECT_LE(farthest, isAlongAxis ? 6e-8 * glm::length(bounds(solid).size())
                                    : 3e-7 * glm::length(bounds(solid).size()));
  }
  const Diagnostics whole = diagnose(solid), low = diagnose(below), high = diagnose(above);
  EXPECT_NEAR(low.signedVolume + high.signedVolume, whole.signedVolume, 1e-6 * whole.signedVolume);
  EXPECT_NEAR(low.area + high.area, whole.area + 2.0 * cap, 3e-6 * whole.area);
  EXPECT_NEAR(areaIn(below, plane) + areaIn(above, plane), 2.0 * cap + flat, 3e-6 * whole.area);
}

TEST(CutAway, CutsACube) {
  const Mesh cube = shapes::box({0, 0, 0}, {2, 2, 2});
  expectHalves(cube, {{0, 0, 1}, 0.7}, 4.0);
  expectHalves(cube, {{0, -3, 0}, -0.3}, 4.0);
  expectHalves(cube, {{1, 1, 1}, 3.0}, 3.0 * std::sqrt(3.0));  // A regular hexagon.
  expectHalves(cube, {{1, 1, 0}, 2.0}, 4.0 * std::sqrt(2.0));  // Through four edges' ends and a diagonal.
  expectHalves(cube, {{1, 1, 1}, 2.0}, 2.0 * std::sqrt(3.0));  // Through three vertices.
  EXPECT_NEAR(diagnose(cutAway(cube, {{0, 0, 2}, 1.0})).signedVolume, 2.0, 1e-12);
}

TEST(CutAway, ClosesSeveralLoopsAndRings) {
  const Mesh torus = shapes::torus(2.0, 0.5, 64, 32);
  const double circle = 0.5 * 32 * 0.25 * std::sin(2.0 * 3.14159265358979323846 / 32);
  expectHalves(torus, {{1, 0, 0}, 0.0}, 2.0 * circle);  // Two caps, through vertices.
  // Across the axis: a ring between two polygons of 64 corners.
  const double ring = 0.5 * 64 * (2.5 * 2.5 - 1.5 * 1.5) * std::sin(2.0 * 3.14159265358979323846 / 64);
  expectHalves(torus, {{0, 0, 1}, 0.0}, ring);
  const Mesh hollow =
      joined(shapes::box({-2, -2, -2}, {2, 2, 2}), shapes::inverted(shapes::box({-1, -1, -1}, {1, 1, 1})));
  expectHalves(hollow, {{0, 0, 1}, 0.5}, 12.0);
  expectHalves(joined(hollow, shapes::box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5})), {{0, 0, 1}, 0.25}, 13.0);
}

TEST(CutAway, TakesFacesInThePlane) {
  // Steps up and down at z = 1: one face becomes part of each cap.
  const Mesh steps = shapes::voxels({{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {2, 0, 1}}, 1);
  const Box box = bounds(steps);
  const double unit = box.size().y, middle = 0.5 * (box.min.z + box.max.z);
  expectHalves(steps, {{0, 0, 1}, middle}, unit * unit);
}

TEST(CutAway, CutsFarFromTheOriginAndAtAnyAngle) {
  Mesh ball = shapes::sphere(1.0, 3);
  for (int k = 0; k < 12; ++k) {
    const Plane plane{{std::cos(k), std::sin(k), 0.3 * k - 1.5}, 0.4};
    const Mesh below = cutAway(ball, plane), above = cutAway(ball, reversed(plane));
    expectHalves(ball, plane, 0.5 * (areaIn(below, plane) + areaIn(above, plane)));
    const double depth = 0.4 / glm::length(plane.normal), circle = 3.14159265358979 * (1.0 - depth * depth);
    EXPECT_NEAR(areaIn(below, plane), circle, 0.01 * circle) << k;
  }
  ball.origin = {1e6, -2e6, 3e6};
  expectHalves(ball, {{0, 0, 1}, 3e6 + 0.25},
               areaIn(cutAway(ball, {{0, 0, 1}, 3e6 + 0.25}), {{0, 0, 1}, 3e6 + 0.25}));
}

TEST(CutAway, IsTheSameForAnyNumberOfThreads) {
  const Mesh ball = shapes::rotated(shapes::sphere(1.0, 5));
  const Plane plane{{1, 2, 3}, 0.5};
  const Mesh all = cutAway(ball, plane);
  withThreads(1, [&] {
    const Mesh one = cutAway(ball, plane);
    EXPECT_EQ(one.vertices, all.vertices);
    EXPECT_EQ(one.triangles, all.triangles);
  });
}

TEST(CutAway, RefusesAPlaneThatMisses) {
  const Mesh cube = shapes::box({0, 0, 0}, {2, 2, 2});
  for (const double offset : {-1.0, 0.0, 2.0, 9.0})
    EXPECT_EQ(codeOf([&] { cutAway(cube, {{0, 0, 1}, offset}); }), ErrorCode::Input) << offset;
}

TEST(CutAway, RepairCutsItsResult) {
  const Mesh cube = shapes::box({0, 0, 0}, {2, 2, 2});
  for (const bool remesh : {false, true}) {
    const Repaired made = repair(cube, fitRepairGrid(cube, {.resolution = 32}), {},
                                 {.remesh = remesh, .cutPlane = Plane{{0, 0, 1}, 0.5}});
    EXPECT_NEAR(made.report.after.signedVolume, 2.0, 0.03);
    EXPECT_EQ(made.report.after.bounds.max.z, 0.5);
    EXPECT_EQ(bounds(made.cutOff).min.z, 0.5);
    EXPECT_NEAR(diagnose(made.cutOff).signedVolume, 6.0, 0.06);
    EXPECT_EQ(made.report.lostShare, 0.0);
  }
  EXPECT_EQ(codeOf([&] {
              repair(cube, fitRepairGrid(cube), {}, {.cutPlane = Plane{{0, 0, 0}, 0.5}});
            }),
            ErrorCode::Usage);
}

}  // namespace
}  // namespace raymap
