#include <raymap/raymap.h>

#include <cstdio>

#include "checks.h"
#include "commands.h"
#include "field_array.h"
#include "field_options.h"
#include "first_use.h"
#include "options.h"
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
  raymap render part.obj -o part.png --up z                (z points up, as in .stl and .3mf by themselves)
  raymap render globe.vdb -o globe.html                    (a page to turn, cut and slice it in a browser))";

struct Arguments : FieldArguments {
  StreamFormat format;
  fs::path input, picture;
  std::string slice, as;
  int index = -1;
  ViewArguments camera;
  RenderOptions view;
  PageOptions page;
  bool mayOverwrite = false;
};

bool isPage(const Arguments& arguments) {
  return hasExtension(named(arguments.picture, arguments.format.output), {".html"});
}

void finishOptions(Arguments& arguments) {
  constexpr int kResolution = 256;  // Twice that of `generate`: people look at the picture.
  if (!arguments.grid.resolution) arguments.grid.resolution = kResolution;
  finishFieldArguments(arguments);
  arguments.options.winding = arguments.as == "winding";
  arguments.options.confidence = arguments.as == "confidence";
  arguments.options.triangle = arguments.as == "triangle";
}

void writeShown(const Field& field, FieldArray array, const Arguments& arguments) {
  const auto write = [&](const Picture& picture) {
    writePng(arguments.picture, picture);
    printWritten(arguments.picture);
  };
  if (!arguments.slice.empty())
    return write(
        renderSlice(field, arguments.slice[0] - 'x', arguments.index, arguments.camera.size[0], array));
  if (array != FieldArray::Distance)
    throw Error(ErrorCode::Usage, arguments.input.string() + ": the array '" + std::string(name(array)) +
                                      "' has no surface to draw; draw a slice of it with --slice x, y or z");
  MachineOptions machine = arguments.machine;
  testBeforeFirstUse(machine.device);
  ProgressLine line;
  machine = withProgress(machine, line);
  if (!isPage(arguments)) return write(renderField(field, arguments.view, machine));
  const PageContent page = writePage(arguments.picture, field, arguments.view, arguments.page, machine);
  line.clear();
  printWritten(arguments.picture);
  if (page.grid.dims != field.grid.dims)
    std::printf("It shows %d x %d x %d samples of %d x %d x %d; more with --max-size\n", page.grid.dims.x,
                page.grid.dims.y, page.grid.dims.z, field.grid.dims.x, field.grid.dims.y, field.grid.dims.z);
}

void run(Arguments& arguments) {
  finishOptions(arguments);
  const std::vector<Output> outputs{{"--output", arguments.picture, {".png", ".html"}}};
  prepareFiles(arguments.format, {{arguments.input, meshAndFieldExtensions()}}, outputs);
  if (!arguments.mayOverwrite) checkInputs(outputs, {arguments.input});
  if (isPage(arguments) && !arguments.slice.empty())
    throw Error(ErrorCode::Usage, "a page moves its own slice; leave out --slice, or write a .png");
  if (arguments.page.title.empty()) arguments.page.title = displayName(arguments.input.filename());
  setView(arguments.camera, isZUp(arguments.input, arguments.format.input), arguments.view);
  Field field = loadField(arguments.input, arguments, arguments.format.input);
  const FieldArray array = chooseArray(arguments.input, arguments.as, field);
  writeShown(field, array, arguments);
}

}  // namespace

void addRender(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Draw a field, or a mesh through its field");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("input", arguments->input, "Mesh or field to read")
      ->type_name("MESH|FIELD")
      ->required();
  addOption(*command, "--output", arguments->picture)->required();
  addOption(*command, "--format", arguments->format.given);
  addOption(*command, "--overwrite", arguments->mayOverwrite);
  addUnitOptions(*command, arguments->units);
  addGridOptions(*command, *arguments);
  addOption(*command, "--thickness", arguments->options.thickness);
  addOption(*command, "--shell", arguments->view.shell);
  addViewOptions(*command, arguments->camera);
  addOption(*command, "--cut", arguments->view.cut);
  addOption(*command, "--index", arguments->index)->needs(addOption(*command, "--slice", arguments->slice));
  addOption(*command, "--as", arguments->as);
  addOption(*command, "--max-size", arguments->page.maxSize);
  addMachineOptions(*command, arguments->machine);
  command->footer(kFooter);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raymap
