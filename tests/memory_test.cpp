// The command line's peak memory for a default field at 256^3: at most 24 bytes a sample plus 200 bytes a
// triangle.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <filesystem>

#include "run_program.h"
#include "shapes.h"

namespace raymap {

namespace {

TEST(Memory, DefaultFieldStaysLean) {
  const std::filesystem::path folder = testing::TempDir();
  const std::string meshFile = folder / "memory_test.ply", fieldFile = folder / "memory_test.nrrd";
  const Mesh mesh = shapes::sphere(1.0, 6);
  writeMesh(meshFile, mesh);
  const ProgramRun run =
      runProgram({RAYMAP_BINARY, "generate", meshFile, "-o", fieldFile, "--resolution", "256"});
  EXPECT_EQ(run.code, 0) << run.error;
  const size_t samples = fitGrid(mesh, {.resolution = 256}).sampleCount();
  EXPECT_LE(run.peakBytes, 24 * samples + 200 * mesh.triangles.size());
  std::filesystem::remove(meshFile);
  std::filesystem::remove(fieldFile);
}

}  // namespace

}  // namespace raymap
