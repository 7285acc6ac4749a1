#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <barrier>
#include <cmath>
#include <numeric>
#include <random>
#include <span>
#include <thread>

#include "any_threads.h"
#include "broken_meshes.h"
#include "error_code.h"
#include "mesh/rim_edges.h"
#include "random_points.h"
#include "reference.h"
#include "shapes.h"

namespace raymap {
namespace {

const QueryOptions kEverything{.closest = true,
                               .triangle = true,
                               .barycentric = true,
                               .direction = true,
                               .winding = true,
                               .confidence = true};

double diagonalOf(const Mesh& mesh) {
  return glm::length(bounds(mesh).size());
}

/// Checks distances, closest points and what follows from them against brute force.
void expectExact(const Mesh& mesh, const std::vector<glm::dvec3>& points) {
  const QueryResult result = Surface(mesh).query(points, kEverything);
  const double tolerance = 1e-6 * diagonalOf(mesh);
  for (size_t i = 0; i < points.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "point " << i);
    const double exact = reference::distance(mesh, points[i]);
    ASSERT_NEAR(std::abs(result.distance[i]), exact, tolerance);
    ASSERT_NEAR(glm::distance(points[i], result.closest[i]), exact, tolerance);
    const glm::uvec3 t = mesh.triangles[result.triangle[i]];
    const glm::dvec3 weights = result.barycentric[i];
    ASSERT_NEAR(weights.x + weights.y + weights.z, 1.0, 1e-12);
    for (int c = 0; c < 3; ++c) {
      ASSERT_GE(weights[c], -1e-12);
      ASSERT_LE(weights[c], 1.0 + 1e-12);
    }
    const glm::dvec3 closest =
        weights.x * mesh.position(t.x) + weights.y * mesh.position(t.y) + weights.z * mesh.position(t.z);
    ASSERT_LT(glm::distance(closest, result.closest[i]), tolerance);
    const glm::dvec3 there = points[i] + std::abs(result.distance[i]) * result.direction[i];
    ASSERT_LT(glm::distance(there, result.closest[i]), tolerance);
  }
}

/// Counts the points whose sign is not that of the exact winding number. Those on the surface do not count.
size_t countWrong(const Mesh& given, const Mesh& truth, const std::vector<glm::dvec3>& points,
                  const SurfaceOptions& options = {}) {
  const QueryResult result = Surface(given, options).query(points);
  size_t wrong = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const bool isInside = std::abs(reference::windingNumber(truth, points[i])) > 0.5;
    wrong += result.distance[i] != 0.0 && isInside != (result.distance[i] < 0.0);
  }
  return wrong;
}

template <class T>
bool sameAt(const Buffer<T>& a, size_t i, const Buffer<T>& b, size_t k) {
  const auto bytesAt = [](const Buffer<T>& buffer, size_t place) {
    return std::as_bytes(std::span(buffer).subspan(place, 1));
  };
  return std::ranges::equal(bytesAt(a, i), bytesAt(b, k));
}

bool sameAt(const QueryResult& a, size_t i, const QueryResult& b, size_t k) {
  return sameAt(a.distance, i, b.distance, k) && sameAt(a.closest, i, b.closest, k) &&
         sameAt(a.triangle, i, b.triangle, k) && sameAt(a.barycentric, i, b.barycentric, k) &&
         sameAt(a.direction, i, b.direction, k) && sameAt(a.winding, i, b.winding, k) &&
         sameAt(a.confidence, i, b.confidence, k);
}

TEST(Surface, GivesTheDistanceToTheClosestTriangle) {
  for (const Mesh& mesh : {shapes::sphere(1.0, 3), shapes::torus(1.0, 0.3, 40, 20), shapes::soup(200, 5),
                           shapes::box({0, 0, 0}, {1, 2, 3})}) {
    expectExact(mesh, uniformPoints(mesh, 600));
    expectExact(mesh, nearPoints(mesh, 600, 0.01));
    expectExact(mesh, nearPoints(mesh, 100, 0.0));
  }
}

TEST(Surface, KeepsItsPrecisionFarFromTheOrigin) {
  Mesh mesh = shapes::sphere(1.0, 3);
  mesh.origin = {5e5, -5.5e6, 300.0};
  const std::vector<glm::dvec3> points = uniformPoints(mesh, 300);
  expectExact(mesh, points);
  EXPECT_EQ(countWrong(mesh, mesh, points), 0u);
}

TEST(Surface, MeasuresPointsFarFromTheMesh) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const std::vector<glm::dvec3> points{
      {30, 0.25, 0.5}, {0.5, -4e3, 0.5}, {1e7 + 1, 0.5, 0.25}, {-3e12, -3e12, -3e12}};
  const QueryResult result = Surface(mesh).query(points, {.closest = true, .winding = true});
  const double expected[] = {29, 4e3, 1e7, 3e12 * std::sqrt(3.0)};
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(result.distance[i], expected[i], 1e-6 * expected[i]) << i;
    EXPECT_EQ(result.winding[i], 0.0f) << i;
  }
  EXPECT_EQ(result.closest[3], glm::dvec3(0.0));
}

// Squares of such coordinates overflow, and those in cells do as well.
TEST(Surface, MeasuresPointsAsFarAsNumbersReach) {
  const double most = std::numeric_limits<double>::max();
  const std::vector<glm::dvec3> points{{1e150, 0.001, 0}, {-1e155, 0, 0}, {0, 1e200, -1e200},
                                       {1e307, 1e307, 0}, {0, 0, -most},  {most, most, most}};
  const double half = std::sqrt(0.5), third = std::sqrt(1.0 / 3.0);
  const double distances[] = {1e150, 1e155, 1e200 / half, 1e307 / half, most, INFINITY};
  const glm::dvec3 directions[] = {{-1, 0, 0},        {1, 0, 0}, {0, -half, half},
                                   {-half, -half, 0}, {0, 0, 1}, {-third, -third, -third}};
  const double side = 1e-3;
  for (const Mesh& mesh :
       {shapes::box({0, 0, 0}, glm::vec3(side)), withHoles(shapes::sphere(side, 3), 3, 0.1, 1)}) {
    const QueryResult result = Surface(mesh).query(points, kEverything);
    for (size_t i = 0; i < points.size(); ++i) {
      SCOPED_TRACE(testing::Message() << "point " << i);
      EXPECT_DOUBLE_EQ(result.distance[i], distances[i]);
      EXPECT_LT(glm::distance(result.direction[i], directions[i]), 1e-12);
      EXPECT_LT(glm::length(result.closest[i]), 2.0 * side);
      EXPECT_LT(result.triangle[i], mesh.triangles.size());
      EXPECT_NEAR(result.winding[i], 0.0f, 1e-3f);
      EXPECT_TRUE(result.confidence[i] >= 0.0f && result.confidence[i] <= 1.0f);
    }
    const QueryResult near = Surface(mesh).query(points, {.triangle = true, .maxDistance = 1e154});
    for (size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(near.distance[i], i == 0 ? 1e150 : 1e154) << i;
      EXPECT_EQ(near.triangle[i] == kNoTriangle, i > 0) << i;
    }
  }
}

TEST(Surface, HasNoWrongSignOnClosedMeshes) {
  const Mesh overlapping =
      shapes::joined(shapes::sphere(1.0, 3), shapes::box({0.2, 0.1, 0.0}, {1.5, 1.2, 1.1}));
  for (const Mesh& mesh : {shapes::torus(1.0, 0.3, 40, 20), overlapping, shapes::box({0, 0, 0}, {1, 2, 3})}) {
    EXPECT_EQ(countWrong(mesh, mesh, uniformPoints(mesh, 2000)), 0u);
    EXPECT_EQ(countWrong(mesh, mesh, nearPoints(mesh, 2000, 2e-3)), 0u);
  }
}

// Single precision could not tell on which side these points lie.
TEST(Surface, HasNoWrongSignCloseToTheSurface) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 40, 20);
  for (const double reach : {1e-6, 1e-8, 1e-10})
    EXPECT_EQ(countWrong(mesh, mesh, nearPoints(mesh, 500, reach)), 0u);
}

// The lattice of a box has samples in the planes of its faces and on the lines through its edges.
TEST(Surface, HasNoWrongSignOnLinesOfTheLattice) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  std::vector<glm::dvec3> points;
  for (const double x : {-1e-9, 0.0, 1e-9, 0.5, 1.0})
    for (const double y : {-1e-9, 0.0, 0.25, 1.0, 1.0 + 1e-9})
      for (const double z : {-1e-9, 1e-9, 0.75, 1.0}) points.emplace_back(x, y, z);
  const QueryResult result = Surface(mesh).query(points, {.winding = true});
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 p = points[i], q = glm::min(p, 1.0 - p);
    const double inside = std::min({q.x, q.y, q.z});
    if (inside == 0.0) continue;
    EXPECT_EQ(result.winding[i], inside > 0.0 ? 1.0f : 0.0f) << i;
    EXPECT_EQ(result.distance[i]<0.0, inside> 0.0) << i;
  }
}

/// Checks winding numbers against the exact ones to single precision, and the signs of a plain query.
void expectExactWinding(const Mesh& mesh, const std::vector<glm::dvec3>& points) {
  EXPECT_EQ(countWrong(mesh, mesh, points, {.orientation = Orientation::Keep}), 0u);
  const QueryResult result =
      Surface(mesh, {.orientation = Orientation::Keep}).query(points, {.winding = true});
  for (size_t i = 0; i < points.size(); ++i)
    ASSERT_NEAR(result.winding[i], reference::windingNumber(mesh, points[i]), 1e-6) << i;
}

TEST(Surface, KnowsTheWindingNumberOfOpenMeshesExactly) {
  const Mesh whole = shapes::sphere(1.0, 3);
  for (const Mesh& mesh :
       {withHoles(whole, 5, 0.08, 2), withMissingFaces(whole, 0.1, 1), withFlippedFaces(whole, 0.05, 3),
        shapes::joined(withHoles(whole, 2, 0.1, 1), withHoles(shapes::torus(1.2, 0.3, 40, 20), 3, 0.1, 2))}) {
    expectExactWinding(mesh, uniformPoints(mesh, 400, 0.5));
    expectExactWinding(mesh, nearPoints(mesh, 400, 2e-3));
    expectExactWinding(mesh, nearPoints(mesh, 200, 1e-6));
  }
}

// The margin is exact, and at least half of it is left if no ray agrees.
TEST(Surface, RatesItsSignsByTheExactWindingNumber) {
  const Mesh mesh = withHoles(shapes::sphere(1.0, 3), 5, 0.08, 2);
  const std::vector<glm::dvec3> points = uniformPoints(mesh, 800);
  for (const double threshold : {0.5, 0.25}) {
    const Surface surface(mesh, {.orientation = Orientation::Keep, .threshold = threshold});
    const QueryResult result = surface.query(points, {.confidence = true});
    for (size_t i = 0; i < points.size(); ++i) {
      const double w = std::abs(reference::windingNumber(mesh, points[i]));
      const double margin = w > threshold ? (w - threshold) / (1.0 - threshold) : 1.0 - w / threshold;
      ASSERT_LE(result.confidence[i], margin + 1e-5) << i;
      ASSERT_GE(result.confidence[i], 0.5 * margin - 1e-5) << i;
    }
  }
}

TEST(Surface, KnowsTheWindingNumberAlongRims) {
  const Mesh mesh = withHoles(shapes::sphere(1.0, 3), 5, 0.08, 2);
  std::vector<glm::dvec3> points;
  for (const RimEdge& rim : findRimEdges(mesh, fitGrid(mesh, {.resolution = 64}).spacing)) {
    const glm::dvec3 a = mesh.position(rim.from), b = mesh.position(rim.to);
    for (const double away : {1e-2, 1e-4, 1e-6})
      for (const double t : {0.0, 0.25, 0.5, 1.0}) points.push_back((1.0 + away) * (a + t * (b - a)));
    points.push_back(2.0 * b - a);  // On the line through it.
  }
  expectExactWinding(mesh, points);
}

// The number has no value there. What is given is finite, and costs no more.
TEST(Surface, AnswersOnRimsAndFaces) {
  const Mesh mesh = withHoles(shapes::sphere(1.0, 3), 5, 0.08, 2);
  std::vector<glm::dvec3> points;
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      points.push_back(mesh.position(t[c]));
      points.push_back(0.5 * (mesh.position(t[c]) + mesh.position(t[(c + 1) % 3])));
    }
  const std::vector<glm::dvec3> inFaces = nearPoints(mesh, 300, 0.0);
  points.insert(points.end(), inFaces.begin(), inFaces.end());
  const QueryResult result = Surface(mesh).query(points, {.winding = true});
  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_LT(std::abs(result.distance[i]), 1e-6);
    ASSERT_GT(result.winding[i], -0.5f) << i;
    ASSERT_LT(result.winding[i], 1.5f) << i;
  }
}

// With so many rims, dipoles tell the number.
TEST(Surface, FollowsTheWindingNumberOfSoups) {
  const Mesh mesh = withMovedCorners(shapes::sphere(1.0, 4), 0.01, 1);
  std::vector<glm::dvec3> points = uniformPoints(mesh, 500);
  const std::vector<glm::dvec3> near = nearPoints(mesh, 500, 2e-3);
  points.insert(points.end(), near.begin(), near.end());
  EXPECT_LE(countWrong(mesh, mesh, points), 1u);
  const QueryResult result = Surface(mesh).query(points, {.winding = true});
  double sum = 0.0;
  for (size_t i = 0; i < points.size(); ++i) {
    const double exact = reference::windingNumber(mesh, points[i]);
    const double error = std::abs(result.winding[i] - exact);
    ASSERT_LT(error, std::abs(exact - 0.5) < 1e-3 ? 1e-4 : 1e-2) << i;
    sum += error;
  }
  EXPECT_LT(sum, 1e-3 * double(points.size()));
}

TEST(Surface, HasNoWrongSignWhereNumbersChangeSteeply) {
  // Around the rims of so many plates, numbers change by more than one from a sample to the next.
  Mesh plates;
  for (int k = 0; k < 8; ++k) {
    const Mesh plate = shapes::box({-1, -1, -0.001 * k}, {1, 1, 1});
    for (const glm::uvec3& t : plate.triangles)
      if (plate.position(t.x).z < 0.5 && plate.position(t.y).z < 0.5 && plate.position(t.z).z < 0.5)
        plates.triangles.push_back(t + uint32_t(plates.vertices.size()));
    for (uint32_t v = 0; v < plate.vertices.size(); ++v) plates.vertices.emplace_back(plate.position(v));
  }
  const Surface surface(plates, {.orientation = Orientation::Keep});
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> along(-0.9, 0.9), aside(-0.15, 0.15);
  std::vector<glm::dvec3> points;
  for (int k = 0; k < 4000; ++k) {
    const double x = 1.0 + aside(random), y = along(random), z = aside(random);
    points.emplace_back(x, y, z);
  }
  const QueryResult found = surface.query(points);
  size_t inside = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const double number = std::abs(reference::windingNumber(plates, points[i]));
    if (std::abs(number - 0.5) < 1e-4) continue;
    EXPECT_EQ(found.distance[i]<0.0, number> 0.5) << number;
    if (number > 0.5) ++inside;
  }
  EXPECT_GT(inside, 500u);
  EXPECT_LT(inside, 3500u);
}

TEST(Surface, HasNoWrongSignCloseToOpenSurfacesAwayFromRims) {
  const Mesh whole = shapes::sphere(1.0, 3);
  const Mesh open = keepTriangles(whole, [&](const glm::uvec3& t) { return whole.position(t.x).z < 0.8; });
  const Surface surface(open);
  for (const double reach : {1e-6, 1e-8, 1e-10}) {
    std::vector<glm::dvec3> points = nearPoints(open, 1000, reach);
    std::erase_if(points, [](const glm::dvec3& p) { return p.z > 0.4; });
    const QueryResult plain = surface.query(points), closely = surface.query(points, {.winding = true});
    for (size_t i = 0; i < points.size(); ++i) {
      const double winding = reference::windingNumber(open, points[i]);
      ASSERT_EQ(std::signbit(plain.distance[i]), winding > 0.5) << i;
      ASSERT_EQ(closely.distance[i], plain.distance[i]) << i;
      ASSERT_NEAR(closely.winding[i], winding, 1e-6) << i;
    }
  }
}

// docs/points.md: beside rims, single precision decides on which side a point lies.
TEST(Surface, KnowsTheSidesOfOpenMeshesDownToRounding) {
  const Mesh mesh = withHoles(shapes::sphere(1.0, 3), 3, 0.1, 2);
  for (const double reach : {1e-4, 1e-6}) {
    const std::vector<glm::dvec3> points = nearPoints(mesh, 3000, reach);
    const QueryResult result = Surface(mesh).query(points);
    size_t sure = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const double winding = std::abs(reference::windingNumber(mesh, points[i]));
      if (reference::distance(mesh, points[i]) < 1e-7 * diagonalOf(mesh) || std::abs(winding - 0.5) < 1e-4)
        continue;
      ++sure;
      ASSERT_EQ(std::signbit(result.distance[i]), winding > 0.5) << i;
    }
    EXPECT_GT(sure, 2000u);
  }
}

TEST(Surface, TurnsAndLeavesOutFacesAsAFieldDoes) {
  const Mesh solid = shapes::sphere(1.0, 3);
  for (const Mesh& mesh : {withFlippedFaces(solid, 0.3, 1), withDoubledFaces(solid, 1.0, 2)}) {
    EXPECT_EQ(countWrong(mesh, solid, uniformPoints(solid, 1000)), 0u);
    EXPECT_EQ(countWrong(mesh, solid, nearPoints(solid, 1000, 1e-3)), 0u);
    expectExact(mesh, uniformPoints(mesh, 200));
  }
}

TEST(Surface, KeepsTheGivenFacesOnRequest) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  for (size_t f = 0; f < 2; ++f) std::swap(mesh.triangles[f].y, mesh.triangles[f].z);
  const std::vector<glm::dvec3> points = uniformPoints(mesh, 200);
  const QueryResult result =
      Surface(mesh, {.orientation = Orientation::Keep}).query(points, {.winding = true});
  for (size_t i = 0; i < points.size(); ++i)
    ASSERT_NEAR(result.winding[i], reference::windingNumber(mesh, points[i]), 1e-6) << i;
}

TEST(Surface, AgreesWithTheGrid) {
  for (const Mesh& mesh : {shapes::torus(1.0, 0.3, 40, 20), withHoles(shapes::sphere(1.0, 4), 3, 0.1, 1),
                           withFlippedFaces(shapes::sphere(1.0, 3), 0.3, 1)}) {
    const Surface surface(mesh);
    const Grid grid = fitGrid(mesh, {.resolution = 25});
    const Generated made = surface.generate(grid, {.winding = true}, {.device = "cpu"});
    std::vector<glm::dvec3> points;
    for (int k = 0; k < grid.dims.z; ++k)
      for (int j = 0; j < grid.dims.y; ++j)
        for (int i = 0; i < grid.dims.x; ++i) points.push_back(grid.position({i, j, k}));
    const QueryResult result = surface.query(points);
    for (size_t s = 0; s < points.size(); ++s) {
      ASSERT_NEAR(std::abs(result.distance[s]), std::abs(made.field.distance[s]), 1e-6 * diagonalOf(mesh))
          << s;
      if (std::abs(std::abs(made.field.winding[s]) - 0.5) > 1e-4) {
        ASSERT_EQ(result.distance[s] < 0.0, made.field.distance[s] < 0.0f) << s;
      }
    }
    EXPECT_EQ(made.stats.turnedFaces, surface.stats().turnedFaces);
  }
}

TEST(Surface, AnswersEachPointByItself) {
  for (const Mesh& mesh : {shapes::soup(300, 1), shapes::torus(1.0, 0.3, 40, 20)}) {
    const Surface surface(mesh);
    std::vector<glm::dvec3> points = uniformPoints(mesh, 3000, 0.5);
    const std::vector<glm::dvec3> near = nearPoints(mesh, 3000, 1e-3);
    points.insert(points.end(), near.begin(), near.end());
    points.emplace_back(1e6, 2.0, 3.0);
    const QueryResult all = surface.query(points, kEverything);

    std::vector<size_t> order(points.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937_64(1));
    std::vector<glm::dvec3> shuffled;
    for (const size_t i : order) shuffled.push_back(points[i]);
    const QueryResult other = surface.query(shuffled, kEverything);
    for (size_t k = 0; k < order.size(); ++k) ASSERT_TRUE(sameAt(all, order[k], other, k)) << order[k];

    for (size_t i = 0; i < points.size(); i += 97) {
      const QueryResult one = surface.query(std::vector{points[i]}, kEverything);
      ASSERT_TRUE(sameAt(all, i, one, 0)) << i;
    }
    for (const int threads : {1, 2, 3}) {
      const QueryResult again = surface.query(points, kEverything, {.threads = threads});
      for (size_t i = 0; i < points.size(); ++i) ASSERT_TRUE(sameAt(all, i, again, i)) << i;
    }
  }
}

TEST(Surface, MayBeUsedByManyThreads) {
  for (const Mesh& mesh : {shapes::torus(1.0, 0.3, 40, 20), shapes::soup(300, 1)}) {
    const Surface surface(mesh);
    const std::vector<glm::dvec3> points = uniformPoints(mesh, 500);
    const QueryResult expected = surface.query(points, kEverything);
    // All of them begin at once: none of them has answered before.
    const Surface fresh(mesh);
    std::vector<QueryResult> results(8);
    std::barrier start(std::ptrdiff_t(results.size()));
    std::vector<std::thread> threads;
    for (QueryResult& result : results)
      threads.emplace_back([&] {
        start.arrive_and_wait();
        fresh.query(points, kEverything, result);
      });
    for (std::thread& thread : threads) thread.join();
    for (const QueryResult& result : results)
      for (size_t i = 0; i < points.size(); ++i) ASSERT_TRUE(sameAt(result, i, expected, i)) << i;
  }
}

TEST(Surface, ReadsPointsInAnyLayout) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Surface surface(mesh);
  struct Particle {
    float mass;
    float position[3];
    float charge[2];
  };
  std::vector<Particle> particles;
  std::vector<glm::vec3> floats;
  std::vector<glm::dvec3> doubles;
  for (const glm::dvec3& p : uniformPoints(mesh, 100)) {
    floats.emplace_back(p);
    doubles.emplace_back(floats.back());
    particles.push_back({1.0f, {floats.back().x, floats.back().y, floats.back().z}, {2.0f, 3.0f}});
  }
  const QueryResult expected = surface.query(doubles);
  EXPECT_TRUE(sameBits(surface.query(floats).distance, expected.distance));
  const PointsView view(particles[0].position, particles.size(), sizeof(Particle));
  EXPECT_TRUE(sameBits(surface.query(view).distance, expected.distance));
}

TEST(Surface, ComputesOnlyWhatIsAskedFor) {
  const Mesh mesh = shapes::sphere(1.0, 2);
  const Surface surface(mesh);
  QueryResult result = surface.query(uniformPoints(mesh, 10), kEverything);
  surface.query(uniformPoints(mesh, 7), {.distance = false, .triangle = true}, result);
  EXPECT_EQ(result.triangle.size(), 7u);
  EXPECT_TRUE(result.distance.empty() && result.closest.empty() && result.barycentric.empty() &&
              result.direction.empty() && result.winding.empty() && result.confidence.empty());
  EXPECT_TRUE(surface.query(std::vector<glm::vec3>{}).distance.empty());
}

TEST(Surface, StopsAtTheLargestDistance) {
  const Mesh mesh = shapes::sphere(1.0, 4);
  const Surface surface(mesh);
  const std::vector<glm::dvec3> points = uniformPoints(mesh, 5000, 0.5);
  const QueryResult exact = surface.query(points, kEverything);
  QueryOptions options = kEverything;
  options.maxDistance = 0.3;
  const QueryResult result = surface.query(points, options);
  size_t beyond = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    if (std::abs(exact.distance[i]) <= 0.3) {
      ASSERT_TRUE(sameAt(exact, i, result, i)) << i;
      continue;
    }
    ++beyond;
    ASSERT_EQ(result.distance[i], std::copysign(0.3, exact.distance[i])) << i;
    ASSERT_EQ(result.triangle[i], kNoTriangle);
    ASSERT_TRUE(std::isnan(result.closest[i].x) && std::isnan(result.barycentric[i].y) &&
                std::isnan(result.direction[i].z));
    ASSERT_EQ(result.winding[i], exact.winding[i]);
  }
  EXPECT_GT(beyond, 1000u);
}

TEST(Surface, KeepsItsSignsWithAnyLargestDistance) {
  for (const Mesh& mesh : {shapes::torus(1.0, 0.3, 40, 20), withHoles(shapes::sphere(1.0, 4), 5, 0.08, 2)}) {
    const Surface surface(mesh);
    // Dense clusters beside the surface: whole blocks of the search are beyond the largest distance.
    std::vector<glm::dvec3> points;
    for (const glm::dvec3& centre : nearPoints(mesh, 30, 0.01))
      for (const glm::dvec3& p : uniformPoints(mesh, 200)) points.push_back(centre + 1e-4 * p);
    const QueryResult exact = surface.query(points);
    for (const double most : {1e-12, 1e-4, 1e-3}) {
      const QueryResult result = surface.query(points, {.maxDistance = most});
      for (size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(std::signbit(result.distance[i]), std::signbit(exact.distance[i])) << i << ", " << most;
        if (i % 50 != 0) continue;
        const QueryResult one = surface.query(std::vector{points[i]}, {.maxDistance = most});
        ASSERT_EQ(one.distance[0], result.distance[i]) << i;
      }
    }
  }
}

TEST(Surface, TellsWhatAFieldOfAnUnsignedSurfaceTurned) {
  const Mesh mesh = withFlippedFaces(shapes::sphere(1.0, 3), 0.3, 1);
  const Surface surface(mesh, {.sign = SignMode::None});
  const Grid grid = fitGrid(mesh, {.resolution = 32});
  const std::vector<uint32_t> turned = generate(mesh, grid, {}, {.device = "cpu"}).stats.turnedFaces;
  EXPECT_FALSE(turned.empty());
  EXPECT_EQ(surface.generate(grid, {}, {.device = "cpu"}).stats.turnedFaces, turned);
}

TEST(Surface, GivesNaNWhereThePointIsNotFinite) {
  const Surface surface(shapes::sphere(1.0, 2));
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const std::vector<glm::dvec3> points{{nan, 0, 0}, {0, 0, infinity}, {2, 0, 0}};
  const QueryResult result = surface.query(points, kEverything);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(std::isnan(result.distance[i]) && std::isnan(result.closest[i].x) &&
                std::isnan(result.winding[i]) && std::isnan(result.barycentric[i].x) &&
                std::isnan(result.direction[i].x) && std::isnan(result.confidence[i]));
    EXPECT_EQ(result.triangle[i], kNoTriangle);
  }
  EXPECT_NEAR(result.distance[2], 1.0, 0.02);
}

TEST(Surface, KnowsNoSignOnRequest) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Surface surface(mesh, {.sign = SignMode::None});
  EXPECT_LT(surface.bytes(), Surface(mesh).bytes());
  const std::vector<glm::dvec3> points{{0, 0, 0}};
  EXPECT_GT(surface.query(points).distance[0], 0.9);
  for (const QueryOptions& options : {QueryOptions{.winding = true}, QueryOptions{.confidence = true}}) {
    EXPECT_NE(messageOf(ErrorCode::Usage, [&] { surface.query(points, options); }).find("without a sign"),
              std::string::npos);
  }
}

TEST(Surface, RefusesBadInput) {
  const Mesh mesh = shapes::sphere(1.0, 2);
  EXPECT_EQ(codeOf([&] { Surface(Mesh{}); }), ErrorCode::Input);
  EXPECT_EQ(codeOf([&] { Surface(mesh, {}, {.threads = -1}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { Surface(mesh, {.threshold = -0.1}); }), ErrorCode::Usage);
  for (const SignMode sign : {SignMode::Paths, SignMode::Evolution, SignMode::Rays, SignMode::Ray})
    EXPECT_EQ(codeOf([&] { Surface(mesh, {.sign = sign}); }), ErrorCode::Usage) << int(sign);
  EXPECT_EQ(codeOf([&] { Surface(mesh, {}, {.memoryLimit = 1000}); }), ErrorCode::Memory);
  EXPECT_EQ(codeOf([&] { Surface(mesh, {}, {.progress = [](std::string_view, double) { return false; }}); }),
            ErrorCode::Cancelled);
  const Surface surface(mesh);
  const std::vector<glm::dvec3> points{{0, 0, 0}};
  EXPECT_EQ(codeOf([&] { surface.query(points, {.maxDistance = 0.0}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { surface.query(points, {}, {.threads = -1}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] {
              surface.query(points, {}, {.progress = [](std::string_view, double) { return false; }});
            }),
            ErrorCode::Cancelled);
}

TEST(Surface, ReportsTheShareOfItsPoints) {
  const Mesh mesh = shapes::sphere(1.0, 2);
  const Surface surface(mesh);
  std::vector<double> shares;
  surface.query(uniformPoints(mesh, 20000), {},
                {.threads = 1, .progress = [&](std::string_view, double done) {
                   shares.push_back(done);
                   return true;
                 }});
  EXPECT_TRUE(std::ranges::is_sorted(shares));
  EXPECT_TRUE(std::ranges::any_of(shares, [](double share) { return share > 0.1 && share < 0.9; }));
  EXPECT_EQ(shares.back(), 1.0);
}

TEST(Surface, GivesTheSameIfItIsCompact) {
  const Mesh large = shapes::sphere(1.0, 5);  // More leaves than a thread keeps.
  const Mesh ball = shapes::sphere(1.0, 4);
  for (const Mesh& mesh : {large, withHoles(ball, 5, 0.2, 1), withFlippedFaces(ball, 0.3, 1),
                           withDoubledFaces(shapes::sphere(1.0, 3), 1.0, 2), shapes::soup(200, 1)})
    for (const SignMode sign : {SignMode::Harmonic, SignMode::None}) {
      SCOPED_TRACE(testing::Message() << mesh.triangles.size() << " triangles, " << name(sign));
      const Surface surface(mesh, {.sign = sign}), compact(mesh, {.sign = sign, .compact = true});
      EXPECT_LT(compact.bytes() + 30 * mesh.triangles.size(), surface.bytes());
      EXPECT_EQ(compact.stats().turnedFaces, surface.stats().turnedFaces);
      const bool isSigned = sign != SignMode::None;
      QueryOptions everything = kEverything;
      everything.winding = everything.confidence = isSigned;
      for (const size_t count : {10, 1000}) {  // Each by itself, and in blocks.
        const std::vector<glm::dvec3> points = uniformPoints(mesh, count, 0.5),
                                      near = nearPoints(mesh, count, 1e-3);
        for (const std::vector<glm::dvec3>& some : {points, near}) {
          const QueryResult expected = surface.query(some, everything),
                            found = compact.query(some, everything);
          EXPECT_TRUE(sameBits(found.distance, expected.distance));
          EXPECT_TRUE(sameBits(found.closest, expected.closest));
          EXPECT_TRUE(sameBits(found.triangle, expected.triangle));
          EXPECT_TRUE(sameBits(found.direction, expected.direction));
          EXPECT_TRUE(sameBits(found.winding, expected.winding));
          EXPECT_TRUE(sameBits(found.confidence, expected.confidence));
        }
      }
      const BandOptions band{.triangle = true, .winding = isSigned};
      const Grid grid = fitGrid(mesh, {.resolution = 40});
      const Field expected = surface.generateBand(grid, band), found = compact.generateBand(grid, band);
      EXPECT_TRUE(sameBits(found.distance, expected.distance));
      EXPECT_TRUE(sameBits(found.triangle, expected.triangle));
      EXPECT_TRUE(sameBits(found.winding, expected.winding));
    }
}

TEST(Surface, NeedsNoDipolesForFewRimsIfItIsCompact) {
  const auto saved = [](int triangles) {
    const Mesh soup = shapes::soup(triangles, 1);  // Each triangle has three rims.
    const SurfaceOptions asGiven{.orientation = Orientation::Keep};
    SurfaceOptions compact = asGiven;
    compact.compact = true;
    return Surface(soup, asGiven).bytes() - Surface(soup, compact).bytes();
  };
  EXPECT_GT(saved(341), saved(342) + 1000);
}

TEST(Surface, IsBestCompactWithFewSamplesPerTriangle) {
  const Grid grid{.dims = {10, 20, 100}};
  EXPECT_FALSE(isCompactBetter(grid, 19));
  EXPECT_FALSE(isCompactBetter(grid, 20));
  EXPECT_TRUE(isCompactBetter(grid, 21));
}

TEST(Surface, MeasuresTheSameThicknessIfItIsCompact) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 40, 20);
  std::vector<FacePoint> points;
  for (uint32_t face = 0; face < mesh.triangles.size(); face += 7)
    points.push_back({.position = mesh.position(mesh.triangles[face].x), .triangle = face});
  const std::vector<Thickness> expected = Surface(mesh).thickness(points),
                               found = Surface(mesh, {.compact = true}).thickness(points);
  EXPECT_EQ(found, expected);
}

TEST(Surface, KeepsAMeshThatIsGivenAway) {
  const Mesh mesh = withHoles(shapes::sphere(1.0, 4), 3, 0.1, 1);
  const std::vector<glm::dvec3> points = uniformPoints(mesh, 100);
  const QueryResult expected = Surface(mesh).query(points);
  Mesh given = mesh;
  const glm::vec3* const vertices = given.vertices.data();
  const Surface surface(std::move(given));
  EXPECT_EQ(surface.mesh().vertices, vertices) << "no copy";
  EXPECT_TRUE(sameBits(surface.query(points).distance, expected.distance));
  Mesh bad = mesh;
  bad.triangles[3].y = 1u << 30;
  EXPECT_EQ(codeOf([&] { Surface refused(std::move(bad)); }), ErrorCode::Input);
}

TEST(Surface, KeepsItsMeshWhenMoved) {
  Mesh mesh = withFlippedFaces(shapes::sphere(1.0, 3), 0.3, 1);
  Surface first(mesh);
  const std::vector<glm::dvec3> points = uniformPoints(mesh, 100);
  const QueryResult expected = first.query(points);
  mesh = {};
  const Surface second = std::move(first);
  EXPECT_TRUE(sameBits(second.query(points).distance, expected.distance));
  EXPECT_EQ(second.mesh().triangleCount, shapes::sphere(1.0, 3).triangles.size());
}

}  // namespace
}  // namespace raymap
