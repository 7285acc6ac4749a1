// Every mesh of the shared folder: those that are right keep what they have.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <cmath>
#include <random>

#include "mesh_folder.h"

namespace raymap {
namespace {

struct Outcome {
  Field field;
  Stats stats;
};

Outcome runOf(const Mesh& mesh, const Grid& grid, Orientation orientation) {
  Options options;
  options.device = "cpu";
  options.orientation = orientation;
  Generator generator;
  Outcome run;
  generator.generate(mesh, grid, options, run.field);
  run.stats = generator.stats();
  return run;
}

size_t countUnlike(const Field& a, const Field& b) {
  size_t unlike = 0;
  for (size_t s = 0; s < a.distance.size(); ++s)
    unlike += std::signbit(a.distance[s]) != std::signbit(b.distance[s]);
  return unlike;
}

Mesh flipped(Mesh mesh, double share) {
  std::mt19937 random(5);
  for (glm::uvec3& t : mesh.triangles)
    if (double(random() % 1000) < 1000.0 * share) std::swap(t.y, t.z);
  return mesh;
}

/// So many that all of them take seconds.
constexpr size_t kMostTriangles = 130'000;

TEST(OrientationWide, AutoKeepsEveryConsistentMesh) {
  if (meshRows().empty()) GTEST_SKIP() << "no folder of meshes";
  size_t tried = 0;
  for (MeshRow& row : meshRows()) {
    if (row["kind"] == "malformed" || row["consistently_oriented"] != "yes") continue;
    SCOPED_TRACE(row["file"]);
    const Mesh mesh = readMesh(meshFolder() / row["file"]);
    if (mesh.triangles.size() > kMostTriangles) continue;
    const Grid grid = fitGrid(mesh, {.resolution = 48});
    const Outcome chosen = runOf(mesh, grid, Orientation::Auto);
    EXPECT_EQ(chosen.stats.turnedFaces.size(), 0u);
    EXPECT_EQ(countUnlike(chosen.field, runOf(mesh, grid, Orientation::Keep).field), 0u);
    ++tried;
  }
  EXPECT_GT(tried, 0u);
}

TEST(OrientationWide, AutoNeverFitsWorse) {
  if (meshRows().empty()) GTEST_SKIP() << "no folder of meshes";
  size_t turned = 0;
  for (MeshRow& row : meshRows()) {
    if (row["kind"] == "malformed" || row["consistently_oriented"] == "yes") continue;
    SCOPED_TRACE(row["file"]);
    const Mesh mesh = readMesh(meshFolder() / row["file"]);
    const Outcome chosen = runOf(mesh, fitGrid(mesh, {.resolution = 48}), Orientation::Auto);
    EXPECT_LE(chosen.stats.misfit, chosen.stats.misfitGiven);
    turned += chosen.stats.turnedFaces.empty() ? 0 : 1;
  }
  EXPECT_GT(turned, 3u);
}

TEST(OrientationWide, TurnsRandomFacesBack) {
  if (meshRows().empty()) GTEST_SKIP() << "no folder of meshes";
  for (const char* name : {"libigl__bunny.off", "common3d__homer.obj", "thingi10k__88566.stl"}) {
    SCOPED_TRACE(name);
    if (!std::filesystem::exists(meshFolder() / name)) continue;
    Mesh mesh = readMesh(meshFolder() / name);
    std::mt19937 random(3);
    std::erase_if(mesh.triangles, [&](const glm::uvec3&) { return random() % 10 == 0; });
    const Grid grid = fitGrid(mesh, {.resolution = 64});
    const Field right = runOf(mesh, grid, Orientation::Keep).field;
    for (const double share : {0.1, 0.3, 0.5})
      EXPECT_LE(double(countUnlike(right, runOf(flipped(mesh, share), grid, Orientation::Auto).field)),
                0.0005 * double(grid.sampleCount()))
          << share;
  }
}

}  // namespace
}  // namespace raymap
