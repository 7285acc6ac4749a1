// Runs one method on one set of points and prints its cost as one line of JSON. Every run has a process of
// its own, so that no run starts with warm memory. bench/points.py alternates the methods and makes the
// table.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "exchange.h"
#include "meshes.h"
#include "point_methods.h"
#include "program.h"
#include "testing/random_points.h"
#include "usage.h"

namespace raymap::bench {

namespace {

constexpr double kNear = 2.5e-3;  // of the diagonal

using Prepared = std::function<void()>;

void runSurface(const PointCase& input, bool isSigned, const Prepared& prepared, Buffer<double>& values) {
  const Surface surface(input.mesh, {.sign = isSigned ? SignMode::Harmonic : SignMode::None},
                        {.threads = input.threads});
  prepared();
  QueryResult result;
  surface.query(input.points, {}, result, {.threads = input.threads});
  values = std::move(result.distance);
}

void runRaymap(const PointCase& input, const Prepared& prepared, Buffer<double>& values) {
  runSurface(input, true, prepared, values);
}

void runRaymapUnsigned(const PointCase& input, const Prepared& prepared, Buffer<double>& values) {
  runSurface(input, false, prepared, values);
}

struct Method {
  std::function<void(const PointCase&, const Prepared&, Buffer<double>&)> run;
  bool isSorted = false;  // Whether it gets the points sorted along a curve, for free.
};

const std::map<std::string, Method> kMethods = {
    {"raymap", {runRaymap}},
    {"raymap_unsigned", {runRaymapUnsigned}},
#ifdef RAYMAP_BENCH_EMBREE
    {"embree", {runEmbreePoints, true}},
#endif
};

/// Returns the order of points along a Morton curve.
std::vector<uint32_t> curveOrder(const std::vector<glm::vec3>& points) {
  constexpr int kBits = 21;
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const glm::vec3& p : points) low = glm::min(low, p), high = glm::max(high, p);
  const glm::vec3 size = high - low;
  const double scale = double((1 << kBits) - 1) / std::max({size.x, size.y, size.z, 1e-30f});
  std::vector<std::pair<uint64_t, uint32_t>> codes;
  for (uint32_t i = 0; i < points.size(); ++i) {
    const glm::uvec3 place((glm::dvec3(points[i]) - glm::dvec3(low)) * scale);
    uint64_t code = 0;
    for (int bit = 0; bit < kBits; ++bit)
      for (int axis = 0; axis < 3; ++axis) code |= uint64_t(place[axis] >> bit & 1) << (3 * bit + axis);
    codes.emplace_back(code, i);
  }
  std::ranges::sort(codes);
  std::vector<uint32_t> order;
  for (const auto& [unused, i] : codes) order.push_back(i);
  return order;
}

std::vector<glm::vec3> readPoints(const std::string& name) {
  std::vector<glm::vec3> points(std::filesystem::file_size(name) / sizeof(glm::vec3));
  std::ifstream file(name, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(points.data()), std::streamsize(points.size() * sizeof(glm::vec3))))
    throw Error(ErrorCode::File, name + ": cannot be read");
  return points;
}

/// Returns the median wall time and the mean CPU time of one call, in milliseconds.
nlohmann::json measureCalls(const PointCase& input, size_t pointsPerCall) {
  constexpr int kCalls = 201;
  const Surface surface(input.mesh, {}, {.threads = input.threads});
  QueryResult result;
  std::vector<double> times;
  const double cpu = Usage::now().cpu;
  for (size_t call = 0; call < kCalls; ++call) {
    const size_t begin = call * pointsPerCall % (input.points.size() - pointsPerCall);
    const auto start = std::chrono::steady_clock::now();
    surface.query(PointsView(&input.points[begin].x, pointsPerCall), {}, result, {.threads = input.threads});
    times.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::nth_element(times, times.begin() + kCalls / 2);
  return {{"wall", times[kCalls / 2]}, {"cpu", 1e3 * (Usage::now().cpu - cpu) / kCalls}};
}

nlohmann::json measure(const Method& method, const PointCase& input, Buffer<double>& values) {
  const Usage before = Usage::start();
  Usage between = before;
  method.run(
      input, [&] { between = Usage::now(); }, values);
  const Usage after = Usage::now();
  return {{"prepare", between.cpu - before.cpu},
          {"query", after.cpu - between.cpu},
          {"wall", after.wall - before.wall},
          {"bytes", (after.peakMegabytes - before.peakMegabytes) * 1024.0 * 1024.0}};
}

nlohmann::json measureSorted(const Method& method, PointCase& input, Buffer<double>& values) {
  const std::vector<uint32_t> order = curveOrder(input.points);
  std::vector<glm::vec3> sorted;
  for (const uint32_t i : order) sorted.push_back(input.points[i]);
  input.points.swap(sorted);
  Buffer<double> sortedValues;
  const nlohmann::json report = measure(method, input, sortedValues);
  values.resizeUninitialized(order.size());
  for (size_t k = 0; k < order.size(); ++k) values[order[k]] = sortedValues[k];
  return report;
}

int run(int argc, char** argv) {
  std::string method, mesh = "bunny", place = "uniform", points, output;
  size_t count = 1000000, small = 1000;
  PointCase input;
  input.threads = 2;
  CLI::App app("Runs one method on one set of points.");
  app.add_option("method", method, "a method, or `export`, `small` or `list`")->required();
  app.add_option("--mesh", mesh, "bunny, holes, million, sphere or a file");
  app.add_option("--place", place, "of points to export: uniform or near");
  app.add_option("--count", count, "points to export");
  app.add_option("--small", small, "points of a call for `small`");
  app.add_option("--points", points, "file of points to read");
  app.add_option("--threads", input.threads);
  app.add_option("--output", output,
                 "where to write the distances as raw doubles, or the mesh and the points");
  CLI11_PARSE(app, argc, argv);

  if (method == "list") {
    for (const auto& [name, unused] : kMethods) std::puts(name.c_str());
    return 0;
  }
  input.mesh = benchMesh(mesh);
  nlohmann::json report = {{"triangles", input.mesh.triangles.size()}};
  if (method == "export") {
    exportMesh(input.mesh, output);
    const std::vector<glm::dvec3> exported =
        place == "near" ? nearPoints(input.mesh, count, kNear) : uniformPoints(input.mesh, count);
    input.points.assign(exported.begin(), exported.end());
    writeRaw(output + ".points", input.points.data(), input.points.size());
  } else {
    input.points = readPoints(points);
    if (method == "small") {
      report.update(measureCalls(input, small));
    } else {
      Buffer<double> values;
      const Method& chosen = kMethods.at(method);
      report.update(chosen.isSorted ? measureSorted(chosen, input, values) : measure(chosen, input, values));
      if (!output.empty()) writeRaw(output, values.data(), values.size());
    }
  }
  std::puts(report.dump().c_str());
  return 0;
}

}  // namespace

}  // namespace raymap::bench

int main(int argc, char** argv) {
  return raymap::bench::runProgram("point_peers", raymap::bench::run, argc, argv);
}
