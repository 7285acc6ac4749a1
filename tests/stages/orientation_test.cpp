#include "cpu/sign/orientation.h"

#include <gtest/gtest.h>
#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <random>

#include "any_threads.h"
#include "broken_meshes.h"
#include "cpu_run.h"
#include "field/trilinear.h"
#include "mesh/patches.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {

using namespace cpu;
namespace {

Mesh flipped(const Mesh& mesh, double share) {
  return withFlippedFaces(mesh, share, 5);
}

/// Returns the mesh with faces that share no vertex and do not touch.
Mesh soupOf(const Mesh& mesh) {
  return withMovedCorners(mesh, 5e-5, 7);
}

/// Returns open solids of every kind whose faces all point the right way.
std::vector<Mesh> rightMeshes() {
  const Mesh ball = withoutCap(shapes::sphere(1.0, 4), 0.9);
  return {ball,
          shapes::inverted(ball),
          withMissingFaces(shapes::torus(1.0, 0.4, 60, 30), 0.1, 3),
          shapes::joined(ball, shapes::sphere(0.8, 3, {0.6, 0.2, 0.0})),   // overlapping
          shapes::joined(ball, shapes::sphere(0.5, 3)),                    // nested
          shapes::joined(ball, shapes::inverted(shapes::sphere(0.5, 3))),  // a cavity
          shapes::joined(ball, shapes::inverted(withoutCap(shapes::sphere(0.5, 3), 0.4))),
          withoutCap(shapes::sphere(1.0, 4), -0.3),  // a bowl
          soupOf(shapes::sphere(1.0, 4)),
          soupOf(shapes::joined(shapes::sphere(1.0, 4), shapes::sphere(0.8, 3, {0.6, 0.2, 0.0})))};
}

TEST(Orientation, AutoKeepsWhatIsRight) {
  for (const Mesh& mesh : rightMeshes()) {
    const Grid grid = fitGrid(mesh, {.resolution = 40});
    const Generated kept = runOf(mesh, grid, Orientation::Keep),
                    chosen = runOf(mesh, grid, Orientation::Auto);
    EXPECT_GT(kept.stats.doubtfulShare, 0.0);
    EXPECT_TRUE(areSame(kept, chosen))
        << mesh.triangles.size() << " faces, " << chosen.stats.turnedFaces.size() << " turned";
    EXPECT_EQ(chosen.stats.misfit, chosen.stats.misfitGiven);
    EXPECT_EQ(0u, countUnlike(kept, runOf(mesh, grid, Orientation::Repair)));
  }
}

TEST(Orientation, TurnsFacesBack) {
  for (const Mesh& mesh : rightMeshes()) {
    const Grid grid = fitGrid(mesh, {.resolution = 40});
    const Generated right = runOf(mesh, grid, Orientation::Keep);
    const double most = 0.0005 * double(grid.sampleCount());
    for (const double share : {0.1, 0.3}) {
      const Mesh broken = flipped(mesh, share);
      const Generated run = runOf(broken, grid, Orientation::Auto);
      EXPECT_LE(double(countUnlike(right, run)), most) << mesh.triangles.size() << " faces, " << share;
      EXPECT_LT(run.stats.misfit, 0.5 * run.stats.misfitGiven);
      EXPECT_GT(double(countUnlike(right, runOf(broken, grid, Orientation::Keep))), most);
      Mesh turned = broken;
      turnFaces(turned, run.stats.turnedFaces);
      EXPECT_GE(2u, countUnlike(run, runOf(turned, grid, Orientation::Keep)));  // Rounding.
    }
  }
}

TEST(Orientation, DoesNotDependOnTheGivenOne) {
  const Mesh ball = withoutCap(shapes::sphere(1.0, 4), 0.9);
  for (const Mesh& mesh :
       {ball, soupOf(shapes::sphere(1.0, 4)), shapes::joined(ball, shapes::inverted(shapes::sphere(0.5, 3))),
        shapes::joined(ball, shapes::sphere(0.8, 3, {0.6, 0.2, 0.0}))}) {
    const Grid grid = fitGrid(mesh, {.resolution = 40});
    EXPECT_LE(double(countUnlike(runOf(mesh, grid, Orientation::Keep),
                                 runOf(flipped(mesh, 0.5), grid, Orientation::Auto))),
              0.0005 * double(grid.sampleCount()));
  }
}

TEST(Orientation, TurnsHalvesThatShareNoVertex) {
  const auto half = [](const Mesh& mesh, double side) {
    Mesh part = mesh;
    std::erase_if(part.triangles, [&](const glm::uvec3& t) {
      return side * (mesh.position(t.x).z + mesh.position(t.y).z + mesh.position(t.z).z) < 0.0;
    });
    for (glm::vec3& v : part.vertices) v.z += float(side) * 1e-5f;
    return part;
  };
  const Mesh ball = shapes::sphere(1.0, 4), top = half(ball, 1.0), bottom = half(ball, -1.0);
  const Mesh right = shapes::joined(top, bottom), broken = shapes::joined(top, shapes::inverted(bottom));
  const Grid grid = fitGrid(right, {.resolution = 40});
  const Generated run = runOf(right, grid, Orientation::Keep);
  EXPECT_EQ(0u, countUnlike(run, runOf(broken, grid, Orientation::Auto)));
  EXPECT_LT(1000u, countUnlike(run, runOf(broken, grid, Orientation::Keep)));
}

TEST(Orientation, RepairWorksWithEveryMode) {
  const Mesh mesh = withoutCap(shapes::sphere(1.0, 4), 0.9), broken = flipped(mesh, 0.3);
  const Grid grid = fitGrid(mesh, {.resolution = 32});
  for (const SignMode sign : {SignMode::Rays, SignMode::Paths, SignMode::Evolution}) {
    const Generated right = runOf(mesh, grid, Orientation::Keep, sign);
    EXPECT_EQ(0u, countUnlike(right, runOf(broken, grid, Orientation::Repair, sign)));
    EXPECT_TRUE(
        areSame(runOf(broken, grid, Orientation::Keep, sign), runOf(broken, grid, Orientation::Auto, sign)));
  }
}

TEST(Orientation, ConfidenceSeesTheTurnedFaces) {
  const Mesh mesh = shapes::sphere(1.0, 4);
  const Grid grid = fitGrid(mesh, {.resolution = 32});
  const Generated run = runOf(flipped(mesh, 0.3), grid, {.confidence = true});
  EXPECT_EQ(run.field.confidence.size(), grid.sampleCount());
  for (const float confidence : run.field.confidence) ASSERT_EQ(confidence, 1.0f);
}

TEST(Orientation, SameForAnyNumberOfThreads) {
  const Mesh mesh = flipped(soupOf(withoutCap(shapes::sphere(1.0, 4), 0.7)), 0.4);
  const Grid grid = fitGrid(mesh, {.resolution = 48});
  const auto run = [&](int threads) { return runOf(mesh, grid, {}, {.threads = threads}); };
  const Generated first = run(1);
  EXPECT_FALSE(first.stats.turnedFaces.empty());
  EXPECT_TRUE(areSame(first, run(2)));
  EXPECT_TRUE(areSame(first, run(8)));
}

TEST(Orientation, StopsWhenCancelled) {
  const Mesh mesh = flipped(withoutCap(shapes::sphere(1.0, 4), 0.7), 0.3);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  MachineOptions machine{.device = "cpu", .threads = 1};  // With several, all calls but one may be skipped.
  double last = 0.0;
  machine.progress = [&](std::string_view stage, double done) {
    if (stage != "orientation") return true;
    EXPECT_GE(done, 0.0);
    EXPECT_LE(done, 1.0);
    last = done;
    return done < 0.05;
  };
  Field field;
  EXPECT_THROW(Generator().generate(mesh, grid, {}, field, machine), Error);
  EXPECT_GE(last, 0.05);
  EXPECT_TRUE(field.distance.empty());
}

TEST(Orientation, DoesNotDependOnTheGeneratorsLastMesh) {
  const Mesh mesh = withoutCap(shapes::sphere(1.0, 4), 0.7), broken = flipped(mesh, 0.3);
  const Grid grid = fitGrid(mesh, {.resolution = 32});
  const FieldOptions options{.winding = true};
  const MachineOptions machine{.device = "cpu"};
  Generator generator;
  Generated again;
  EXPECT_FALSE(generator.generate(broken, grid, options, again.field, machine).turnedFaces.empty());
  again.stats = generator.generate(mesh, grid, options, again.field, machine);
  EXPECT_TRUE(areSame(again, runOf(mesh, grid, Orientation::Keep)));
}

TEST(Patches, LinkAcrossManifoldEdges) {
  const Patches ball = findPatches(Model(flipped(shapes::sphere(1.0, 2), 0.5)));
  EXPECT_EQ(ball.count, 1u);
  const Mesh mesh = flipped(shapes::sphere(1.0, 2), 0.5);
  Mesh turned = mesh;
  for (size_t f = 0; f < turned.triangles.size(); ++f)
    if (ball.isReversed[f]) std::swap(turned.triangles[f].y, turned.triangles[f].z);
  const Patches straight = findPatches(Model(turned));
  EXPECT_EQ(0, std::count(straight.isReversed.begin(), straight.isReversed.end(), 1));
  EXPECT_EQ(findPatches(Model(soupOf(mesh))).count, mesh.triangles.size());
  EXPECT_EQ(findPatches(Model(shapes::joined(mesh, mesh))).count,
            2 * mesh.triangles.size());  // Four faces an edge.
}

TEST(Patches, SetDegenerateAndDoubledFacesApart) {
  const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_EQ(findPatches(Model(makeMesh(p, {{0, 1, 2}, {0, 2, 1}}))).count, 2u);
  EXPECT_EQ(findPatches(Model(makeMesh(p, {{0, 1, 2}, {0, 1, 2}}))).count, 2u);
  EXPECT_EQ(findPatches(Model(makeMesh(p, {{0, 1, 2}, {0, 0, 1}}))).count, 1u + 1u);
  EXPECT_EQ(findPatches(Model(makeMesh(p, {{0, 1, 2}, {1, 0, 3}, {0, 1, 3}}))).count, 3u);
}

TEST(Orientation, ExaminesFacesOnlyIfASignContradictsTheParity) {
  const Mesh ball = withoutCap(shapes::sphere(1.0, 6), 0.95);
  const Grid grid = fitGrid(ball, {.resolution = 20});
  const Generated right = runOf(ball, grid, Orientation::Auto);
  EXPECT_TRUE(right.stats.turnedFaces.empty());
  EXPECT_GT(right.stats.misfit, 0.0);
  EXPECT_TRUE(areSame(right, runOf(ball, grid, Orientation::Keep)));
  for (const double share : {0.3, 0.5}) {
    const Generated turned = runOf(flipped(ball, share), grid, Orientation::Auto);
    EXPECT_FALSE(turned.stats.turnedFaces.empty());
    EXPECT_EQ(countUnlike(turned, right), 0u);
  }
  // No edge links the cap to the rest.
  Mesh cap = shapes::sphere(1.0, 6);
  const Mesh whole = cap;
  std::erase_if(cap.triangles, [&](const glm::uvec3& t) { return whole.position(t.x).x < 0.7; });
  Mesh rest = ball;
  std::erase_if(rest.triangles, [&](const glm::uvec3& t) { return whole.position(t.x).x >= 0.7; });
  const Mesh apart = shapes::joined(rest, shapes::inverted(soupOf(cap)));
  const Generated turned = runOf(apart, grid, Orientation::Auto);
  EXPECT_FALSE(turned.stats.turnedFaces.empty());
  EXPECT_EQ(countUnlike(turned, right), 0u);
  EXPECT_GT(countUnlike(runOf(apart, grid, Orientation::Keep), right), 20u);
}

Mesh doubled(const Mesh& mesh) {
  return withDoubledFaces(mesh, 1.0, 1);
}

/// Returns the mesh with its faces in another order. Double-sided faces then have either side first.
Mesh shuffled(Mesh mesh) {
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(5));
  return mesh;
}

Mesh openBox() {
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  return keepTriangles(box, [&](const glm::uvec3& t) {
    return box.position(t.x).z + box.position(t.y).z + box.position(t.z).z < 2.9;
  });
}

TEST(DoubleSided, FieldsAreTheSameAfterACancelledRun) {
  const Mesh mesh = doubled(withoutCap(shapes::sphere(1.0, 3), 0.7));
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  const FieldOptions options{.winding = true};
  MachineOptions machine{.device = "cpu"};
  const Generated fresh = generate(mesh, grid, options, machine);
  Generator generator;
  Field field;
  bool isCancelled = true;
  for (int stopAt = 1; isCancelled; ++stopAt) {  // At every call in turn.
    int calls = 0;
    machine.progress = [&](std::string_view stage, double) { return stage == "begin" || ++calls < stopAt; };
    try {
      generator.generate(mesh, grid, options, field, machine);
      isCancelled = false;
    } catch (const Error&) {
      machine.progress = {};
      generator.generate(mesh, grid, options, field, machine);
    }
    ASSERT_TRUE(sameBits(field.winding, fresh.field.winding)) << stopAt;
    ASSERT_TRUE(sameBits(field.distance, fresh.field.distance)) << stopAt;
  }
}

/// Expects that `auto` makes of a mesh with double-sided faces what `keep` makes of the single-sided one.
void expectSolid(const Mesh& single, const Mesh& broken, size_t leftOut, double most = 0.0) {
  const Grid grid = fitGrid(single, {.resolution = 40});
  const Generated right = runOf(single, grid, Orientation::Keep);
  for (const Orientation orientation : {Orientation::Auto, Orientation::Repair}) {
    const Generated run = runOf(broken, grid, orientation);
    EXPECT_LE(double(countUnlike(right, run)), most * double(grid.sampleCount()));
    EXPECT_EQ(run.stats.leftOutFaces.size(), leftOut);
    EXPECT_TRUE(run.stats.orientationFits);
    Mesh taken = broken;
    turnFaces(taken, run.stats.turnedFaces);
    removeFaces(taken, run.stats.leftOutFaces);
    EXPECT_LE(countUnlike(run, runOf(taken, grid, Orientation::Keep)), 2u);  // Rounding.
    for (size_t s = 0; s < grid.sampleCount(); ++s)
      ASSERT_NEAR(std::abs(run.field.distance[s]), std::abs(right.field.distance[s]), 1e-6);
  }
  EXPECT_LT(300u, countUnlike(right, runOf(broken, grid, Orientation::Keep)));
}

TEST(DoubleSidedFaces, BoundASolid) {
  const Mesh cube = shapes::box({0, 0, 0}, {1, 1, 1});
  expectSolid(cube, doubled(cube), 12);
  expectSolid(cube, shuffled(doubled(cube)), 12);
  expectSolid(cube, doubled(doubled(cube)), 36);
  const Mesh torus = shapes::torus(1.0, 0.4, 40, 20);
  expectSolid(torus, shuffled(doubled(torus)), 1600);
}

TEST(DoubleSidedFaces, BoundASolidWithAHole) {
  for (const double height : {0.95, 0.8, 0.7}) {
    const Mesh ball = withoutCap(shapes::sphere(1.0, 4), height);
    expectSolid(ball, doubled(ball), ball.triangles.size());
    expectSolid(ball, shuffled(doubled(ball)), ball.triangles.size());
  }
}

TEST(DoubleSidedFaces, AreCompletedBySingleSidedOnes) {
  const Mesh ball = shapes::sphere(1.0, 4);
  Mesh half = ball;
  for (const glm::uvec3& t : ball.triangles)
    if (ball.position(t.x).z + ball.position(t.y).z + ball.position(t.z).z > 0.0)
      half.triangles.emplace_back(t.x, t.z, t.y);
  expectSolid(ball, half, half.triangles.size() - ball.triangles.size());
  expectSolid(ball, shuffled(half), half.triangles.size() - ball.triangles.size());
  const Mesh some = withDoubledFaces(ball, 0.4, 2);
  expectSolid(ball, shuffled(some), some.triangles.size() - ball.triangles.size());
  expectSolid(ball, shuffled(withDoubledFaces(flipped(ball, 0.3), 0.4, 2)),
              some.triangles.size() - ball.triangles.size());
}

TEST(DoubleSidedFaces, MakeAUnionOrACavityOfTwo) {
  const Mesh ball = shapes::sphere(1.0, 4), other = shapes::sphere(0.8, 4, {0.6, 0.2, 0.0});
  const Mesh pair = shapes::joined(ball, other);
  expectSolid(pair, doubled(pair), pair.triangles.size());
  expectSolid(pair, shuffled(doubled(pair)), pair.triangles.size());
  const Mesh boxes =
      shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}));
  expectSolid(boxes, doubled(boxes), 24);  // A face is half in the other solid.
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1}), inner = shapes::box({0.2, 0.2, 0.2}, {0.7, 0.7, 0.7});
  const Mesh hollow =
      shapes::joined(box, shapes::inverted(inner));  // Nothing says that the inner one is solid.
  expectSolid(hollow, doubled(hollow), 24);
  expectSolid(hollow, shuffled(doubled(shapes::joined(box, inner))), 24);
}

TEST(DoubleSidedFaces, StaySheetsThatBoundNothing) {
  const Mesh ball = shapes::sphere(1.0, 4);
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1}), beside = shapes::box({1, 0, 0}, {2, 1, 1});
  const Mesh fin =
      makeMesh(std::vector<glm::dvec3>{{0.5, 0.5, 1.0}, {0.5, 0.0, 1.0}, {0.5, 0.0, 1.8}}, {{0, 1, 2}});
  for (const Mesh& mesh :
       {doubled(openBox()), doubled(withoutCap(ball, 0.0)), doubled(withoutCap(shapes::sphere(1.0, 4), -0.5)),
        shapes::joined(box, beside),        // They touch in a wall.
        shapes::joined(box, doubled(fin)),  // No edge in common.
        shapes::joined(ball, doubled(openBox())), shapes::joined(withoutCap(ball, 0.9), doubled(fin))}) {
    const Grid grid = fitGrid(mesh, {.resolution = 40});
    const Generated kept = runOf(mesh, grid, Orientation::Keep), run = runOf(mesh, grid, Orientation::Auto);
    EXPECT_EQ(countUnlike(kept, run), 0u) << mesh.triangles.size() << " faces";
    EXPECT_TRUE(run.stats.leftOutFaces.empty()) << mesh.triangles.size() << " faces";
    EXPECT_TRUE(run.stats.turnedFaces.empty()) << mesh.triangles.size() << " faces";
  }
}

TEST(DoubleSidedFaces, AreSolidOrSheetEachForItself) {
  const Mesh ball = shapes::sphere(1.0, 4);
  Mesh bin = openBox();
  bin.origin += glm::dvec3(2, 0, 0);
  const Mesh both = shapes::joined(doubled(ball), doubled(bin));
  const Grid grid = fitGrid(both, {.resolution = 48});
  const Generated right = runOf(shapes::joined(ball, doubled(bin)), grid, Orientation::Keep);
  for (const Mesh& mesh : {both, shuffled(both)}) {
    const Generated run = runOf(mesh, grid, Orientation::Auto);
    EXPECT_EQ(countUnlike(right, run), 0u);
    EXPECT_EQ(run.stats.leftOutFaces.size(), ball.triangles.size());
  }
}

TEST(DoubleSidedFaces, AreTheSameForAnyNumberOfThreads) {
  const Mesh mesh = shuffled(withDoubledFaces(flipped(withoutCap(shapes::sphere(1.0, 5), 0.8), 0.3), 0.5, 2));
  const Grid grid = fitGrid(mesh, {.resolution = 48});
  const Generated one = runOf(mesh, grid, {}, {.threads = 1});
  EXPECT_FALSE(one.stats.leftOutFaces.empty());
  for (const int threads : {2, 5}) {
    const Generated run = runOf(mesh, grid, {}, {.threads = threads});
    EXPECT_TRUE(areSame(one, run));
    EXPECT_EQ(one.stats.leftOutFaces, run.stats.leftOutFaces);
  }
}

TEST(DoubleSidedFaces, LeaveTheSignWithEveryDistance) {
  const Mesh ball = withoutCap(shapes::sphere(1.0, 4), 0.8);
  const Grid grid = fitGrid(ball, {.resolution = 32});
  for (const DistanceMode mode : {DistanceMode::Cell, DistanceMode::Raster}) {
    const Generated right = runOf(ball, grid, {.distance = mode, .orientation = Orientation::Keep});
    const Generated run = runOf(doubled(ball), grid, {.distance = mode});
    EXPECT_EQ(countUnlike(right, run), 0u);
    EXPECT_EQ(run.stats.leftOutFaces.size(), ball.triangles.size());
  }
}

TEST(Orientation, KeepsWhatMostOfAPartsAreaSays) {
  // The field fits as well whether the inner sphere bounds a cavity or a solid in the solid.
  const Mesh inner = soupOf(shapes::sphere(0.5, 2)), outer = soupOf(shapes::sphere(1.0, 2));
  for (const Mesh& right : {shapes::joined(outer, inner), shapes::joined(outer, shapes::inverted(inner))}) {
    const Grid grid = fitGrid(right, {.resolution = 40});
    const Generated whole = runOf(right, grid, Orientation::Keep);
    for (const double share : {0.1, 0.4}) {
      const Generated run = runOf(flipped(right, share), grid, Orientation::Auto);
      EXPECT_LE(countUnlike(whole, run), 30u) << share;
      EXPECT_NEAR(double(run.stats.turnedFaces.size()), share * double(right.triangles.size()),
                  0.1 * double(right.triangles.size()));
    }
  }
}

TEST(Orientation, KeepsWhatIsGivenWhereNothingFits) {
  Mesh tangle = shapes::sphere(1.0, 5);  // A fan through the centre.
  tangle.vertices.emplace_back(0.0f);
  for (glm::uvec3& t : tangle.triangles) t.z = uint32_t(tangle.vertices.size() - 1);
  tangle = flipped(tangle, 0.5);
  const Grid grid = fitGrid(tangle, {.resolution = 40});
  const Generated kept = runOf(tangle, grid, Orientation::Keep), run = runOf(tangle, grid, Orientation::Auto);
  EXPECT_TRUE(areSame(kept, run));
  EXPECT_GT(run.stats.misfitGiven, 0.5);
  EXPECT_EQ(run.stats.misfit, run.stats.misfitGiven);
  EXPECT_FALSE(run.stats.orientationFits);
  EXPECT_TRUE(kept.stats.orientationFits);
  EXPECT_TRUE(runOf(shapes::sphere(1.0, 3), grid, Orientation::Auto).stats.orientationFits);
}

/// Returns what `measureSides` says of a face, in double precision.
double sidesOf(const Trilinear<double>& field, double farSides, SideMeasure measure, const glm::dvec3& a,
               const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 across = glm::cross(b - a, c - a);
  const double area2 = glm::length(across);
  if (area2 == 0.0) return 0.0;
  const glm::dvec3 step = across / area2 * std::max(1.0, farSides * std::sqrt(area2));
  const double longest = std::max({glm::length(b - a), glm::length(c - a), glm::length(c - b)});
  const int parts = std::clamp(int(std::ceil(longest / 2.0)), 1, 8);
  double sum = 0.0;
  for (int i = 0; i < parts; ++i)
    for (int j = 0; i + j < parts; ++j)
      for (const double shift : {1.0 / 3.0, 2.0 / 3.0}) {
        if (shift > 0.5 && i + j + 1 == parts) continue;
        const glm::dvec3 p = a + ((i + shift) * (b - a) + (j + shift) * (c - a)) / double(parts);
        const auto at = [&](const glm::dvec3& q) {
          return field(glm::clamp(q, glm::dvec3(0.0), field.last()));
        };
        const double before = at(p + step), behind = at(p - step);
        const double toOdd = std::abs(std::remainder(before + behind - 1.0, 2.0));
        sum += measure == SideMeasure::Rise ? before - behind : 1.0 - toOdd;
      }
  return sum / (parts * parts);
}

TEST(Orientation, MeasuresTheFieldBesideEachFace) {
  std::mt19937 random(3);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (const glm::ivec3 dims : {glm::ivec3(14, 9, 11), glm::ivec3(1, 20, 2), glm::ivec3(2, 1, 12)}) {
    Buffer<float> field(size_t(dims.x) * size_t(dims.y) * size_t(dims.z));
    for (float& value : field) value = float(between(-1.5, 1.5));
    std::vector<glm::dvec3> points;
    std::vector<glm::uvec3> faces;
    Turns turns;
    for (uint32_t f = 0; f < 1500; ++f) {  // From tiny faces to those that reach far out of the grid.
      const double size = std::pow(2.0, between(-4.0, 5.0));
      const glm::dvec3 a{between(0, dims.x - 1), between(0, dims.y - 1), between(0, dims.z - 1)};
      for (const double scale : {0.0, f % 50 == 7 ? 0.0 : size, size})
        points.push_back(a + scale * glm::dvec3(between(-1, 1), between(-1, 1), between(-1, 1)));
      faces.emplace_back(3 * f, 3 * f + 1, 3 * f + 2);
      turns.push_back(std::array{kAsGiven, kReversed, kLeftOut}[f % 3]);
    }
    CellMesh mesh;
    mesh.vertices.resizeUninitialized(points.size());
    std::copy(points.begin(), points.end(), mesh.vertices.begin());
    mesh.triangles = faces;
    mesh.dims = dims;
    const Trilinear<double> exact(dims, field.data());
    Progress progress;
    Buffer<float> rises, wholeness;
    for (const double farSides : {0.0, 0.7})
      for (const Turns& taken : {turns, Turns()}) {
        measureSides(mesh, taken, field, float(farSides), progress, rises, &wholeness);
        ASSERT_EQ(rises.size(), faces.size());
        ASSERT_EQ(wholeness.size(), faces.size());
        for (uint32_t f = 0; f < faces.size(); ++f) {
          const auto expected = [&](SideMeasure measure) {
            if (!taken.empty() && taken[f] == kLeftOut) return 0.0;
            return sidesOf(exact, farSides, measure, mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2));
          };
          ASSERT_NEAR(rises[f], expected(SideMeasure::Rise), 2e-4) << "face " << f;
          ASSERT_NEAR(wholeness[f], expected(SideMeasure::Wholeness), 2e-4) << "face " << f;
        }
      }
  }
}

TEST(Misfit, IsZeroWhereAllRaysAgree) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  const Generated right = runOf(mesh, grid, Orientation::Keep);
  EXPECT_NEAR(measureMisfit(grid.dims, crossingsOf(mesh, grid), right.field.winding), 0.0, 1e-12);
  Buffer<float> nothing(grid.sampleCount());
  std::fill(nothing.begin(), nothing.end(), 0.0f);
  EXPECT_EQ(measureMisfit(grid.dims, crossingsOf(mesh, grid), nothing), 1.0);
}

}  // namespace
}  // namespace raymap
