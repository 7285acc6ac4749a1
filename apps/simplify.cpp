#include <raymap/json.h>
#include <raymap/raymap.h>

#include <cstdio>
#include <optional>

#include "batch.h"
#include "commands.h"
#include "field_options.h"
#include "mesh_output.h"
#include "mesh_units.h"
#include "report.h"
#include "terminal.h"
#include "warnings.h"

namespace raymap {

namespace {

constexpr const char* kSimplifyFooter = R"(Examples:
  raymap simplify scan.ply -o small.ply --triangles 5000
      as near to the mesh as so many triangles allow
  raymap simplify part.stl -o small.stl --tolerance 0.02
      as few triangles as this deviation allows
  raymap simplify part.stl -o small.stl --triangles 5000 --tolerance 0.02
      5000, or more where they would be farther off

The mesh must be watertight and stays so: no faces cross that did not cross before. raymap repair makes any
mesh watertight, and takes the same options.)";

struct SimplifyArguments {
  StreamFormat format;
  std::vector<std::filesystem::path> meshes;
  std::filesystem::path mesh, result, stats;
  MeshUnits units;
  MachineOptions machine;
  std::optional<double> tolerance;
  size_t triangles = 0;
};

Json describe(const SimplifyArguments& arguments, const SimplifyReport& report, const StoredMesh& stored) {
  Json json{{"raymap", version().text},
            {"mesh", arguments.mesh.string()},
            {"options",
             {{"tolerance", arguments.tolerance ? Json(*arguments.tolerance) : Json()},
              {"triangles", arguments.triangles}}},
            {"vertices", stored.exact.vertices.size()},
            {"file_offset", toJson(stored.options.offset)}};
  json.update(toJson(report));
  return json;
}

void printCounts(const SimplifyReport& report) {
  const std::string count = counted(report.trianglesAfter, "triangle");
  if (report.tolerance == 0.0)
    std::printf("kept as it is, with %s\n", count.c_str());
  else
    std::printf("%s instead of %s, at most %.3g off the mesh, with a tolerance of %.3g\n", count.c_str(),
                grouped(report.trianglesBefore).c_str(), report.deviation, report.tolerance);
}

Outcome simplifyOne(SimplifyArguments& arguments) {
  const std::filesystem::path input = named(arguments.mesh, arguments.format.input),
                              output = named(arguments.result, arguments.format.output);
  checkMeshUnits(arguments.units, output);
  MeshAttributes attributes;
  Mesh mesh = loadMesh(arguments.mesh, arguments.format.input, false, &attributes);
  convertUnits(mesh, arguments.units, input, output);
  ProgressLine line;
  Simplified made =
      simplify(mesh, {.tolerance = arguments.tolerance.value_or(0.0), .triangles = arguments.triangles},
               withProgress(arguments.machine, line));
  line.clear();
  const SimplifyReport report{made.tolerance, mesh.triangles.size(), made.mesh.triangles.size(),
                              made.deviation};
  StoredMesh stored = storeMesh(arguments.result, std::move(made.mesh),
                                {.recenter = arguments.units.recenter,
                                 .unit = writtenUnit(arguments.units, input),
                                 .format = arguments.format.output});
  checkStored(stored);
  stored.attributes = carryAttributes(attributes, mesh, stored.exact, {});
  stored.options.attributes = &stored.attributes;
  writeMesh(stored.path, stored.exact, stored.options);
  printCounts(report);
  printWritten(stored.path, stored.options);
  return {.done = report.tolerance == 0.0 ? "kept" : "simplified",
          .trianglesBefore = report.trianglesBefore,
          .trianglesAfter = report.trianglesAfter,
          .volume = {},
          .figures = describe(arguments, report, stored)};
}

void run(SimplifyArguments& arguments) {
  if (!arguments.tolerance && arguments.triangles == 0)
    throw Error(ErrorCode::Usage, "add --triangles N, --tolerance LENGTH or both: they say how far to go");
  checkSimplification(arguments.tolerance, arguments.triangles);
  runOnEach(arguments, simplifyOne);
}

}  // namespace

void addSimplify(Program& program) {
  Command& command =
      program.addCommand("simplify", "Make a watertight mesh of fewer triangles", kSimplifyFooter);
  auto& arguments = command.runs<SimplifyArguments>(run);
  addMeshFileOptions(command, arguments);
  addOptions(command, {{"--tolerance", &arguments.tolerance}, {"--triangles", &arguments.triangles}});
  addCpuOptions(command, arguments.machine);
}

}  // namespace raymap
