// Measures the errors of the paper's unsigned distances (§3.3) and prints a table over real meshes.
//
//   distance_table [FOLDER [RESOLUTION]]

#include <raymap/raymap.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "testing/mesh_rows.h"

namespace raymap {
namespace {

constexpr const char* kMeshes[] = {"draco__bun_zipper.ply", "fcpw__armadillo.obj",   "common3d__igea.ply",
                                   "common3d__spot.obj",    "common3d__fandisk.obj", "libigl__truck.obj"};

struct Mode {
  DistanceMode distance;
  const char* name;
};
constexpr Mode kModes[] = {
    {DistanceMode::Neighbours, "neighbours"}, {DistanceMode::Cell, "cell"}, {DistanceMode::Raster, "raster"}};

/// Largest and mean error in samples, over all samples and over those within 1.5 of the surface.
struct Errors {
  double largest = 0.0, sum = 0.0;
  size_t count = 0, wrong = 0;

  void add(double error) {
    largest = std::max(largest, error);
    sum += error;
    ++count;
    wrong += error > 1e-4;
  }
  void print() const {
    const double samples = double(std::max<size_t>(count, 1));
    std::printf(" %.3f | %.5f | %.2f %% |", largest, sum / samples, 100.0 * double(wrong) / samples);
  }
};

Field unsignedField(const Mesh& mesh, const Grid& grid, DistanceMode distance) {
  FieldOptions options;
  options.distance = distance;
  options.sign = SignMode::None;
  return generate(mesh, grid, options).field;
}

void printRows(const std::string& name, const Mesh& mesh, int resolution) {
  const Grid grid = fitGrid(mesh, {.resolution = resolution});
  const Field exact = unsignedField(mesh, grid, DistanceMode::Exact);
  for (const Mode& mode : kModes) {
    const Field field = unsignedField(mesh, grid, mode.distance);
    Errors all, near;
    for (size_t s = 0; s < field.distance.size(); ++s) {
      const double error = std::abs(double(field.distance[s]) - double(exact.distance[s])) / grid.spacing;
      all.add(error);
      if (exact.distance[s] <= 1.5 * grid.spacing) near.add(error);
    }
    std::printf("| %s | `%s` |", name.c_str(), mode.name);
    all.print();
    near.print();
    std::printf("\n");
  }
}

void printTable(const std::filesystem::path& folder, int resolution) {
  std::printf("| mesh | method | max | mean | wrong | max near | mean near | wrong near |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const char* name : kMeshes)
    if (std::filesystem::exists(folder / name)) printRows(name, readMesh(folder / name), resolution);
}

}  // namespace
}  // namespace raymap

int main(int argc, char** argv) {
  try {
    raymap::printTable(argc > 1 ? argv[1] : raymap::meshFolder(), argc > 2 ? std::atoi(argv[2]) : 64);
  } catch (const raymap::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
