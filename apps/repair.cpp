#include <raymap/raymap.h>

#include <cstdio>
#include <ostream>

#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "first_use.h"
#include "mesh_output.h"
#include "mesh_units.h"
#include "repair_report.h"
#include "terminal.h"
#include "warnings.h"

namespace raymap {

namespace {

constexpr const char* kFooter = R"(Examples:
  raymap repair scan.ply -o scan.stl                             (a watertight solid)
  raymap repair part.stl -o part.3.stl --voxel-size 0.1 --offset 0.2
  raymap repair bust.obj -o bust.stl --shell 2 --drain-hole 4    (hollow, walls 2 thick, a hole 4 wide)
  raymap repair bust.obj -o bust.stl --shell 2 --drain-hole 4 --drain-holes 2    (a vent, too)
  raymap repair car.obj -o car.stl --min-thickness 0.8           (nothing is thinner, sheets become plates)
  raymap repair part.stl -o part.3mf --unit in                   (its numbers are inches)
  raymap repair car.glb -o car.stl --unit mm --up y              (from metres, y up, to millimetres, z up)

All lengths are in the mesh's units, or in those that --unit names. The program measures and prints how far the
result deviates from the mesh.)";

/// Repairs with progress and warnings on stderr.
RepairReport makeSolid(const Mesh& mesh, const Grid& grid, const RepairArguments& arguments,
                       StoredMesh& stored) {
  ProgressLine line;
  RepairOptions how = arguments.repair;
  how.finish = [&](Mesh& result) {
    stored = storeMesh(arguments.result, std::move(result),
                       {.recenter = arguments.recenter,
                        .unit = writtenUnit(arguments.units, named(arguments.mesh, arguments.format.input)),
                        .format = arguments.format.output});
    checkStored(stored);
    result = std::move(stored.stored);
  };
  Repaired repaired = repair(mesh, grid, arguments.options, how, withProgress(arguments.machine, line));
  stored.stored = std::move(repaired.mesh);
  return std::move(repaired.report);
}

void run(RepairArguments& arguments) {
  finishFieldArguments(arguments);
  if (!arguments.units.up.empty())
    arguments.repair.down = downIn(named(arguments.result, arguments.format.output));
  if (const std::vector<double>& d = arguments.down; !d.empty()) arguments.repair.down = {d[0], d[1], d[2]};
  const std::vector<Output> outputs{{"--output", arguments.result, writableMeshExtensions()},
                                    {"--stats", arguments.stats, {".json"}}};
  prepareFiles(arguments.format, {{arguments.mesh, meshExtensions()}}, outputs);
  if (!arguments.mayOverwrite) checkInputs(outputs, {arguments.mesh});
  const std::filesystem::path input = named(arguments.mesh, arguments.format.input),
                              output = named(arguments.result, arguments.format.output);
  checkMeshUnits(arguments.units, output);
  Mesh mesh = loadMesh(arguments.mesh, arguments.format.input);
  convertUnits(mesh, arguments.units, input, output);
  testBeforeFirstUse(arguments.machine.device);
  const RepairGrid grid = fitRepairGrid(mesh, arguments.grid, arguments.repair, arguments.machine);
  StoredMesh stored;
  const RepairReport report = makeSolid(mesh, grid, arguments, stored);
  checkCrossing(stored, report.crossingAfter.pairs);
  if (!isSound(report.after))
    printWarning(
        "the result is not watertight, or its faces do not point outwards; this is a bug, please report it");
  writeMesh(stored.path, stored.exact, stored.options);
  if (!arguments.stats.empty())
    writeAtomically(arguments.stats, [&](std::ostream& out) {
      out << textOf(describe(arguments, grid, report, stored.options));
    });
  print(arguments, grid, report);
  printWritten(stored.path, stored.options);
  if (!arguments.stats.empty()) printWritten(arguments.stats);
}

void addShapeOptions(CLI::App& command, RepairArguments& arguments) {
  RepairOptions& repair = arguments.repair;
  command
      .add_option("--tolerance", repair.tolerance,
                  "Largest deviation from the isosurface, to write fewer triangles; 0: all of them (default "
                  "a tenth of the distance between samples)")
      ->check(numberFrom(0))
      ->group("Shape");
  command.add_option("--offset", repair.offset, "Distance to move the surface outwards; negative: inwards")
      ->group("Shape");
  CLI::Option* shell =
      command.add_option("--shell", repair.shell, "Hollow the solid out, leaving walls this thick");
  shell->check(numberFrom(0, true))->group("Shape");
  command
      .add_option(
          "--min-thickness", repair.minThickness,
          "Make walls, fins and sheets that are thinner this thick; at least two samples (default 1.75 "
          "samples, the least that none is lost), or 0: lose what the samples miss")
      ->check(numberFrom(0))
      ->group("Shape");
  CLI::Option* hole = command.add_option(
      "--drain-hole", repair.drainHole,
      "Drill a hole of this diameter straight down from the lowest point of each hollow; hollows too "
      "small for it stay solid");
  hole->check(numberFrom(0, true))->needs(shell)->group("Shape");
  command
      .add_option("--drain-holes", repair.drainHoles,
                  "Number of holes of each hollow: the second is a vent up from the highest point, more go "
                  "down from level floors (default 1)")
      ->check(wholeNumberFrom(1))
      ->needs(hole)
      ->type_name("N")
      ->group("Shape");
  command
      .add_option("--down", arguments.down, "Direction of down (default 0 0 -1; with --up in a .glb, 0 -1 0)")
      ->expected(3)
      ->needs(hole)
      ->group("Shape");
}

void addPartOptions(CLI::App& command, RepairArguments& arguments) {
  RepairOptions& repair = arguments.repair;
  command
      .add_option("--drop-smaller", repair.dropSmaller,
                  "Drop parts that enclose less than this volume, in the mesh's units cubed; 0 keeps all "
                  "(default: a thousandth of the largest part's volume)")
      ->check(numberFrom(0))
      ->type_name("VOLUME")
      ->group("Parts");
  command.add_flag("--keep-cavities", repair.keepCavities, "Do not fill sealed cavities")->group("Parts");
  command
      .add_flag("--remesh", repair.remesh,
                "Make the mesh anew even if its faces can be kept, because nothing is wrong with it but "
                "small holes")
      ->group("Parts");
}

}  // namespace

void addRepair(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("repair", "Make a watertight solid from any mesh, for example to print it");
  const auto arguments = std::make_shared<RepairArguments>();
  command->add_option("mesh", arguments->mesh, "Mesh to read: OBJ, PLY, STL, OFF, glTF, GLB, 3MF, FBX or DAE")
      ->type_name("MESH")
      ->required();
  command->add_option("-o,--output", arguments->result, "Mesh to write: .ply, .obj, .stl, .glb or .3mf")
      ->type_name("FILE")
      ->required();
  addRecenterOption(*command, arguments->recenter);
  addFormatOption(*command, arguments->format);
  command->add_option("--stats", arguments->stats, "Also write all figures as .json")->type_name("FILE");
  addOverwriteOption(*command, arguments->mayOverwrite);
  addSpacingOptions(*command, arguments->grid, kRepairResolution);
  addOrientationOption(*command, *arguments);
  command
      ->add_flag_callback(
          "--no-close-holes", [arguments] { arguments->repair.closeHoles = false; },
          "Do not measure distances to the surface that closes holes; they are still closed, but in steps")
      ->group("Method");
  addShapeOptions(*command, *arguments);
  addPartOptions(*command, *arguments);
  addMeshUnits(*command, arguments->units);
  addMachineOptions(*command, *arguments);
  command->footer(kFooter);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raymap
