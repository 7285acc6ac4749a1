// Runs one method on one case and prints its cost as one line of JSON. Every run has a process of its own, so
// that no run starts with warm memory. bench/compare.py alternates the methods and makes the table.

#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "exchange.h"
#include "meshes.h"
#include "methods.h"
#include "program.h"

namespace raymap::bench {

namespace {

const std::map<std::string, std::function<void(const Case&, Buffer<float>&)>> kMethods = {
    {"raymap", runRaymap},
    {"raymap_winding", runRaymapWinding},
#ifdef RAYMAP_BENCH_EMBREE
    {"embree", runEmbree},
#endif
#ifdef RAYMAP_BENCH_OPENVDB
    {"openvdb", runOpenvdb},
#endif
};

/// Returns the peak since it was last cleared. getrusage includes the peak of the program that started this
/// one.
double peakMegabytesNow() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0.0; word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024.0;
  return 0.0;
}

struct Usage {
  double wall, cpu, peakMegabytes;

  /// Clears the peak, so that it does not include making the mesh.
  static Usage start() {
    std::ofstream("/proc/self/clear_refs") << 5;
    return now();
  }
  static Usage now() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now().time_since_epoch();
    return {wall.count(), seconds(usage.ru_utime) + seconds(usage.ru_stime), peakMegabytesNow()};
  }
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
