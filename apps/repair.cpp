#include <raymap/raymap.h>

#include <cstdio>
#include <ostream>

#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "first_use.h"
#include "report.h"
#include "terminal.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(Examples:
  raymap repair scan.ply -o scan.stl                             (a watertight solid)
  raymap repair part.stl -o part.3.stl --voxel-size 0.1 --offset 0.2
  raymap repair bust.obj -o bust.stl --shell 2 --drain-hole 4    (hollow, walls 2 thick, a hole 4 wide)

All lengths are in the mesh's units. The deviation of the result from the mesh is measured and printed.)";

struct Arguments : FieldArguments {
  Arguments() {
    grid.resolution = 256;
    options.closeHoles = true;
  }
  fs::path mesh, result, stats;
  RepairOptions repair;
  std::vector<double> down;
};

bool isSound(const Diagnostics& found) {
  return found.watertight && found.consistentlyOriented && found.signedVolume > 0.0;
}

Json toJson(const Deviation& deviation) {
  return {
      {"max", deviation.max}, {"mean", deviation.mean}, {"p99", deviation.p99}, {"points", deviation.points}};
}

Json toJson(const Diagnostics& found, const SelfIntersections& crossing) {
  Json json = toJson(found);
  json["self_intersections"] = toJson(crossing);
  return json;
}

Json describe(const Arguments& arguments, const Grid& grid, const RepairReport& report) {
  return {{"raymap", version().text},
          {"mesh", arguments.mesh.string()},
          {"grid", {{"dims", {grid.dims.x, grid.dims.y, grid.dims.z}}, {"spacing", grid.spacing}}},
          {"options",
           {{"orientation", arguments.orientation},
            {"close_holes", arguments.options.closeHoles},
            {"offset", arguments.repair.offset},
            {"shell", arguments.repair.shell},
            {"drain_hole", arguments.repair.drainHole}}},
          {"before", toJson(report.before, report.crossingBefore)},
          {"after", toJson(report.after, report.crossingAfter)},
          {"result_from_mesh", toJson(report.ofResult)},
          {"mesh_from_result", toJson(report.ofMesh)},
          {"buried_share", report.buriedShare},
          {"lost_share", report.lostShare},
          {"hollows", report.hollows},
          {"drain_holes", report.holes},
          {"turned_faces", report.stats.turnedFaces.size()},
          {"left_out_faces", report.stats.leftOutFaces.size()},
          {"orientation_fits", report.stats.orientationFits},
          {"patch", {{"triangles", report.stats.patchTriangles}, {"area", report.stats.patchArea}}},
          {"stages", toJson(report.stats)}};
}

std::string pairsText(const SelfIntersections& crossing) {
  return (crossing.isComplete ? "" : "at least ") + counted(crossing.pairs, "pair");
}

void print(const char* name, const Deviation& deviation, double spacing) {
  std::printf("  %-22s at most %.3g (%.2g samples), 99 %% within %.3g, mean %.3g\n", name, deviation.max,
              deviation.max / spacing, deviation.p99, deviation.mean);
}

void print(const Arguments& arguments, const Grid& grid, const RepairReport& report) {
  std::printf("%s: %s, wrong with it: %s\n", arguments.mesh.string().c_str(),
              counted(report.before.triangles, "triangle").c_str(), describeDefects(report.before).c_str());
  std::printf("grid: %d x %d x %d, spacing %g\n", grid.dims.x, grid.dims.y, grid.dims.z, grid.spacing);
  std::printf("result: %s, %s, %s\n", counted(report.after.triangles, "triangle").c_str(),
              counted(report.after.components, "part").c_str(),
              isSound(report.after) ? "checked: watertight, faces outwards" : "NOT watertight");
  std::printf("  %-22s %g before, %g after\n", "volume", report.before.signedVolume,
              report.after.signedVolume);
  std::printf("  %-22s %s before, %s after\n", "crossing faces", pairsText(report.crossingBefore).c_str(),
              pairsText(report.crossingAfter).c_str());
  print("result from mesh", report.ofResult, grid.spacing);
  print("mesh from result", report.ofMesh, grid.spacing);
  if (const size_t turned = report.stats.turnedFaces.size(); turned > 0)
    std::printf("  %-22s %s\n", "turned", counted(turned, "face").c_str());
  if (const size_t leftOut = report.stats.leftOutFaces.size(); leftOut > 0)
    std::printf("  %-22s %s left out\n", "double-sided", counted(leftOut, "other side").c_str());
  if (!report.stats.orientationFits)
    std::printf("  %-22s none fits, misfit %.3g\n", "orientation", report.stats.misfit);
  if (report.stats.patchTriangles > 0)
    std::printf("  %-22s area %.4g\n", "closed holes", report.stats.patchArea);
  if (report.buriedShare > 0.0)
    std::printf("  %.3g %% of the mesh lies inside the solid, and is no surface any more\n",
                100.0 * report.buriedShare);
  if (report.lostShare > 0.0)
    std::printf("  %.3g %% of the mesh lies outside of it: open there, or thinner than the samples\n",
                100.0 * report.lostShare);
  if (arguments.repair.shell > 0.0)
    std::printf("  %s, %s\n", counted(report.hollows, "hollow").c_str(),
                counted(report.holes, "drain hole").c_str());
}

/// Repairs with progress and warnings on stderr.
Repaired makeSolid(const Mesh& mesh, const Grid& grid, const Arguments& arguments) {
  ProgressLine line;
  Options options = arguments.options;
  options.progress = line.callback();
  options.warn = warn;
  return repair(mesh, grid, options, arguments.repair);
}

void run(Arguments& arguments) {
  finishFieldArguments(arguments);
  if (const std::vector<double>& d = arguments.down; !d.empty()) arguments.repair.down = {d[0], d[1], d[2]};
  checkOutputs(
      {{"--output", arguments.result, writableMeshExtensions()}, {"--stats", arguments.stats, {".json"}}});
  const Mesh mesh = loadMesh(arguments.mesh);
  testBeforeFirstUse(arguments.options.device);
  const Grid grid = fitRepairGrid(mesh, arguments.grid, arguments.repair);
  const auto [result, report] = makeSolid(mesh, grid, arguments);
  if (!isSound(report.after)) warn("the result is not watertight; this is a bug, please report it");
  writeMesh(arguments.result, result);
  if (!arguments.stats.empty())
    writeAtomically(arguments.stats, [&, &found = report](std::ostream& out) {
      out << describe(arguments, grid, found).dump(2) << "\n";
    });
  print(arguments, grid, report);
  printWritten(arguments.result);
  if (!arguments.stats.empty()) printWritten(arguments.stats);
}

void addShapeOptions(CLI::App& command, Arguments& arguments) {
  RepairOptions& repair = arguments.repair;
  command.add_option("--offset", repair.offset, "Distance to move the surface outwards; negative: inwards")
      ->group("Shape");
  CLI::Option* shell =
      command.add_option("--shell", repair.shell, "Hollow the solid out, leaving walls this thick");
  shell->check(numberFrom(0, true))->group("Shape");
  CLI::Option* hole = command.add_option(
      "--drain-hole", repair.drainHole,
      "Drill a hole of this diameter straight down from the lowest point of each hollow; hollows too "
      "small for it stay solid");
  hole->check(numberFrom(0, true))->needs(shell)->group("Shape");
  command.add_option("--down", arguments.down, "Direction of down (default 0 0 -1)")
      ->expected(3)
      ->needs(hole)
      ->group("Shape");
}

void addRepairGridOptions(CLI::App& command, Arguments& arguments) {
  CLI::Option* resolution = command.add_option("--resolution", arguments.grid.resolution,
                                               "Samples along the longest side (default 256)");
  resolution->check(wholeNumberFrom(1))->group("Grid");
  command
      .add_option("--voxel-size", arguments.grid.voxelSize,
                  "Distance between samples, in the mesh's units, instead of --resolution")
      ->check(numberFrom(0, true))
      ->excludes(resolution)
      ->group("Grid");
}

}  // namespace

void addRepair(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("repair", "Make a watertight solid from any mesh, for example to print it");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("mesh", arguments->mesh, "Mesh to read: OBJ, PLY, STL, OFF, glTF, GLB, 3MF, FBX or DAE")
      ->type_name("MESH")
      ->required();
  command->add_option("-o,--output", arguments->result, "Mesh to write: .ply, .obj, .stl or .glb")
      ->type_name("FILE")
      ->required();
  command->add_option("--stats", arguments->stats, "Also write all figures as .json")->type_name("FILE");
  addRepairGridOptions(*command, *arguments);
  addOrientationOption(*command, *arguments);
  command
      ->add_flag(
          "!--no-close-holes", arguments->options.closeHoles,
          "Do not measure distances to the surface that closes holes; they are still closed, but in steps")
      ->group("Method");
  addShapeOptions(*command, *arguments);
  addMachineOptions(*command, *arguments);
  command->footer(kFooter);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raymap
