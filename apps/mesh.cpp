#include <raymap/json.h>
#include <raymap/raymap.h>

#include <cstdio>
#include <optional>
#include <variant>

#include "checks.h"
#include "commands.h"
#include "field_array.h"
#include "field_options.h"
#include "mesh_output.h"
#include "mesh_units.h"
#include "report.h"
#include "terminal.h"
#include "warnings.h"

namespace raymap {

namespace {

constexpr const char* kMeshFooter = R"(Examples:
  raymap mesh scan.vdb -o scan.ply                      (the surface of a field)
  raymap mesh scan.ply -o scan.stl --resolution 256     (makes the field first; closes a broken mesh)
  raymap mesh part.stl -o grown.stl --iso 0.5           (half a unit outside the surface)

Every edge of the result has exactly two faces, which point outwards. The result is closed where
it reaches the grid's box.)";

constexpr double kSimplifyTolerance = 0.1;  ///< In samples; that of `repair`, too.

struct MeshArguments : FieldArguments {
  StreamFormat format;
  std::filesystem::path input, mesh, stats;
  IsosurfaceOptions surface;
  std::optional<double> tolerance;
  size_t triangles = 0;
  const Command* command = nullptr;
};

/// Makes the surface, and drops triangles within the tolerance.
Simplified makeSurface(const Field& field, const MeshArguments& arguments) {
  ProgressLine line;
  const MachineOptions machine = withProgress(arguments.machine, line);
  Mesh mesh = isosurface(field, arguments.surface, machine);
  const double byDefault = arguments.triangles > 0 ? 0.0 : kSimplifyTolerance * field.grid.spacing;
  return simplify(mesh,
                  {.tolerance = arguments.tolerance.value_or(byDefault),
                   .step = field.grid.spacing,
                   .triangles = arguments.triangles},
                  machine);
}

Json describe(const MeshArguments& arguments, const Grid& grid, const Simplified& surface,
              const StoredMesh& stored) {
  return {{"raymap", version().text},
          {"input", arguments.input.string()},
          {"grid", figuresOf(grid)},
          {"triangles", stored.exact.triangles.size()},
          {"vertices", stored.exact.vertices.size()},
          {"deviation", surface.deviation},
          {"file_offset", toJson(stored.options.offset)}};
}

void run(MeshArguments& arguments) {
  if (!arguments.command->isGiven("--close-holes"))
    arguments.options.closeHoles =
        arguments.options.sign != SignMode::None && arguments.options.thickness == 0.0;
  finishFieldArguments(arguments);
  checkSimplification(arguments.tolerance, arguments.triangles);
  const std::vector<Output> outputs{{"--output", arguments.mesh, writableMeshExtensions()},
                                    {"--stats", arguments.stats, {".json"}}};
  prepareFiles(arguments.format, {{arguments.input, meshAndFieldExtensions()}}, outputs);
  const std::filesystem::path output = named(arguments.mesh, arguments.format.output);
  checkMeshUnits(arguments.units, output);
  const Field field =
      loadOrMakeField(arguments.input, arguments, arguments.format.input, arguments.format.grid, output);
  requireDistances(arguments.input, field);
  Simplified surface = makeSurface(field, arguments);
  const StoredMesh stored =
      storeMesh(arguments.mesh, std::move(surface.mesh),
                {.recenter = arguments.units.recenter,
                 .unit = writtenUnit(arguments.units, named(arguments.input, arguments.format.input)),
                 .format = arguments.format.output});
  checkStored(stored);
  const Mesh& mesh = stored.exact;
  writeMesh(stored.path, mesh, stored.options);
  if (!arguments.stats.empty()) writeJson(arguments.stats, describe(arguments, field.grid, surface, stored));
  std::printf("%s, %s, at most %.3g off the isosurface\n", counted(mesh.triangles.size(), "triangle").c_str(),
              mesh.vertices.size() == 1 ? "1 vertex" : (grouped(mesh.vertices.size()) + " vertices").c_str(),
              surface.deviation);
  printWritten(stored.path, stored.options);
  if (!arguments.stats.empty()) printWritten(arguments.stats);
}

}  // namespace

void addMesh(Program& program) {
  Command& command = program.addCommand(
      "mesh", "Make a closed mesh from a field, or from a mesh through its field", kMeshFooter);
  auto& arguments = command.runs<MeshArguments>(run);
  arguments.command = &command;
  addOperand(command, "FIELD|MESH", &arguments.input, "Field or mesh to read");
  addOutput(command, arguments.mesh, "Mesh to write", writableMeshExtensions()).isRequired = true;
  addOptions(command, {{"--format", &arguments.format.given},
                       {"--grid", &arguments.format.grid},
                       {"--overwrite", &arguments.format.mayOverwrite}});
  addFigureOptions(command, arguments.stats);
  addMeshOutputOptions(command, arguments.units);
  addOptions(command, {{"--iso", &arguments.surface.iso},
                       {"--tolerance", &arguments.tolerance},
                       {"--triangles", &arguments.triangles}});
  addFieldOptions(command, arguments);
}

}  // namespace raymap
