// The first program of a new user: README's lines, then a DAE in and a .vdb out. Runs in a folder that holds
// tetrahedron.dae.

#include <raymap/raymap.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <vector>

namespace {

void require(bool isTrue, const char* what) {
  if (!isTrue) throw std::runtime_error(what);
}

/// README's snippet.
void measureScan() {
  raymap::Mesh mesh = raymap::readMesh("scan.ply");
  raymap::Field field = raymap::generate(mesh, raymap::fitGrid(mesh, {.resolution = 256})).field;
  float d = field.distance[field.grid.index({10, 20, 30})];  // negative inside

  raymap::Surface surface(mesh);  // for any number of queries at any points
  const std::vector<glm::dvec3> points{{0.1, 0.2, 0.3}, {4.0, 5.0, 6.0}};
  raymap::QueryResult found = surface.query(points, {.closest = true});
  double nearest = found.distance[0];  // from the mesh itself, not from a field

  require(d > 0.0f, "the sample lies outside");
  require(nearest < 0.0 && found.distance[1] > 0.0, "the points lie on both sides");
}

void useFiles() {
  const raymap::Mesh mesh = raymap::readMesh("tetrahedron.dae");
  require(mesh.triangles.size() == 4, "the DAE has four triangles");
  raymap::writeMesh("scan.ply", mesh);
  measureScan();

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
