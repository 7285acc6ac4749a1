#include <raymap/raymap.h>

#include <cstdio>

#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "mesh_output.h"
#include "mesh_units.h"
#include "report.h"
#include "terminal.h"
#include "warnings.h"

namespace raymap {

namespace {

constexpr const char* kFooter = R"(Examples:
  raymap mesh scan.vdb -o scan.ply                      (the surface of a field)
  raymap mesh scan.ply -o scan.stl --resolution 256     (makes the field first; closes a broken mesh)
  raymap mesh part.stl -o grown.stl --iso 0.5           (half a unit outside the surface)

Every edge of the result has exactly two faces, which point outwards. The result is closed where it reaches
the grid's box.)";

struct Arguments : FieldArguments {
  StreamFormat format;
  std::filesystem::path input, mesh;
  bool recenter = false;
  bool mayOverwrite = false;
  IsosurfaceOptions surface;
};

Mesh makeSurface(const Field& field, const Arguments& arguments) {
  ProgressLine line;
  return isosurface(field, arguments.surface, withProgress(arguments.machine, line));
}

void run(Arguments& arguments) {
  finishFieldArguments(arguments);
  const std::vector<Output> outputs{{"--output", arguments.mesh, writableMeshExtensions()}};
  prepareFiles(arguments.format, {{arguments.input, meshAndFieldExtensions()}}, outputs);
  if (!arguments.mayOverwrite) checkInputs(outputs, {arguments.input});
  const StoredMesh stored = storeMesh(
      arguments.mesh, makeSurface(loadField(arguments.input, arguments, arguments.format.input), arguments),
      {.recenter = arguments.recenter,
       .unit = writtenUnit({}, named(arguments.input, arguments.format.input)),
       .format = arguments.format.output});
  checkStored(stored);
  const Mesh& mesh = stored.exact;
  writeMesh(stored.path, mesh, stored.options);
  std::printf("%s, %s\n", counted(mesh.triangles.size(), "triangle").c_str(),
              mesh.vertices.size() == 1 ? "1 vertex" : (grouped(mesh.vertices.size()) + " vertices").c_str());
  printWritten(stored.path, stored.options);
}

}  // namespace

void addMesh(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("mesh", "Make a closed mesh from a field, or from a mesh through its field");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("input", arguments->input, "Field or mesh to read")
      ->type_name("FIELD|MESH")
      ->required();
  command->add_option("-o,--output", arguments->mesh, "Mesh to write: .ply, .obj, .stl, .glb or .3mf")
      ->type_name("FILE")
      ->required();
  addOverwriteOption(*command, arguments->mayOverwrite);
  addFormatOption(*command, arguments->format);
  command->add_option("--iso", arguments->surface.iso,
                      "Distance at which the surface lies, in the mesh's units (default 0)");
  addRecenterOption(*command, arguments->recenter);
  addFieldOptions(*command, *arguments);
  command->footer(kFooter);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raymap
