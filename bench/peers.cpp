// Runs one method on one case and prints its cost as one line of JSON. Every run has a process of its own, so
// that no run starts with warm memory. bench/speed.py alternates the methods and makes the tables.

#include <raymap/error.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "meshes.h"
#include "methods.h"
#include "program.h"
#include "usage.h"

namespace raymap::bench {

namespace {

const std::map<std::string, std::function<void(Case&, Buffer<float>&)>> kMethods = {
    {"raymap", runRaymap},   {"raymap_winding", runRaymapWinding}, {"raymap_band", runRaymapBand},
#ifdef RAYMAP_BENCH_EMBREE
    {"embree", runEmbree},   {"embree_points", runEmbreePoints},
#endif
#ifdef RAYMAP_BENCH_OPENVDB
    {"openvdb", runOpenvdb}, {"openvdb_band", runOpenvdbBand},
#endif
};

template <class T>
std::vector<T> readRaw(const std::string& path) {
  std::vector<T> values(std::filesystem::file_size(path) / sizeof(T));
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(values.data()), std::streamsize(values.size() * sizeof(T))))
    throw Error(ErrorCode::File, path + ": cannot be read");
  return values;
}

template <class T>
void writeRaw(const std::string& path, const T* data, size_t count) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(data), std::streamsize(count * sizeof(T)));
  if (!file.flush()) throw Error(ErrorCode::File, path + ": cannot be written");
}

/// Reads NAME.vertices (double x 3) and NAME.triangles (uint32 x 3) if they exist, else what `benchMesh`
/// knows.
Mesh meshOf(const std::string& name) {
  if (!std::filesystem::exists(name + ".vertices")) return benchMesh(name);
  return makeMesh(readRaw<glm::dvec3>(name + ".vertices"), readRaw<glm::uvec3>(name + ".triangles"));
}

void exportMesh(const Mesh& mesh, const std::string& name) {
  std::vector<glm::dvec3> positions;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) positions.push_back(mesh.position(v));
  writeRaw(name + ".vertices", positions.data(), positions.size());
  writeRaw(name + ".triangles", mesh.triangles.data(), mesh.triangles.size());
}

int run(int argc, char** argv) {
  if (argc != 2) throw Error(ErrorCode::Usage, "the case is one argument, an object of JSON");
  const nlohmann::json given = nlohmann::json::parse(argv[1]);
  const std::string method = given.at("method");         // Or "export".
  const std::string points = given.value("points", "");  // A raw file of float x 3.
  const std::string output =
      given.value("output", "");  // Where to write the samples as raw floats, or the mesh.
  Case input;
  input.threads = given.value("threads", 2);
  input.band = given.value("band", input.band);  // In samples; 0: the whole box.
  input.mesh =
      meshOf(given.value("mesh", "scan"));  // scan, holes, million, sphere or a file; NAME of raw files.
  if (!points.empty()) input.points = readRaw<glm::vec3>(points);
  if (given.contains("dims")) {
    const std::vector<int> dims = given["dims"];
    const std::vector<double> origin = given.at("origin");
    input.grid = {.dims = {dims.at(0), dims.at(1), dims.at(2)},
                  .origin = {origin.at(0), origin.at(1), origin.at(2)},
                  .spacing = given.at("spacing")};
  } else {
    GridOptions options;
    if (given.contains("resolution")) options.resolution = given["resolution"].get<int>();
    input.grid = fitGrid(input.mesh, options);
  }
  const Grid& grid = input.grid;
  nlohmann::json report = {{"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
                           {"origin", {grid.origin.x, grid.origin.y, grid.origin.z}},
                           {"spacing", grid.spacing},
                           {"triangles", input.mesh.triangles.size()}};
  if (method == "export") {
    exportMesh(input.mesh, output);
  } else {
    Buffer<float> values;
    const Usage before = Usage::start();
    Usage between = before;
    input.prepared = [&] { between = Usage::now(); };
    kMethods.at(method)(input, values);
    const Usage after = Usage::now();
    report.update({{"wall", after.wall - before.wall},
                   {"cpu", after.cpu - before.cpu},
                   {"prepare", between.cpu - before.cpu},
                   {"query", after.cpu - between.cpu},
                   {"megabytes", after.peakMegabytes - before.peakMegabytes}});
    if (!output.empty()) writeRaw(output, values.data(), values.size());
  }
  std::puts(report.dump().c_str());
  return 0;
}

}  // namespace

}  // namespace raymap::bench

int main(int argc, char** argv) {
  return raymap::bench::runProgram("peers", raymap::bench::run, argc, argv);
}
