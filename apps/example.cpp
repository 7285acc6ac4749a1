#include <raymap/raymap.h>

#include "checks.h"
#include "commands.h"
#include "example_mesh.h"
#include "report.h"

namespace raymap {

namespace {

struct ExampleArguments {
  std::filesystem::path mesh;
  bool holes = false, isFine = false;
};

void run(ExampleArguments& arguments) {
  StreamFormat format;
  prepareFiles(format, {}, {{"--output", arguments.mesh, {".ply"}}});
  writeMesh(arguments.mesh, makeExampleMesh(arguments.holes, arguments.isFine), {.format = ".ply"});
  printWritten(arguments.mesh);
}

}  // namespace

void addExample(Program& program) {
  Command& command =
      program.addCommand("example", "Write an example mesh as .ply: a globe of 95,000 triangles",
                         "Example:\n  raymap example -o torn.ply --holes");
  auto& arguments = command.runs<ExampleArguments>(run);
  addOutput(command, arguments.mesh, "Mesh to write", {".ply"}).isRequired = true;
  addOptions(command, {{"--holes", &arguments.holes}, {"--fine", &arguments.isFine}});
}

}  // namespace raymap
