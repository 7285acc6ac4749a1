#include <raymap/raymap.h>

#include "checks.h"
#include "commands.h"
#include "report.h"
#include "terminal.h"

namespace raymap {

namespace {

/// Returns the array that a file holds: the distance, or one that `generate` wrote by itself.
std::string_view arrayToConvert(const Field& field) {
  if (!field.distance.empty()) return "distance";
  if (!field.winding.empty()) return "winding";
  return field.confidence.empty() ? "triangle" : "confidence";
}

struct Arguments {
  std::filesystem::path input, output;
};

void convertField(const Arguments& arguments) {
  checkOutputs({{"output", arguments.output, fieldExtensions()}});
  const Field field = readField(arguments.input);
  writeField(arguments.output, field, arrayToConvert(field));
}

void convertMesh(const Arguments& arguments) {
  checkOutputs({{"output", arguments.output, writableMeshExtensions()}});
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
                   ".ply, .obj, "
                   ".stl or .glb")
      ->type_name("FILE")
      ->required();
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
