// The first program of a new user: README's lines, then a 3MF in and a .vdb out. Runs in a folder that holds
// tetrahedron.3mf.

#include <raymap/raymap.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <stdexcept>

namespace {

void require(bool isTrue, const char* what) {
  if (!isTrue) throw std::runtime_error(what);
}

/// README's snippet.
float distanceToScan() {
  raymap::Mesh mesh = raymap::readMesh("scan.ply");
  raymap::Field field = raymap::generate(mesh, raymap::fitGrid(mesh, {.resolution = 256})).field;
  float d = field.distance[field.grid.index({10, 20, 30})];  // negative inside
  return d;
}

void useFiles() {
  const raymap::Mesh mesh = raymap::readMesh("tetrahedron.3mf");
  require(mesh.triangles.size() == 4, "the 3MF has four triangles");
  raymap::writeMesh("scan.ply", mesh);
  require(distanceToScan() > 0.0f, "the sample lies outside");

  const raymap::Grid grid = raymap::fitGrid(mesh, {.resolution = 21});
  const raymap::Field field = raymap::generate(mesh, grid).field;
  require(field.distance[grid.index(grid.dims / 2)] < 0.0f, "the middle is inside");
  raymap::writeField("field.vdb", field);
  const raymap::Field copy = raymap::readField("field.vdb");
  require(copy.grid == field.grid && std::ranges::equal(copy.distance, field.distance),
          "a .vdb keeps the field");
}

/// The GPU backend joins by the link options of raymap::vulkan or raymap.pc.
void requireVulkan() {
  const raymap::DeviceList list = raymap::devices();
  require(!list.note.starts_with("this program has no GPU backend"), "the GPU backend is linked");
}

}  // namespace

int main() {
  try {
    useFiles();
    requireVulkan();
    return 0;
  } catch (const std::exception& error) {
    std::printf("failed: %s\n", error.what());
    return 1;
  }
}
