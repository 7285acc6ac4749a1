// Makes the field of a tetrahedron with raymap::core. With the argument "cpu-only" a GPU must be refused, by an error that
// names the option.

#include <raymap/error.h>
#include <raymap/generate.h>
#include <raymap/grid.h>

#include <cstdio>
#include <string_view>

int main(int count, char** arguments) {
  const raymap::Mesh mesh = raymap::makeMesh(std::vector<glm::dvec3>{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                                             {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
  const raymap::Grid grid = raymap::fitGrid(mesh, {.resolution = 21});
  const raymap::Field field = raymap::generate(mesh, grid, {.threads = 2}).field;
  if (field.distance[grid.index(grid.dims / 2)] >= 0.0f || field.distance[0] <= 0.0f) return 1;
  if (count < 2 || arguments[1] != std::string_view("cpu-only")) return 0;
  try {
    raymap::generate(mesh, grid, {.device = "vulkan"});
  } catch (const raymap::Error& error) {
    std::printf("%s\n", error.what());
    const bool namesOption = std::string_view(error.what()).find("RAYMAP_VULKAN=ON") != std::string_view::npos;
    return error.code() == raymap::ErrorCode::Unsupported && namesOption ? 0 : 1;
  }
  return 1;
}
