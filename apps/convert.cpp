#include <raymap/raymap.h>

#include "checks.h"
#include "commands.h"
#include "field_array.h"
#include "report.h"
#include "terminal.h"

namespace raymap {

namespace {

struct Arguments {
  std::filesystem::path input, output;
  bool mayOverwrite = false;
};

void check(const Arguments& arguments, const std::vector<std::string>& extensions) {
  const Output output{"output", arguments.output, extensions};
  checkOutputs({output});
  if (!arguments.mayOverwrite) checkInputs({output}, {arguments.input});
}

void convertField(const Arguments& arguments) {
  check(arguments, fieldExtensions());
  const Field field = readField(arguments.input);
  writeField(arguments.output, field, name(heldArray(field)));
}

void convertMesh(const Arguments& arguments) {
  check(arguments, writableMeshExtensions());
  writeMesh(arguments.output, loadMesh(arguments.input));
}

}  // namespace

void addConvert(CLI::App& app) {
  CLI::App* command = app.add_subcommand("convert", "Convert a field or a mesh to another format");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("input", arguments->input, "Field or mesh to read")
      ->type_name("FIELD|MESH")
      ->required();
  command
      ->add_option("output", arguments->output,
                   "File to write; a field as .vdb, .nrrd, .npz, .vti or .npy (without its grid), a mesh as "
                   ".ply, .obj, .stl, .glb or .3mf")
      ->type_name("FILE")
      ->required();
  addOverwriteOption(*command, arguments->mayOverwrite);
  command->footer("Examples:\n  raymap convert bunny.vdb bunny.nrrd\n  raymap convert bunny.3mf bunny.ply");
  command->callback([arguments] {
    if (hasExtension(arguments->input, meshExtensions()))
      convertMesh(*arguments);
    else
      convertField(*arguments);
    printWritten(arguments->output);
  });
}

}  // namespace raymap
