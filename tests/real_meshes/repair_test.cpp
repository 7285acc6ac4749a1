// The faces of every mesh of the folder that a repair keeps bound a solid.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <random>

#include "mesh_folder.h"
#include "reference.h"

namespace raymap {
namespace {

constexpr int kPoints = 50;

/// Returns random points around and in the mesh.
std::vector<glm::dvec3> randomPoints(const Mesh& mesh) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-0.05, 1.05);
  const Box box = bounds(mesh);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < kPoints; ++i)
    points.push_back(box.min + box.size() * glm::dvec3(unit(random), unit(random), unit(random)));
  return points;
}

TEST(RepairOfRealMeshes, KeepsOnlyFacesThatBoundASolid) {
  const std::vector<std::string> names = wellFormedMeshes();
  RAYMAP_NEED_MESHES();
  size_t kept = 0, closed = 0, cleaned = 0, united = 0, withNeedles = 0;
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    const Mesh mesh = readMesh(meshFolder() / name);
    if (mesh.triangles.size() > 200'000) continue;
    Repaired made;
    try {
      // Without plates, which meshes take whose faces are not kept.
      made = repair(mesh, fitRepairGrid(mesh, {.resolution = 12}, {}), {},
                    {.minThickness = 0.0, .measure = false}, {.device = "cpu"});
    } catch (const Error&) {
      continue;  // So few samples may miss a mesh.
    }
    if (!made.report.keepsFaces()) continue;
    ++kept;
    closed += made.report.closedHoles > 0 ? 1 : 0;
    const size_t most = mesh.triangles.size() + made.report.closingFaces;
    const bool isUnited = made.report.unitedFaces > 0 || made.report.partsOverlap;
    united += isUnited ? 1 : 0;
    if (!isUnited) {
      EXPECT_LE(made.mesh.triangles.size(), most);
      EXPECT_GE(made.mesh.triangles.size() + made.report.cleanedFaces, most);
    }
    const Diagnostics found = diagnose(made.mesh);
    if (made.report.cleanedFaces > 0 && made.report.closedHoles == 0 && !isUnited) {
      ++cleaned;
      const double volume = diagnose(mesh, {.brief = true}).signedVolume;
      EXPECT_NEAR(found.signedVolume, volume, 1e-5 * volume);
    }
    EXPECT_TRUE(found.watertight && found.consistentlyOriented);
    EXPECT_EQ(found.vertices, found.weldedVertices);
    EXPECT_EQ(found.duplicateFaces, 0u);
    if (found.degenerateFaces > 0) {  // Without these, others would cross.
      ++withNeedles;
      EXPECT_GT(diagnose(mesh, {.brief = true}).degenerateFaces, 0u);
    }
    EXPECT_EQ(findSelfIntersections(made.mesh).pairs, 0u);
    for (const glm::dvec3& p : randomPoints(made.mesh)) {
      const double winding = reference::windingNumber(made.mesh, p);
      EXPECT_LT(std::min(std::abs(winding), std::abs(winding - 1.0)), 1e-3) << winding;
    }
  }
  EXPECT_LE(withNeedles, 1u);
  EXPECT_GT(kept, 10u);
  EXPECT_GT(closed, 2u);
  EXPECT_GT(cleaned, 2u);
  EXPECT_GT(united, 5u);
}

}  // namespace
}  // namespace raymap
