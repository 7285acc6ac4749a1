#include <raymap/raymap.h>

#include <cstdio>
#include <type_traits>
#include <variant>

#include "checks.h"
#include "commands.h"
#include "field_array.h"
#include "field_options.h"
#include "first_use.h"
#include "movie.h"
#include "report.h"
#include "sequence.h"
#include "terminal.h"
#include "view_options.h"
#include "warnings.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kRenderFooter = R"(Examples:
  raymap render globe.vdb -o globe.png
  raymap render globe.ply -o globe.png --resolution 256    (makes the field first)
  raymap render globe.vdb -o half.png --cut --shell 0.05   (half of it, hollow)
  raymap render globe.vdb -o slice.png --slice z           (contour lines of the distance)
  raymap render winding.vdb -o slice.png --slice z         (of a file of --winding: its numbers)
  raymap render man.glb --frames 0:59 -o man.%04d.png      (a picture of each frame; -o man.mp4: a movie)
  raymap render part.obj -o part.png --up z                (z points up, as in .stl and .3mf by themselves)
  raymap render globe.vdb -o near.png --eye 3,1,2 --direction -3,-1,-2 --cut-plane 0,0,1,0.4
  raymap render globe.vdb -o globe.html                    (a page to turn, cut and slice it in a browser)
  raymap render scan.ply fixed.stl -o repair.html          (a page that compares the two)
  raymap render scan.ply fixed.stl -o repair.png           (the first in the colours of the difference))";

struct RenderArguments : FieldArguments {
  StreamFormat format;
  FrameArguments frames;
  fs::path input, other, picture;
  std::string slice, as;
  int index = -1;
  ViewArguments camera;
  RenderOptions view;
  PageOptions page;
};

bool isPage(const RenderArguments& arguments) {
  return hasExtension(named(arguments.picture, arguments.format.output), {".html"});
}

void finishOptions(RenderArguments& arguments) {
  constexpr int kResolution = 256;  // Twice that of `generate`: people look at the picture.
  if (!arguments.grid.resolution) arguments.grid.resolution = kResolution;
  finishFieldArguments(arguments);
  arguments.options.winding = arguments.as == "winding";
  arguments.options.confidence = arguments.as == "confidence";
  arguments.options.triangle = arguments.as == "triangle";
}

/// Warns of walls thicker than the shape.
void warnOfShell(const Field& field, const RenderArguments& arguments) {
  const Grid& grid = field.grid;
  const Box all{grid.origin, grid.position(glm::dvec3(grid.dims - 1))};
  warnOfLength("--shell", arguments.view.shell, field.surfaceBounds.isEmpty() ? all : field.surfaceBounds);
}

/// Draws a field, in colours that tell the difference from another one, if there is one.
Picture draw(const Field& field, FieldArray array, const RenderArguments& arguments,
             const std::string& title = "", const Field* other = nullptr) {
  if (!arguments.slice.empty())
    return renderSlice(field, arguments.slice[0] - 'x', arguments.index, arguments.camera.size[0], array);
  const bool hasSurface = field.narrow || !field.distance.empty();
  if (!hasSurface || array == FieldArray::Triangle)
    throw Error(ErrorCode::Usage, arguments.input.string() + ": the array '" + std::string(name(array)) +
                                      "' has no surface to draw; draw a slice of it with --slice x, y or z");
  RenderOptions view = arguments.view;
  view.array = array;
  view.other = other;
  MachineOptions machine = arguments.machine;
  testBeforeFirstUse(machine.device);
  ProgressLine line;
  return renderField(field, view, withProgress(machine, line, title));
}

/// Pictures of frames: files of their own, or one movie.
class FrameWriter {
 public:
  FrameWriter(const RenderArguments& arguments, const Sequence& sequence)
      : path_(arguments.picture), isMovie_(hasExtension(path_, {".mp4"})), fps_(sequence.fps()) {}

  void add(const Picture& picture, int frame) {
    if (!isMovie_) {
      const fs::path path = framePath(path_, frame);
      writePng(path, picture);
      printWritten(path);
      std::fflush(stdout);
      return;
    }
    if (!movie_) movie_.emplace(path_, picture.width, picture.height, fps_);
    movie_->add(picture);
  }

  void finish() {
    if (!isMovie_) return;
    movie_->finish();
    printWritten(path_);
  }

 private:
  fs::path path_;
  bool isMovie_;
  double fps_;
  std::optional<Movie> movie_;
};

void checkFrames(const RenderArguments& arguments, const Sequence& sequence) {
  const bool isMovie = hasExtension(arguments.picture, {".mp4"});
  if (isMovie) findFfmpeg(arguments.picture);
  std::vector<fs::path> inputs;
  for (size_t i = 0; i < sequence.size(); ++i) inputs.push_back(sequence.input(i));
  for (size_t i = 0; i < sequence.size(); ++i) {
    fs::path picture = isMovie ? arguments.picture : framePath(arguments.picture, sequence.frame(i));
    if (!arguments.format.mayOverwrite) checkInputs({{"--output", picture, {}}}, inputs);
  }
}

/// Draws each frame on one grid, before one camera. Holds one at a time.
void renderFrames(RenderArguments& arguments) {
  Sequence sequence(arguments.frames, arguments.input, arguments.format.input, arguments.units, false,
                    arguments.format.grid);
  checkFrames(arguments, sequence);
  const Box bounds = sequence.bounds();
  const double pad = 0.5 * arguments.options.thickness;
  if (!arguments.view.frame) arguments.view.frame = Box{bounds.min - pad, bounds.max + pad};
  testBeforeFirstUse(arguments.machine.device);
  Generator generator;
  Field field;
  FrameWriter writer(arguments, sequence);
  for (size_t i = 0; i < sequence.size(); ++i) {
    std::variant<Mesh, Field> shape = sequence.read(i);
    if (const Mesh* mesh = std::get_if<Mesh>(&shape)) {
      ProgressLine line;
      generator.generate(*mesh, fitGrid(bounds, arguments.grid), arguments.options, field,
                         withProgress(arguments.machine, line, sequence.title(i)));
    } else {
      field = std::move(std::get<Field>(shape));
    }
    const FieldArray array = chooseArray(sequence.input(i), arguments.as, field);
    writer.add(draw(field, array, arguments, sequence.title(i)), sequence.frame(i));
  }
  writer.finish();
}

using MeshOrField = std::variant<Mesh, Field>;

/// Returns the grid on which two shapes are shown: that of a field, the first one's rather, or one over both
/// meshes.
Grid gridOfBoth(const MeshOrField& first, const MeshOrField& second, const GridOptions& options) {
  for (const MeshOrField* each : {&first, &second})
    if (const Field* field = std::get_if<Field>(each)) return field->grid;
  const Box box = gridBounds(std::get<Mesh>(first)), more = gridBounds(std::get<Mesh>(second));
  return fitGrid(Box{glm::min(box.min, more.min), glm::max(box.max, more.max)}, options);
}

MeshOrField load(const fs::path& path, const RenderArguments& arguments) {
  return loadMeshOrField(path, arguments.format.input, arguments.format.grid, arguments.units);
}

/// Returns a field as it is, or that of a mesh on a grid.
Field fieldOf(MeshOrField& shape, const Grid& grid, const RenderArguments& arguments) {
  if (const Mesh* mesh = std::get_if<Mesh>(&shape)) return makeField(*mesh, grid, arguments);
  return std::move(std::get<Field>(shape));
}

/// Does the same, and makes a narrow band dense.
Field denseOf(MeshOrField& shape, const Grid& grid, const RenderArguments& arguments) {
  Field field = fieldOf(shape, grid, arguments);
  return field.narrow ? toDense(field, arguments.machine) : std::move(field);
}

bool isBand(const MeshOrField& shape) {
  const Field* field = std::get_if<Field>(&shape);
  return field && field->narrow;
}

/// Draws a narrow band in the colours of its difference from another field, or in those of --as.
Picture drawBand(Field& band, const MeshOrField& second, const RenderArguments& arguments) {
  const FieldArray array = chooseArray(arguments.input, arguments.as, band);
  return draw(band, array, arguments, "", arguments.as.empty() ? std::get_if<Field>(&second) : nullptr);
}

/// Draws a shape in the colours of its difference from another one, or in those of --as.
Picture drawDense(MeshOrField& first, MeshOrField& second, const RenderArguments& arguments) {
  const Grid grid = gridOfBoth(first, second, arguments.grid);
  Field field = denseOf(first, grid, arguments);
  if (!arguments.as.empty()) return draw(field, chooseArray(arguments.input, arguments.as, field), arguments);
  const Field other = denseOf(second, grid, arguments);
  return draw(field, FieldArray::Distance, arguments, "", &other);
}

/// Draws the first of two shapes. Large level sets stay narrow bands, if the second shape is not a mesh.
void renderOneOfTwo(RenderArguments& arguments) {
  if (!arguments.slice.empty())
    throw Error(ErrorCode::Usage,
                "a map of a slice shows one shape; show two on a plane with --slice-plane, or compare their "
                "fields by 'raymap compare'");
  MeshOrField first = load(arguments.input, arguments), second = load(arguments.other, arguments);
  const bool isMeshNeeded = std::holds_alternative<Mesh>(second) && arguments.as.empty();
  writePng(arguments.picture, isBand(first) && !isMeshNeeded
                                  ? drawBand(std::get<Field>(first), second, arguments)
                                  : drawDense(first, second, arguments));
  printWritten(arguments.picture);
}

/// Returns the array of a page's first shape in whose colours it begins.
FieldArray arrayOf(Field& field, const RenderArguments& arguments) {
  const FieldArray array = chooseArray(arguments.input, arguments.as, field);
  if (!field.narrow && field.distance.empty())
    throw Error(ErrorCode::Usage, arguments.input.string() +
                                      ": it has no distances, and a page shows a surface; " +
                                      "draw a slice of it as a .png, with --slice x, y or z");
  return array;
}

/// Says what a page does not show of its shapes as they are.
void printShown(const Page& page, const Field& first, const Field* second, const PageOptions& options) {
  const glm::ivec3 shown = page.grid.dims, all = first.grid.dims;
  if (shown != all)
    std::printf("it shows %d x %d x %d samples of %d x %d x %d; more with --max-size\n", shown.x, shown.y,
                shown.z, all.x, all.y, all.z);
  if (first.narrow && first.arrays().size() > 1)
    std::printf("it shows the distances of the narrow band; a picture can show its other arrays\n");
  if (second && second->grid != first.grid && second->grid != page.grid)
    std::printf("it shows %s on the grid of %s\n", options.otherTitle.c_str(), options.title.c_str());
}

/// Writes a page of a shape, or of two. It has all arrays of one field, and the defects of a mesh.
void renderPage(RenderArguments& arguments) {
  if (!arguments.slice.empty())
    throw Error(ErrorCode::Usage, "a page moves its own slice; leave out --slice");
  MeshOrField first = load(arguments.input, arguments);
  std::optional<MeshOrField> second;
  if (!arguments.other.empty()) second = load(arguments.other, arguments);
  arguments.options.winding = arguments.options.confidence = !second && arguments.options.thickness == 0.0;
  if (const Mesh* mesh = std::get_if<Mesh>(&first)) {
    validate(*mesh);
    arguments.page.mesh = *mesh;
  }
  Grid grid = gridOfBoth(first, second ? *second : first, arguments.grid);
  if (isBand(first) || (second && isBand(*second))) grid = pageGrid(grid, arguments.page.maxSize);
  Field field = fieldOf(first, grid, arguments);
  warnOfShell(field, arguments);
  arguments.page.array = arrayOf(field, arguments);
  std::optional<Field> other;
  if (second) other = fieldOf(*second, grid, arguments);
  arguments.page.other = other ? &*other : nullptr;
  arguments.page.title = briefName(arguments.input);
  arguments.page.otherTitle = briefName(arguments.other);
  testBeforeFirstUse(arguments.machine.device);
  ProgressLine line;
  const MachineOptions machine = withProgress(arguments.machine, line);
  const Page page = writePage(arguments.picture, field, arguments.view, arguments.page, machine);
  line.clear();
  printWritten(arguments.picture);
  printShown(page, field, arguments.page.other, arguments.page);
}

void renderOne(RenderArguments& arguments) {
  if (isPage(arguments)) return renderPage(arguments);
  if (!arguments.other.empty()) return renderOneOfTwo(arguments);
  Field field =
      loadOrMakeField(arguments.input, arguments, arguments.format.input, arguments.format.grid, {});
  warnOfShell(field, arguments);
  writePng(arguments.picture, draw(field, chooseArray(arguments.input, arguments.as, field), arguments));
  printWritten(arguments.picture);
}

/// Returns the formats that the output may have. A pipe gets a picture, unless --format says
/// otherwise.
std::vector<std::string> kindsOf(const RenderArguments& arguments) {
  const bool isSequence = !arguments.frames.frames.empty();
  const std::string& format = arguments.format.given;
  if (!arguments.picture.has_extension() && canonical(format) != "html" && canonical(format) != ".html")
    return {".png"};
  return {".png", isSequence ? ".mp4" : ".html"};
}

void run(RenderArguments& arguments) {
  finishOptions(arguments);
  const bool isSequence = !arguments.frames.frames.empty();
  const std::vector<Output> outputs{{"--output", arguments.picture, kindsOf(arguments)}};
  const bool isTwo = !arguments.other.empty();
  if (isTwo && isSequence) throw Error(ErrorCode::Usage, "--frames draws one shape; leave the other out");
  if (isTwo && (arguments.units.height || !arguments.units.fit.empty()))
    throw Error(ErrorCode::Usage, "--height and --fit scale one shape; leave the other out, or use --scale");
  std::vector<Input> inputs{{arguments.input, meshAndFieldExtensions()}};
  if (isTwo) inputs.push_back({arguments.other, meshAndFieldExtensions()});
  prepareFiles(arguments.format, inputs, outputs);
  arguments.units.upright = arguments.camera.up;
  setView(arguments.camera, isZUp(arguments.input, arguments.format.input), arguments.view);
  if (isSequence)
    renderFrames(arguments);
  else
    renderOne(arguments);
}

}  // namespace

void addRender(Program& program) {
  Command& command = program.addCommand("render", "Draw a field, or a mesh through its field", kRenderFooter);
  auto& arguments = command.runs<RenderArguments>(run);
  addOperand(command, "MESH|FIELD", &arguments.input, "Mesh or field to read");
  addOperand(command, "MESH|FIELD", &arguments.other, "Another one to compare with").isRequired = false;
  addOutput(command, arguments.picture,
            "Picture to write: .png; or a page: .html; of --frames, also a movie: .mp4")
      .isRequired = true;
  addOptions(command, {{"--format", &arguments.format.given},
                       {"--grid", &arguments.format.grid},
                       {"--overwrite", &arguments.format.mayOverwrite}});
  addFrameOptions(command, arguments.frames);
  addUnitOptions(command, arguments.units);
  addGridOptions(command, arguments);
  addOptions(command, {{"--thickness", &arguments.options.thickness}});
  addViewOptions(command, arguments.camera);
  addSceneOptions(command, arguments.camera, arguments.view);
  addOptions(command, {{"--frame", &arguments.camera.frame},
                       {"--cut", &arguments.view.cut},
                       {"--index", &arguments.index},
                       {"--slice", &arguments.slice},
                       {"--as", &arguments.as},
                       {"--max-size", &arguments.page.maxSize}});
  addMachineOptions(command, arguments.machine);
}

}  // namespace raymap
