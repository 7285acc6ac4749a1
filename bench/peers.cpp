// Runs one method on one case and prints its cost as one line of JSON. Every run has a process of its own, so
// that no run starts with warm memory. bench/compare.py alternates the methods and makes the table.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "exchange.h"
#include "meshes.h"
#include "methods.h"
#include "program.h"
#include "usage.h"

namespace raymap::bench {

namespace {

const std::map<std::string, std::function<void(Case&, Buffer<float>&)>> kMethods = {
    {"raymap", runRaymap},   {"raymap_winding", runRaymapWinding}, {"raymap_band", runRaymapBand},
#ifdef RAYMAP_BENCH_EMBREE
    {"embree", runEmbree},
#endif
#ifdef RAYMAP_BENCH_OPENVDB
    {"openvdb", runOpenvdb}, {"openvdb_band", runOpenvdbBand},
#endif
};

int run(int argc, char** argv) {
  std::string method, mesh = "bunny", output;
  GridOptions gridOptions;
  Case input;
  input.threads = 2;
  CLI::App app("Runs one method on one case.");
  app.add_option("method", method, "a method, or `export` or `list`")->required();
  app.add_option("--mesh", mesh, "bunny, holes, million, sphere or a file");
  app.add_option("--resolution", gridOptions.resolution);
  app.add_option("--threads", input.threads);
  app.add_option("--band", input.band, "samples; 0 = the whole box");
  app.add_option("--output", output, "where to write the samples as raw floats, or the mesh");
  CLI11_PARSE(app, argc, argv);

  if (method == "list") {
    for (const auto& [name, unused] : kMethods) std::puts(name.c_str());
    return 0;
  }
  input.mesh = benchMesh(mesh);
  input.grid = fitGrid(input.mesh, gridOptions);
  nlohmann::json report = describe(input.mesh, input.grid);
  if (method == "export") {
    exportMesh(input.mesh, output);
  } else {
    Buffer<float> values;
    const Usage before = Usage::start();
    kMethods.at(method)(input, values);
    const Usage after = Usage::now();
    report["wall"] = after.wall - before.wall;
    report["cpu"] = after.cpu - before.cpu;
    report["megabytes"] = after.peakMegabytes - before.peakMegabytes;
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
