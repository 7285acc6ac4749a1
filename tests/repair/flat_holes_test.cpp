#include "repair/topology/flat_holes.h"

#include <gtest/gtest.h>
#include <raymap/mesh_view.h>

#include <numbers>

#include "broken_meshes.h"
#include "closed_mesh.h"
#include "mesh/compact.h"
#include "mesh/model.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::box;
using shapes::inverted;
using shapes::joined;

/// Leaves out the faces of a mesh all of whose corners lie at a height.
Mesh without(const Mesh& mesh, double z) {
  return keepTriangles(mesh, [&](const glm::uvec3& t) {
    return mesh.position(t.x).z != z || mesh.position(t.y).z != z || mesh.position(t.z).z != z;
  });
}

/// Fills the holes of a mesh, and expects a closed one of this volume.
void expectFills(Mesh mesh, size_t holes, double volume) {
  mesh = weldedCopy(Model(mesh));
  const size_t before = mesh.triangles.size();
  const FilledHoles filled = fillFlatHoles(mesh);
  EXPECT_EQ(filled.holes, holes);
  EXPECT_EQ(mesh.triangles.size(), before + filled.faces);
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_NEAR(volumeOf(mesh), volume, 1e-5 * volume);
}

void expectLeaves(Mesh mesh) {
  mesh = weldedCopy(Model(mesh));
  const size_t before = mesh.triangles.size();
  EXPECT_EQ(fillFlatHoles(mesh).holes, 0u);
  EXPECT_EQ(mesh.triangles.size(), before);
}

Mesh tilted(Mesh mesh) {
  for (glm::vec3& p : mesh.vertices) {
    const glm::dvec3 q(p);
    p = glm::vec3(0.8 * q.x - 0.36 * q.y + 0.48 * q.z, 0.6 * q.x + 0.48 * q.y - 0.64 * q.z,
                  0.8 * q.y + 0.6 * q.z);
  }
  return mesh;
}

const Mesh kOpen = without(box({0, 0, 0}, {4, 4, 4}), 0.0);

TEST(FlatHoles, ClosesPartsWithoutFloors) {
  expectFills(kOpen, 1, 64.0);
  expectFills(without(kOpen, 4.0), 2, 64.0);
  expectFills(tilted(kOpen), 1, 64.0);
  const Mesh other = without(box({2, 1, 0}, {6, 3, 5}), 0.0), third = without(box({3, 2, 0}, {4, 9, 3}), 0.0);
  expectFills(joined(kOpen, other), 2, 64.0 + 40.0);
  expectFills(joined(joined(kOpen, other), third), 3, 64.0 + 40.0 + 21.0);
  expectFills(joined(kOpen, box({1, 1, 0}, {9, 2, 1})), 1, 64.0 + 8.0);  // It has a floor there.
}

TEST(FlatHoles, ClosesRimsInRimsByOneFace) {
  // A cup, and a cup with a post in it. The inner walls point to the axis.
  const Mesh cup = joined(kOpen, inverted(without(box({1, 1, 0}, {3, 3, 3}), 0.0)));
  expectFills(cup, 2, 64.0 - 12.0);
  const Mesh post = without(box({1.5, 1.5, 0}, {2.5, 2.5, 2}), 0.0);
  expectFills(joined(cup, post), 3, 64.0 - 12.0 + 2.0);
  // A part in another one that points the same way has a floor of its own.
  expectFills(joined(kOpen, without(box({1, 1, 0}, {3, 3, 3}), 0.0)), 2, 64.0 + 12.0);
}

Mesh tube(uint32_t sides) {
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (uint32_t i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    for (const double z : {0.0, 1.0}) p.emplace_back(std::cos(angle), std::sin(angle), z);
    const uint32_t next = 2 * ((i + 1) % sides);
    t.emplace_back(2 * i, next, 2 * i + 1), t.emplace_back(next, next + 1, 2 * i + 1);
  }
  return makeMesh(p, t);
}

TEST(FlatHoles, ClosesLongRims) {
  expectFills(tube(900), 2, 450.0 * std::sin(2.0 * std::numbers::pi / 900));
}

TEST(FlatHoles, LeavesWhatIsNotCertain) {
  expectLeaves(box({0, 0, 0}, {1, 1, 1}));
  // A flat sheet, also beside a box that it would close but for the vertices on its rim.
  const Mesh sheet = keepTriangles(box({0, 0, 0}, {4, 4, 4}), [&](const glm::uvec3& t) {
    const Mesh whole = box({0, 0, 0}, {4, 4, 4});
    return whole.position(t.x).z == 0.0 && whole.position(t.y).z == 0.0 && whole.position(t.z).z == 0.0;
  });
  ASSERT_EQ(sheet.triangles.size(), 2u);
  expectLeaves(sheet);
  Mesh divided = sheet;  // Its rim has a corner more.
  const glm::uvec3 t = divided.triangles[0];
  const auto middle = uint32_t(divided.vertices.size());
  for (int c = 0; c < 3; ++c) {
    const uint32_t from = t[c], to = t[(c + 1) % 3];
    if (glm::distance(divided.vertices[from], divided.vertices[to]) > 4.5f) continue;
    divided.vertices.push_back(0.5f * (divided.vertices[from] + divided.vertices[to]));
    divided.triangles[0] = {from, middle, t[(c + 2) % 3]};
    divided.triangles.emplace_back(middle, to, t[(c + 2) % 3]);
    break;
  }
  expectLeaves(joined(kOpen, divided));
  // A rim that lies in no plane; then no hole of the part is filled.
  Mesh bent = without(kOpen, 4.0);
  bent.vertices[0].z -= 0.01f;
  expectLeaves(bent);
  bent.vertices[0].z += 0.0099f;
  expectFills(bent, 2, 64.0);
}

}  // namespace
}  // namespace raymap
