// Measures how well meshes whose faces point the wrong way, or both ways, are repaired, and OpenVDB's result:
// a line of JSON each. bench/evaluate_orientation.py adds the other peers and makes the tables.
//
//   orientation_cases flipped|doubled FOLDER OUT [RESOLUTION]
//
// `flipped` reverses faces of many meshes. `doubled` makes meshes double-sided, and coarse ones soups of
// faces. FOLDER holds the meshes named here. OUT receives each broken mesh, as exportMesh names its files,
// and NAME.inside: a byte for every `stride`-th sample, 1 inside. The exact generalized winding number of the
// mesh before its faces were reversed, doubled or moved decides.

#include <raymap/raymap.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "exact_numbers.h"
#include "exchange.h"
#include "program.h"
#include "testing/broken_meshes.h"
#include "testing/cpu_run.h"
#include "testing/shapes.h"
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

const char* const kCoarseMeshes[] = {"geogram__joint.off",
                                     "trimesh__20mm-xyz-cube.stl",
                                     "thingi10k__65004.stl",
                                     "trimesh__nested.glb",
                                     "geomcentral__dodecahedron_poly.obj",
                                     "geomcentral__hourglass_ico.obj",
                                     "prusaslicer__20mmbox-CR.stl",
                                     "draco__cube_quads.ply"};

struct Broken {
  const char* how;
  Mesh mesh;
  std::vector<double> flippedShares = {0.0, 0.1, 0.3, 0.5};
};

/// A mesh to repair, and the mesh whose inside is right.
struct Case {
  std::string file, how;
  double flipped;
  Mesh mesh, right;
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

void addFlipped(const std::string& file, const Mesh& mesh, std::vector<Case>& cases) {
  for (const Broken& broken : breakMesh(mesh))
    for (const double share : broken.flippedShares)
      cases.push_back({file, broken.how, share, withFlippedFaces(broken.mesh, share, 5), broken.mesh});
}

void addDoubled(const std::string& file, const Mesh& mesh, std::vector<Case>& cases) {
  for (const unsigned seed : {11u, 12u}) {
    const Mesh holed = withHoles(mesh, 3, 0.06, seed);
    cases.push_back({file, "every face twice", 0.0, withDoubledFaces(mesh, 1.0, seed), mesh});
    cases.push_back({file, "the same, three holes", 0.0, withDoubledFaces(holed, 1.0, seed), holed});
    cases.push_back({file, "40 % of the faces twice", 0.0, withDoubledFaces(mesh, 0.4, seed), mesh});
  }
}

/// Gives every face corners of its own, moved by 0.05 % of the longest side.
void addSoups(const std::string& file, const Mesh& mesh, std::vector<Case>& cases) {
  for (const unsigned seed : {11u, 12u}) {
    const Mesh soup = withMovedCorners(mesh, 0.0005, seed);
    cases.push_back({file, "coarse soup", 0.0, soup, mesh});
    cases.push_back({file, "coarse soup", 0.4, withFlippedFaces(soup, 0.4, seed), mesh});
  }
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

void runAll(const std::vector<Case>& cases, const std::string& out, int resolution, size_t& count) {
  for (const Case& c : cases) {
    const Grid grid = fitGrid(c.mesh, {.resolution = resolution});
    const Truth truth = truthOf(c.right, grid);
    const std::string name = out + "/" + std::to_string(++count);
    exportMesh(c.mesh, name);
    writeRaw(name + ".inside", truth.inside.data(), truth.inside.size());
    Json report = runCase(c.mesh, grid, truth);
    report.update({{"mesh", c.file},
                   {"broken", c.how},
                   {"flipped", c.flipped},
                   {"name", name},
                   {"stride", truth.stride}});
    std::puts(report.dump().c_str());
    std::fflush(stdout);
  }
}

int run(int argc, char** argv) {
  const std::string set = argc > 1 ? argv[1] : "";
  if (argc < 4 || (set != "flipped" && set != "doubled"))
    return std::fprintf(stderr, "usage: orientation_cases flipped|doubled FOLDER OUT [RESOLUTION]\n"), 2;
  const std::filesystem::path folder = argv[2];
  const int resolution = argc > 4 ? std::atoi(argv[4]) : 64;
  size_t count = 0;
  const auto runMeshes = [&](std::span<const char* const> files, auto&& add) {
    for (const std::string file : files) {
      if (!std::filesystem::exists(folder / file)) continue;
      std::vector<Case> cases;
      add(file, readMesh(folder / file), cases);
      runAll(cases, argv[3], resolution, count);
    }
  };
  if (set == "flipped") {
    runMeshes(kMeshes, addFlipped);
  } else {
    runMeshes(kMeshes, addDoubled);
    runMeshes(kCoarseMeshes, addSoups);
  }
  return 0;
}

}  // namespace

}  // namespace raymap::bench

int main(int argc, char** argv) {
  return raymap::bench::runProgram("orientation_cases", raymap::bench::run, argc, argv);
}
