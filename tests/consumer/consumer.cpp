// Makes the field of a tetrahedron with the installed library and checks its sign in the middle and at a
// corner.

#include <raymap/raymap.h>

#include <cstdio>

int main() {
  const raymap::Mesh mesh =
      raymap::makeMesh(std::vector<glm::dvec3>{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                       {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
  const raymap::Grid grid = raymap::fitGrid(mesh, {.resolution = 21});
  const raymap::Field field = raymap::generate(mesh, grid).field;
  const float middle = field.distance[grid.index(grid.dims / 2)];
  const float corner = field.distance[0];
  std::printf("middle %g, corner %g\n", double(middle), double(corner));
  return middle < 0.f && corner > 0.f ? 0 : 1;
}
