// Counts how often each sign mode differs from the exact generalized winding number on broken meshes and
// prints a table in Markdown. `sign_table [FOLDER [RESOLUTION]]`: FOLDER holds the further meshes of
// kPublished.

#include <raymap/raymap.h>

#include "base/parallel.h"
#include "diagonal_rays.h"
#include "exact_numbers.h"
#include "testing/broken_meshes.h"
#include "testing/shapes.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace raymap;
using namespace raymap::bench;

/// Limits the samples, because the exact number visits every triangle.
constexpr double kTriangleTests = 4e8;

const char* const kPublished[] = {"common3d__beetle.obj",
                                  "common3d__teapot.obj",
                                  "trimesh__suzanne.ply",
                                  "libigl__truck.obj",
                                  "meshlab__greek_helmet.obj",
                                  "geogram__SaraPezzini.obj",
                                  "fast-winding-n__pig-head.ply",
                                  "assimp__Wuson.stl",
                                  "mitsuba-data__bunny_lowres.ply",
                                  "meshlab__many_small_holes.ply",
                                  "odedstein__demosthenes-low-res.obj",
                                  "draco__bun_zipper.ply"};

struct Row {
  std::string name;
  Mesh mesh;
};

std::vector<Row> brokenVariants(const std::string& name, const Mesh& mesh) {
  return {{name + ", one hole", withHoles(mesh, 1, 0.06, 1)},
          {name + ", five holes", withHoles(mesh, 5, 0.06, 2)},
          {name + ", 20 % of faces missing", withMissingFaces(mesh, 0.2, 3)},
          {name + ", all corners moved 1.5 %", withMovedCorners(mesh, 0.015, 4)}};
}

struct Mode {
  const char* name;
  SignMode sign;
  Sampling sampling = Sampling::Raymap;
};
constexpr Mode kModes[] = {{"1 ray", SignMode::Ray},
                           {"6 rays", SignMode::Rays},
                           {"paths, 5 passes", SignMode::Paths},
                           {"the same, paper's sampling", SignMode::Paths, Sampling::Paper},
                           {"evolution, 5 steps", SignMode::Evolution},
                           {"the same, paper's sampling", SignMode::Evolution, Sampling::Paper},
                           {"harmonic", SignMode::Harmonic}};

void printCell(const std::vector<double>& exact, size_t stride,
               const std::function<double(size_t)>& winding) {
  size_t wrong = 0;
  double error = 0.0;
  for (size_t e = 0; e < exact.size(); ++e) {
    const double w = winding(e * stride);
    wrong += (std::abs(w) > 0.5) != (std::abs(exact[e]) > 0.5);
    error += std::abs(w - exact[e]);
  }
  std::printf(" %.3f %% (%.4f) |", 100.0 * double(wrong) / double(exact.size()),
              error / double(exact.size()));
  std::fflush(stdout);
}

void printRow(const Row& row, int resolution) {
  const Grid grid = fitGrid(row.mesh, {.resolution = resolution});
  const double work = double(grid.sampleCount()) * double(row.mesh.triangles.size());
  const size_t stride = size_t(work / kTriangleTests) | 1;
  const std::vector<double> exact = exactNumbers(row.mesh, grid, stride);
  std::printf("| %s |", row.name.c_str());
  for (const Mode& mode : kModes) {
    const Buffer<float> winding =
        windingOf(row.mesh, grid,
                  {.sign = mode.sign, .orientation = Orientation::Keep, .sampling = mode.sampling})
            .winding;
    printCell(exact, stride, [&](size_t s) { return double(winding[s]); });
    if (mode.sign != SignMode::Rays) continue;
    const std::vector<double> all = averageAllRays(row.mesh, grid, winding);
    printCell(exact, stride, [&](size_t s) { return all[s]; });
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  const int resolution = argc > 2 ? std::atoi(argv[2]) : 48;
  std::vector<Row> rows = brokenVariants("torus", shapes::torus(1.0, 0.4, 60, 30));
  if (argc > 1) {
    const std::filesystem::path folder = argv[1];
    for (const char* name : {"common3d__spot.obj", "libigl__bunny.off"})
      if (std::filesystem::exists(folder / name))
        for (Row& row : brokenVariants(name, readMesh(folder / name))) rows.push_back(std::move(row));
    for (const char* name : kPublished)
      if (std::filesystem::exists(folder / name)) rows.push_back({name, readMesh(folder / name)});
  }
  std::printf("| wrong signs (mean error of w) |");
  for (const Mode& mode : kModes)
    std::printf(" %s |%s", mode.name, mode.sign == SignMode::Rays ? " 26 rays |" : "");
  std::printf("\n|");
  for (size_t column = 0; column < std::size(kModes) + 2; ++column) std::printf("---|");
  std::printf("\n");
  for (const Row& row : rows) try {
      printRow(row, resolution);
    } catch (const Error& error) {
      std::fprintf(stderr, "%s: %s\n", row.name.c_str(), error.what());
    }
  return 0;
}
