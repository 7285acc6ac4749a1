// How well meshes with randomly flipped faces are repaired: a table in Markdown. `orientation_table FOLDER
// [RESOLUTION]`: FOLDER holds the meshes named here. Wrong signs are those that differ from the exact
// generalized winding number of the mesh before its faces were flipped.

#include <raymap/raymap.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "broken_meshes.h"
#include "exact_numbers.h"
#include "shapes.h"

namespace {

using namespace raymap;
using namespace raymap::bench;

/// Sampled so that the exact number, which looks at every triangle, stays affordable.
constexpr double kTriangleTests = 2e8;

const char* const kMeshes[] = {"libigl__bunny.off",         "common3d__spot.obj",
                               "common3d__cheburashka.obj", "common3d__homer.obj",
                               "common3d__fandisk.obj",     "common3d__rocker-arm.obj",
                               "libigl__decimated-max.obj", "sellan__eiffel.obj",
                               "thingi10k__79741.stl",      "prusaslicer__M3x10_screw.stl"};

/// A mesh and a copy of it, moved so that they overlap.
Mesh overlappingPair(const Mesh& mesh) {
  Mesh copy = mesh;
  copy.origin += glm::dvec3(0.3, 0.2, 0.1) * bounds(mesh).size();
  return shapes::joined(mesh, copy);
}

struct Run {
  double wrong = 0.0, seconds = 0.0;
  Stats stats;
};

Run run(const Mesh& mesh, const Grid& grid, const std::vector<double>& exact, size_t stride,
        Orientation orientation) {
  Options options;
  options.device = "cpu";
  options.winding = true;
  options.orientation = orientation;
  Generator generator;
  Field field;
  const std::clock_t start = std::clock();
  generator.generate(mesh, grid, options, field);
  Run result{.seconds = double(std::clock() - start) / CLOCKS_PER_SEC, .stats = generator.stats()};
  size_t wrong = 0;
  for (size_t e = 0; e < exact.size(); ++e)
    wrong += (std::abs(exact[e]) > 0.5) != (std::abs(field.winding[e * stride]) > 0.5f);
  result.wrong = 100.0 * double(wrong) / double(exact.size());
  return result;
}

void printRows(const std::string& name, const Mesh& mesh, const std::vector<double>& shares, int resolution) {
  const Grid grid = fitGrid(mesh, {.resolution = resolution});
  const auto stride = size_t(double(grid.sampleCount()) * double(mesh.triangles.size()) / kTriangleTests) | 1;
  const std::vector<double> exact = exactNumbers(mesh, grid, stride);
  for (const double share : shares) {
    const Mesh flipped = withFlippedFaces(mesh, share, 5);
    const Run keep = run(flipped, grid, exact, stride, Orientation::Keep),
              choice = run(flipped, grid, exact, stride, Orientation::Auto),
              repair = run(flipped, grid, exact, stride, Orientation::Repair);
    std::printf("| %s | %.0f %% | %.3f %% | %.3f %% | %.3f %% | %.4f, %.4f | %.1f |\n", name.c_str(),
                100.0 * share, keep.wrong, choice.wrong, repair.wrong, choice.stats.misfitGiven,
                choice.stats.misfit, choice.seconds / keep.seconds);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: orientation_table FOLDER [RESOLUTION]\n"), 2;
  const int resolution = argc > 2 ? std::atoi(argv[2]) : 64;
  std::printf(
      "| mesh | flipped | keep | auto | repair | misfit before, after | times the CPU time of keep |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  for (const std::string file : kMeshes) {
    const std::filesystem::path path = std::filesystem::path(argv[1]) / file;
    if (!std::filesystem::exists(path)) continue;
    const Mesh mesh = readMesh(path);
    const Mesh holed = withHoles(mesh, 5, 0.06, 2);
    printRows(file, mesh, {0.0, 0.1, 0.3, 0.5}, resolution);
    printRows(file + ", five holes", holed, {0.0, 0.1, 0.3, 0.5}, resolution);
    printRows(file + ", 10 % of faces missing", withMissingFaces(mesh, 0.1, 3), {0.0, 0.1, 0.3, 0.5},
              resolution);
    printRows(file + ", five holes and 10 % missing", withMissingFaces(holed, 0.1, 3), {0.0, 0.1, 0.3, 0.5},
              resolution);
    printRows(file + ", two overlapping", overlappingPair(mesh), {0.0, 0.1, 0.3}, resolution);
  }
  return 0;
}
