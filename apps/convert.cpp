#include <raymap/raymap.h>

#include "checks.h"
#include "commands.h"

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
    std::filesystem::path from, to;
  };
  CLI::App* command = app.add_subcommand("convert", "Write a field in another format");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("from", arguments->from, ".vdb, .nrrd, .npz, .npy or .vti")
      ->type_name("FIELD")
      ->required();
  command->add_option("to", arguments->to, "The same")->type_name("FIELD")->required();
  command->footer("Example:\n  raymap convert bunny.vdb bunny.nrrd");
  command->callback([arguments] {
    checkOutputs({{"FIELD", arguments->to, fieldExtensions()}});
    const Field field = readField(arguments->from);
    writeField(arguments->to, field, arrayToConvert(field));
  });
}

}  // namespace raymap
