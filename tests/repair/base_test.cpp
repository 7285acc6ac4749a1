#include "repair/topology/base.h"

#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/repair.h>

#include <cmath>
#include <functional>

#include "closed_mesh.h"
#include "error_code.h"
#include "mesh/compact.h"
#include "shapes.h"

namespace raymap {
namespace {

using Height = std::function<double(int, int)>;

/// A height field over (n + 1)^2 points, one unit apart. `has` says which squares there are.
Mesh terrain(int n, const Height& height, const std::function<bool(int, int)>& has = {}) {
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) p.emplace_back(i, j, height(i, j));
  const auto at = [&](int i, int j) { return uint32_t(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (has && !has(i, j)) continue;
      t.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      t.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  Mesh mesh = makeMesh(p, t);
  removeUnusedVertices(mesh);
  return mesh;
}

double wavy(int i, int j) {
  return 0.25 * ((3 * i + 5 * j) % 7);
}

Repaired based(const Mesh& mesh, double base, RepairOptions options = {}) {
  options.base = base;
  return repair(mesh, fitRepairGrid(mesh, {.resolution = 24}, options), {}, options, {.device = "cpu"});
}

double volumeAbove(const Mesh& mesh, double base) {
  double volume = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.position(t.x), b = mesh.position(t.y), c = mesh.position(t.z);
    volume += 0.5 * glm::cross(b - a, c - a).z * ((a.z + b.z + c.z) / 3.0 - base);
  }
  return volume;
}

void expectStandsOnBase(const Mesh& mesh, double base, double volume) {
  const Repaired made = based(mesh, base);
  EXPECT_TRUE(made.report.keepsFaces());
  EXPECT_TRUE(made.report.after.watertight && made.report.after.consistentlyOriented);
  EXPECT_EQ(made.report.after.degenerateFaces, 0u);
  EXPECT_EQ(made.report.crossingAfter.pairs, 0u);
  EXPECT_NEAR(made.report.after.signedVolume, volume, 1e-5 * volume);
  EXPECT_EQ(made.report.after.bounds.min.z, base);
  EXPECT_EQ(made.report.after.bounds.max.z, bounds(mesh).max.z);
  for (size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(made.mesh.position(made.mesh.triangles[f][c]), mesh.position(mesh.triangles[f][c]));
}

TEST(Base, MakesASolidOfATerrain) {
  const Mesh mesh = terrain(8, wavy);
  expectStandsOnBase(mesh, -2.0, volumeAbove(mesh, -2.0));
  // With a hole, in two parts, and with an outline that is not convex.
  const Mesh holed = terrain(8, wavy, [](int i, int j) { return i < 3 || i > 4 || j < 2 || j > 5; });
  expectStandsOnBase(holed, -2.0, volumeAbove(holed, -2.0));
  const Mesh two = terrain(8, wavy, [](int i, int j) { return i != 3 && (i > 3 || j > 1); });
  expectStandsOnBase(two, -1.0, volumeAbove(two, -1.0));
}

TEST(Base, MayLieWhereTheRimDoes) {
  const auto slope = [](int i, int) { return 0.5 * i; };
  expectStandsOnBase(terrain(4, slope), 0.0, 16.0);
  // Two faces of this one lie in the base.
  const Mesh hill =
      terrain(8, [](int i, int j) { return i % 8 == 0 || j % 8 == 0 ? 0.0 : 1.0 + wavy(i, j); });
  EXPECT_NEAR(based(hill, 0.0).report.after.signedVolume, volumeAbove(hill, 0.0), 5.0);
}

TEST(Base, TurnsTheSheetUp) {
  const Mesh mesh = terrain(6, wavy);
  const Repaired made = based(shapes::inverted(mesh), -1.0);
  EXPECT_TRUE(made.report.keepsFaces());
  EXPECT_NEAR(made.report.after.signedVolume, volumeAbove(mesh, -1.0), 1e-4);
  Mesh turned = mesh;
  std::swap(turned.triangles[7].x, turned.triangles[7].y);
  const Repaired back = based(turned, -1.0);
  EXPECT_TRUE(back.report.keepsFaces());
  EXPECT_EQ(back.report.stats.turnedFaces, std::vector<uint32_t>{7});
  EXPECT_NEAR(back.report.after.signedVolume, volumeAbove(mesh, -1.0), 1e-4);
}

TEST(Base, LiesInTheDirectionThatIsAskedFor) {
  Mesh mesh = terrain(6, wavy);
  const double volume = volumeAbove(mesh, -1.0);
  for (glm::vec3& p : mesh.vertices) p = {p.x, p.z, -p.y};
  std::swap(mesh.origin.y, mesh.origin.z);
  mesh.origin.z = -mesh.origin.z;
  const Repaired made = based(mesh, -1.0, {.down = {0, -2, 0}});
  EXPECT_TRUE(made.report.keepsFaces());
  EXPECT_EQ(made.report.after.bounds.min.y, -1.0);
  EXPECT_NEAR(made.report.after.signedVolume, volume, 1e-4);
}

TEST(Base, BecomesPartOfWhatIsMadeAnew) {
  const Mesh mesh = terrain(8, [](int, int) { return 1.0; });
  const Repaired made = based(mesh, -1.0, {.remesh = true});
  EXPECT_FALSE(made.report.keepsFaces());
  EXPECT_NEAR(made.report.after.signedVolume, 128.0, 2.0);
  EXPECT_NEAR(made.report.after.bounds.min.z, -1.0, 0.1);
}

TEST(Base, IsRefusedWhereThereIsNone) {
  const Mesh mesh = terrain(6, wavy);
  EXPECT_EQ(codeOf([&] { based(shapes::box({0, 0, 0}, {1, 1, 1}), -1.0); }), ErrorCode::Input);
  EXPECT_EQ(codeOf([&] { based(mesh, 0.01); }), ErrorCode::Input);
  EXPECT_EQ(codeOf([&] { based(mesh, NAN); }), ErrorCode::Usage);
  // A ramp that winds around twice: its outline overlaps itself.
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (uint32_t i = 0; i <= 48; ++i) {
    const double angle = 0.26 * i, r = 1.0 + 0.01 * i;
    p.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.1 * i);
    p.emplace_back((r + 1) * std::cos(angle), (r + 1) * std::sin(angle), 0.1 * i);
    if (i > 0) t.insert(t.end(), {{2 * i - 2, 2 * i - 1, 2 * i}, {2 * i - 1, 2 * i + 1, 2 * i}});
  }
  EXPECT_EQ(codeOf([&] { based(makeMesh(p, t), -1.0); }), ErrorCode::Input);
}

}  // namespace
}  // namespace raymap
