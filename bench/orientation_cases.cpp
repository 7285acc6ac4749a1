// Measures how well meshes with randomly reversed faces are repaired, and OpenVDB's result: a line of JSON
// each. bench/evaluate_orientation.py adds the other peers and makes the tables.
//
//   orientation_cases FOLDER OUT [RESOLUTION]
//
// FOLDER holds the meshes named here. OUT receives each broken mesh, as exportMesh names its files, and
// NAME.inside: a byte for every `stride`-th sample, 1 inside. The exact generalized winding number of the
// mesh before its faces were reversed decides.

#include <raymap/raymap.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "broken_meshes.h"
#include "cpu_run.h"
#include "exact_numbers.h"
#include "exchange.h"
#include "program.h"
#include "shapes.h"
#ifdef RAYMAP_BENCH_OPENVDB
#include "methods.h"
#endif

namespace raymap::bench {

namespace {

using Json = nlohmann::json;

/// Limits the samples, because the exact number visits every triangle.
constexpr double kTriangleTests = 2e8;

const char* const kMeshes[] = {"libigl__bunny.off",         "common3d__spot.obj",
                               "common3d__cheburashka.obj", "common3d__homer.obj",
                               "common3d__fandisk.obj",     "common3d__rocker-arm.obj",
                               "libigl__decimated-max.obj", "sellan__eiffel.obj",
                               "thingi10k__79741.stl",      "prusaslicer__M3x10_screw.stl"};

struct Broken {
  const char* how;
  Mesh mesh;
  std::vector<double> flippedShares = {0.0, 0.1, 0.3, 0.5};
};

/// Returns a mesh and a copy of it, moved so that they overlap.
Mesh overlappingPair(const Mesh& mesh) {
  Mesh copy = mesh;
  copy.origin += glm::dvec3(0.3, 0.2, 0.1) * bounds(mesh).size();
  return shapes::joined(mesh, copy);
}

std::vector<Broken> breakMesh(const Mesh& mesh) {
  const Mesh holed = withHoles(mesh, 5, 0.06, 2);
  return {{.how = "whole", .mesh = mesh},
          {.how = "five holes", .mesh = holed},
          {.how = "10 % of faces missing", .mesh = withMissingFaces(mesh, 0.1, 3)},
          {.how = "five holes and 10 % missing", .mesh = withMissingFaces(holed, 0.1, 3)},
          {.how = "two overlapping", .mesh = overlappingPair(mesh), .flippedShares = {0.0, 0.1, 0.3}}};
}

struct Truth {
  std::vector<uint8_t> inside;  ///< One per `stride`-th sample.
  size_t stride;
};

Truth truthOf(const Mesh& mesh, const Grid& grid) {
  const auto stride = size_t(double(grid.sampleCount()) * double(mesh.triangles.size()) / kTriangleTests) | 1;
  Truth truth{.inside = {}, .stride = stride};
  for (const double w : exactNumbers(mesh, grid, stride)) truth.inside.push_back(std::abs(w) > 0.5);
  return truth;
}

template <class IsInside>
double percentWrong(const Truth& truth, IsInside&& isInside) {
  size_t wrong = 0;
  for (size_t e = 0; e < truth.inside.size(); ++e)
    wrong += (truth.inside[e] != 0) != isInside(e * truth.stride);
  return 100.0 * double(wrong) / double(truth.inside.size());
}

Json runOurs(const Mesh& mesh, const Grid& grid, const Truth& truth, Orientation orientation) {
  const std::clock_t start = std::clock();
  const Generated run = runOf(mesh, grid, orientation);
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  const auto isInside = [&](size_t s) { return std::abs(run.field.winding[s]) > 0.5f; };
  return {{"wrong", percentWrong(truth, isInside)},
          {"cpu", seconds},
          {"misfit_given", run.stats.misfitGiven},
          {"misfit", run.stats.misfit}};
}

#ifdef RAYMAP_BENCH_OPENVDB
Json runVdb(const Mesh& mesh, const Grid& grid, const Truth& truth) {
  Buffer<float> distance;
  runOpenvdb({.mesh = mesh, .grid = grid}, distance);
  size_t inside = 0, found = 0;
  for (size_t e = 0; e < truth.inside.size(); ++e) {
    inside += truth.inside[e];
    found += truth.inside[e] && distance[e * truth.stride] < 0.0f;
  }
  return {{"wrong", percentWrong(truth, [&](size_t s) { return distance[s] < 0.0f; })},
          {"found", 100.0 * double(found) / double(inside)}};
}
#endif

Json runCase(const Mesh& mesh, const Grid& grid, const Truth& truth) {
  Json report = describe(mesh, grid);
  report["keep"] = runOurs(mesh, grid, truth, Orientation::Keep);
  report["auto"] = runOurs(mesh, grid, truth, Orientation::Auto);
  report["repair"] = runOurs(mesh, grid, truth, Orientation::Repair);
#ifdef RAYMAP_BENCH_OPENVDB
  report["openvdb"] = runVdb(mesh, grid, truth);
#endif
  return report;
}

int run(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: orientation_cases FOLDER OUT [RESOLUTION]\n"), 2;
  const std::filesystem::path folder = argv[1], out = argv[2];
  const int resolution = argc > 3 ? std::atoi(argv[3]) : 64;
  size_t count = 0;
  for (const std::string file : kMeshes) {
    if (!std::filesystem::exists(folder / file)) continue;
    for (const Broken& broken : breakMesh(readMesh(folder / file))) {
      const Grid grid = fitGrid(broken.mesh, {.resolution = resolution});
      const Truth truth = truthOf(broken.mesh, grid);
      for (const double share : broken.flippedShares) {
        const Mesh flipped = withFlippedFaces(broken.mesh, share, 5);
        const std::string name = (out / std::to_string(++count)).string();
        exportMesh(flipped, name);
        writeRaw(name + ".inside", truth.inside.data(), truth.inside.size());
        Json report = runCase(flipped, grid, truth);
        report.update({{"mesh", file},
                       {"broken", broken.how},
                       {"flipped", share},
                       {"name", name},
                       {"stride", truth.stride}});
        std::puts(report.dump().c_str());
        std::fflush(stdout);
      }
    }
  }
  return 0;
}

}  // namespace

}  // namespace raymap::bench

int main(int argc, char** argv) {
  return raymap::bench::runProgram("orientation_cases", raymap::bench::run, argc, argv);
}
