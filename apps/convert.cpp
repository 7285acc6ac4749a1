#include <raymap/raymap.h>

#include "checks.h"
#include "commands.h"
#include "report.h"

namespace raymap {

namespace {

/// The distance, or what `generate` wrote by itself: winding, confidence or triangle numbers.
std::string_view arrayToConvert(const Field& field) {
  if (!field.distance.empty()) return "distance";
  if (!field.winding.empty()) return "winding";
  return field.confidence.empty() ? "triangle" : "confidence";
}

}  // namespace

void addConvert(CLI::App& app) {
  struct Arguments {
    std::filesystem::path input, output;
  };
  CLI::App* command = app.add_subcommand("convert", "Write a field in another format");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("input", arguments->input, ".vdb, .nrrd, .npz, .npy or .vti")
      ->type_name("FIELD")
      ->required();
  command->add_option("output", arguments->output, "Likewise; a .npy is without its grid")
      ->type_name("FIELD")
      ->required();
  command->footer("Example:\n  raymap convert bunny.vdb bunny.nrrd");
  command->callback([arguments] {
    checkOutputs({{"output", arguments->output, fieldExtensions()}});
    const Field field = readField(arguments->input);
    writeField(arguments->output, field, arrayToConvert(field));
    printWritten(arguments->output);
  });
}

}  // namespace raymap
