#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "analytic_fields.h"
#include "closed_mesh.h"
#include "field_kinds.h"
#include "reference.h"
#include "shapes.h"

namespace raymap {
namespace {

using glm::dvec3;
using Distance = std::function<double(const dvec3&)>;

/// Returns a grid of `count` samples along each side of a cube around the origin.
Grid gridAround(double halfSide, int count) {
  return analytic::cube(count, 2.0 * halfSide);
}

Distance sphere(double radius) {
  return [=](const dvec3& p) { return analytic::sphere(p, radius); };
}

/// Returns a rotation about two axes by arbitrary angles.
glm::dmat3 turned() {
  const double a = 0.51, b = 0.83;
  const glm::dmat3 aboutZ(std::cos(a), std::sin(a), 0, -std::sin(a), std::cos(a), 0, 0, 0, 1);
  const glm::dmat3 aboutX(1, 0, 0, 0, std::cos(b), std::sin(b), 0, -std::sin(b), std::cos(b));
  return aboutZ * aboutX;
}

void expectSound(const Mesh& mesh) {
  EXPECT_TRUE(isClosed(mesh));
  const Diagnostics found = diagnose(mesh);
  EXPECT_TRUE(found.watertight);
  EXPECT_TRUE(found.consistentlyOriented);
  EXPECT_EQ(found.degenerateFaces, 0u);
  EXPECT_EQ(found.duplicateFaces, 0u);
  EXPECT_EQ(found.vertices, found.weldedVertices);
}

/// Returns the surface of a dense field, after it has compared it with that of the band of all its samples.
Mesh surfaceOf(const Field& field, const IsosurfaceOptions& options = {}) {
  const Mesh mesh = isosurface(field, options);
  const Field band = toSparse(field, {.outside = 1e6, .inside = 1e6});
  const Mesh same = isosurface(band, options, {.threads = 2});
  EXPECT_TRUE(mesh.vertices == same.vertices && mesh.triangles == same.triangles);
  EXPECT_EQ(mesh.origin, same.origin);
  return mesh;
}

TEST(Isosurface, ClosesEveryCaseOfACube) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> magnitude(0.1, 1.0);
  for (int corners = 1; corners < 256; ++corners) {
    SCOPED_TRACE(corners);
    Field field = analytic::sampled(gridAround(1.0, 2), sphere(1.0));
    for (int c = 0; c < 8; ++c)
      field.distance[size_t(c)] = float((corners >> c & 1) != 0 ? -magnitude(random) : magnitude(random));
    const Mesh mesh = surfaceOf(field);
    expectSound(mesh);
    EXPECT_GT(volumeOf(mesh), 0.0);
  }
}

TEST(Isosurface, ClosesNoise) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    const Field field = analytic::sampled(gridAround(6.0, 12), [&](const dvec3&) { return noise(random); });
    const Mesh mesh = surfaceOf(field, {.iso = 0.1 * double(seed % 7) - 0.3});
    expectSound(mesh);
    EXPECT_GT(volumeOf(mesh), 0.0);
  }
}

TEST(Isosurface, ClosesNoiseThatIsZeroAtSamples) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Field field =
        analytic::sampled(gridAround(6.0, 12), [&](const dvec3&) { return double(random() % 3) - 1.0; });
    expectSound(surfaceOf(field));
  }
}

TEST(Isosurface, ClosesCheckerboards) {
  for (const int period : {1, 2, 3}) {
    SCOPED_TRACE(period);
    const Grid grid = gridAround(6.0, 12);
    int n = 0;
    const auto board = [&](const dvec3& p) {
      const glm::ivec3 cell = glm::ivec3(p + 6.0) / period;
      return ((cell.x + cell.y + cell.z) % 2 == 0 ? -1.0 : 1.0) * (1.0 + 0.001 * (n++ % 10));
    };
    expectSound(surfaceOf(analytic::sampled(grid, board)));
    const auto equal = [&](const dvec3& p) { return board(p) < 0.0 ? -1.0 : 1.0; };
    expectSound(surfaceOf(analytic::sampled(grid, equal)));
  }
}

TEST(Isosurface, HasTheShapeOfASphere) {
  const Mesh mesh = surfaceOf(analytic::sampled(gridAround(1.0, 40), sphere(0.7)));
  expectSound(mesh);
  const double h = 2.0 / 40;
  double worst = 0.0;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
    worst = std::max(worst, std::abs(glm::length(mesh.position(v)) - 0.7));
  EXPECT_LT(worst, 0.03 * h);
  EXPECT_NEAR(volumeOf(mesh) / (4.0 / 3.0 * std::numbers::pi * 0.343), 1.0, 5e-4);
  EXPECT_EQ(int(mesh.vertices.size()) - int(mesh.triangles.size()) / 2, 2);  // Euler.
}

TEST(Isosurface, IsAsLargeAsASmallSphere) {
  for (const double radius :
       {4.0, 6.0}) {  // In samples. With its vertices on the sphere the mesh would be 2 % smaller.
    const Mesh mesh = surfaceOf(analytic::sampled(gridAround(9.0, 18), sphere(radius)));
    EXPECT_NEAR(volumeOf(mesh) / (4.0 / 3.0 * std::numbers::pi * radius * radius * radius), 1.0, 8e-3);
  }
}

/// Returns a field of blades about one spacing thick that cross each other.
double blades(const dvec3& p) {
  const glm::dmat3 turn = turned();
  dvec3 q = p;
  double distance = INFINITY;
  for (int blade = 0; blade < 6; ++blade) {
    distance = std::min(distance, analytic::box(q, {7.0, 5.0, 0.3 + 0.1 * blade}));
    q = turn * q;
  }
  return distance;
}

TEST(Isosurface, HasNoFacesThatCross) {
  const Mesh mesh = surfaceOf(analytic::sampled(gridAround(10.0, 20), blades));
  expectSound(mesh);
  EXPECT_EQ(findSelfIntersections(mesh).pairs, 0u);
}

TEST(Isosurface, ReportsProgressAndStops) {
  const Field field = analytic::sampled(gridAround(1.0, 40), sphere(0.7));
  double most = 0.0;
  const auto note = [&](std::string_view, double done) { return most = std::max(most, done), true; };
  isosurface(field, {}, {.threads = 1, .progress = note});  // With several, all calls but one may be skipped.
  EXPECT_GT(most, 0.5);
  EXPECT_LE(most, 1.0);
  const auto stop = [](std::string_view, double done) { return done < 0.5; };
  EXPECT_THROW(isosurface(field, {}, {.threads = 1, .progress = stop}), Error);
}

TEST(Isosurface, LiesAtTheIsoValue) {
  const Field field = analytic::sampled(gridAround(1.0, 40), sphere(0.5));
  for (const double iso : {-0.2, 0.15}) {
    const Mesh mesh = surfaceOf(field, {.iso = iso});
    EXPECT_NEAR(std::cbrt(volumeOf(mesh) * 0.75 / std::numbers::pi), 0.5 + iso, 1e-3);
  }
}

TEST(Isosurface, HasTheHoleOfATorus) {
  const auto torus = [](const dvec3& p) { return analytic::torus(p, 1.0, 0.4); };
  const Mesh mesh = surfaceOf(analytic::sampled(gridAround(1.6, 48), torus));
  expectSound(mesh);
  EXPECT_EQ(int(mesh.vertices.size()) - int(mesh.triangles.size()) / 2, 0);
  const double truth = 2.0 * std::numbers::pi * std::numbers::pi * 0.16;
  EXPECT_NEAR(volumeOf(mesh) / truth, 1.0, 3e-3);
}

/// Mean and largest distance of a cube's edges and corners from its mesh, in samples.
struct CubeError {
  double edges = 0.0, corners = 0.0, largest = 0.0;
};

CubeError cubeError(const glm::dmat3& turn, int count) {
  const Grid grid = gridAround(1.0, count);
  const dvec3 half(0.51, 0.43, 0.37);
  const Mesh mesh = surfaceOf(
      analytic::sampled(grid, [&](const dvec3& p) { return analytic::box(glm::transpose(turn) * p, half); }));
  expectSound(mesh);
  CubeError error;
  for (int edge = 0; edge < 12; ++edge)
    for (int step = 0; step <= 16; ++step) {
      const int axis = edge / 4;
      dvec3 p;
      p[axis] = (step / 8.0 - 1.0) * half[axis];
      p[(axis + 1) % 3] = (edge & 1 ? 1 : -1) * half[(axis + 1) % 3];
      p[(axis + 2) % 3] = (edge & 2 ? 1 : -1) * half[(axis + 2) % 3];
      const double distance = reference::distance(mesh, turn * p) / grid.spacing;
      const bool isCorner = step % 16 == 0;
      (isCorner ? error.corners : error.edges) += distance / (isCorner ? 24 : 180);
      error.largest = std::max(error.largest, distance);
    }
  return error;
}

TEST(Isosurface, KeepsTheEdgesOfACube) {
  for (const int count : {20, 27}) {
    const CubeError straight = cubeError(glm::dmat3(1.0), count);
    EXPECT_LT(straight.largest, 0.2);
    const CubeError error = cubeError(turned(), count);
    EXPECT_LT(error.edges, 0.08);  // It would be 0.45 without planes from the samples.
    EXPECT_LT(error.corners, 0.25);
    EXPECT_LT(error.largest, 0.5);
  }
}

TEST(Isosurface, DoesNotLetRoundingDecideWhereSidesAreEquallyNear) {
  // Samples on the diagonals of this box are as far from two or three of its sides.
  const auto box = [](const dvec3& p) {
    const dvec3 q = glm::abs(p) - 1.03;
    return glm::length(glm::max(q, 0.0)) + std::min(std::max({q.x, q.y, q.z}), 0.0);
  };
  const Mesh mesh = surfaceOf(analytic::sampled(gridAround(1.6, 17), box));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-1e-6, 1e-6);
  const Mesh noisy = surfaceOf(
      analytic::sampled(gridAround(1.6, 17), [&](const dvec3& p) { return box(p) + noise(random); }));
  ASSERT_EQ(noisy.vertices.size(), mesh.vertices.size());
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
    EXPECT_LT(glm::distance(noisy.position(v), mesh.position(v)), 1e-4);
}

TEST(Isosurface, ClosesASolidThatReachesTheBox) {
  const Grid grid = gridAround(2.0, 16);
  Warning warning;
  const MachineOptions machine{.warn = [&](const Warning& given) { warning = given; }};
  const Mesh half =
      isosurface(analytic::sampled(grid, [](const dvec3& p) { return p.x - 0.3; }), {}, machine);
  expectSound(half);
  EXPECT_NEAR(volumeOf(half), 2.3 * 4.0 * 4.0, 0.05);
  EXPECT_EQ(warning.code, WarningCode::BoxReached);
  EXPECT_NE(warning.message.find("closed there"), std::string::npos);
  warning = {};
  isosurface(analytic::sampled(grid, sphere(1.0)), {}, machine);
  EXPECT_EQ(warning.message, "");
  const Mesh whole = surfaceOf(analytic::sampled(grid, [](const dvec3&) { return -1.0; }));
  expectSound(whole);
  EXPECT_NEAR(volumeOf(whole), 64.0, 0.1);
}

TEST(Isosurface, AcceptsGridsOfOneSample) {
  for (const glm::ivec3 dims : {glm::ivec3(1, 1, 1), glm::ivec3(5, 1, 1), glm::ivec3(1, 4, 3)}) {
    const Grid grid{dims, dvec3(0.0), 1.0};
    const Mesh mesh = surfaceOf(analytic::sampled(grid, [](const dvec3&) { return -1.0; }));
    expectSound(mesh);
    EXPECT_NEAR(volumeOf(mesh) / double(grid.sampleCount()), 1.0, 0.06);
  }
}

TEST(Isosurface, IsTheSameForAnyNumberOfThreads) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  const Field field = analytic::sampled(gridAround(1.0, 24),
                                        [&](const dvec3& p) { return sphere(0.7)(p) + 0.1 * noise(random); });
  const Mesh one = isosurface(field, {}, {.threads = 1});
  for (const int threads : {2, 8}) {
    const Mesh other = isosurface(field, {}, {.threads = threads});
    EXPECT_TRUE(one.vertices == other.vertices);
    EXPECT_TRUE(one.triangles == other.triangles);
  }
}

TEST(Isosurface, ReusesTheMemoryOfItsResult) {
  const Field field = analytic::sampled(gridAround(1.0, 8), sphere(0.5));
  Mesh mesh = isosurface(field);
  const Mesh again = mesh;
  const glm::vec3* const memory = mesh.vertices.data();
  isosurface(field, {}, mesh);
  EXPECT_EQ(mesh.vertices.data(), memory);
  EXPECT_EQ(mesh.vertices, again.vertices);
  EXPECT_EQ(mesh.triangles, again.triangles);
  EXPECT_THROW(isosurface(field, {.iso = -5.0}, mesh), Error);
  EXPECT_TRUE(mesh.triangles.empty());
}

class IsosurfaceOfEachKind : public EachKind {};
INSTANTIATE_TEST_SUITE_P(Fields, IsosurfaceOfEachKind, kEachKind, nameOfKind);

TEST_P(IsosurfaceOfEachKind, ReportsWhyThereIsNone) {
  const auto errorOf = [](const Field& field, double iso) -> std::string {
    try {
      isosurface(field, {.iso = iso});
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  const auto ball = [](double clamp) {
    Field field = analytic::sampled(gridAround(1.0, 8), sphere(0.5));
    field.clampDistance = clamp;
    return made(std::move(field));
  };
  EXPECT_NE(errorOf(ball(0.0), -0.6).find("the field's values go from"), std::string::npos);
  Field field = ball(0.2);
  EXPECT_NE(errorOf(field, 0.3).find("clamped at"), std::string::npos);
  EXPECT_NE(errorOf(field, 0.3).find("0.2"), std::string::npos);
  field = ball(0.0);
  field.distance[placeOf(field, {1, 2, 3})] = NAN;
  EXPECT_NE(errorOf(field, 0.0).find("sample (1, 2, 3)"), std::string::npos);
  field.distance.resizeUninitialized(3);
  EXPECT_NE(errorOf(field, 0.0).find("holds 3 distances"), std::string::npos);
}

}  // namespace
}  // namespace raymap
