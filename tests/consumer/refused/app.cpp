// A raymap with only its core refuses what it lacks, by errors that name the option.

#include <raymap/c.h>
#include <raymap/error.h>
#include <raymap/generate.h>
#include <raymap/grid.h>

#include <cstdio>
#include <string>

namespace {

bool names(const std::string& message, const char* option) {
  std::printf("%s\n", message.c_str());
  return message.find(option) != std::string::npos;
}

bool refusesGpu(const raymap::Mesh& mesh, const raymap::Grid& grid) {
  try {
    raymap::generate(mesh, grid, {}, {.device = "vulkan"});
  } catch (const raymap::Error& error) {
    return error.code() == raymap::ErrorCode::Unsupported && names(error.what(), "RAYMAP_VULKAN=ON");
  }
  return false;
}

bool refusesFiles() {
  return !raymap_mesh_load("mesh.ply", nullptr) && raymap_last_error() == RAYMAP_ERROR_UNSUPPORTED &&
         names(raymap_last_error_message(), "RAYMAP_IO=ON");
}

}  // namespace

int main() {
  const raymap::Mesh mesh =
      raymap::makeMesh(std::vector<glm::dvec3>{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                       {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
  const raymap::Grid grid = raymap::fitGrid(mesh, {.resolution = 21});
  return refusesGpu(mesh, grid) && refusesFiles() ? 0 : 1;
}
