#include "cpu/sign/winding_dipoles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

  double exact(size_t s) const { return reference::windingNumber(mesh, samplePosition(grid, s)); }
};

/// Settles winding numbers that all start at `value`, `distance` cells from the surface, with a threshold of
/// 0.5.
Settled settled(const Mesh& mesh, int resolution, float value, float distance = 0.0f) {
  Settled result{.mesh = mesh, .grid = fitGrid(mesh, {.resolution = resolution})};
  result.winding.resizeUninitialized(result.grid.sampleCount());
  std::fill(result.winding.begin(), result.winding.end(), value);
  Buffer<float> distances(result.winding.size());
  std::fill(distances.begin(), distances.end(), distance);
  SurfaceTree tree;
  const auto surface = [&]() -> const SurfaceTree& {
    tree.build(cellMesh(mesh, result.grid));
    return tree;
  };
  Progress progress;
  WindingDipoles().settle(surface, result.grid.dims, distances, 0.5, {0, kLooks}, progress, result.winding);
  return result;
}

Mesh openSphere() {
  Mesh mesh = shapes::sphere(1.0, 4);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.4; });
  return mesh;
}

TEST(WindingDipoles, AreTheExactWindingNumber) {
  // One triangle, a leaf that is not full, one triangle more than a leaf holds, and thousands.
  for (const Mesh& mesh :
       {shapes::soup(1, 3), shapes::soup(5, 4), shapes::soup(9, 5), shapes::soup(1000, 6), openSphere()}) {
    const Settled result = settled(mesh, 16, 0.5f);
    double sum = 0.0;
    for (size_t s = 0; s < result.winding.size(); ++s) {
      const double error = std::abs(result.winding[s] - result.exact(s));
      // Numbers near the threshold are computed more accurately.
      ASSERT_LT(error, std::abs(std::abs(result.winding[s]) - 0.5) < 0.015 ? 0.005 : 0.05);
      sum += error;
    }
    EXPECT_LT(sum / double(result.winding.size()), 0.008) << mesh.triangles.size() << " triangles";
  }
}

TEST(WindingDipoles, HaveTheSignOfTheExactNumber) {
  const Settled result = settled(openSphere(), 24, 0.5f);
  size_t wrong = 0;
  for (size_t s = 0; s < result.winding.size(); ++s)
    wrong += (std::abs(result.winding[s]) > 0.5f) != (std::abs(result.exact(s)) > 0.5);
  EXPECT_LE(wrong, 1u);
}

TEST(WindingDipoles, LeaveAloneWhatIsFarFromTheThreshold) {
  for (const float w : settled(openSphere(), 12, 0.85f).winding) ASSERT_EQ(w, 0.85f);
  for (const float w : settled(openSphere(), 12, -0.15f).winding) ASSERT_EQ(w, -0.15f);
  // The lattice's error is smaller far from the surface.
  for (const float w : settled(openSphere(), 12, 0.55f, 20.0f).winding) ASSERT_EQ(w, 0.55f);
}

TEST(WindingDipoles, SurviveDegenerateTriangles) {
  Mesh mesh = openSphere();
  mesh.triangles.insert(mesh.triangles.begin(), {{0, 0, 0}, {0, 1, 1}, {2, 3, 2}});
  for (const float w : settled(mesh, 16, 0.5f).winding) ASSERT_TRUE(std::abs(w) < 1.1f);
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
  cpu::Backend backend;
  backend.take({mesh, grid, options, progress, field});
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
