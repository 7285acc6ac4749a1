#include <raymap/json.h>
#include <raymap/raymap.h>

#include <cmath>
#include <cstdio>
#include <ostream>
#include <utility>

#include "batch.h"
#include "commands.h"
#include "field_options.h"
#include "first_use.h"
#include "library_options.h"
#include "mesh_output.h"
#include "mesh_units.h"
#include "repair_report.h"
#include "terminal.h"
#include "verdict.h"
#include "warnings.h"

namespace raymap {

namespace {

constexpr const char* kRepairFooter = R"(Examples:
  raymap repair scan.ply -o scan.stl                             (a watertight solid)
  raymap repair part.stl -o part.3.stl --voxel-size 0.1 --offset 0.2
  raymap repair bust.obj -o bust.stl --shell 2 --drain-hole 4    (hollow, walls 2 thick, a hole 4 wide)
  raymap repair bust.obj -o bust.stl --shell 2 --drain-hole 4 --drain-holes 2    (a vent, too)
  raymap repair car.obj -o car.stl --min-thickness 0.8           (nothing is thinner, sheets become plates)
  raymap repair terrain.stl -o block.stl --base -5               (walls and a flat base at z = -5)
  raymap repair part.stl -o part.3mf --unit in                   (its numbers are inches)
  raymap repair car.glb -o car.stl --unit mm --up y              (from metres, y up, to millimetres, z up)
  raymap repair bust.obj -o bust.stl --height 80                 (80 high in the file)
  raymap repair bust.stl -o half.stl --cut-plane 0 0 1 40 --split (both halves, cut flat at z = 40)
  raymap repair plate.stl -o part.stl --split                    (part_1.stl, part_2.stl: each part by itself)
  raymap repair *.stl -o printable/                              (each file by itself; then a table)

All lengths are in the mesh's units, or in those that --unit names. The program measures and prints how far the
result deviates from the mesh.)";

void warnOfLengths(const RepairOptions& repair, const Box& shape) {
  warnOfLength("--shell", repair.shell, shape);
  warnOfLength("--drain-hole", repair.drainHole, shape);
  warnOfLength("--min-thickness", repair.minThickness.value_or(0.0), shape);
  warnOfLength("--offset", std::abs(repair.offset), shape);
}

/// Prints a text before the work goes on.
void printNow(const std::string& text, ProgressLine& line) {
  line.clear();
  std::printf("%s\n", text.c_str());
  std::fflush(stdout);
}

StoredMesh store(const RepairArguments& arguments, Mesh mesh) {
  return storeMesh(arguments.result, std::move(mesh),
                   {.recenter = arguments.units.recenter,
                    .unit = writtenUnit(arguments.units, named(arguments.mesh, arguments.format.input)),
                    .format = arguments.format.output});
}

/// Repairs with progress and warnings on stderr. Stores the result, and what a plane cuts off.
RepairReport makeSolid(const Mesh& mesh, const MeshAttributes& attributes, const RepairGrid& grid,
                       const RepairArguments& arguments, ProgressLine& line, StoredMesh& stored,
                       StoredMesh& cutOff) {
  RepairOptions how = arguments.repair;
  how.roundResult = [&](Mesh& result) {
    stored = store(arguments, std::move(result));
    result = std::move(stored.stored);
  };
  MachineOptions machine = withProgress(arguments.machine, line);
  machine.warn = [&, warnElse = machine.warn](const Warning& warning) {
    if (warning.code != WarningCode::Sheet) return warnElse(warning);
    line.clear();
    printWarning(warning.message + " (" + thickenCommand(warning.fields.length, arguments.mesh) +
                 "; or --base Z)");
  };
  std::string notice = whyItTakesLong(grid);
  machine.progress = [&, report = machine.progress](std::string_view stage, double done) {
    // A mesh that only the first stage sees is kept as it is.
    if (stage != "inspect" && !notice.empty()) printNow(std::exchange(notice, ""), line);
    return report(stage, done);
  };
  Repaired repaired = repair(mesh, grid, arguments.options, how, machine);
  stored.stored = std::move(repaired.mesh);
  stored.attributes = carryAttributes(attributes, mesh, stored.exact, repaired.faceSource);
  if (arguments.isSplit && how.cutPlane) {
    cutOff = store(arguments, std::move(repaired.cutOff));
    cutOff.attributes = carryAttributes(attributes, mesh, cutOff.exact, repaired.cutOffSource);
  }
  return std::move(repaired.report);
}

Outcome repairOne(RepairArguments& arguments) {
  const Clock::time_point start = Clock::now();
  const std::filesystem::path input = named(arguments.mesh, arguments.format.input),
                              output = named(arguments.result, arguments.format.output);
  arguments.repair.down = downIn(arguments.units.up.empty() ? input : output);  // Only --up rotates.
  if (const std::vector<double>& d = arguments.down; !d.empty()) arguments.repair.down = {d[0], d[1], d[2]};
  checkMeshUnits(arguments.units, output);
  std::vector<Stats::Stage> steps;
  Mesh mesh;
  MeshAttributes attributes;
  timeStep(steps, "load",
           [&] { mesh = loadMesh(arguments.mesh, arguments.format.input, false, &attributes); });
  arguments.units.scale = convertUnits(mesh, arguments.units, input, output);
  warnOfLengths(arguments.repair, bounds(mesh));
  testBeforeFirstUse(arguments.machine.device);
  RepairGrid grid;
  StoredMesh stored, cutOff;
  RepairReport report;
  {
    ProgressLine line;
    const MachineOptions machine = withProgress(arguments.machine, line);
    timeStep(steps, "fit", [&] { grid = fitRepairGrid(mesh, arguments.grid, arguments.repair, machine); });
    report = makeSolid(mesh, attributes, grid, arguments, line, stored, cutOff);
  }
  steps.insert(steps.end(), report.stats.stages.begin(), report.stats.stages.end());
  checkStored(stored, report.after, report.crossingAfter.pairs);
  checkStored(cutOff);
  if (!isSound(report.after))
    printWarning(
        "the result is not watertight, or its faces do not point outwards; this is a bug, please report it");
  Json parts;
  for (StoredMesh* each : {&stored, &cutOff}) each->options.attributes = &each->attributes;
  timeStep(steps, "write", [&] {
    if (!arguments.isSplit) return writeMesh(stored.path, stored.exact, stored.options);
    parts = Json::array();
    for (const StoredMesh* each : {&stored, &cutOff})
      if (!each->exact.triangles.empty())
        writeParts(each->path, each->exact, each->options, inputsKept(arguments.format, arguments.mesh),
                   parts);
  });
  print(arguments, grid, report);
  const Stats::Stage slowest = slowestStep(steps);
  std::printf("time: %.1f s", millisecondsSince(start) / 1000.0);
  if (isVerbose())
    std::printf("; the longest step, %s, took %.1f s", slowest.name.c_str(), slowest.milliseconds / 1000.0);
  std::printf("\n");
  Outcome outcome{.done = wordFor(report),
                  .trianglesBefore = report.before.triangles,
                  .trianglesAfter = report.after.triangles,
                  .volume = report.after.signedVolume,
                  .figures = describe(arguments, grid, report, steps, stored.options)};
  if (!arguments.isSplit) {
    printWritten(stored.path, stored.options);
    if (arguments.repair.cutPlane) std::printf("--split writes what the plane cuts off, too\n");
  } else {
    printParts(parts);
    printOffset(stored.options);
  }
  outcome.figures["parts"] = std::move(parts);
  return outcome;
}

void run(RepairArguments& arguments) {
  finishFieldArguments(arguments);
  checkSimplification(arguments.repair.tolerance, arguments.repair.triangles);
  checkSplit(arguments.isSplit, arguments.result);
  if (const std::vector<double>& c = arguments.cutPlane; !c.empty())
    arguments.repair.cutPlane = Plane{{c[0], c[1], c[2]}, c[3]};
  runOnEach(arguments, repairOne);
}

}  // namespace

void addRepair(Program& program) {
  Command& command = program.addCommand(
      "repair", "Make a watertight solid from any mesh, for example to print it", kRepairFooter);
  auto& arguments = command.runs<RepairArguments>(run);
  addMeshFileOptions(command, arguments);
  addSpacingOptions(command, arguments.grid);
  addOptions(command, {{"--orientation", targetOf(arguments.options.orientation)}});
  addLibraryOptions(command, arguments.repair, {"measure"});
  addOptions(
      command,
      {{"--down", &arguments.down}, {"--cut-plane", &arguments.cutPlane}, {"--split", &arguments.isSplit}});
  addMachineOptions(command, arguments.machine);
}

}  // namespace raymap
