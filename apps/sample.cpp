#include <raymap/raymap.h>

#include <algorithm>
#include <cstdio>

#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "report.h"
#include "terminal.h"

namespace raymap {

namespace {

constexpr const char* kFooter = R"(Examples:
  raymap sample scan.ply -o scan.npz
      points near the surface and in its bounding sphere, as mesh_to_sdf and DeepSDF choose them
  raymap sample scan.ply -o scan.npz --normalize --count 100000 --sigma 0.05,0.005 --seed 7
      in the unit sphere, with other offsets
  raymap sample scan.ply -o surface.ply --surface 1 --near 0
      points on the surface, with their normals

The points are those of raymap.sample_points in Python, bit for bit.)";

struct Arguments : FieldArguments {
  StreamFormat format;
  std::filesystem::path mesh, samples;
  SamplePointsOptions choice;
  bool mayOverwrite = false;
};

void print(const Arguments& arguments, const Surface& surface, const PointSamples& samples) {
  const auto inside =
      static_cast<size_t>(std::ranges::count_if(samples.distance, [](double d) { return d < 0.0; }));
  std::printf("%s: %s\n", displayName(arguments.mesh).c_str(),
              counted(surface.mesh().triangleCount, "triangle").c_str());
  std::printf("%s, %s inside\n", counted(samples.points.size(), "point").c_str(), grouped(inside).c_str());
  if (arguments.choice.normalize)
    std::printf("moved by %.9g %.9g %.9g, then scaled by %.9g\n", -samples.centre.x, -samples.centre.y,
                -samples.centre.z, samples.scale);
  printOrientation(surface.stats());
  printWritten(arguments.samples);
}

void run(Arguments& arguments) {
  const std::vector<Output> outputs{{"--output", arguments.samples, sampleExtensions()}};
  prepareFiles(arguments.format, {{arguments.mesh, meshExtensions()}}, outputs);
  if (!arguments.mayOverwrite) checkInputs(outputs, {arguments.mesh});
  samplePointCounts(arguments.choice);
  const Mesh mesh = loadMesh(arguments.mesh, arguments.format.input);
  ProgressLine line;
  const MachineOptions machine = withProgress(arguments.machine, line);
  const Surface surface(
      mesh,
      {.orientation = fromName<Orientation>(arguments.orientation), .threshold = arguments.options.threshold},
      machine);
  const PointSamples samples = samplePoints(surface, arguments.choice, machine);
  line.clear();
  writePointSamples(arguments.samples, samples, arguments.format.output);
  print(arguments, surface, samples);
}

void addChoice(CLI::App& command, SamplePointsOptions& choice) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    return command.add_option(name, value, text)->group("Points");
  };
  add("-n,--count", choice.count, "Number of points (default 500000)")->check(wholeNumberFrom(0));
  add("--near", choice.nearShare, "Share of the points that are near the surface, 0 to 1 (default 0.94)");
  add("--sigma", choice.sigmas,
      "Comma-separated standard deviations of their offsets, as shares of the bounding sphere's radius; each "
      "gets as many points (default 0.0025,0.00025)")
      ->delimiter(',');
  add("--surface", choice.surfaceShare,
      "Share of the points that are on the surface, 0 to 1 (default 0); the rest lies in the bounding "
      "sphere");
  add("--seed", choice.seed, "Another whole number gives other points (default 0)")->check(numberFrom(0));
  command
      .add_flag("--normalize", choice.normalize,
                "Move and scale all so that the bounding sphere is the unit sphere about 0")
      ->group("Points");
}

}  // namespace

void addSample(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("sample", "Choose points near a mesh with signed distances, to train networks");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("mesh", arguments->mesh, "Mesh to choose points of")->type_name("MESH")->required();
  command
      ->add_option("-o,--output", arguments->samples,
                   "Points to write: .npz (pos and neg, as DeepSDF reads them), .csv or .ply")
      ->type_name("FILE")
      ->required()
      ->group("Files");
  addFormatOption(*command, arguments->format);
  addOverwriteOption(*command, arguments->mayOverwrite)->group("Files");
  addChoice(*command, arguments->choice);
  addOrientationOption(*command, *arguments);
  addThresholdOption(*command, *arguments);
  addCpuOptions(*command, *arguments);
  command->footer(kFooter);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raymap
