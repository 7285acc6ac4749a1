// Each stage by itself, on warm buffers: NAME/MESH/RESOLUTION. `bytes_per_second` counts the least a stage
// can move: it reads its input once and writes its output once. It compares with machine/copy.

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "cpu/backend.h"
#include "meshes.h"

namespace raymap::bench {

namespace {

using B = cpu::Backend;
using Run = void (*)(B&);

template <void (B::*kStage)()>
void run(B& backend) {
  (backend.*kStage)();
}

void winding(B& backend) {
  backend.winding(backend.options().sign);
}

/// Least number of bytes that a stage moves, per sample and per triangle; 0 if it depends on other things.
struct Traffic {
  int perSample = 0;
  int perTriangle = 0;
};

struct Stage {
  const char* name;
  Run run;
  FieldOptions options;
  std::vector<Run> once;    ///< Stages that must have run before.
  std::vector<Run> always;  ///< Stages that run before every time, untimed.
  Traffic traffic;
};

constexpr int kTriangle = 3 * sizeof(glm::vec3);
constexpr int kFloat = sizeof(float);
constexpr int kIndex = sizeof(uint32_t);

std::vector<Stage> stages() {
  const auto distance = [](DistanceMode mode) {
    return FieldOptions{.distance = mode, .sign = SignMode::None};
  };
  const auto sign = [](SignMode mode) { return FieldOptions{.sign = mode}; };
  const std::vector<Run> rays{run<&B::crossings>, run<&B::rayMap>};
  const FieldOptions exact = distance(DistanceMode::Exact), cell = distance(DistanceMode::Cell);
  const FieldOptions neighbours = distance(DistanceMode::Neighbours), raster = distance(DistanceMode::Raster);
  FieldOptions band = exact;
  band.band = 3.0;
  return {
      {"exact_distance", run<&B::exactDistance>, exact, {}, {}, {kFloat, kTriangle}},
      {"exact_distance_band_3", run<&B::exactDistance>, band, {}, {}, {kFloat, kTriangle}},
      {"voxel_grid", run<&B::voxelGrid>, cell, {}, {}, {0, kTriangle + kIndex}},
      {"cell_distance", run<&B::cellDistance>, cell, {run<&B::voxelGrid>}, {}, {0, kTriangle + kIndex}},
      {"distance_transform",
       run<&B::distanceTransform>,
       cell,
       {run<&B::voxelGrid>},
       {run<&B::cellDistance>},
       {3 * 2 * (kFloat + kIndex), 0}},
      {"refine_cell",
       run<&B::refine>,
       cell,
       {run<&B::voxelGrid>, run<&B::cellDistance>, run<&B::distanceTransform>},
       {},
       {kIndex + kFloat, kTriangle}},
      {"refine_neighbours",
       run<&B::refine>,
       neighbours,
       {run<&B::voxelGrid>, run<&B::cellDistance>, run<&B::distanceTransform>},
       {},
       {kIndex + kFloat, kTriangle}},
      {"raster_distance", run<&B::rasterDistance>, raster, {}, {}, {kFloat, kTriangle}},
      {"crossings", run<&B::crossings>, sign(SignMode::Rays), {}, {}, {0, kTriangle}},
      {"ray_map", run<&B::rayMap>, sign(SignMode::Rays), {run<&B::crossings>}, {}, {}},
      {"winding_rays", winding, sign(SignMode::Rays), rays, {}, {kFloat, 0}},
      {"winding_paths", winding, sign(SignMode::Paths), rays, {}, {kFloat, 0}},
      {"winding_evolution", winding, sign(SignMode::Evolution), rays, {}, {kFloat, 0}},
      {"winding_harmonic",
       winding,
       sign(SignMode::Harmonic),
       {run<&B::exactDistance>, run<&B::crossings>, run<&B::rayMap>},
       {},
       {kFloat, 0}},
      {"winding_orientation",
       orientFaces<B>,
       sign(SignMode::Harmonic),
       {run<&B::exactDistance>, run<&B::crossings>, run<&B::rayMap>},
       {winding},
       {kFloat, kTriangle}},
      {"winding_dipoles",
       run<&B::windingDipoles>,
       sign(SignMode::Harmonic),
       {run<&B::exactDistance>, run<&B::crossings>, run<&B::rayMap>},
       {winding},
       {kFloat, 0}},
      {"sign",
       run<&B::sign>,
       sign(SignMode::Rays),
       {run<&B::exactDistance>, run<&B::crossings>, run<&B::rayMap>, winding},
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
  Progress progress;
  Field field;
  cpu::Backend backend;
  withThreads(0, [&] {
    backend.take({mesh, grid, stage.options, progress, field});
    backend.begin();
    for (const Run before : stage.once) before(backend);
    for (auto unused : state) {
      if (!stage.always.empty()) state.PauseTiming();
      for (const Run before : stage.always) before(backend);
      if (!stage.always.empty()) state.ResumeTiming();
      stage.run(backend);
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
