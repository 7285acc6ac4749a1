// Makes fields on a Vulkan device, or on the CPU, with warm buffers, and prints the cost of each. Reads one
// case per line as JSON and answers each with a line of JSON; the first line describes the device.
// bench/gpu_tables.py runs it and makes the tables. With --count it counts work instead (count_work.h), with
// --latencies it times steps without work (latencies.h).

#include <raymap/error.h>
#include <raymap/generate.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "api/devices.h"
#include "copy_rate_push.h"
#include "count_work.h"
#include "latencies.h"
#include "meshes.h"
#include "method/pipeline.h"
#include "program.h"
#include "shaders/copy_rate_spv.h"
#include "vulkan/runtime/backend.h"

namespace raymap::bench {

namespace {

using Json = nlohmann::ordered_json;

const std::map<std::string, DistanceMode> kDistances = {{"exact", DistanceMode::Exact},
                                                        {"cell", DistanceMode::Cell}};
const std::map<std::string, SignMode> kSigns = {{"harmonic", SignMode::Harmonic}, {"rays", SignMode::Rays}};

double now() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Run {
  double milliseconds;  ///< From the mesh to the field, both on the device; for the CPU, in memory.
  std::vector<Stats::Stage> stages;
};

/// Returns medians over several runs, fewer of slow ones. The first run, which allocates, does not count.
template <class Make>
Json measure(Make&& make) {
  constexpr size_t kFewest = 3, kMost = 31;
  constexpr double kEnough = 150.0, kTooLong = 4000.0;
  make();
  std::vector<double> totals, walls;
  std::map<std::string, std::vector<double>> times;
  std::vector<Stats::Stage> order;
  const double start = now();
  const auto goesOn = [&] {
    const double spent = now() - start;
    return totals.empty() ||
           (totals.size() < kFewest ? spent < kTooLong : totals.size() < kMost && spent < kEnough);
  };
  while (goesOn()) {
    const double before = now();
    Run run = make();
    walls.push_back(now() - before);
    totals.push_back(run.milliseconds);
    for (const Stats::Stage& stage : run.stages) times[stage.name].push_back(stage.milliseconds);
    order = std::move(run.stages);
  }
  Json stages;
  for (const Stats::Stage& stage : order) stages[stage.name] = median(times[stage.name]);
  return {{"ms", median(totals)}, {"wall_ms", median(walls)}, {"runs", totals.size()}, {"stages", stages}};
}

/// Measures a case on the device. Each case has its own backend, so that it holds only what the case needs.
Json runOnDevice(vulkan::Device& device, const Mesh& mesh, const Grid& grid, const FieldOptions& options) {
  const Model model(mesh);
  vulkan::Backend backend(device);
  Field field;
  Json report = measure([&]() -> Run {
    Progress progress;
    backend.setJob({model, grid, options, progress, field});
    runPipeline(backend);
    backend.readResults();
    return {backend.milliseconds(), backend.stages()};
  });
  report["bytes"] = device.heldMemory();
  report["doubtful_share"] = backend.doubtfulShare();
  return report;
}

Json runOnCpu(const Mesh& mesh, const Grid& grid, const FieldOptions& options) {
  Generator generator;
  Field field;
  return measure([&]() -> Run {
    Stats stats = generator.generate(mesh, grid, options, field, {.device = "cpu"});
    return {stats.milliseconds, std::move(stats.stages)};
  });
}

size_t coveringCells(const Mesh& mesh, const Grid& grid) {
  const Box box = bounds(mesh);
  const auto inCells = [&](const glm::dvec3& p) { return glm::vec3((p - grid.origin) / grid.spacing); };
  size_t cells = 0;
  for (const CellLattice& lattice : coverBounds(inCells(box.min), inCells(box.max), grid.dims))
    cells += lattice.count();
  return cells;
}

Json runCase(vulkan::Device& device, const Json& input) {
  static std::string lastName;
  static Mesh mesh;
  const auto name = input.at("mesh").get<std::string>();
  if (name != lastName) {
    lastName.clear();
    mesh = benchMesh(name);
    validate(mesh);
    lastName = name;
  }
  const Grid grid = fitGrid(mesh, {.resolution = input.at("resolution")});
  const bool isCpu = input.at("device") == "cpu";
  const FieldOptions options{.distance = kDistances.at(input.at("distance")),
                             .sign = kSigns.at(input.at("sign"))};
  Json report = isCpu ? runOnCpu(mesh, grid, options) : runOnDevice(device, mesh, grid, options);
  report["samples"] = grid.sampleCount();
  report["cells"] = coveringCells(mesh, grid);
  report["triangles"] = mesh.triangles.size();
  report["vertices"] = mesh.vertices.size();
  return report;
}

/// Returns the throughput of copies by a kernel: bytes read plus bytes written per second. `vkCmdCopyBuffer`
/// is no measure: on some devices, such as an NVIDIA H200, it takes four times as long.
double copyRate(vulkan::Device& device) {
  constexpr uint64_t kBytes = uint64_t{512} << 20;  // Far beyond any cache.
  vulkan::DeviceBuffer from(device, "from"), to(device, "to");
  from.resize<std::byte>(kBytes);
  to.resize<std::byte>(kBytes);
  constexpr uint32_t kGroup = 256;
  vulkan::Kernel<vulkan::CopyRatePush> kernel(device, vulkan::shaders::kCopyRate, kGroup);
  const vulkan::CopyRatePush push{
      .from = from.address(), .to = to.address(), .count = kBytes / (4 * sizeof(float))};
  vulkan::CommandBuffer own(device);
  double best = HUGE_VAL;
  for (int round = 0; round < 10; ++round) {
    vulkan::Commands commands = own.begin();
    commands.fill(from, 1);
    commands.startStage("copy");
    commands.dispatch(kernel, push, push.count);
    commands.stopStage();
    own.submitAndWait();
    if (own.times().empty())
      throw Error(ErrorCode::Unsupported, "the device has no timestamps, so nothing can be timed");
    best = std::min(best, own.times().front().milliseconds);
  }
  return 2.0 * double(kBytes) / (1e-3 * best);
}

void print(const Json& line) {
  std::puts(line.dump().c_str());
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  std::map<std::string, std::vector<std::string>> given;  // Values that follow each option.
  std::vector<std::string>* values = &given[""];
  for (const std::string word : std::span(argv + 1, argv + argc))
    if (word.starts_with("--"))
      values = &given[word];
    else
      values->push_back(word);
  const std::string name = given.contains("--device") ? given["--device"].at(0) : "vulkan";  // Or vulkan:K.
  if (given.contains("--count")) {
    CountOptions count{.device = name, .timesOnly = given.contains("--times-only")};
    if (given.contains("--mesh")) count.meshes = given["--mesh"];          // Built-in names or files.
    if (given.contains("--setting")) count.settings = given["--setting"];  // default, quick
    if (given.contains("--resolution")) count.resolutions.clear();
    for (const std::string& number : given["--resolution"]) count.resolutions.push_back(std::stoi(number));
    countWork(count);
    return 0;
  }
  const std::optional<size_t> index = chooseDevice({.device = name});
  if (!index) throw Error(ErrorCode::Usage, name + " is no Vulkan device");
  vulkan::Device device({.index = index});
  if (given.contains("--latencies")) {
    printLatencies(device);
    return 0;
  }
  print({{"device", device.info().name},
         {"driver", device.info().driver},
         {"is_software", device.info().type == DeviceType::Software},
         {"copy_bytes_per_second", copyRate(device)},
         {"cpu", devices().devices.front().name},
         {"threads", devices().devices.front().threads}});
  for (std::string line; std::getline(std::cin, line);) {
    try {
      print(runCase(device, Json::parse(line)));
    } catch (const Error& error) {
      print({{"error", error.what()}});
      if (error.code() == ErrorCode::DeviceLost) return 1;
    }
  }
  return 0;
}

}  // namespace

}  // namespace raymap::bench

int main(int argc, char** argv) {
  return raymap::bench::runProgram("gpu_bench", raymap::bench::run, argc, argv);
}
