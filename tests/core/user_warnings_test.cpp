// Compiled, never run: what users write must not warn, with any warning that GCC and Clang call sensible.

#include <raymap/raymap.h>

void userCode(const raymap::Mesh& mesh, raymap::Field& field);

void userCode(const raymap::Mesh& mesh, raymap::Field& field) {
  using namespace raymap;
  const Grid grid = fitGrid(mesh, {.resolution = 256});
  Generated made = generate(mesh, grid, {.sign = SignMode::Rays});
  field = std::move(made.field);
  Samples samples = sample(field, {}, {.gradients = true});
  const Mesh surface = isosurface(field, {.iso = 1.0});
  const Repaired solid = repair(mesh, grid, {}, {.offset = 1.0}, {.threads = 2});
  const Picture picture = renderField(field, {.width = 64});
  const DeviceInfo device{.id = "cpu"};
  const AnimatedMesh animated{.rest = mesh};
  const Field empty{.grid = grid};
  [[maybe_unused]] const Grid lattice{.dims = {1, 1, 1}};
  const Mesh triangle{.triangles = {{0, 1, 2}}};
  const Stats stats{.device = "cpu"};
  const Diagnostics found{.triangles = 1};
}
