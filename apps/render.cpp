#include <raymap/raymap.h>

#include "checks.h"
#include "commands.h"
#include "field_array.h"
#include "field_options.h"
#include "first_use.h"
#include "report.h"
#include "terminal.h"
#include "view_options.h"
#include "warnings.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(Examples:
  raymap render globe.vdb -o globe.png
  raymap render globe.ply -o globe.png --resolution 256    (makes the field first)
  raymap render globe.vdb -o half.png --cut --shell 0.05   (half of it, hollow)
  raymap render globe.vdb -o slice.png --slice z           (contour lines of the distance)
  raymap render winding.vdb -o slice.png --slice z         (of a file of --winding: its numbers)
  raymap render part.obj -o part.png --up 0 0 1            (z points up, as in .stl and .3mf by themselves))";

struct Arguments {
  StreamFormat format;
  fs::path input, picture;
  std::string slice, as;
  int index = -1;
  int resolution = 256;
  double thickness = 0.0;
  ViewArguments view;
  RenderOptions options;
  MachineOptions machine;
};

Field loadField(const Arguments& arguments) {
  FieldArguments field;
  field.grid.resolution = arguments.resolution;
  field.machine = arguments.machine;
  field.options.thickness = field.grid.thickness = arguments.thickness;
  field.options.winding = arguments.as == "winding";
  field.options.confidence = arguments.as == "confidence";
  field.options.triangle = arguments.as == "triangle";
  return loadField(arguments.input, field, arguments.format.input);
}

Picture draw(const Field& field, FieldArray array, const Arguments& arguments) {
  if (!arguments.slice.empty())
    return renderSlice(field, arguments.slice[0] - 'x', arguments.index, arguments.view.size[0], array);
  if (array != FieldArray::Distance)
    throw Error(ErrorCode::Usage, arguments.input.string() + ": the array '" + std::string(name(array)) +
                                      "' has no surface to draw; draw a slice of it with --slice x, y or z");
  MachineOptions machine = arguments.machine;
  testBeforeFirstUse(machine.device);
  ProgressLine line;
  return renderField(field, arguments.options, withProgress(machine, line));
}

void run(Arguments& arguments) {
  prepareFiles(arguments.format, {{arguments.input, meshAndFieldExtensions()}},
               {{"--output", arguments.picture, {".png"}}});
  setView(arguments.view, isZUp(arguments.input, arguments.format.input), arguments.options);
  Field field = loadField(arguments);
  const FieldArray array = chooseArray(arguments.input, arguments.as, field);
  writePng(arguments.picture, draw(field, array, arguments));
  printWritten(arguments.picture);
}

void addSliceOptions(CLI::App& command, Arguments& arguments) {
  CLI::Option* slice = command.add_option("--slice", arguments.slice,
                                          "Draw a map of the slice across this axis instead of the surface");
  slice->check(CLI::IsMember({"x", "y", "z"}));
  command.add_option("--index", arguments.index, "Index of the slice, in samples (default: the middle one)")
      ->check(wholeNumberFrom(0))
      ->needs(slice);
}

void addShapeOptions(CLI::App& command, Arguments& arguments) {
  command.add_flag("--cut", arguments.options.cut, "Cut the shape open and show half of it");
  command
      .add_option("--shell", arguments.options.shell,
                  "Hollow the shape out, leaving a wall this thick, in the mesh's units")
      ->check(numberFrom(0, true));
}

}  // namespace

void addRender(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Draw a field, or a mesh through its field");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("input", arguments->input, "Mesh or field to read")
      ->type_name("MESH|FIELD")
      ->required();
  command->add_option("-o,--output", arguments->picture, "Picture to write, .png")
      ->type_name("FILE")
      ->required();
  addFormatOption(*command, arguments->format);
  command
      ->add_option("--resolution", arguments->resolution,
                   "Samples along the longest side of a mesh's field (default 256)")
      ->check(wholeNumberFrom(1));
  command
      ->add_option("--thickness", arguments->thickness,
                   "Draw a solid of this thickness around a mesh's surface, in its units: for sheets")
      ->check(numberFrom(0, true));
  command->add_option(
      "--device", arguments->machine.device,
      "Device that makes a mesh's field and draws it: cpu, vulkan, vulkan:K (see raymap devices), or auto "
      "(default), a GPU if there is one, else the CPU");
  command
      ->add_option("--threads", arguments->machine.threads,
                   "Number of CPU threads; 0 = RAYMAP_THREADS, or else all (default)")
      ->check(wholeNumberFrom(0));
  addViewOptions(*command, arguments->view);
  addShapeOptions(*command, *arguments);
  addSliceOptions(*command, *arguments);
  addArrayOption(*command, arguments->as);
  command->footer(kFooter);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raymap
