#include <raymap/json.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cstdio>

#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "library_options.h"
#include "report.h"
#include "terminal.h"

namespace raymap {

namespace {

constexpr const char* kSampleFooter = R"(Examples:
  raymap sample scan.ply -o scan.npz
      points near the surface and in its bounding sphere, as mesh_to_sdf and DeepSDF choose them
  raymap sample scan.ply -o scan.npz --normalize --count 100000 --sigma 0.05,0.005 --seed 7
      in the unit sphere, with other offsets
  raymap sample scan.ply -o surface.ply --surface 1 --near 0
      points on the surface, with their normals

The points are those of raymap.sample_points in Python, bit for bit.)";

struct SampleArguments : FieldArguments {
  StreamFormat format;
  std::filesystem::path mesh, samples, stats;
  SamplePointsOptions choice;
};

size_t countInside(const PointSamples& samples) {
  return static_cast<size_t>(std::ranges::count_if(samples.distance, [](double d) { return d < 0.0; }));
}

Json describe(const SampleArguments& arguments, const Surface& surface, const PointSamples& samples) {
  return {{"raymap", version().text},
          {"mesh", arguments.mesh.string()},
          {"triangles", surface.mesh().triangleCount},
          {"points", samples.points.size()},
          {"inside", countInside(samples)},
          {"centre", toJson(samples.centre)},
          {"scale", samples.scale},
          {"stats", toJson(surface.stats())}};
}

void print(const SampleArguments& arguments, const Surface& surface, const PointSamples& samples) {
  std::printf("%s: %s\n", displayName(arguments.mesh).c_str(),
              counted(surface.mesh().triangleCount, "triangle").c_str());
  std::printf("%s, %s inside\n", counted(samples.points.size(), "point").c_str(),
              grouped(countInside(samples)).c_str());
  if (arguments.choice.normalize)
    std::printf("moved by %.9g %.9g %.9g, then scaled by %.9g\n", -samples.centre.x, -samples.centre.y,
                -samples.centre.z, samples.scale);
  printOrientation(surface.stats());
  printWritten(arguments.samples);
  if (!arguments.stats.empty()) printWritten(arguments.stats);
}

void run(SampleArguments& arguments) {
  const std::vector<Output> outputs{{"--output", arguments.samples, sampleExtensions()},
                                    {"--stats", arguments.stats, {".json"}}};
  prepareFiles(arguments.format, {{arguments.mesh, meshExtensions()}}, outputs);
  samplePointCounts(arguments.choice);
  Mesh mesh = loadMesh(arguments.mesh, arguments.format.input, arguments.units);
  ProgressLine line;
  const MachineOptions machine = withProgress(arguments.machine, line);
  const Surface surface(
      std::move(mesh),
      {.orientation = arguments.options.orientation, .threshold = arguments.options.threshold}, machine);
  const PointSamples samples = samplePoints(surface, arguments.choice, machine);
  line.clear();
  writePointSamples(arguments.samples, samples, arguments.format.output);
  if (!arguments.stats.empty()) writeJson(arguments.stats, describe(arguments, surface, samples));
  print(arguments, surface, samples);
}

void addChoice(Command& command, SamplePointsOptions& choice) {
  addOptions(command, {{"--count", &choice.count},
                       {"--near", &choice.nearShare},
                       {"--sigma", &choice.sigmas},
                       {"--surface", &choice.surfaceShare},
                       {"--seed", &choice.seed},
                       {"--normalize", &choice.normalize}});
}

}  // namespace

void addSample(Program& program) {
  Command& command = program.addCommand(
      "sample", "Choose points near a mesh with signed distances, to train networks", kSampleFooter);
  auto& arguments = command.runs<SampleArguments>(run);
  addOperand(command, "MESH", &arguments.mesh, "Mesh to choose points of");
  addOutput(command, arguments.samples, "Points to write", sampleExtensions()).isRequired = true;
  addOptions(command, {{"--format", &arguments.format.given}});
  addFigureOptions(command, arguments.stats);
  addOptions(command, {{"--overwrite", &arguments.format.mayOverwrite}});
  addUnitOptions(command, arguments.units);
  addChoice(command, arguments.choice);
  addOptions(command, {{"--orientation", targetOf(arguments.options.orientation)},
                       {"--threshold", &arguments.options.threshold}});
  addCpuOptions(command, arguments.machine);
}

}  // namespace raymap
