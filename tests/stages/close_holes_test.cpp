#include "cpu/sign/close_holes.h"

#include <gtest/gtest.h>
#include <raymap/error.h>

#include <map>
#include <numbers>

#include "any_threads.h"
#include "shapes.h"
#include "sign_scene.h"
#include "steepest.h"

namespace raymap {

using namespace cpu;
namespace {

/// A mesh with a flat hole, and the same with a lid on it. The lid is where the winding number of the first
/// is 1/2, because the hole fills half the view from every point in its plane.
struct Holed {
  Mesh open, closed;
};

/// Returns a sphere of radius 1 without the cap within `degrees` of its axis.
Holed openSphere(double degrees, int rings = 64, int segments = 128) {
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  const double first = degrees * std::numbers::pi / 180.0;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.3, 0.5, 0.8));
  const glm::dvec3 u = glm::normalize(glm::cross(axis, glm::dvec3(1, 0, 0))), v = glm::cross(axis, u);
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      const double polar = first + (std::numbers::pi - first) * r / rings;
      const double turn = 2.0 * std::numbers::pi * s / segments;
      p.push_back(std::cos(polar) * axis + std::sin(polar) * (std::cos(turn) * u + std::sin(turn) * v));
    }
  p.push_back(-axis);
  const auto at = [&](int r, int s) {
    return r == rings ? uint32_t(rings * segments) : uint32_t(r * segments + s % segments);
  };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      t.emplace_back(at(r, s), at(r + 1, s), at(r, s + 1));
      if (r + 1 < rings) t.emplace_back(at(r + 1, s), at(r + 1, s + 1), at(r, s + 1));
    }
  Holed holed{.open = makeMesh(p, t), .closed = {}};
  p.push_back(std::cos(first) * axis);
  for (int s = 0; s < segments; ++s) t.emplace_back(uint32_t(p.size() - 1), at(0, s), at(0, s + 1));
  holed.closed = makeMesh(p, t);
  return holed;
}

Holed openBox() {
  Holed holed{.open = shapes::box({0, 0, 0}, {1, 1.3, 0.8}), .closed = {}};
  holed.closed = holed.open;
  holed.open.triangles.erase(holed.open.triangles.begin() + 2, holed.open.triangles.begin() + 4);
  return holed;
}

FieldOptions closing(FieldOptions options = {}) {
  options.closeHoles = true;
  return options;
}

/// Returns the largest error in samples.
double largestError(const Field& field, const Field& truth) {
  double largest = 0.0;
  for (size_t s = 0; s < truth.distance.size(); ++s)
    largest = std::max(largest, std::abs(double(field.distance[s]) - double(truth.distance[s])));
  return largest / truth.grid.spacing;
}

TEST(CloseHoles, LeavesClosedMeshesAlone) {
  for (const Mesh& mesh :
       {shapes::sphere(1.0, 3), shapes::torus(1.0, 0.4, 30, 15),
        shapes::joined(shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3}))}) {
    const Grid grid = fitGrid(mesh, {.resolution = 30});
    FieldOptions options = closing();
    options.winding = options.confidence = options.triangle = true;
    Generator generator;
    Field closed, plain;
    const Stats stats = generator.generate(mesh, grid, options, closed);
    EXPECT_EQ(stats.patchTriangles, 0u);
    EXPECT_EQ(stats.patchArea, 0.0);
    options.closeHoles = false;
    generator.generate(mesh, grid, options, plain);
    EXPECT_TRUE(sameBits(closed.distance, plain.distance));
    EXPECT_TRUE(sameBits(closed.triangle, plain.triangle));
    EXPECT_TRUE(sameBits(closed.winding, plain.winding));
    EXPECT_TRUE(sameBits(closed.confidence, plain.confidence));
  }
}

TEST(CloseHoles, PutsAFlatLidOnAFlatHole) {
  for (const double degrees : {10.0, 30.0, 60.0, 90.0, 120.0}) {
    SCOPED_TRACE(degrees);
    const Holed holed = openSphere(degrees);
    const Grid grid = fitGrid(holed.closed, {.resolution = 48});
    const Field field = generate(holed.open, grid, closing()).field,
                truth = generate(holed.closed, grid).field;
    EXPECT_LT(largestError(field, truth), 0.2);
    EXPECT_LT(steepest(field), 1.001);
  }
}

TEST(CloseHoles, ClosesABox) {
  const Holed holed = openBox();
  for (const int resolution : {20, 33}) {
    const Grid grid = fitGrid(holed.closed, {.resolution = resolution});
    const Field field = generate(holed.open, grid, closing()).field,
                truth = generate(holed.closed, grid).field;
    EXPECT_LT(largestError(field, truth), 0.1);
    EXPECT_LT(steepest(field), 1.05);
  }
}

TEST(CloseHoles, SeesDoubleSidedLids) {
  const Holed holed = openBox();
  Mesh covered = holed.closed;  // With seven more layers of its lid, half of them facing inwards.
  for (const size_t face : {2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3}) {
    const glm::uvec3 t = holed.closed.triangles[face];
    const bool isInwards = covered.triangles.size() % 4 < 2;
    covered.triangles.push_back(isInwards ? glm::uvec3(t.x, t.z, t.y) : t);
  }
  const Grid grid = fitGrid(holed.closed, {.resolution = 33});
  const FieldOptions options = closing({.orientation = Orientation::Keep});
  EXPECT_LT(0u, generate(holed.open, grid, options).stats.patchTriangles);
  EXPECT_EQ(generate(covered, grid, options).stats.patchTriangles, 0u);
}

TEST(CloseHoles, MeasuresWhatItAdds) {
  const Holed holed = openSphere(30.0);
  const Stats stats = generate(holed.open, fitGrid(holed.closed, {.resolution = 64}), closing()).stats;
  EXPECT_NEAR(stats.patchArea, std::numbers::pi * 0.25, 0.01);
  EXPECT_GT(stats.patchTriangles, 500u);
}

TEST(CloseHoles, KeepsSignsAndAddsSurfaceOnly) {
  const Holed holed = openSphere(40.0);
  const Grid grid = fitGrid(holed.closed, {.resolution = 32});
  FieldOptions options = closing();
  options.triangle = true;
  const Field closed = generate(holed.open, grid, options).field;
  options.closeHoles = false;
  const Field plain = generate(holed.open, grid, options).field;
  size_t ofPatch = 0;
  for (size_t s = 0; s < plain.distance.size(); ++s) {
    ASSERT_EQ(std::signbit(closed.distance[s]), std::signbit(plain.distance[s])) << s;
    ASSERT_LE(std::abs(closed.distance[s]), std::abs(plain.distance[s])) << s;
    if (closed.triangle[s] == kNoTriangle) {
      ++ofPatch;
      continue;
    }
    ASSERT_EQ(closed.distance[s], plain.distance[s]) << s;
    ASSERT_EQ(closed.triangle[s], plain.triangle[s]) << s;
  }
  EXPECT_GT(ofPatch, plain.distance.size() / 10);
}

TEST(CloseHoles, WorksWithEveryDistanceAndSign) {
  const Holed holed = openSphere(40.0);
  const Grid grid = fitGrid(holed.closed, {.resolution = 32});
  for (const DistanceMode distance :
       {DistanceMode::Exact, DistanceMode::Neighbours, DistanceMode::Cell, DistanceMode::Raster})
    for (const SignMode sign : {SignMode::Harmonic, SignMode::Paths, SignMode::Evolution, SignMode::Rays}) {
      SCOPED_TRACE(testing::Message() << "distance " << int(distance) << ", sign " << int(sign));
      FieldOptions options = closing();
      options.distance = distance;
      options.sign = sign;
      const Field field = generate(holed.open, grid, options).field;
      options.closeHoles = false;
      const Field truth = generate(holed.closed, grid, options).field;
      // The paper's distances are not exact even where the mesh is whole.
      EXPECT_LT(steepest(field), std::max(1.2, 1.05 * steepest(truth)));
      if (sign == SignMode::Harmonic) {
        EXPECT_LT(largestError(field, truth), 0.9);
      }
    }
}

TEST(CloseHoles, KeepsToTheBand) {
  const Holed holed = openSphere(40.0);
  const Grid grid = fitGrid(holed.closed, {.resolution = 40});
  FieldOptions options = closing();
  options.band = 3.0;
  const Field field = generate(holed.open, grid, options).field;
  options.closeHoles = false;
  EXPECT_LT(largestError(field, generate(holed.closed, grid, options).field), 0.1);
}

TEST(CloseHoles, FollowsTheThreshold) {
  const Holed holed = openSphere(40.0);
  const Grid grid = fitGrid(holed.closed, {.resolution = 40});
  for (const double threshold : {0.3, 0.7}) {
    FieldOptions options = closing();
    options.threshold = threshold;
    EXPECT_LT(steepest(generate(holed.open, grid, options).field), 1.05) << threshold;
  }
}

TEST(CloseHoles, AcceptsMeshesThatBoundNoSolid) {
  for (const Mesh& mesh : {shapes::soup(300, 2), openSphere(150.0).open}) {
    const Grid whole = fitGrid(mesh, {.resolution = 24});
    Grid part = whole;
    part.dims /= 2;
    for (const Grid& grid : {whole, part}) {
      const Field field = generate(mesh, grid, closing()).field;
      for (const float d : field.distance) ASSERT_TRUE(std::isfinite(d));
    }
    Grid one = whole;
    one.dims = {1, 1, 1};
    EXPECT_EQ(generate(mesh, one, closing()).field.distance.size(), 1u);
  }
}

TEST(CloseHoles, GivesTheSameForAnyThreads) {
  Mesh torn = shapes::torus(1.0, 0.4, 30, 16);
  torn.triangles.erase(torn.triangles.begin() + 40, torn.triangles.begin() + 120);
  const Mesh mesh = shapes::joined(torn, shapes::soup(20, 5));
  expectSameForAnyThreads(mesh, fitGrid(mesh, {.resolution = 24}), closing(), {2, 4});
}

TEST(CloseHoles, RefusesPatchesBeyondTheMemory) {
  EXPECT_NO_THROW(requirePatch(1000, 100, 1'000'000));
  for (const auto& [edges, left] : std::initializer_list<std::pair<size_t, size_t>>{
           {1000, 200'000}, {1, 0}, {SIZE_MAX / 2, SIZE_MAX}, {size_t{1} << 31, SIZE_MAX}}) {
    try {
      requirePatch(edges, 100, left);
      ADD_FAILURE() << edges;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Memory);
      EXPECT_NE(std::string(error.what()).find(std::to_string(edges)), std::string::npos);
    }
  }
}

TEST(CloseHoles, StopsWhenAsked) {
  const Holed holed = openSphere(40.0);
  FieldOptions options = closing();
  MachineOptions machine{.device = "cpu", .threads = 1};  // With several, all calls but one may be skipped.
  int calls = 0;
  machine.progress = [&](std::string_view stage, double) { return stage != "close_holes" || ++calls < 20; };
  try {
    generate(holed.open, fitGrid(holed.open, {.resolution = 40}), options, machine);
    FAIL() << "asked only " << calls << " times";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Cancelled);
  }
}

TEST(CloseHoles, NeedsASign) {
  FieldOptions options = closing();
  options.sign = SignMode::None;
  const Mesh mesh = shapes::sphere(1.0, 1);
  EXPECT_THROW(generate(mesh, fitGrid(mesh, {.resolution = 8}), options), Error);
}

/// Returns the patch alone, made from the results of the stages before it.
HolePatch patchOf(const Mesh& mesh, const Grid& grid) {
  Progress progress;
  const Buffer<float> winding = windingOf(mesh, grid, SignMode::Harmonic).winding;
  const RayMap map = rayMapOf(mesh, grid);
  HolePatch patch;
  const auto windingAt = [&](std::span<const glm::vec3> points) {
    std::vector<float> numbers;
    for (const glm::vec3& p : points)
      numbers.push_back(float(reference::windingNumber(mesh, grid.position(glm::dvec3(p)))));
    return numbers;
  };
  makePatch(cellMesh(mesh, grid), findMissingEdges(map, winding, 0.5, progress), 0.5, windingAt, progress,
            patch);
  return patch;
}

TEST(CloseHoles, EndsOnTheRim) {
  const Holed holed = openSphere(50.0, 24, 48);
  const Grid grid = fitGrid(holed.closed, {.resolution = 32});
  const HolePatch patch = patchOf(holed.open, grid);
  std::map<std::pair<uint32_t, uint32_t>, int> uses;
  for (const glm::uvec3& t : patch.triangles)
    for (int c = 0; c < 3; ++c) {
      ++uses[{t[c], t[(c + 1) % 3]}];
      --uses[{t[(c + 1) % 3], t[c]}];
    }
  size_t ends = 0;
  for (const auto& [edge, count] : uses) {
    if (count <= 0) continue;
    ++ends;
    const glm::dvec3 p = grid.position(glm::dvec3(patch.mesh.vertices[edge.first]));
    EXPECT_LT(reference::distance(holed.open, p), 0.03 * grid.spacing);
  }
  EXPECT_GT(ends, 60u);
}

}  // namespace
}  // namespace raymap
