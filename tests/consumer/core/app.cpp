// Makes the field of a tetrahedron with raymap::core.

#include <raymap/generate.h>
#include <raymap/grid.h>

int main() {
  const raymap::Mesh mesh =
      raymap::makeMesh(std::vector<glm::dvec3>{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                       {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
  const raymap::Grid grid = raymap::fitGrid(mesh, {.resolution = 21});
  const raymap::Field field = raymap::generate(mesh, grid, {}, {.threads = 2}).field;
  return field.distance[grid.index(grid.dims / 2)] < 0.0f && field.distance[0] > 0.0f ? 0 : 1;
}
