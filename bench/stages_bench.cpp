// Each stage by itself, on warm buffers: NAME/MESH/RESOLUTION. `bytes_per_second` counts the least a stage
// can move, its input read once and its output written once, so that it compares with machine/copy.

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "cpu/backend.h"
#include "meshes.h"

namespace raymap::bench {

namespace {

using Run = void (cpu::Backend::*)();

/// The least bytes that a stage moves, per sample and per triangle; none if it depends on other things.
struct Traffic {
  int perSample = 0;
  int perTriangle = 0;
};

struct Stage {
  const char* name;
  Run run;
  Options options;
  std::vector<Run> once;    ///< What must have run before.
  std::vector<Run> always;  ///< What must run before every time, untimed.
  Traffic traffic;
};

constexpr int kTriangle = 3 * sizeof(glm::vec3);
constexpr int kFloat = sizeof(float);
constexpr int kIndex = sizeof(uint32_t);

std::vector<Stage> stages() {
  using B = cpu::Backend;
  const auto distance = [](DistanceMode mode) { return Options{.distance = mode, .sign = SignMode::None}; };
  const auto sign = [](SignMode mode) { return Options{.sign = mode}; };
  const std::vector<Run> rays{&B::crossings, &B::rayMap};
  const Options exact = distance(DistanceMode::Exact), cell = distance(DistanceMode::Cell);
  const Options neighbours = distance(DistanceMode::Neighbours), raster = distance(DistanceMode::Raster);
  Options band = exact;
  band.band = 3.0;
  return {
      {"exact_distance", &B::exactDistance, exact, {}, {}, {kFloat, kTriangle}},
      {"exact_distance_band_3", &B::exactDistance, band, {}, {}, {kFloat, kTriangle}},
      {"voxel_grid", &B::voxelGrid, cell, {}, {}, {0, kTriangle + kIndex}},
      {"cell_distance", &B::cellDistance, cell, {&B::voxelGrid}, {}, {0, kTriangle + kIndex}},
      {"distance_transform",
       &B::distanceTransform,
       cell,
       {&B::voxelGrid},
       {&B::cellDistance},
       {3 * 2 * (kFloat + kIndex), 0}},
      {"refine_cell",
       &B::refine,
       cell,
       {&B::voxelGrid, &B::cellDistance, &B::distanceTransform},
       {},
       {kIndex + kFloat, kTriangle}},
      {"refine_neighbours",
       &B::refine,
       neighbours,
       {&B::voxelGrid, &B::cellDistance, &B::distanceTransform},
       {},
       {kIndex + kFloat, kTriangle}},
      {"raster_distance", &B::rasterDistance, raster, {}, {}, {kFloat, kTriangle}},
      {"crossings", &B::crossings, sign(SignMode::Rays), {}, {}, {0, kTriangle}},
      {"ray_map", &B::rayMap, sign(SignMode::Rays), {&B::crossings}, {}, {}},
      {"winding_rays", &B::winding, sign(SignMode::Rays), rays, {}, {kFloat, 0}},
      {"winding_paths", &B::winding, sign(SignMode::Paths), rays, {}, {kFloat, 0}},
      {"winding_evolution", &B::winding, sign(SignMode::Evolution), rays, {}, {kFloat, 0}},
      {"winding_harmonic",
       &B::winding,
       sign(SignMode::Harmonic),
       {&B::exactDistance, &B::crossings, &B::rayMap},
       {},
       {kFloat, 0}},
      {"winding_orientation",
       &B::orientation,
       sign(SignMode::Harmonic),
       {&B::exactDistance, &B::crossings, &B::rayMap},
       {&B::winding},
       {kFloat, kTriangle}},
      {"winding_dipoles",
       &B::windingDipoles,
       sign(SignMode::Harmonic),
       {&B::exactDistance, &B::crossings, &B::rayMap},
       {&B::winding},
       {kFloat, 0}},
      {"sign",
       &B::sign,
       sign(SignMode::Rays),
       {&B::exactDistance, &B::crossings, &B::rayMap, &B::winding},
       {},
       {3 * kFloat, 0}},
  };
}

const Mesh& cachedMesh(const std::string& name) {
  static std::map<std::string, Mesh> meshes;
  const auto [it, isNew] = meshes.try_emplace(name);
  if (isNew) it->second = benchMesh(name);
  return it->second;
}

void runStage(benchmark::State& state, const Stage& stage, const std::string& meshName) {
  const Mesh& mesh = cachedMesh(meshName);
  const Grid grid = fitGrid(mesh, {.resolution = int(state.range(0))});
  Stats stats;
  Progress progress(stage.options, stats);
  Field field;
  cpu::Backend backend;
  withThreads(stage.options.threads, [&] {
    backend.begin(mesh, grid, stage.options, progress, field);
    for (const Run before : stage.once) (backend.*before)();
    for (auto unused : state) {
      if (!stage.always.empty()) state.PauseTiming();
      for (const Run before : stage.always) (backend.*before)();
      if (!stage.always.empty()) state.ResumeTiming();
      (backend.*stage.run)();
    }
  });
  const size_t bytes =
      stage.traffic.perSample * grid.sampleCount() + stage.traffic.perTriangle * mesh.triangles.size();
  if (bytes > 0) state.SetBytesProcessed(int64_t(bytes) * state.iterations());
}

}  // namespace

}  // namespace raymap::bench

int main(int argc, char** argv) {
  using namespace raymap::bench;
  for (const Stage& stage : stages())
    for (const std::string mesh : {"bunny", "holes", "million"}) {
      // Holes change nothing but the winding number.
      if (mesh == "holes" && !std::string_view(stage.name).starts_with("winding")) continue;
      benchmark::RegisterBenchmark((std::string(stage.name) + "/" + mesh).c_str(),
                                   [=](benchmark::State& state) { runStage(state, stage, mesh); })
          ->Arg(50)
          ->Arg(128)
          ->Arg(256)
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime()
          ->MeasureProcessCPUTime();
    }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
