#include <algorithm>

#include "cli.h"
#include "shapes.h"

namespace raymap {
namespace {

class CliConvert : public Cli {};

TEST_F(CliConvert, ConvertsMeshes) {
  writeTorus();
  succeed("convert torus.ply torus.glb");
  const Mesh before = readMesh(path("torus.ply")), after = readMesh(path("torus.glb"));
  EXPECT_EQ(before.vertices, after.vertices);
  EXPECT_EQ(before.triangles, after.triangles);
  expectFailure("convert torus.ply torus.vdb", ErrorCode::Usage, "torus.vdb");
  succeed("convert torus.ply -o again.ply");
  EXPECT_EQ(readBytes(path("again.ply")), readBytes(path("torus.ply")));
  expectFailure("convert torus.ply -o torus.vdb", ErrorCode::Usage, "torus.vdb");
  expectFailure("convert torus.ply", ErrorCode::Usage, "--output is required");
  expectFailure("convert torus.ply a.ply -o b.ply", ErrorCode::Usage,
                "file and --output cannot be used together");
}

TEST_F(CliConvert, ConvertsUnitsScaleAndAxis) {
  // y is up: 2 wide, 3 high, 5 deep.
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(2, 3, 5)));
  const auto boxOf = [&](const char* name) { return bounds(readMesh(path(name))); };
  const auto expectBox = [&](const char* name, const glm::dvec3& low, const glm::dvec3& high) {
    const Box box = boxOf(name);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(box.min[axis], low[axis], 1e-4) << name << " " << axis;
      EXPECT_NEAR(box.max[axis], high[axis], 1e-4) << name << " " << axis;
    }
    EXPECT_GT(diagnose(readMesh(path(name))).signedVolume, 0.0) << name;
  };
  succeed("convert box.ply a.3mf");
  expectBox("a.3mf", {0, 0, 0}, {2, 3, 5});
  succeed("convert box.ply inch.3mf --unit in");
  expectBox("inch.3mf", {0, 0, 0}, {50.8, 76.2, 127});
  succeed("convert box.ply scaled.ply --scale 2.5 --unit in");
  expectBox("scaled.ply", {0, 0, 0}, {5, 7.5, 12.5});
  succeed("convert box.ply z.ply --up y");
  expectBox("z.ply", {0, -5, 0}, {2, 0, 3});
  succeed("convert z.ply same.ply --up z");
  expectBox("same.ply", {0, -5, 0}, {2, 0, 3});
  succeed("convert z.ply y.glb --up z --unit m");
  expectBox("y.glb", {0, 0, 0}, {2, 3, 5});
  succeed("convert y.glb y2.glb --up y");
  expectBox("y2.glb", {0, 0, 0}, {2, 3, 5});
  succeed("convert y.glb metres.3mf --scale .001");
  expectBox("metres.3mf", {0, 0, 0}, {2, 3, 5});
  succeed("convert y.glb b.stl --unit cm --scale 2 --up y");
  expectBox("b.stl", {0, -1000, 0}, {400, 0, 600});
  EXPECT_EQ(
      run("convert y.glb c.stl").err,
      "raymap: warning: c.stl: its lengths are in m, as in y.glb, but programs take them for mm; --unit mm "
      "converts them\n");
  expectBox("c.stl", {0, 0, 0}, {2, 3, 5});
  EXPECT_EQ(
      run("convert a.3mf c.glb").err,
      "raymap: warning: c.glb: its lengths are in mm, as in a.3mf, but programs take them for m; --unit m "
      "converts them\n");
}

TEST_F(CliConvert, RefusesUnitsThatMeanNothing) {
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(1.0)));
  expectFailure("convert box.ply a.3mf --unit furlong", ErrorCode::Usage,
                "--unit: must be one of um, mm, cm, m, in, ft, not furlong");
  expectFailure("convert box.ply a.3mf --up w", ErrorCode::Usage,
                "--up takes 3 numbers, or an axis such as z");
  expectFailure("convert box.ply a.3mf --scale 0", ErrorCode::Usage,
                "--scale: must be a number above 0, not 0");
  expectFailure("convert box.ply a.3mf --scale 1e39", ErrorCode::Usage,
                "--scale 1e+39: the mesh becomes too large for single precision");
  expectFailure("convert box.ply a.3mf --scale 1e-39", ErrorCode::Usage,
                "--scale 1e-39: the mesh becomes too small for single precision");
  expectFailure("repair box.ply -o a.glb --unit mm", ErrorCode::Usage,
                "--unit mm: a.glb is in metres, as its format demands; use --unit m");
  Field field;
  field.grid = {{2, 2, 2}, glm::dvec3(0.0), 1.0};
  field.distance.resizeUninitialized(8);
  std::ranges::fill(field.distance, 1.0F);
  writeField(path("field.nrrd"), field);
  expectFailure("convert field.nrrd a.npz --up z", ErrorCode::Usage,
                "--up, --rotate and --recenter are for meshes, and field.nrrd is a field");
  expectFailure("convert field.nrrd a.npz --recenter", ErrorCode::Usage, "are for meshes");
  EXPECT_EQ(fileCount(), 2u);
}

}  // namespace
}  // namespace raymap
