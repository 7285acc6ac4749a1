#include "mesh/pieces.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "repair/topology/drop_pieces.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::box;
using shapes::joined;

constexpr uint32_t kNone = Piece::kNone;

Mesh cube(double low, double high) {
  return box(glm::dvec3(low), glm::dvec3(high));
}

/// A cube of 1000 with a cavity of 64 that holds a cube of 8, and a cube of 0.5 beside them.
Mesh nestedCubes() {
  const Mesh inner = joined(shapes::inverted(cube(3, 7)), cube(4, 6));
  return joined(joined(cube(0, 10), inner), box({12, 0, 0}, {13, 1, 0.5}));
}

Pieces nested(const Mesh& mesh, size_t rays = 1) {
  Pieces found = findPieces(Model(mesh));
  nestPieces(mesh, rays, found);
  return found;
}

std::vector<uint32_t> around(const Pieces& found) {
  std::vector<uint32_t> result;
  for (const Piece& piece : found.pieces) result.push_back(piece.around);
  return result;
}

TEST(Pieces, HaveVolumesAndPiecesAround) {
  const Pieces found = nested(nestedCubes());
  ASSERT_EQ(found.pieces.size(), 4u);
  const double volumes[] = {1000.0, -64.0, 8.0, 0.5};
  for (size_t p = 0; p < 4; ++p) {
    EXPECT_NEAR(found.pieces[p].volume, volumes[p], 1e-5 * std::abs(volumes[p])) << p;
    EXPECT_EQ(found.pieces[p].isCavity(), p == 1);
  }
  EXPECT_EQ(around(found), (std::vector<uint32_t>{kNone, 0, 1, kNone}));
  EXPECT_TRUE(found.areApart());
  for (size_t f = 0; f < 48; ++f) EXPECT_EQ(found.ids[f], f / 12);
}

struct Ball {
  glm::dvec3 centre;
  double radius;
};

/// Returns balls that touch nowhere; many lie in others.
std::vector<Ball> randomBalls(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-10.0, 10.0), exponent(-2.0, 2.5);
  std::vector<Ball> balls;
  while (balls.size() < count) {
    const Ball ball{{place(random), place(random), place(random)}, std::exp(exponent(random))};
    const bool isFree = std::ranges::all_of(balls, [&](const Ball& other) {
      const double apart = glm::distance(ball.centre, other.centre);
      return apart > 1.1 * (ball.radius + other.radius) || ball.radius > 1.3 * (apart + other.radius) ||
             other.radius > 1.3 * (apart + ball.radius);
    });
    if (isFree) balls.push_back(ball);
  }
  return balls;
}

TEST(Pieces, AreInTheSmallestBallAroundThem) {
  const std::vector<Ball> balls = randomBalls(100, 3);
  Mesh mesh;
  for (const Ball& ball : balls) mesh = joined(mesh, shapes::sphere(ball.radius, 2, ball.centre));
  const Pieces found = nested(mesh, 16);
  ASSERT_EQ(found.pieces.size(), balls.size());
  EXPECT_TRUE(found.areApart());
  size_t inside = 0;
  for (size_t p = 0; p < balls.size(); ++p) {
    uint32_t expected = kNone;
    for (uint32_t other = 0; other < balls.size(); ++other)
      if (other != p && glm::distance(balls[p].centre, balls[other].centre) < balls[other].radius &&
          balls[p].radius < balls[other].radius &&
          (expected == kNone || balls[other].radius < balls[expected].radius))
        expected = other;
    EXPECT_EQ(found.pieces[p].around, expected) << p;
    inside += expected == kNone ? 0 : 1;
  }
  EXPECT_GE(inside, 10u);
}

TEST(Pieces, ThatTouchOrOverlapAreNotApart) {
  EXPECT_TRUE(nested(joined(cube(0, 10), box({11, 0, 0}, {20, 10, 10})), 64).areApart());
  EXPECT_FALSE(nested(joined(cube(0, 10), box({0, 0, 5}, {10, 10, 20})), 64).areApart());
  EXPECT_FALSE(nested(joined(cube(0, 10), box({10, 1, 1}, {20, 9, 9})), 64).areApart());
  EXPECT_FALSE(nested(joined(cube(0, 10), box({5, 5, 5}, {15, 15, 15})), 64).areApart());
}

TEST(Pieces, TouchWithinAShareOfTheirSize) {
  // A side of a tetrahedron is parallel to one of a cube. The vertices are relative to 0, where floats tell
  // such gaps apart.
  const auto areApart = [](float size, float share) {
    Mesh mesh{.triangles = cube(0, 1).triangles};
    for (int i = 0; i < 8; ++i) mesh.vertices.emplace_back(i & 1, i >> 1 & 1, i >> 2);
    mesh.vertices.insert(mesh.vertices.end(),
                         {{-share, 0.4, 0.4}, {-share, 0.4, 0.6}, {-share, 0.6, 0.4}, {-0.2, 0.4, 0.4}});
    mesh.triangles.insert(mesh.triangles.end(), {{8, 10, 9}, {8, 9, 11}, {9, 10, 11}, {10, 8, 11}});
    for (glm::vec3& v : mesh.vertices) v *= size;
    return nested(mesh, 1).areApart();
  };
  for (const float size : {1e-3f, 1.0f, 1e3f}) {
    EXPECT_FALSE(areApart(size, 0.5e-10f)) << size;
    EXPECT_TRUE(areApart(size, 2e-10f)) << size;
  }
}

TEST(Pieces, AreNotApartIfTheOnlyRayOfOneStartsOnAnother) {
  // The first face of the tetrahedron lies in a side of the cube. No ray says that it is inside.
  const std::vector<glm::dvec3> p{{0, 4, 4}, {0, 4, 6}, {0, 6, 4}, {-2, 4, 4}};
  const auto mesh = [&](double gap) {
    Mesh tip = makeMesh(p, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
    tip.origin.x -= gap;
    return joined(cube(0, 10), tip);
  };
  EXPECT_GT(findPieces(Model(mesh(0.0))).pieces[1].volume, 0.0);
  EXPECT_FALSE(nested(mesh(0.0), 1).areApart());
  EXPECT_TRUE(nested(mesh(0.001), 1).areApart());
}

Choice chosen(const Mesh& mesh, const RepairOptions& repair, RepairReport& report) {
  return choosePieces(nested(mesh), repair, repair.keepCavities, report);
}

void expectRemoved(const Removed& removed, size_t count, double volume, double largest) {
  EXPECT_EQ(removed.count, count);
  EXPECT_NEAR(removed.volume, volume, 1e-4);
  EXPECT_NEAR(removed.largest, largest, 1e-4);
}

TEST(DropPieces, ChoosesCrumbsBubblesAndWhatIsInThem) {
  RepairReport report;
  Choice choice = chosen(nestedCubes(), {}, report);
  EXPECT_EQ(choice.isDropped, (std::vector<bool>{false, true, true, true}));
  EXPECT_EQ(choice.count, 3u);
  EXPECT_NEAR(report.dropSmaller, 1.0, 1e-5);
  expectRemoved(report.dropped, 1, 0.5, 0.5);
  expectRemoved(report.filled, 1, 64, 64);
  expectRemoved(report.buried, 1, 8, 8);

  report = {};
  choice = chosen(nestedCubes(), {.dropSmaller = 0.0, .keepCavities = true}, report);
  EXPECT_EQ(choice.count, 0u);
  EXPECT_EQ(report.dropSmaller, 0.0);
  EXPECT_EQ(report.dropped.count + report.filled.count + report.buried.count, 0u);

  report = {};
  choice = chosen(nestedCubes(), {.dropSmaller = 9.0, .keepCavities = true}, report);
  EXPECT_EQ(choice.isDropped, (std::vector<bool>{false, false, true, true}));
  expectRemoved(report.dropped, 2, 8.5, 8);

  report = {};
  choice = chosen(nestedCubes(), {.dropSmaller = 2000.0, .keepCavities = true}, report);
  EXPECT_EQ(choice.isDropped, std::vector<bool>(4, true));
  expectRemoved(report.dropped, 3, 1008.5, 1000);
  EXPECT_EQ(report.filled.count, 0u);
}

TEST(DropPieces, KeepsPartsOfEqualSizeAndAtTheLimit) {
  RepairReport report;
  const Mesh two = joined(cube(0, 1), cube(4, 5));
  EXPECT_EQ(chosen(two, {}, report).count, 0u);
  EXPECT_EQ(chosen(two, {.dropSmaller = findPieces(Model(two)).pieces[0].volume}, report).count, 0u);
  EXPECT_EQ(chosen(two, {.dropSmaller = 1.001}, report).count, 2u);
}

TEST(DropPieces, CountsAPieceWithoutVolumeAsDropped) {
  const Pieces found{.ids = {0, 1}, .pieces = {{.volume = 1.0}, {.volume = 0.0}}};
  RepairReport report;
  EXPECT_EQ(choosePieces(found, {}, false, report).isDropped, (std::vector<bool>{false, true}));
  expectRemoved(report.dropped, 1, 0.0, 0.0);
  EXPECT_EQ(report.filled.count, 0u);
}

TEST(DropPieces, LeavesTheFacesAndVerticesOfTheOthers) {
  Mesh mesh = nestedCubes();
  const Mesh all = mesh;
  RepairReport report;
  const Pieces found = nested(mesh);
  dropFrom(mesh, found, choosePieces(found, {.dropSmaller = 20.0}, true, report));
  ASSERT_EQ(mesh.triangles.size(), 24u);
  ASSERT_EQ(mesh.vertices.size(), 16u);
  for (uint32_t v = 0; v < 16; ++v) EXPECT_EQ(mesh.position(v), all.position(v));
  for (size_t f = 0; f < 24; ++f) EXPECT_EQ(mesh.triangles[f], all.triangles[f]);
  report = {};
  countPieces(Model(mesh), report);
  EXPECT_EQ(report.solids, 1u);
  EXPECT_EQ(report.cavities, 1u);
}

Field constantField(const Grid& grid, float value) {
  Field field{.grid = grid, .distance = Buffer<float>(grid.sampleCount())};
  std::ranges::fill(field.distance, value);
  return field;
}

TEST(DropPieces, GivesSamplesTheSideOfTheSpaceAroundThem) {
  const Mesh mesh = nestedCubes();
  const Grid grid{.dims = {29, 23, 23}, .origin = glm::dvec3(-0.7), .spacing = 0.5};
  const auto isIn = [](const glm::dvec3& p, const glm::dvec3& low, const glm::dvec3& high) {
    return glm::all(glm::greaterThan(p, low)) && glm::all(glm::lessThan(p, high));
  };
  Field solid = constantField(grid, 0.25f);
  RepairReport report;
  const Pieces found = nested(mesh);
  dropFrom(solid, mesh, found, choosePieces(found, {}, false, report));
  for (int k = 0; k < 23; ++k)
    for (int j = 0; j < 23; ++j)
      for (int i = 0; i < 29; ++i) {
        const glm::dvec3 p = grid.position({i, j, k});
        const float far = 0.5f * (29 + 23 + 23);
        const float expected = isIn(p, glm::dvec3(3), glm::dvec3(7)) ? -far
                               : isIn(p, {12, 0, 0}, {13, 1, 0.5})   ? far
                                                                     : 0.25f;
        ASSERT_EQ(solid.distance[grid.index({i, j, k})], expected) << i << " " << j << " " << k;
      }
}

TEST(DropPieces, FillsOnlySamplesOfTheGrid) {
  const Grid grid{.dims = {4, 4, 4}, .origin = glm::dvec3(36, 0, 0), .spacing = 2.0};
  for (const double y : {5.0, 15.0})  // The grid ends at 6.
    for (const double z : {5.0, 15.0}) {
      const Mesh mesh = joined(box({-20, -20, -20}, {20, 20, 20}), box({30, -5, -5}, {40, y, z}));
      Field solid = constantField(grid, -1.0f);
      const Pieces found = nested(mesh);
      RepairReport report;
      dropFrom(solid, mesh, found, choosePieces(found, {.dropSmaller = 5000.0}, false, report));
      for (int k = 0; k < 4; ++k)
        for (int j = 0; j < 4; ++j)
          for (int i = 0; i < 4; ++i)  // The side at x = 40 is inside on neither side of the sample.
            EXPECT_EQ(solid.distance[grid.index({i, j, k})] > 0.0f, i <= 2 && 2 * j < y && 2 * k < z)
                << i << j << k;
    }
}

TEST(DropPieces, WarnsOfWhatMayBeMissed) {
  std::vector<Warning> warnings;
  const auto warn = [&](const Warning& warning) { warnings.push_back(warning); };
  RepairReport report;
  const Pieces found = nested(nestedCubes());
  const Choice choice = choosePieces(found, {}, false, report);
  warnOfRemoved(found, choice, report, warn);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0].message, "filled 1 sealed cavity, the largest of volume 64; cavities can be kept");
  EXPECT_EQ(warnings[1].message,
            "filled cavities that held 1 part, the largest of volume 8; cavities can be kept");
  warnings.clear();
  report.buried = {};
  report.filled.count = 2;
  warnOfRemoved(found, choice, report, warn);
  EXPECT_EQ(warnings[0].message, "filled 2 sealed cavities, the largest of volume 64; cavities can be kept");
  warnings.clear();
  report.filled.largest = 0.99 * report.dropSmaller;
  warnOfRemoved(found, choice, report, warn);
  EXPECT_TRUE(warnings.empty());
  warnOfKept(report, warn);
  report.dropped = {};
  warnOfKept(report, warn);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].message.find("kept 1 part, the largest of volume 0.5, less than a thousandth"), 0u);
}

TEST(DropPieces, WarnsOfDroppedPartsThatAreSimilarToOthers) {
  const auto warningOf = [](double side) {
    const Pieces found =
        nested(joined(joined(cube(0, 10), box({12, 0, 0}, {14, 1, 1})), box({16, 0, 0}, {16 + side, 1, 1})));
    RepairReport report;
    std::string warning;
    warnOfRemoved(found, choosePieces(found, {}, false, report), report,
                  [&](const Warning& given) { warning = given.message; });
    EXPECT_EQ(report.dropped.count, 1u);
    return warning;
  };
  EXPECT_EQ(warningOf(0.199), "");
  EXPECT_EQ(warningOf(0.201),
            "dropped 1 part, the largest of volume 0.201, while a part of volume 2 stays; a least "
            "volume of 0 keeps all");
}

}  // namespace
}  // namespace raymap
