#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "analytic_fields.h"
#include "closed_mesh.h"
#include "mesh/face_points.h"
#include "reference.h"
#include "shapes.h"
#include "simplify/decimate.h"

namespace raymap {
namespace {

using glm::dvec3;

constexpr int kSamples = 32;
constexpr double kSide = 2.4, kSpacing = kSide / kSamples, kTolerance = 0.1 * kSpacing;

Mesh surfaceOf(const std::function<double(const dvec3&)>& distance) {
  return isosurface(analytic::sampled(analytic::cube(kSamples, kSide), distance));
}

Simplified simplified(const Mesh& mesh, double tolerance = kTolerance) {
  return simplify(mesh, {.tolerance = tolerance, .step = kSpacing});
}

/// Returns the largest distance from points of one mesh to another: corners, middles and middles of the edges
/// of as many faces as take little time.
double farthest(const Mesh& from, const Mesh& to) {
  const size_t every = from.triangles.size() * to.triangles.size() / 500000 + 1;
  double most = 0.0;
  for (size_t f = 0; f < from.triangles.size(); f += every) {
    const glm::uvec3 t = from.triangles[f];
    const dvec3 a = from.position(t.x), b = from.position(t.y), c = from.position(t.z);
    for (const dvec3& p : {a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (a + b + c) / 3.0})
      most = std::max(most, reference::distance(to, p));
  }
  return most;
}

/// Checks what every simplified surface must be, and that it says how far off it is.
void expectSound(const Mesh& before, const Simplified& after, double tolerance = kTolerance) {
  EXPECT_TRUE(isClosed(after.mesh));
  EXPECT_EQ(findSelfIntersections(after.mesh).pairs, 0u);
  EXPECT_EQ(diagnose(after.mesh).components, diagnose(before).components);
  EXPECT_LE(after.deviation, tolerance);
  EXPECT_GT(after.deviation, 0.0);
  // The points here are others than those that were measured.
  EXPECT_LE(farthest(after.mesh, before), 1.2 * tolerance);
  EXPECT_LE(farthest(before, after.mesh), 1.2 * tolerance);
}

TEST(Simplify, KeepsTheEdgesAndCornersOfACube) {
  const dvec3 half(0.7, 0.8, 0.9);
  const Mesh cube = surfaceOf([&](const dvec3& p) { return analytic::box(p, half); });
  const Simplified result = simplified(cube);
  expectSound(cube, result);
  EXPECT_GT(cube.triangles.size(), 5000u);
  EXPECT_LT(result.mesh.triangles.size(), 150u);
  for (int c = 0; c < 8; ++c) {
    const dvec3 corner = half * dvec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
    EXPECT_LE(reference::distance(result.mesh, corner), reference::distance(cube, corner) + kTolerance);
    for (int axis = 0; axis < 3; ++axis) {
      dvec3 other = corner;
      other[axis] = -other[axis];
      for (int k = 1; k < 10; ++k) {
        const dvec3 p = glm::mix(corner, other, 0.1 * k);
        EXPECT_LE(reference::distance(result.mesh, p), reference::distance(cube, p) + kTolerance);
      }
    }
  }
}

TEST(Simplify, MovesNoCornerThatItNeedNotMove) {
  // The tolerance would allow to cut the corners; the planes around each vertex tell where to move it.
  std::vector<glm::ivec3> cells;
  for (int x = 0; x < 40; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 4; ++z) cells.emplace_back(x, y, z);
  const Simplified bar = simplify(shapes::rotated(shapes::voxels(cells, 1)), {.tolerance = 1.8});
  EXPECT_EQ(bar.mesh.triangles.size(), 12u);
  EXPECT_LT(bar.deviation, 1e-4);
  EXPECT_NEAR(diagnose(bar.mesh).signedVolume, 800.0, 0.01);
}

TEST(Simplify, SpendsFewFacesAlongRidges) {
  // A ring whose section is nearly a square. Moving vertices along its edges costs nothing, across them much.
  // Planes that are wrong, have wrong weights or are forgotten after a collapse leave 640 triangles or more.
  constexpr uint32_t kAround = 160, kSection = 80;
  const Mesh torus = shapes::torus(2.0, 0.5, kAround, kSection);
  std::vector<dvec3> points;
  for (uint32_t v = 0; v < torus.vertices.size(); ++v) {
    const double u = 2.0 * std::numbers::pi * (v / kSection) / kAround,
                 w = 2.0 * std::numbers::pi * (v % kSection) / kSection;
    const auto squared = [](double x) { return std::copysign(std::pow(std::abs(x), 0.3), x); };
    const double r = 2.0 + 0.5 * squared(std::cos(w));
    points.emplace_back(r * std::cos(u), r * std::sin(u), 0.5 * squared(std::sin(w)));
  }
  const Mesh ring = shapes::rotated(makeMesh(points, torus.triangles));
  const Simplified result = simplify(ring, {.tolerance = 0.02});
  EXPECT_TRUE(isClosed(result.mesh));
  EXPECT_LT(result.mesh.triangles.size(), 620u);
}

TEST(Simplify, HasFewerFacesTheLargerTheTolerance) {
  const Mesh ball = surfaceOf([](const dvec3& p) { return analytic::sphere(p, 1.0); });
  size_t faces = ball.triangles.size();
  for (const double tolerance : {0.02 * kSpacing, kTolerance, 0.5 * kSpacing}) {
    const Simplified result = simplified(ball, tolerance);
    expectSound(ball, result, tolerance);
    EXPECT_LT(result.mesh.triangles.size(), faces * 3 / 4);
    faces = result.mesh.triangles.size();
  }
  EXPECT_LT(faces, 300u);
}

TEST(Simplify, KnowsHowFarOffItsEdgesAre) {
  const Mesh ball = surfaceOf([](const dvec3& p) { return analytic::sphere(p, 1.0); });
  const Simplified result = simplified(ball, kSpacing);
  for (const glm::uvec3& t : result.mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const dvec3 from = result.mesh.position(t[c]), to = result.mesh.position(t[(c + 1) % 3]);
      if (t[c] > t[(c + 1) % 3]) continue;  // The other face has the same edge.
      forEachEdgePoint(
          from, to, partsOf(Decimator::kEdgePoints * glm::distance(from, to), kSpacing),
          [&](const dvec3& p) { EXPECT_LE(reference::distance(ball, p), result.deviation * (1.0 + 1e-6)); });
    }
}

TEST(Simplify, KeepsSolidsThatAreCloseToEachOtherApart) {
  // Half a sample between two boxes, and half a sample between a box and the sphere in it.
  const double gap = 0.5 * kSpacing;
  const Mesh two = surfaceOf([&](const dvec3& p) {
    const dvec3 half(0.8, 0.5, 0.8), up(0.0, 0.5 + 0.5 * gap, 0.0);
    return std::min(analytic::box(p - up, half), analytic::box(p + up, half));
  });
  expectSound(two, simplified(two));
  const Mesh balls = surfaceOf([&](const dvec3& p) {
    return std::min(std::abs(analytic::sphere(p, 0.9)) - gap, analytic::sphere(p, 0.9 - 3.0 * gap));
  });
  expectSound(balls, simplified(balls));
}

TEST(Simplify, KeepsThinWalls) {
  const Mesh wall =
      surfaceOf([](const dvec3& p) { return analytic::box(p, dvec3(0.9, 0.6 * kSpacing, 0.9)); });
  expectSound(wall, simplified(wall));
}

TEST(Simplify, SurvivesNoise) {
  // Hundreds of pieces, handles and sheets that share cubes.
  uint32_t state = 1;
  const Mesh noise = surfaceOf([&](const dvec3&) {
    state = state * 1664525u + 1013904223u;
    return kSpacing * (double(state >> 8) / double(1 << 24) - 0.5);
  });
  const size_t crossing = findSelfIntersections(noise).pairs;
  const Simplified result = simplified(noise);
  EXPECT_TRUE(isClosed(result.mesh));
  EXPECT_LE(findSelfIntersections(result.mesh).pairs, crossing);
  EXPECT_LE(result.deviation, kTolerance);
  EXPECT_LT(result.mesh.triangles.size(), noise.triangles.size());
}

TEST(Simplify, TakesMeshesWithLargeFaces) {
  const Mesh torus = shapes::torus(1.0, 0.3, 60, 30);
  const double tolerance = 0.02;
  const Simplified result = simplify(torus, {.tolerance = tolerance});
  expectSound(torus, result, tolerance);
  EXPECT_LT(result.mesh.triangles.size(), torus.triangles.size() / 2);
  const Mesh box = shapes::box(dvec3(-1.0), dvec3(1.0));
  EXPECT_EQ(simplify(box, {.tolerance = 0.01}).mesh.triangles.size(), 12u);
}

TEST(Simplify, IsTheSameForAnyNumberOfThreads) {
  const Mesh ball = surfaceOf([](const dvec3& p) { return analytic::torus(p, 0.7, 0.35); });
  const auto run = [&](int threads) {
    // Small steps: many tiles.
    return simplify(ball, {.tolerance = kTolerance, .step = 0.2 * kSpacing}, {.threads = threads}).mesh;
  };
  const Mesh one = run(1);
  EXPECT_LT(one.triangles.size(), ball.triangles.size() / 2);
  for (const int threads : {2, 5, 0}) {
    const Mesh many = run(threads);
    EXPECT_EQ(one.triangles, many.triangles);
    EXPECT_EQ(one.vertices, many.vertices);
  }
}

TEST(Simplify, KeepsTheMeshWithoutATolerance) {
  const Mesh ball = surfaceOf([](const dvec3& p) { return analytic::sphere(p, 1.0); });
  const Simplified result = simplified(ball, 0.0);
  EXPECT_EQ(result.mesh.triangles, ball.triangles);
  EXPECT_EQ(result.mesh.vertices, ball.vertices);
  EXPECT_EQ(result.mesh.origin, ball.origin);
  EXPECT_EQ(result.deviation, 0.0);
}

TEST(Simplify, TurnsNoPartInsideOut) {
  // A tetrahedron so thin that the samples see crumbs of it, with few faces each.
  const dvec3 a(0, 0, 0), b(1.9, 0.7, 0.4), c(0.2, 1.3, 1.7);
  for (const double height : {0.002, 0.003, 0.004, 0.005}) {
    const dvec3 top = (a + b + c) / 3.0 + height * glm::normalize(glm::cross(b - a, c - a));
    const std::vector<dvec3> corners{a, b, c, top};
    const Mesh mesh = makeMesh(corners, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
    const Grid grid = fitGrid(mesh, {.resolution = 64});
    const Mesh crumbs = isosurface(generate(mesh, grid, {}).field);
    EXPECT_EQ(diagnose(crumbs).inwardComponents, 0u);
    const Simplified result = simplify(crumbs, {.tolerance = 0.1 * grid.spacing, .step = grid.spacing});
    EXPECT_LT(result.mesh.triangles.size(), crumbs.triangles.size());
    EXPECT_EQ(diagnose(result.mesh).inwardComponents, 0u);
    EXPECT_EQ(diagnose(result.mesh).components, diagnose(crumbs).components);
  }
}

TEST(Simplify, KeepsATetrahedronSmallerThanTheTolerance) {
  const std::vector<dvec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Mesh mesh = makeMesh(corners, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  const Simplified result = simplify(mesh, {.tolerance = 5.0, .step = 0.5});
  EXPECT_EQ(result.mesh.triangles, mesh.triangles);
  EXPECT_EQ(result.undone, 0u);
}

TEST(Simplify, ReachesANumberOfTriangles) {
  const Mesh ball = surfaceOf([](const dvec3& p) { return analytic::sphere(p, 1.0); });
  double tolerance = 0.0;
  for (const size_t most : {3000, 601, 150}) {
    const Simplified result = simplify(ball, {.step = kSpacing, .triangles = most});
    EXPECT_LE(result.mesh.triangles.size(), most);
    EXPECT_GE(result.mesh.triangles.size(), most * 9 / 10);
    EXPECT_GT(result.tolerance, tolerance);
    tolerance = result.tolerance;
    expectSound(ball, result, tolerance);
    // The tolerance tells the same result, and a smaller one does not reach the number.
    EXPECT_EQ(simplified(ball, tolerance).mesh.triangles, result.mesh.triangles);
    EXPECT_GT(simplified(ball, 0.8 * tolerance).mesh.triangles.size(), most);
  }
}

TEST(Simplify, ReachesANumberOfTrianglesWithoutAStep) {
  const Mesh torus = shapes::torus(1.0, 0.3, 120, 60);
  const Simplified result = simplify(torus, {.triangles = 1000});
  EXPECT_LE(result.mesh.triangles.size(), 1000u);
  EXPECT_GE(result.mesh.triangles.size(), 900u);
  expectSound(torus, result, result.tolerance);
  const Simplified kept = simplify(torus, {.triangles = torus.triangles.size()});
  EXPECT_EQ(kept.mesh.triangles, torus.triangles);
  EXPECT_EQ(kept.tolerance, 0.0);
}

TEST(Simplify, WarnsIfItDoesNotReachTheNumberOfTriangles) {
  const Mesh ball = surfaceOf([](const dvec3& p) { return analytic::sphere(p, 1.0); });
  std::vector<Warning> warnings;
  const MachineOptions machine{.warn = [&](const Warning& warning) { warnings.push_back(warning); }};
  const auto reach = [&](const SimplifyOptions& options) {
    warnings.clear();
    return simplify(ball, options, machine);
  };
  const Simplified limited = reach({.tolerance = kTolerance, .step = kSpacing, .triangles = 100});
  EXPECT_EQ(limited.tolerance, kTolerance);
  EXPECT_EQ(limited.mesh.triangles, simplified(ball).mesh.triangles);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].code, WarningCode::TrianglesMissed);
  EXPECT_EQ(warnings[0].fields.count, limited.mesh.triangles.size());
  EXPECT_NE(warnings[0].message.find("a larger one may leave fewer"), std::string::npos)
      << warnings[0].message;
  const Simplified coarsest = reach({.step = kSpacing, .triangles = 3});
  EXPECT_TRUE(isClosed(coarsest.mesh));
  EXPECT_LT(coarsest.mesh.triangles.size(), 200u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].message.find("parts, handles or details"), std::string::npos) << warnings[0].message;
  // A limit that is not needed changes nothing.
  const Simplified free = reach({.step = kSpacing, .triangles = 600});
  EXPECT_EQ(reach({.tolerance = 1.0, .step = kSpacing, .triangles = 600}).mesh.triangles,
            free.mesh.triangles);
  EXPECT_TRUE(warnings.empty());
}

TEST(Simplify, TakesVerticesAtTheSamePositionAsOne) {
  const Mesh ball = shapes::sphere(1.0, 4);
  Mesh soup;  // As a .stl holds it.
  for (const glm::uvec3& t : ball.triangles) {
    const auto first = uint32_t(soup.vertices.size());
    for (int c = 0; c < 3; ++c) soup.vertices.push_back(ball.vertices[t[c]]);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  const Simplified result = simplify(soup, {.triangles = 500});
  EXPECT_LE(result.mesh.triangles.size(), 500u);
  expectSound(ball, result, result.tolerance);
  soup.triangles.pop_back();
  EXPECT_THROW(simplify(soup, {.triangles = 500}), Error);
}

TEST(Simplify, RefusesMeshesThatAreNotClosed) {
  const auto refuse = [](const Mesh& mesh, const char* message) {
    try {
      simplified(mesh);
      FAIL() << message;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Input);
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  };
  Mesh open = shapes::sphere(1.0, 2);
  open.triangles.pop_back();
  refuse(open, "without exactly two faces that agree");
  Mesh flipped = shapes::sphere(1.0, 2);
  std::swap(flipped.triangles[0].x, flipped.triangles[0].y);
  refuse(flipped, "without exactly two faces that agree");
  // Two tetrahedra with a common corner.
  Mesh joined;
  joined.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  joined.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
  refuse(joined, "joins two surfaces");
  EXPECT_THROW(simplify(shapes::sphere(1.0, 2), {.tolerance = -1.0}), Error);
  EXPECT_THROW(simplify(shapes::sphere(1.0, 2), {.tolerance = NAN}), Error);
  EXPECT_THROW(simplify(shapes::sphere(1.0, 2), {.tolerance = 0.1, .step = -1.0}), Error);
}

// Faces nearly as large as the step, or twice as large, once had too few points to grow.
TEST(Simplify, TakesAnyStep) {
  std::vector<glm::ivec3> cells;
  for (int i = 0; i < 1000; ++i) cells.emplace_back(i % 10, i / 10 % 10, i / 100);
  const Mesh cube = shapes::voxels(cells, 1);  // Its edges are 1 and 1.41 long.
  ASSERT_EQ(cube.triangles.size(), 1200u);
  for (const double step : {0.3, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 1.0, 1.1, 1.2, 1.5, 2.0, 3.0})
    EXPECT_LE(simplify(cube, {.tolerance = 0.01, .step = step}).mesh.triangles.size(), 150u) << step;
}

TEST(Simplify, IsPartOfARepair) {
  const Mesh box = shapes::box(dvec3(-1.0, -0.7, -0.8), dvec3(1.0, 0.7, 0.8));
  RepairOptions how{.remesh = true};
  const Grid grid = fitRepairGrid(box, {.resolution = 48}, how);
  const Repaired byDefault = repair(box, grid, {}, how);
  how.tolerance = 0.0;
  const Repaired whole = repair(box, grid, {}, how);
  const SimplifyReport& report = byDefault.report.simplified;
  EXPECT_EQ(report.tolerance, 0.1 * grid.spacing);
  EXPECT_EQ(report.trianglesBefore, whole.mesh.triangles.size());
  EXPECT_EQ(report.trianglesAfter, byDefault.mesh.triangles.size());
  EXPECT_LT(report.trianglesAfter, 200u);
  EXPECT_LE(report.deviation, report.tolerance);
  EXPECT_EQ(whole.report.simplified.deviation, 0.0);
  const Mesh surface = isosurface(Surface(box).generateBand(grid, {.outside = 4.0, .inside = 4.0}));
  EXPECT_EQ(whole.mesh.triangles, surface.triangles);
  EXPECT_EQ(whole.mesh.vertices, surface.vertices);
  how.tolerance = -1.0;
  EXPECT_THROW(repair(box, grid, {}, how), Error);
}

TEST(Simplify, GivesARepairAsFewTrianglesAsAskedFor) {
  const Mesh torus = shapes::torus(1.0, 0.3, 60, 30);
  const Grid grid = fitRepairGrid(torus, {.resolution = 64});
  for (const bool remesh : {false, true}) {
    const Repaired made = repair(torus, grid, {}, {.remesh = remesh, .triangles = 800});
    const SimplifyReport& report = made.report.simplified;
    EXPECT_EQ(made.report.keepsFaces(), !remesh);
    EXPECT_TRUE(made.report.after.watertight);
    EXPECT_LE(made.mesh.triangles.size(), 800u);
    EXPECT_GE(made.mesh.triangles.size(), 700u);
    EXPECT_EQ(report.trianglesAfter, made.mesh.triangles.size());
    EXPECT_GT(report.trianglesBefore, 800u);
    EXPECT_LE(report.deviation, report.tolerance);
    EXPECT_TRUE(made.report.warnings.empty());
  }
  const Repaired kept = repair(torus, grid, {}, {.triangles = torus.triangles.size()});
  EXPECT_EQ(kept.mesh.triangles.size(), torus.triangles.size());
  EXPECT_EQ(kept.report.simplified.tolerance, 0.0);
  const Repaired within = repair(torus, grid, {}, {.tolerance = 0.01});
  EXPECT_TRUE(within.report.keepsFaces());
  EXPECT_TRUE(within.report.after.watertight);
  EXPECT_LT(within.mesh.triangles.size(), torus.triangles.size() / 2);
  EXPECT_EQ(within.report.simplified.tolerance, 0.01);
  EXPECT_EQ(within.report.simplified.trianglesAfter, within.mesh.triangles.size());
  EXPECT_LE(within.report.simplified.deviation, 0.01);
  const Repaired exact = repair(torus, grid, {}, {.tolerance = 0.0});
  EXPECT_EQ(exact.mesh.triangles.size(), torus.triangles.size());
  EXPECT_EQ(exact.report.simplified.trianglesBefore, 0u);
  const Repaired limited =
      repair(torus, grid, {}, {.remesh = true, .tolerance = 0.02 * grid.spacing, .triangles = 800});
  ASSERT_EQ(limited.report.warnings.size(), 1u);
  EXPECT_EQ(limited.report.warnings[0].code, WarningCode::TrianglesMissed);
  EXPECT_EQ(limited.report.simplified.tolerance, 0.02 * grid.spacing);
  EXPECT_THROW(repair(torus, grid, {}, {.tolerance = 0.0, .triangles = 800}), Error);
}

}  // namespace
}  // namespace raymap
