// Memory that a run asks for, beside what it holds.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "base/memory.h"
#include "broken_meshes.h"
#include "shapes.h"

namespace raymap {
namespace {

/// Returns the error of a run that may hold so many bytes; "" if it succeeds.
std::string errorWith(const Mesh& mesh, size_t memoryLimit, const FieldOptions& options = {}) {
  try {
    generate(mesh, fitGrid(mesh, {.resolution = 96}), options, {.device = "cpu", .memoryLimit = memoryLimit});
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Memory);
    return error.what();
  }
  return {};
}

size_t heldBy(const Mesh& mesh, const FieldOptions& options = {}) {
  return generate(mesh, fitGrid(mesh, {.resolution = 96}), options, {.device = "cpu"}).stats.bytes;
}

/// Returns spheres in spheres, whose surface crosses each line many times.
Mesh manyLayers() {
  Mesh layers = shapes::sphere(1.0, 3);
  for (int k = 1; k < 24; ++k) layers = shapes::joined(layers, shapes::sphere(1.0 - 0.04 * k, 3));
  return layers;
}

TEST(GeneratorMemory, AsksForWhatAClosedMeshHolds) {
  for (const Mesh& mesh : {shapes::sphere(1.0, 5), shapes::torus(1.0, 0.3, 200, 100)}) {
    const size_t held = heldBy(mesh);
    EXPECT_EQ(errorWith(mesh, held + held / 2), "");
    const std::string error = errorWith(mesh, held - 1);
    EXPECT_NE(error.find("the field needs "), std::string::npos) << error;
    EXPECT_EQ(error.find("because"), std::string::npos) << error;
  }
}

TEST(GeneratorMemory, AsksForTheSolverWhereRaysDisagree) {
  const Mesh closed = shapes::sphere(1.0, 4);
  const Mesh open = withHoles(closed, 40, 0.04, 1);  // So many rims that the field is fitted.
  for (const SignMode sign : {SignMode::Harmonic, SignMode::Paths, SignMode::Evolution}) {
    SCOPED_TRACE(testing::Message() << "sign " << int(sign));
    const FieldOptions options{.sign = sign};
    const size_t held = heldBy(open, options), before = heldBy(closed, options);
    ASSERT_LT(before + before / 4, held - 1);
    EXPECT_EQ(errorWith(closed, before + before / 4, options), "");
    for (const size_t limit : {before + before / 4, held - held / 20}) {
      const std::string error = errorWith(open, limit, options);
      EXPECT_NE(error.find(", because the mesh has holes or reversed faces, but only " + limitText(limit) +
                           " may be used"),
                std::string::npos)
          << error;
    }
    EXPECT_EQ(errorWith(open, held + held / 4, options), "");
  }
}

TEST(GeneratorMemory, AsksForLayersWhenItHasCountedThem) {
  const Mesh mesh = manyLayers();
  const size_t held = heldBy(mesh);
  const std::string error = errorWith(mesh, held - held / 50);
  EXPECT_NE(error.find(", because the mesh has many layers, but only "), std::string::npos) << error;
  EXPECT_EQ(errorWith(mesh, held + held / 10), "");
}

TEST(GeneratorMemory, AsksForTheSearchForReversedFaces) {
  // Many faces for a coarse grid: the search takes most.
  const Mesh mesh = withFlippedFaces(shapes::sphere(1.0, 7), 0.3, 1);
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  const size_t held = generate(mesh, grid, {.orientation = Orientation::Keep}, {.device = "cpu"}).stats.bytes;
  try {
    generate(mesh, grid, {}, {.device = "cpu", .memoryLimit = held + held / 4});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Memory);
    EXPECT_EQ(std::string(error.what()).find("finding the reversed faces needs 42 MiB, but only "), 0u)
        << error.what();
  }
  EXPECT_NO_THROW(generate(mesh, grid, {}, {.device = "cpu", .memoryLimit = held + (size_t{48} << 20)}));
}

TEST(GeneratorMemory, KeepsToTheLimitWithMemoryOfEarlierRuns) {
  const Mesh closed = shapes::sphere(1.0, 4);
  const Mesh open = withHoles(closed, 40, 0.04, 1);
  const Grid grid = fitGrid(closed, {.resolution = 64});
  Generator generator;
  Field field;
  const FieldOptions options{.orientation = Orientation::Keep};
  const size_t held = generator.generate(open, grid, options, field, {.device = "cpu"}).bytes;
  const MachineOptions limited{.device = "cpu", .memoryLimit = held + held / 50};
  EXPECT_EQ(generator.generate(open, grid, options, field, limited).bytes, held);
}

TEST(MemoryText, RoundsNeedsUpAndLimitsDown) {
  EXPECT_EQ(neededText(0), "0 bytes");
  EXPECT_EQ(neededText(1), "1 byte");
  EXPECT_EQ(limitText(12), "12 bytes");
  EXPECT_EQ(limitText(1023), "1023 bytes");
  EXPECT_EQ(neededText(1024), "1 KiB");
  EXPECT_EQ(neededText(1025), "2 KiB");
  EXPECT_EQ(limitText(2047), "1 KiB");
  EXPECT_EQ(limitText((1 << 20) - 1), "1023 KiB");
  EXPECT_EQ(limitText(1 << 20), "1 MiB");
  EXPECT_EQ(limitText((2 << 20) - 1), "1 MiB");
  EXPECT_EQ(neededText((1 << 20) + 1), "2 MiB");
  EXPECT_EQ(neededText(uint64_t{5} << 40), "5242880 MiB");
}

}  // namespace
}  // namespace raymap
