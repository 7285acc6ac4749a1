#include <raymap/raymap.h>

#include "checks.h"
#include "commands.h"
#include "example_mesh.h"
#include "options.h"
#include "report.h"

namespace raymap {

void addExample(CLI::App& app) {
  struct Arguments {
    std::filesystem::path mesh;
    bool holes = false, isFine = false;
  };
  CLI::App* command =
      app.add_subcommand("example", "Write an example mesh as .ply: a globe of 95,000 triangles");
  const auto arguments = std::make_shared<Arguments>();
  addOutput(*command, arguments->mesh, "Mesh to write", {".ply"})->required();
  addOption(*command, "--holes", arguments->holes);
  addOption(*command, "--fine", arguments->isFine);
  command->footer("Example:\n  raymap example -o torn.ply --holes");
  command->callback([arguments] {
    StreamFormat format;
    prepareFiles(format, {}, {{"--output", arguments->mesh, {".ply"}}});
    writeMesh(arguments->mesh, makeExampleMesh(arguments->holes, arguments->isFine), {.format = ".ply"});
    printWritten(arguments->mesh);
  });
}

}  // namespace raymap
