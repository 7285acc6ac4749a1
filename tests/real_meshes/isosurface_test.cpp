// The isosurface of every mesh of the folder is watertight.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "closed_mesh.h"
#include "mesh_folder.h"

namespace raymap {
namespace {

TEST(IsosurfaceOfRealMeshes, IsClosedForEveryMesh) {
  const std::vector<std::string> names = wellFormedMeshes();
  RAYMAP_NEED_MESHES();
  Generator generator;
  Field field;
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    const Mesh mesh = readMesh(meshFolder() / name);
    const Box box = bounds(mesh);
    const double longest = std::max({box.size().x, box.size().y, box.size().z});
    // Flat and open meshes have no inside, but a sheet with a thickness has.
    for (const double thickness : {0.0, longest / 16.0}) {
      FieldOptions options;
      options.thickness = thickness;
      generator.generate(mesh, fitGrid(mesh, {.resolution = 48}), options, field);
      if (std::ranges::none_of(field.distance, [](float d) { return d < 0.0f; })) continue;
      const Mesh surface = isosurface(field);
      EXPECT_TRUE(isClosed(surface));
      const Diagnostics found = diagnose(surface);
      EXPECT_TRUE(found.watertight && found.consistentlyOriented);
      EXPECT_EQ(found.degenerateFaces + found.duplicateFaces, 0u);
      EXPECT_GT(found.signedVolume, 0.0);
      EXPECT_EQ(findSelfIntersections(surface).pairs, 0u);
    }
  }
}

TEST(IsosurfaceOfRealMeshes, HasNoFacesThatCross) {
  RAYMAP_NEED_MESHES();
  // There would be 4 pairs without fans, and 383 where walls are thinner than a sample.
  for (const char* name : {"common3d__fandisk.obj", "vtkdata__trumpet.obj"}) {
    const Mesh mesh = readMesh(meshFolder() / name);
    const Mesh surface = isosurface(generate(mesh, fitGrid(mesh, {.resolution = 256})).field);
    EXPECT_TRUE(isClosed(surface));
    EXPECT_EQ(findSelfIntersections(surface).pairs, 0u);
  }
}

}  // namespace
}  // namespace raymap
