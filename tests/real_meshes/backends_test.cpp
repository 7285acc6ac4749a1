// Every mesh of the folder on a Vulkan device against the CPU, which other tests compare with brute force.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <cmath>

#include "api/devices.h"
#include "mesh_folder.h"

namespace raymap {
namespace {

/// Largest mesh to compare: a software rasterizer takes a minute for a million triangles.
constexpr size_t kMostTriangles = 30'000;

Field make(const Mesh& mesh, const char* device, bool closesHoles = false) {
  FieldOptions options;
  options.winding = true;
  options.closeHoles = closesHoles;
  return generate(mesh, fitGrid(mesh, {.resolution = closesHoles ? 32 : 48}), options, {.device = device})
      .field;
}

TEST(Backends, GiveTheSameFieldOfEveryMesh) {
  const std::vector<std::string> names = wellFormedMeshes();
  RAYMAP_NEED_MESHES();
  if (devices().devices.size() < 2) GTEST_SKIP() << devices().note;
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    const Mesh mesh = readMesh(meshFolder() / name);
    if (mesh.triangles.size() > kMostTriangles) continue;
    const Field cpu = make(mesh, "cpu"), gpu = make(mesh, "vulkan");
    const double tolerance = 1e-6 * glm::length(bounds(mesh).size());
    double largest = 0.0;
    size_t wrong = 0;
    for (size_t s = 0; s < cpu.distance.size(); ++s) {
      const float a = cpu.distance[s], b = gpu.distance[s];
      largest = std::max(largest, double(std::abs(std::abs(a) - std::abs(b))));
      wrong += std::signbit(a) != std::signbit(b) && std::abs(a) > tolerance &&
               std::abs(std::abs(cpu.winding[s]) - 0.5f) > 1e-4f;
    }
    EXPECT_LE(largest, tolerance);
    EXPECT_EQ(wrong, 0u);
  }
}

TEST(Backends, CloseTheSameHolesOfEveryMesh) {
  RAYMAP_NEED_MESHES();
  if (devices().devices.size() < 2) GTEST_SKIP() << devices().note;
  for (const MeshRow& row : meshRows()) {
    if (row.at("kind") == "malformed" || row.at("boundary_edges") == "0") continue;
    SCOPED_TRACE(row.at("file"));
    const Mesh mesh = readMesh(meshFolder() / row.at("file"));
    if (mesh.triangles.size() > kMostTriangles) continue;
    const Field cpu = make(mesh, "cpu", true), gpu = make(mesh, "vulkan", true);
    for (size_t i = 0; i < cpu.distance.size(); ++i)
      ASSERT_NEAR(std::abs(cpu.distance[i]), std::abs(gpu.distance[i]), 0.01 * cpu.grid.spacing) << i;
  }
}

}  // namespace
}  // namespace raymap
