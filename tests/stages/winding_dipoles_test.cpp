#include "cpu/sign/winding_dipoles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "broken_meshes.h"
#include "cpu/backend.h"
#include "method/orientation_surface.h"
#include "reference.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {

using namespace cpu;
namespace {

struct Settled {
  Mesh mesh;
  Grid grid;
  Buffer<float> winding;
  std::vector<uint32_t> unsure;

  double exact(size_t s) const { return reference::windingNumber(mesh, samplePosition(grid, s)); }
};

/// Settles the winding numbers of all samples, with a threshold of 0.5.
Settled settled(const Mesh& mesh, int resolution, WindingDipoles::Looks looks = {0, kLooks}) {
  Settled result{.mesh = mesh, .grid = fitGrid(mesh, {.resolution = resolution})};
  result.winding.resizeUninitialized(result.grid.sampleCount());
  std::vector<uint32_t> all(result.winding.size());
  std::iota(all.begin(), all.end(), 0u);
  SurfaceTree tree;
  tree.build(cellMesh(mesh, result.grid));
  Progress progress;
  result.unsure = WindingDipoles().settle(tree, result.grid.dims, all, 0.5, looks, progress, result.winding);
  return result;
}

Mesh openSphere() {
  return withoutCap(shapes::sphere(1.0, 4), 0.4);
}

TEST(WindingDipoles, AreTheExactWindingNumber) {
  // One triangle, a leaf that is not full, one triangle more than a leaf holds, and thousands.
  for (const Mesh& mesh :
       {shapes::soup(1, 3), shapes::soup(5, 4), shapes::soup(9, 5), shapes::soup(1000, 6), openSphere()}) {
    const Settled result = settled(mesh, 16);
    double sum = 0.0;
    size_t wrong = 0;
    for (size_t s = 0; s < result.winding.size(); ++s) {
      const double error = std::abs(result.winding[s] - result.exact(s));
      wrong += (std::abs(result.winding[s]) > 0.5f) != (std::abs(result.exact(s)) > 0.5) ? 1 : 0;
      // Numbers near the threshold are computed more accurately.
      ASSERT_LT(error, std::abs(std::abs(result.winding[s]) - 0.5) < 0.015 ? 0.005 : 0.05);
      sum += error;
    }
    EXPECT_LT(sum / double(result.winding.size()), 0.008) << mesh.triangles.size() << " triangles";
    EXPECT_LE(wrong, 1u);
  }
}

TEST(WindingDipoles, ChangeOnlyTheSamplesAskedFor) {
  const Mesh mesh = openSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 12});
  SurfaceTree tree;
  tree.build(cellMesh(mesh, grid));
  Buffer<float> winding(grid.sampleCount());
  std::fill(winding.begin(), winding.end(), 7.0f);
  const std::vector<uint32_t> asked{3, 70, 71, 900};
  Progress progress;
  WindingDipoles().settle(tree, grid.dims, asked, 0.5, {0, kLooks}, progress, winding);
  for (uint32_t s = 0; s < winding.size(); ++s)
    ASSERT_EQ(winding[s] != 7.0f, std::ranges::binary_search(asked, s)) << s;
}

TEST(WindingDipoles, SayWhichSamplesTheLastLookIsNotSureOf) {
  for (const Mesh& mesh : {openSphere(), shapes::soup(300, 5)})
    for (const uint32_t end : {1u, 2u, 3u}) {
      const Settled result = settled(mesh, 24, {0, end});
      EXPECT_TRUE(std::ranges::is_sorted(result.unsure));
      EXPECT_LT(result.unsure.size(), result.winding.size() / 4);
      size_t close = 0;
      for (uint32_t s = 0; s < result.winding.size(); ++s)
        if (std::abs(std::abs(result.winding[s]) - 0.5f) < kClose[end - 1]) {
          ++close;
          EXPECT_TRUE(std::ranges::binary_search(result.unsure, s)) << s;
        }
      EXPECT_TRUE(close > 0 || end == 3) << end;
    }
}

TEST(WindingDipoles, KnowTheErrorOfManyLayers) {
  // Groups of triangles err 64 times as much.
  const Settled result = settled(nearlyEqualShells(64, 2), 12);
  size_t wrong = 0;
  for (uint32_t s = 0; s < result.winding.size(); ++s)
    if (!std::ranges::binary_search(result.unsure, s))
      wrong += (std::abs(result.winding[s]) > 0.5f) != (std::abs(result.exact(s)) > 0.5);
  EXPECT_EQ(wrong, 0u);
  EXPECT_LT(result.unsure.size(), result.winding.size() / 10);
}

TEST(WindingDipoles, SurviveDegenerateTriangles) {
  Mesh mesh = openSphere();
  mesh.triangles.insert(mesh.triangles.begin(), {{0, 0, 0}, {0, 1, 1}, {2, 3, 2}});
  for (const float w : settled(mesh, 16).winding) ASSERT_TRUE(std::abs(w) < 1.1f);
}

/// Compares winding numbers of the backend, which keeps one face of each double-sided group in its tree, with
/// those of the mesh as the sign takes it.
void expectTaken(const Mesh& mesh, const Turns& turns, bool isTreeThereBefore) {
  Mesh taken = mesh;
  for (size_t f = 0; f < turns.size(); ++f) taken.triangles[f] = turned(mesh.triangles[f], turns[f]);
  const Grid grid = fitGrid(mesh, {.resolution = 12});
  const FieldOptions options;
  Progress progress;
  Field field;
  const Model model(mesh);
  cpu::Backend backend;
  backend.setJob({model, grid, options, progress, field});
  backend.begin();
  if (isTreeThereBefore) backend.exactDistance();
  if (!turns.empty()) backend.turnFaces(turns);
  std::vector<glm::vec3> points;
  for (size_t s = 0; s < grid.sampleCount(); s += 5)
    points.emplace_back((samplePosition(grid, s) - grid.origin) / grid.spacing);
  const std::vector<float> numbers = backend.windingAt(points);
  for (size_t p = 0; p < points.size(); ++p)
    ASSERT_NEAR(numbers[p], reference::windingNumber(taken, samplePosition(grid, 5 * p)), 0.05) << p;
}

TEST(WindingDipoles, CountDoubleSidedFacesAsTheSignTakesThem) {
  const Mesh mesh = withDoubledFaces(openSphere(), 0.4, 1);
  const DoubleSidedFaces faces = findDoubleSidedFaces(mesh);
  ASSERT_GT(faces.firsts.size(), 500u);
  const Turns single = withoutOthers(faces, mesh.triangles.size());
  Turns reversed = single, sheets = single, odd = single, bothReversed = single;
  for (const uint32_t first : faces.firsts) reversed[first] = kReversed;
  for (size_t g = 0; g < faces.firsts.size(); ++g) {
    if (g % 2 == 0) sheets[faces.others[g]] = kAsGiven;
    odd[faces.others[g]] = g % 2 == 0 ? kReversed : kAsGiven;  // Twice the same way, or cancelled.
    bothReversed[faces.firsts[g]] = bothReversed[faces.others[g]] = kReversed;
  }
  for (const Turns& turns : {Turns{}, single, reversed, sheets, odd, bothReversed})
    for (const bool isTreeThereBefore : {false, true}) expectTaken(mesh, turns, isTreeThereBefore);
}

TEST(WindingDipoles, CountLargerGroupsOfDoubleSidedFaces) {
  Mesh mesh = openSphere();
  const std::vector<glm::uvec3> once = mesh.triangles;
  for (size_t f = 0; f < once.size(); f += 3)  // Two faces of each direction.
    for (const glm::uvec3& t : {once[f], turned(once[f], kReversed), turned(once[f], kReversed)})
      mesh.triangles.push_back(t);
  const Turns given(mesh.triangles.size(), kAsGiven);
  Turns mixed = given;
  mixed[once.size() + 1] = kLeftOut;
  for (const Turns& turns : {Turns{}, given, mixed}) expectTaken(mesh, turns, true);
}

}  // namespace
}  // namespace raymap
