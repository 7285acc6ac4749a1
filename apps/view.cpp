#include <raymap/raymap.h>

#include <cmath>
#include <cstdio>
#include <sstream>

#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "movie.h"
#include "report.h"
#include "terminal.h"
#include "text.h"
#include "view_options.h"
#include "warnings.h"
#ifdef RAYMAP_HAS_VIEW
#include "view/viewer.h"
#endif

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kViewFooter =
    R"(Left drag turns, right drag moves, the wheel zooms, H shows all keys. When the window is closed, the command
that draws its last view is printed.

Examples:
  raymap view globe.ply
  raymap view man.glb --resolution 96 --clip walk
  raymap view scan.ply fixed.stl                     (B changes between the two)
  raymap view globe.vdb --cut-plane 0,0,1,0 --slice-plane 1,0,0,0)";

struct WindowArguments : FieldArguments {
  fs::path input, other;
  std::string clip, as, gridName;
  ViewArguments camera;
  RenderOptions view;
};

#ifdef RAYMAP_HAS_VIEW

/// Reads what the window shows. `grid` names that of a field.
view::Content load(const fs::path& path, const std::string& clip, const std::string& grid) {
  view::Content content;
  if (grid.empty() && hasExtension(path, {".gltf", ".glb"})) {
    const WaitingLine line("reading " + displayName(path.filename()));
    std::vector<Warning> warnings;
    const ReadOptions options{.warn = [&](const Warning& warning) { warnings.push_back(warning); }};
    AnimatedMesh mesh =
        clip.empty() ? readAnimatedMesh(path, size_t{0}, options) : readAnimatedMesh(path, clip, options);
    if (mesh.seconds() > 0.0) {
      for (const Warning& warning : warnings) warn(warning);
      content = view::contentOf(std::move(mesh));
    }
  }
  if (content.bounds.isEmpty()) {  // Nothing in it moves.
    std::variant<Mesh, Field> read = loadMeshOrField(path, "", grid);
    content = std::visit([](auto& each) { return view::contentOf(std::move(each)); }, read);
  }
  content.title = displayName(path.filename());
  return content;
}

std::string numbers(std::initializer_list<double> values, int digits = 9) {
  std::ostringstream text;
  text.precision(digits);
  for (const double value : values) text << (text.tellp() > 0 ? "," : "") << value;
  return text.str();
}

std::string numbers(const glm::dvec3& v) {
  return numbers({v.x, v.y, v.z});
}

std::string numbers(const Plane& plane) {
  return numbers({plane.normal.x, plane.normal.y, plane.normal.z, plane.offset});
}

/// Returns the options of a field that are not the defaults.
std::string fieldWords(const view::FieldSettings& field) {
  const FieldOptions& options = field.options;
  std::string words = " --resolution " + std::to_string(field.resolution);
  const FieldOptions usual;
  const auto add = [&](const char* option, const auto& value, const auto& fallback, const std::string& text) {
    if (value != fallback) words += std::string(" ") + option + (text.empty() ? "" : " ") + text;
  };
  const auto named = [](auto value) { return std::string(name(value)); };
  add("--distance", options.distance, usual.distance, named(options.distance));
  add("--sign", options.sign, usual.sign, named(options.sign));
  add("--orientation", options.orientation, usual.orientation, named(options.orientation));
  add("--sampling", options.sampling, usual.sampling, named(options.sampling));
  add("--passes", options.passes, usual.passes, std::to_string(options.passes));
  add("--threshold", options.threshold, usual.threshold, numbers({options.threshold}));
  add("--band", options.band, usual.band, numbers({options.band}));
  add("--thickness", options.thickness, usual.thickness, numbers({options.thickness}));
  add("--close-holes", options.closeHoles, false, "");
  add("--invert", options.invert, false, "");
  return words;
}

/// Returns the words that say in which colours a shape is drawn; `isOneOfTwo`: on the grid of two.
std::string colourWords(const view::ViewState& state, bool isOneOfTwo) {
  if (isOneOfTwo && state.isDifferenceShown)
    return state.view.range > 0.0 ? " --range " + numbers({state.view.range}) : "";
  const bool isUsual = !isOneOfTwo && state.view.array == FieldArray::Distance;
  return isUsual ? "" : " --as " + std::string(name(state.view.array));
}

/// Returns the command that draws the view. `other` is the second shape, empty if there is none.
std::string commandFor(const fs::path& path, const fs::path& other, const view::ViewState& state) {
  const RenderOptions& view = state.view;
  const bool isFrame = state.box.has_value(), isOneOfTwo = !other.empty() && !isFrame;
  const auto isField = [](const fs::path& each) { return hasExtension(each, fieldExtensions()); };
  std::string command = "raymap render " + quoted(path.string()) +
                        (isOneOfTwo ? " " + quoted(other.string()) : "") +
                        (isFrame ? " -o view.%d.png" : " -o view.png") + " --size " +
                        std::to_string(view.width) + " " + std::to_string(view.height);
  // Frames are a thousandth of a second long.
  if (isFrame) command += " --fps 1000 --frames " + std::to_string(std::lround(1000.0 * state.seconds));
  if (isFrame && !state.clip.empty()) command += " --clip " + quoted(state.clip);
  if (!isField(path) || (isOneOfTwo && !isField(other))) command += fieldWords(state.field);
  // With all digits it is the same grid.
  if (const std::optional<Box>& box = state.box)
    command +=
        " --bounds " + numbers({box->min.x, box->min.y, box->min.z, box->max.x, box->max.y, box->max.z}, 17);
  command += " --up " + numbers(view.up) + " --direction " + numbers(view.direction);
  if (view.eye) command += " --eye " + numbers(*view.eye);
  if (view.frame) command += " --frame " + numbers(view.frame->min) + "," + numbers(view.frame->max);
  if (view.iso != 0.0) command += " --iso " + numbers({view.iso});
  if (view.shell != 0.0) command += " --shell " + numbers({view.shell});
  if (view.cutPlane) command += " --cut-plane " + numbers(*view.cutPlane);
  if (view.slice) command += " --slice-plane " + numbers(*view.slice);
  return command + colourWords(state, isOneOfTwo);
}

void setPlane(const std::optional<Plane>& plane, view::MovingPlane& moving) {
  moving.isOn = plane.has_value();
  if (!plane) return;
  const double length = glm::length(plane->normal);
  moving.normal = plane->normal / length;
  moving.offset = plane->offset / length;
}

void setState(const RenderOptions& options, view::ViewState& state) {
  state.view = options;
  setPlane(options.cutPlane, state.cut);
  setPlane(options.slice, state.slice);
}

/// Takes the camera, the planes and the surface of a command such as `commandFor` returns.
void applyCommand(const std::string& text, view::ViewState& state) {
  Command command;
  ViewArguments camera;
  RenderOptions options;
  addViewOptions(command, camera);
  addSceneOptions(command, camera, options);
  std::string as;
  addOptions(command, {{"--as", &as}});
  Parsed parsed;
  parse(command, wordsOf(text), parsed);
  if (!parsed.mistake.empty())
    throw Error(ErrorCode::Usage, "the clipboard holds no view: " + parsed.mistake);
  if (camera.eye.empty() || camera.direction.empty())
    throw Error(ErrorCode::Usage, "the clipboard holds no view: a command with --eye and --direction is one");
  setView(camera, false, options);
  if (!as.empty()) {
    options.array = fromName<FieldArray>(as);
    state.isDifferenceShown = false;
  }
  setState(options, state);
}

/// Returns the first name "view_0001.png", "view_0002.png", ... that no file has.
fs::path freeName(const std::string& extension) {
  for (int number = 1;; ++number) {
    char name[32];
    std::snprintf(name, sizeof name, "view_%04d", number);
    if (fs::path path = name + extension; !fs::exists(path)) return path;
  }
}

void open(WindowArguments& arguments) {
  view::ViewerOptions options;
  options.input = arguments.input;
  options.other = arguments.other;
  options.machine = arguments.machine;
  options.size = {arguments.camera.size[0], arguments.camera.size[1]};
  constexpr int kResolution = 128;
  options.state.field = {.resolution = arguments.grid.resolution.value_or(kResolution),
                         .options = arguments.options};
  options.state.clip = arguments.clip;
  setState(arguments.view, options.state);
  // Files that are dropped on the window have other grids.
  const auto gridOf = [&arguments](const fs::path& path) {
    return path == arguments.input || path == arguments.other ? arguments.gridName : "";
  };
  options.load = [gridOf](const fs::path& path, const std::string& clip) {
    return load(path, clip, gridOf(path));
  };
  options.command = [&arguments, gridOf](const fs::path& path, const fs::path& other,
                                         const view::ViewState& state) {
    const auto add = [](const char* option, const std::string& value) {
      return value.empty() ? "" : std::string(" ") + option + " " + quoted(value);
    };
    return commandFor(path, other, state) + add("--grid", gridOf(path)) +
           add("--offsets", arguments.offsets.string());
  };
  options.apply = applyCommand;
  options.write = [](const Picture& picture, const std::string& command) {
    const fs::path path = freeName(".png");
    writePng(path, picture);
    printWritten(path);
    std::printf("%s\n", command.c_str());
    std::fflush(stdout);
    return path.string();
  };
  options.record = [](int width, int height, double fps) -> std::function<void(const Picture*)> {
    const fs::path path = freeName(".mp4");
    const auto movie = std::make_shared<Movie>(path, width, height, fps);
    return [movie, path](const Picture* picture) {
      if (picture) return movie->add(*picture);
      movie->finish();
      printWritten(path);
      std::fflush(stdout);
    };
  };
  const std::string command = runViewer(std::move(options));
  std::printf("%s\n", command.c_str());
}

#else

void open(WindowArguments&) {
  throw Error(ErrorCode::Unsupported,
              "this raymap was built without a window; build it where libglfw3-dev and libimgui-dev are "
              "installed, or draw pictures and pages with raymap render");
}

#endif

void run(WindowArguments& arguments) {
  finishFieldArguments(arguments);
  StreamFormat format;
  std::vector<Input> inputs{{arguments.input, meshAndFieldExtensions()}};
  if (!arguments.other.empty()) inputs.push_back({arguments.other, meshAndFieldExtensions()});
  prepareFiles(format, inputs, {});
  if (!arguments.as.empty()) arguments.view.array = fromName<FieldArray>(arguments.as);
  if (arguments.view.array == FieldArray::Triangle)
    throw Error(ErrorCode::Usage,
                "a window has no colours of triangles; draw a slice of them by 'raymap render'");
  setView(arguments.camera, isZUp(arguments.input, ""), arguments.view);
  open(arguments);
}

}  // namespace

void addView(Program& program) {
  Command& command =
      program.addCommand("view", "Show a mesh and its field, or a field, in a window", kViewFooter);
  auto& arguments = command.runs<WindowArguments>(run);
  arguments.camera.size = {1280, 800};
  addOperand(command, "MESH|FIELD", &arguments.input, "Mesh or field to show");
  addOperand(command, "MESH|FIELD", &arguments.other, "Another one to compare with").isRequired = false;
  addOptions(command, {{"--grid", &arguments.gridName},
                       {"--clip", &arguments.clip},
                       {"--resolution", &arguments.grid.resolution}});
  addMethodOptions(command, arguments);
  addViewOptions(command, arguments.camera);
  addSceneOptions(command, arguments.camera, arguments.view);
  addOptions(command, {{"--as", &arguments.as}});
  addMachineOptions(command, arguments.machine);
}

}  // namespace raymap
