#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "any_threads.h"
#include "error_code.h"
#include "measure/random_numbers.h"
#include "reference.h"
#include "shapes.h"

namespace raymap {
namespace {

/// Returns the mesh with its first faces reversed.
Mesh withReversed(Mesh mesh, size_t faces) {
  for (size_t f = 0; f < faces; ++f) std::swap(mesh.triangles[f].y, mesh.triangles[f].z);
  return mesh;
}

TEST(RandomNumbers, AreThoseOfNumPy) {
  // numpy.random.PCG64(seed).random_raw(3) >> 11
  const std::pair<uint64_t, std::array<uint64_t, 3>> known[] = {
      {0, {0x1461fd79fb3850, 0x8a217bf105b3a, 0x14fa7b529d9bd}},
      {5, {0x19c2957dd5771c, 0x19daa6a4a0b993, 0x107d8c07ef00d5}},
      {(1ull << 32) + 5, {0x18c647d8643bd7, 0xf10290438e740, 0x1644a6db1c1d82}},
      {(1ull << 63) + 11, {0x56ff480115fcd, 0x19d87925cdd9e5, 0x87041216450a3}}};
  for (const auto& [seed, numbers] : known) {
    RandomNumbers random(seed);
    for (const uint64_t number : numbers) EXPECT_EQ(random.uniform(), double(number) * 0x1p-53) << seed;
  }
}

TEST(RandomNumbers, AreNormal) {
  std::vector<double> numbers = RandomNumbers(5).normals(50'001);
  ASSERT_EQ(numbers.size(), 50'001u);
  std::ranges::sort(numbers);
  double farthest = 0.0;  // Kolmogorov and Smirnov
  for (size_t i = 0; i < numbers.size(); ++i) {
    const double expected = 0.5 * std::erfc(-numbers[i] / std::numbers::sqrt2);
    farthest = std::max(farthest, std::abs(expected - (double(i) + 0.5) / double(numbers.size())));
  }
  EXPECT_LT(farthest, 0.007);
}

TEST(RandomNumbers, HaveALogarithm) {
  std::vector<double> arguments = RandomNumbers(1).uniforms(1000);
  for (int k = 1; k < 100; ++k) arguments.push_back(std::ldexp(1.0, -k));
  arguments.insert(arguments.end(), {std::sqrt(0.5), std::nextafter(std::sqrt(0.5), 0.0), 1 - 0x1p-53, 1.0});
  for (const double x : arguments)
    EXPECT_NEAR(portableLog(x), std::log(x), 1e-14 * std::abs(std::log(x)) + 1e-16) << x;
}

TEST(SamplePoints, LieOnFacesByTheirArea) {
  const Mesh mesh = shapes::torus(2.0, 0.7, 20, 12);
  const size_t count = 48'000;
  const PointSamples samples =
      samplePoints(Surface(mesh), {.count = count, .surfaceShare = 1.0, .nearShare = 0.0, .seed = 3});
  std::vector<double> area, found(mesh.triangles.size());
  double total = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.position(t.x),
                     normal = glm::cross(mesh.position(t.y) - a, mesh.position(t.z) - a);
    total += area.emplace_back(0.5 * glm::length(normal));
  }
  const QueryResult closest = Surface(mesh).query(samples.points, {.triangle = true});
  for (size_t i = 0; i < count; ++i) {
    const glm::uvec3 t = mesh.triangles[closest.triangle[i]];
    const glm::dvec3 a = mesh.position(t.x), b = mesh.position(t.y), c = mesh.position(t.z);
    ASSERT_LT(reference::triangleDistance(samples.points[i], a, b, c), 1e-6);
    ASSERT_EQ(samples.distance[i], 0.0);
    ASSERT_GT(glm::dot(samples.gradient[i], glm::normalize(glm::cross(b - a, c - a))), 0.99);
    ++found[closest.triangle[i]];
  }
  double chi2 = 0.0;
  for (size_t f = 0; f < area.size(); ++f) {
    const double expected = double(count) * area[f] / total;
    chi2 += (found[f] - expected) * (found[f] - expected) / expected;
  }
  const auto freedom = double(area.size() - 1);  // Within four standard deviations of its mean.
  EXPECT_NEAR(chi2, freedom, 4.0 * std::sqrt(2.0 * freedom));
}

TEST(SamplePoints, SpreadEvenlyWithinAFace) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const size_t count = 40'000;
  const PointSamples samples =
      samplePoints(Surface(mesh), {.count = count, .surfaceShare = 1.0, .nearShare = 0.0});
  std::array<double, 4> parts{};  // The middle triangle, then those at the corners.
  for (const glm::dvec3& p : samples.points) ++parts[p.x > 0.5 ? 1 : p.y > 0.5 ? 2 : p.x + p.y < 0.5 ? 3 : 0];
  for (const double part : parts) EXPECT_NEAR(part, count / 4.0, 4.0 * std::sqrt(count * 3.0 / 16.0));
}

TEST(SamplePoints, HaveTheDistancesAndSignsOfBruteForce) {
  const Mesh mesh = shapes::torus(2.0, 0.7, 16, 10);
  const PointSamples samples =
      samplePoints(Surface(mesh), {.count = 2000, .nearShare = 0.6, .sigmas = {0.02, 0.2}, .seed = 7});
  size_t inside = 0;
  for (size_t i = 0; i < samples.points.size(); ++i) {
    const glm::dvec3& p = samples.points[i];
    EXPECT_EQ(p, glm::dvec3(glm::vec3(p)));
    EXPECT_NEAR(std::abs(samples.distance[i]), reference::distance(mesh, p), 1e-6);
    EXPECT_EQ(samples.distance[i]<0.0, reference::windingNumber(mesh, p)> 0.5) << i;
    EXPECT_NEAR(glm::length(samples.gradient[i]), 1.0, 1e-12);
    const glm::dvec3 onSurface = p - samples.distance[i] * samples.gradient[i];
    EXPECT_LT(reference::distance(mesh, onSurface), 1e-5);
    inside += samples.distance[i] < 0.0 ? 1 : 0;
  }
  EXPECT_GT(inside, 200u);
  EXPECT_LT(inside, 1800u);
}

TEST(SamplePoints, HaveTheDeviationsAndFillTheBall) {
  // The faces of a box of this size are planes to points that lie within four deviations.
  const Mesh mesh = shapes::box({-100, -100, -0.01}, {100, 100, 0.01});
  const double radius = std::sqrt(2e4 + 1e-4);
  const size_t count = 40'000;
  const PointSamples samples =
      samplePoints(Surface(mesh), {.count = count, .nearShare = 0.5, .sigmas = {0.001, 0.01}});
  const auto deviation = [&](size_t begin, size_t end) {
    double sum = 0.0;
    for (size_t i = begin; i < end; ++i) sum += samples.points[i].z * samples.points[i].z;
    return std::sqrt(sum / double(end - begin));
  };
  EXPECT_NEAR(deviation(0, count / 4), 0.001 * radius, 0.03 * 0.001 * radius);
  EXPECT_NEAR(deviation(count / 4, count / 2), 0.01 * radius, 0.03 * 0.01 * radius);
  for (const double share : {0.5, 0.8, 1.0}) {
    const auto within =
        std::count_if(samples.points.begin() + count / 2, samples.points.end(),
                      [&](const glm::dvec3& p) { return glm::length(p) <= share * radius * 1.000001; });
    const double expected = std::pow(share, 3) * count / 2.0;
    EXPECT_NEAR(double(within), expected, 4.0 * std::sqrt(count / 8.0)) << share;
  }
}

TEST(SamplePoints, HaveOutwardNormalsHoweverFacesAreWound) {
  const Mesh ball = shapes::sphere(1.0, 3);
  const Mesh other = shapes::inverted(ball), both = shapes::joined(ball, other);
  for (const auto& [mesh, orientation] :
       {std::pair(ball, Orientation::Keep), std::pair(other, Orientation::Auto),
        std::pair(other, Orientation::Keep), std::pair(both, Orientation::Auto),
        std::pair(withReversed(ball, 40), Orientation::Repair)}) {
    const Surface surface(mesh, {.orientation = orientation});
    const PointSamples samples =
        samplePoints(surface, {.count = 3000, .surfaceShare = 1.0, .nearShare = 0.0});
    for (size_t i = 0; i < samples.points.size(); ++i)
      ASSERT_GT(glm::dot(samples.gradient[i], samples.points[i]), 0.9) << i;
  }
}

TEST(SamplePoints, PointToTheLowerWindingNumberWhereBothSidesAreInside) {
  const Mesh mesh = shapes::joined(shapes::sphere(1.0, 3), shapes::sphere(0.5, 3));
  for (const size_t turned : {size_t{0}, mesh.triangles.size()}) {
    const Surface surface(withReversed(mesh, turned), {.orientation = Orientation::Keep});
    const PointSamples samples =
        samplePoints(surface, {.count = 3000, .surfaceShare = 1.0, .nearShare = 0.0});
    for (size_t i = 0; i < samples.points.size(); ++i)
      ASSERT_GT(glm::dot(samples.gradient[i], samples.points[i]), 0.4) << i;
  }
}

TEST(SamplePoints, FollowTheFacesOfASheetAsTheSurfaceTurnedThem) {
  constexpr uint32_t kSide = 8, kRow = kSide + 1;
  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> faces;
  for (uint32_t v = 0; v < kRow * kRow; ++v) positions.emplace_back(v % kRow, v / kRow, 0);
  for (uint32_t v = 0; v < kSide * kRow; ++v)
    if (v % kRow < kSide) faces.insert(faces.end(), {{v, v + 1, v + kRow + 1}, {v, v + kRow + 1, v + kRow}});
  const Surface surface(withReversed(makeMesh(positions, faces), 3), {.orientation = Orientation::Repair});
  ASSERT_EQ(surface.stats().turnedFaces.size(), 3u);
  const PointSamples samples = samplePoints(surface, {.count = 3000, .surfaceShare = 1.0, .nearShare = 0.0});
  for (const glm::dvec3& normal : samples.gradient) ASSERT_EQ(normal, glm::dvec3(0, 0, 1));
}

TEST(SamplePoints, LeaveOutTheOtherSidesOfDoubleSidedFaces) {
  const Mesh ball = shapes::sphere(1.0, 3), far = shapes::sphere(1.0, 3, {3, 0, 0});
  const Surface surface(shapes::joined(shapes::joined(ball, shapes::inverted(ball)), far));
  ASSERT_EQ(surface.stats().leftOutFaces.size(), ball.triangles.size());
  for (const double share : {0.0, 1.0}) {
    const PointSamples samples =
        samplePoints(surface, {.count = 20'000, .surfaceShare = share, .nearShare = 1.0 - share});
    const auto here = std::ranges::count_if(samples.points, [](const glm::dvec3& p) { return p.x < 1.5; });
    EXPECT_NEAR(double(here), 10'000.0, 4.0 * std::sqrt(5000.0));
  }
}

TEST(SamplePoints, AreTheSameForAnyThreadsAndOthersForAnotherSeed) {
  const Surface surface(shapes::torus(2.0, 0.7, 40, 24));
  SamplePointsOptions options{.count = 200'000, .surfaceShare = 0.05};
  const PointSamples one = samplePoints(surface, options, {.threads = 1});
  for (const int threads : {2, 3}) {
    const PointSamples other = samplePoints(surface, options, {.threads = threads});
    EXPECT_TRUE(sameBits(one.points, other.points));
    EXPECT_TRUE(sameBits(one.distance, other.distance));
    EXPECT_TRUE(sameBits(one.gradient, other.gradient));
  }
  options.seed = 1;
  const PointSamples other = samplePoints(surface, options);
  for (size_t i = 0; i < one.points.size(); ++i) ASSERT_NE(one.points[i], other.points[i]);
}

TEST(SamplePoints, FitTheUnitSphereIfAsked) {
  const Mesh mesh = shapes::sphere(3.0, 3, {10, -20, 30});
  const PointSamples samples =
      samplePoints(Surface(mesh), {.count = 1000, .nearShare = 0.3, .sigmas = {0.01}, .normalize = true});
  EXPECT_LT(glm::distance(samples.centre, glm::dvec3(10, -20, 30)), 1e-5);
  EXPECT_NEAR(samples.scale, 1.0 / 3.0, 1e-6);
  for (size_t i = 0; i < samples.points.size(); ++i) {
    const glm::dvec3 given = samples.points[i] / samples.scale + samples.centre;
    EXPECT_NEAR(std::abs(samples.distance[i]), reference::distance(mesh, given) * samples.scale, 1e-6);
    EXPECT_TRUE(i < 300 || glm::length(samples.points[i]) <= 1.000001);
  }
}

TEST(SamplePoints, KeepDoublePrecisionWhereStepsOfSingleAreLong) {
  const double step = 0x1p-19;  // Single precision from 16 to 32.
  for (const auto& [far, sigma, isSingle] :
       {std::tuple(30.9, 16 * step, true), std::tuple(31.1, 16 * step, false),
        std::tuple(30.9, 15.9 * step, false), std::tuple(0.0, 0.0, false)}) {
    const PointSamples samples =
        samplePoints(Surface(shapes::sphere(1.0, 3, {0, -far, 0})), {.count = 200, .sigmas = {0.5, sigma}});
    const SampleRows inside = sampleRows(samples, true), outside = sampleRows(samples, false);
    EXPECT_EQ(std::holds_alternative<std::vector<glm::vec4>>(inside), isSingle) << far;
    const auto sizeOf = [](const SampleRows& rows) {
      return std::visit([](const auto& values) { return values.size(); }, rows);
    };
    const auto negative = size_t(std::ranges::count_if(samples.distance, [](double d) { return d < 0.0; }));
    EXPECT_EQ(sizeOf(inside), negative);
    EXPECT_EQ(sizeOf(outside), samples.points.size() - negative);
    if (!isSingle) continue;
    const glm::vec4 first = std::get<0>(outside).front();
    const auto at = size_t(std::ranges::find_if(samples.distance, [](double d) { return d >= 0.0; }) -
                           samples.distance.begin());
    EXPECT_EQ(glm::dvec3(first), samples.points[at]);
    EXPECT_EQ(first.w, float(samples.distance[at]));
  }
}

TEST(SamplePoints, AreCounted) {
  using Counts = std::vector<size_t>;
  EXPECT_EQ(samplePointCounts({.count = 11, .surfaceShare = 0.3, .nearShare = 0.5, .sigmas = {1, 2, 3}}),
            Counts({3, 2, 2, 2, 2}));
  EXPECT_EQ(samplePointCounts({.count = 10, .sigmas = {0.5}}), Counts({0, 9, 1}));
  EXPECT_EQ(samplePointCounts({.count = 50}), Counts({0, 24, 23, 3}));
  const Surface surface(shapes::sphere(1.0, 2));
  EXPECT_TRUE(samplePoints(surface, {.count = 0}).points.empty());
  const auto refuses = [](const SamplePointsOptions& options) {
    return codeOf([&] { samplePointCounts(options); }) == ErrorCode::Usage;
  };
  EXPECT_TRUE(refuses({.nearShare = 1.1}));
  EXPECT_TRUE(refuses({.nearShare = NAN}));
  EXPECT_TRUE(refuses({.surfaceShare = -0.1}));
  EXPECT_TRUE(refuses({.surfaceShare = 0.3, .nearShare = 0.8}));
  EXPECT_TRUE(refuses({.sigmas = {}}));
  EXPECT_TRUE(refuses({.sigmas = {0.1, -1.0}}));
  EXPECT_TRUE(refuses({.sigmas = {INFINITY}}));
}

TEST(SamplePoints, NeedASignAndAnArea) {
  const Surface unsignedSurface(shapes::sphere(1.0, 2), {.sign = SignMode::None});
  EXPECT_FALSE(unsignedSurface.isSigned());
  EXPECT_EQ(codeOf([&] { samplePoints(unsignedSurface); }), ErrorCode::Usage);
  Mesh line;
  line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.triangles = {{0, 1, 2}};
  EXPECT_EQ(codeOf([&] { samplePoints(Surface(line)); }), ErrorCode::Input);
}

/// In a region of any size, of a mesh of any size.
TEST(SamplePoints, LieInTheRegionOfTheOptions) {
  const Surface surface(shapes::torus(2.0, 0.7, 20, 12));
  for (const bool inCube : {false, true}) {
    const PointSamples samples = samplePoints(
        surface, {.count = 4000, .nearShare = 0.0, .unit = 4.0, .inCube = inCube, .radius = 6.0});
    EXPECT_EQ(samples.scale, 0.25);
    size_t close = 0;
    double farthest = 0.0;
    for (size_t i = 0; i < samples.points.size(); ++i) {
      const glm::dvec3 point = samples.points[i], size = glm::abs(point);
      const double away = inCube ? std::max({size.x, size.y, size.z}) : glm::length(point);
      farthest = std::max(farthest, away);
      close += away < 0.75 ? 1 : 0;  // An eighth of the region
      const glm::dvec3 position = point / samples.scale + samples.centre;
      const QueryResult found = surface.query(std::span(&position, 1));
      EXPECT_NEAR(samples.distance[i], found.distance[0] * samples.scale, 1e-7);
    }
    EXPECT_GT(farthest, 1.48);
    EXPECT_LE(farthest, 1.5 + 1e-6);
    EXPECT_NEAR(double(close) / 4000.0, 0.125, 0.02);
  }
  EXPECT_EQ(codeOf([&] { samplePoints(surface, {.unit = -1.0}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { samplePoints(surface, {.radius = INFINITY}); }), ErrorCode::Usage);
}

}  // namespace
}  // namespace raymap
