// The command line's peak memory for a default field at 256^3: at most 24 bytes a sample plus 200 bytes a
// triangle.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "files.h"
#include "run_program.h"
#include "shapes.h"

namespace raymap {

namespace {

TEST(Memory, DefaultFieldStaysLean) {
  const TemporaryFolder folder;
  const std::string meshFile = folder.path() / "mesh.ply", fieldFile = folder.path() / "field.nrrd";
  const Mesh mesh = shapes::sphere(1.0, 6);
  writeMesh(meshFile, mesh);
  const ProgramRun run =
      runProgram({RAYMAP_BINARY, "generate", meshFile, "-o", fieldFile, "--resolution", "256"});
  EXPECT_EQ(run.code, 0) << run.error;
  const size_t samples = fitGrid(mesh, {.resolution = 256}).sampleCount();
  EXPECT_LE(run.peakBytes, 24 * samples + 200 * mesh.triangles.size());
}

TEST(Memory, AFarVertexTakesNoMorePointsOfASimplification) {
  const TemporaryFolder folder;
  const std::string far = folder.path() / "far.ply", fewer = folder.path() / "fewer.ply";
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.vertices[6].z = 1e19f;
  writeMesh(far, mesh);
  const ProgramRun run = runProgram({RAYMAP_BINARY, "simplify", far, "-o", fewer, "--tolerance", "0.05"});
  EXPECT_EQ(run.code, 0) << run.error;
  EXPECT_LE(run.peakBytes, size_t{300} << 20);
}

}  // namespace

}  // namespace raymap
