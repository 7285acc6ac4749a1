// The orientation of every mesh of the folder: faces that point the right way stay as they are.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "broken_meshes.h"
#include "cpu_run.h"
#include "mesh_folder.h"

namespace raymap {
namespace {

/// Largest mesh to examine, so that the test takes seconds.
constexpr size_t kMostTurned = 130'000;

TEST(OrientationOfRealMeshes, AutoKeepsEveryConsistentMesh) {
  RAYMAP_NEED_MESHES();
  size_t tried = 0, inverted = 0;
  for (MeshRow& row : meshRows()) {
    if (row["kind"] == "malformed" || row["consistently_oriented"] != "yes") continue;
    SCOPED_TRACE(row["file"]);
    const Mesh mesh = readMesh(meshFolder() / row["file"]);
    if (mesh.triangles.size() > kMostTurned) continue;
    const Grid grid = fitGrid(mesh, {.resolution = 48});
    const Generated chosen = runOf(mesh, grid, Orientation::Auto);
    EXPECT_EQ(chosen.stats.turnedFaces.empty(), chosen.stats.invertedParts.empty());
    if (chosen.stats.invertedParts.empty()) {
      EXPECT_EQ(countUnlike(chosen, runOf(mesh, grid, Orientation::Keep)), 0u);
    } else {
      ++inverted;
    }
    ++tried;
  }
  EXPECT_GT(tried, 0u);
  EXPECT_EQ(inverted, 2u);  // They have whole parts that are inside out and cross others.
}

TEST(OrientationOfRealMeshes, AutoNeverFitsWorse) {
  RAYMAP_NEED_MESHES();
  size_t turned = 0;
  for (MeshRow& row : meshRows()) {
    if (row["kind"] == "malformed" || row["consistently_oriented"] == "yes") continue;
    SCOPED_TRACE(row["file"]);
    const Mesh mesh = readMesh(meshFolder() / row["file"]);
    const Generated chosen = runOf(mesh, fitGrid(mesh, {.resolution = 48}), Orientation::Auto);
    EXPECT_LE(chosen.stats.misfit, chosen.stats.misfitGiven);
    turned += chosen.stats.turnedFaces.empty() ? 0 : 1;
  }
  EXPECT_GT(turned, 3u);
}

TEST(OrientationOfRealMeshes, TurnsRandomFacesBack) {
  RAYMAP_NEED_MESHES();
  for (const char* name : {"libigl__bunny.off", "common3d__homer.obj", "thingi10k__79741.stl"}) {
    SCOPED_TRACE(name);
    if (!std::filesystem::exists(meshFolder() / name)) continue;
    // These random numbers reverse most of a large patch of the last mesh.
    const Mesh mesh = withMissingFaces(withHoles(readMesh(meshFolder() / name), 5, 0.06, 15), 0.1, 15);
    const Grid grid = fitGrid(mesh, {.resolution = 64});
    const Generated right = runOf(mesh, grid, Orientation::Keep);
    for (const double share : {0.1, 0.3, 0.5})
      EXPECT_LE(double(countUnlike(right, runOf(withFlippedFaces(mesh, share, 15), grid, Orientation::Auto))),
                0.0005 * double(grid.sampleCount()))
          << share;
  }
}

}  // namespace
}  // namespace raymap
