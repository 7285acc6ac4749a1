#include <raymap/json.h>
#include <raymap/named_options.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <string>
#include <utility>

#include "batch.h"
#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "first_use.h"
#include "report.h"
#include "sequence.h"
#include "terminal.h"
#include "view_options.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kGenerateFooter = R"(Examples:
  raymap generate bunny.obj -o bunny.vdb
      128 samples along the longest side, exact distance, correct signs even for a broken mesh
  raymap generate bunny.obj -o bunny.nrrd --voxel-size 0.5 --bounds 0 0 0 100 80 60
      samples half a unit apart in a given box
  raymap generate car.glb -o car.vdb --resolution 256 --band 3
      distances clamped three samples from the surface, for level sets
  raymap generate scan.ply -o scan.npz --winding w.npy --confidence c.npy --stats scan.json
      also the winding number, the confidence in the sign and figures of the mesh
  raymap generate man.glb --frames 0:59 --fps 24 -o man.%04d.vdb
      a field for each frame of an animation, all on one grid
  raymap generate *.stl -o fields/ --format nrrd
      a field of each file by itself; then a table)";

struct GenerateArguments : FieldArguments {
  StreamFormat format;
  FrameArguments frames;
  std::vector<fs::path> meshes;
  fs::path mesh, field, triangleIds, winding, confidence, stats, report, reportPicture;
  std::string gridName;
  bool half = false, fullInside = false;
};

/// Results of one run, for the summary and the statistics.
struct Report {
  Diagnostics found;
  Grid grid;
  Stats stats;
  std::vector<Stats::Stage> before, after;  ///< Steps of the command before and after the stages.
  double elapsedMilliseconds = 0.0;
  std::vector<fs::path> written;

  /// Returns all steps, in order.
  std::vector<Stats::Stage> steps() const {
    std::vector<Stats::Stage> all = before;
    for (const auto* more : {&stats.stages, &after}) all.insert(all.end(), more->begin(), more->end());
    return all;
  }
};

/// Returns the files of each frame.
std::vector<Output> frameOutputs(GenerateArguments& arguments) {
  return {{"--output", arguments.field, fieldExtensions()},
          {"--triangle-ids", arguments.triangleIds, fieldExtensions()},
          {"--winding", arguments.winding, fieldExtensions()},
          {"--confidence", arguments.confidence, fieldExtensions()},
          {"--report", arguments.report, {".json"}},
          {"--report-picture", arguments.reportPicture, {".png"}}};
}

std::vector<Output> outputs(GenerateArguments& arguments) {
  std::vector<Output> all = frameOutputs(arguments);
  all.push_back({"--stats", arguments.stats, {".json"}});
  return all;
}

void finishOptions(GenerateArguments& arguments) {
  finishFieldArguments(arguments);
  FieldOptions& options = arguments.options;
  const bool isSigned = options.sign != SignMode::None;
  options.confidence = isSigned && !arguments.report.empty();
  if (!isSigned && !(arguments.winding.empty() && arguments.confidence.empty()))
    throw Error(ErrorCode::Usage,
                "--winding and --confidence need a sign; leave out --sign none and --thickness");
  if (options.distance == DistanceMode::Raster && !arguments.triangleIds.empty())
    throw Error(ErrorCode::Usage, "--triangle-ids needs another distance; leave out --distance raster");
}

/// Returns the files of the field, and how they are written.
FieldFiles filesOf(const GenerateArguments& arguments, bool isEmpty) {
  return {.distance = arguments.field,
          .triangle = arguments.triangleIds,
          .winding = arguments.winding,
          .confidence = arguments.confidence,
          .format = arguments.format.output,
          .gridName = arguments.gridName,
          .half = arguments.half,
          .fullInside = arguments.fullInside && !isEmpty,
          .keepsField = !arguments.report.empty(),
          .planned = [](const FieldPlan& plan) {
            if (plan.form == FieldForm::Slabs)
              printNote("the field does not fit into memory, so it is written in slabs of " +
                        counted(size_t(plan.planes), "plane"));
          }};
}

/// Returns what the command line asks for, but arrays: they have files of their own.
Json optionsOf(const GenerateArguments& arguments) {
  Json json;
  forEachOption(arguments.asked,
                [&](const OptionName& option, const auto& member) { json[option.name] = toJson(member); });
  for (const char* array : {"triangle", "winding", "confidence"}) json.erase(array);
  json["threads"] = arguments.machine.threads;
  return json;
}

Json describe(const GenerateArguments& arguments, const Report& report) {
  return {{"raymap", version().text},
          {"mesh", arguments.mesh.string()},
          {"result", arguments.field.empty() ? Json() : Json(arguments.field.string())},
          {"frame", nullptr},
          {"steps", toJson(report.steps())},
          {"diagnostics", toJson(report.found)},
          {"grid", figuresOf(report.grid)},
          {"options", optionsOf(arguments)},
          {"stats", toJson(report.stats)},
          {"peak_memory_bytes", peakMemory()}};
}

/// Defects of the mesh, and how many signs are uncertain.
Json describeDefects(const GenerateArguments& arguments, const Mesh& mesh, const Field& field,
                     const Report& report) {
  const SelfIntersections crossings =
      mesh.triangles.empty() ? SelfIntersections{} : findSelfIntersections(mesh);
  Json json{{"raymap", version().text},
            {"mesh", arguments.mesh.string()},
            {"diagnostics", toJson(Inspection{report.found, crossings})},
            {"stats", toJson(report.stats)},
            {"guessed_share", nullptr},
            {"guessed_below", nullptr}};
  if (arguments.options.sign == SignMode::None) return json;
  constexpr float kSure = 0.5f;
  const auto guessed = std::count_if(field.confidence.begin(), field.confidence.end(),
                                     [](float confidence) { return confidence < kSure; });
  json["guessed_share"] = double(guessed) / double(field.confidence.size());
  json["guessed_below"] = kSure;
  return json;
}

void printGrid(const Grid& grid) {
  std::printf("grid: %d x %d x %d = %s, spacing %g\n", grid.dims.x, grid.dims.y, grid.dims.z,
              counted(grid.sampleCount(), "sample").c_str(), grid.spacing);
}

/// Prints where the mesh leaves the sign open, if it does anywhere.
void printSign(const GenerateArguments& arguments, const Stats& stats) {
  if (stats.doubtfulShare == 0.0) return;
  std::printf("sign: estimated at %.3g %% of the samples, which see holes or contradicting faces%s\n",
              100.0 * stats.doubtfulShare,
              arguments.confidence.empty() ? "; --confidence FILE writes how certain it is" : "");
  if (isVerbose()) std::printf("  their six rays disagree\n");
}

void print(const GenerateArguments& arguments, const Report& report) {
  if (report.found.triangles == 0) {
    std::printf("%s: no triangles, so the field is far everywhere\n", displayName(arguments.mesh).c_str());
    printGrid(report.grid);
    for (const fs::path& path : report.written) printWritten(path);
    return;
  }
  const glm::dvec3 size = report.found.bounds.size();
  std::printf("%s: %s, size %.4g x %.4g x %.4g, wrong with it: %s\n", displayName(arguments.mesh).c_str(),
              counted(report.found.triangles, "triangle").c_str(), size.x, size.y, size.z,
              describeDefects(report.found, std::nullopt).c_str());
  printGrid(report.grid);
  if (isVerbose()) std::printf("%s", describeTimes(report.steps(), report.elapsedMilliseconds).c_str());
  std::printf("field: %.1f ms on %s, peak memory %s", report.stats.milliseconds, report.stats.device.c_str(),
              sizeText(peakMemory()).c_str());
  std::printf("\n");
  printSign(arguments, report.stats);
  printOrientation(report.stats);
  if (report.stats.patchTriangles > 0)
    std::printf("closed holes: %s, area %.4g\n", counted(report.stats.patchTriangles, "triangle").c_str(),
                report.stats.patchArea);
  for (const fs::path& path : report.written) printWritten(path);
}

/// Appends the figures of --stats to those of other frames, or writes them.
void writeReports(const GenerateArguments& arguments, const Mesh& mesh, const Field& field, Report& report,
                  Json* frames) {
  if (!arguments.stats.empty() && frames != nullptr) {
    frames->push_back(describe(arguments, report));
  } else if (!arguments.stats.empty()) {
    writeJson(arguments.stats, describe(arguments, report));
    report.written.push_back(arguments.stats);
  }
  if (!arguments.report.empty()) {
    writeJson(arguments.report, describeDefects(arguments, mesh, field, report));
    report.written.push_back(arguments.report);
  }
  if (arguments.reportPicture.empty()) return;
  const RenderOptions view = defaultView(isZUp(arguments.mesh, arguments.format.input));
  writePng(arguments.reportPicture, renderDefects(mesh, view));
  report.written.push_back(arguments.reportPicture);
}

/// Throws unless a mesh without triangles is allowed and the options say where its field lies. `bounds` is
/// empty without those of other frames.
void checkEmpty(const GenerateArguments& arguments, const Box& bounds) {
  const std::string name = displayName(arguments.mesh);
  if (!arguments.options.allowEmpty)
    throw Error(ErrorCode::Input,
                name + ": the file has no triangles; --allow-empty makes a field that is far everywhere");
  if (!arguments.grid.box && bounds.isEmpty())
    throw Error(ErrorCode::Usage,
                "--allow-empty: " + name + " has no triangles, so it has no bounds; add --bounds");
  if (!arguments.reportPicture.empty())
    throw Error(ErrorCode::Usage, "--report-picture: " + name + " has no triangles to draw; leave it out");
}

bool isReported(const GenerateArguments& arguments) {
  return !arguments.stats.empty() || !arguments.report.empty() || !arguments.reportPicture.empty();
}

/// Makes a field, and writes it if it is made in slabs. Takes the mesh if no report needs it.
FileReport runGenerator(const GenerateArguments& arguments, Mesh& mesh, const Grid& grid,
                        FileGenerator& generator, const MachineOptions& machine) {
  const FieldFiles files = filesOf(arguments, mesh.triangles.empty());
  if (files.fullInside &&
      planFile(mesh, grid, arguments.options, files, machine).form != FieldForm::NarrowBand)
    throw Error(ErrorCode::Usage,
                "--full-inside needs --band and a .vdb or .nvdb, with --distance exact and --sign harmonic "
                "on the CPU, without --close-holes, --invert, --thickness, --triangle-ids, --winding and "
                "--confidence");
  return isReported(arguments) ? generator.make(mesh, grid, arguments.options, files, machine)
                               : generator.make(std::move(mesh), grid, arguments.options, files, machine);
}

/// Makes the field of a mesh on a grid about `bounds`, and writes it. `title` begins the names of stages.
/// May take the mesh.
void make(const GenerateArguments& arguments, Mesh& mesh, const std::optional<Box>& bounds,
          const std::string& title, FileGenerator& generator, Report& report, Json* frames) {
  FieldForm form{};
  const bool isEmpty = mesh.triangles.empty();
  if (isEmpty) checkEmpty(arguments, bounds.value_or(Box{}));
  {
    ProgressLine line;
    const MachineOptions machine = withProgress(arguments.machine, line, title);
    // The summary line needs no more. The files list everything.
    const bool isBrief = arguments.stats.empty() && arguments.report.empty();
    if (!isEmpty)
      timeStep(report.before, "diagnose",
               [&] { report.found = diagnose(mesh, {.brief = isBrief}, machine); });
    timeStep(report.before, "fit", [&] {
      report.grid = bounds ? fitGrid(*bounds, arguments.grid) : fitGrid(mesh, arguments.grid);
    });
    FileReport made = runGenerator(arguments, mesh, report.grid, generator, machine);
    form = made.plan.form;
    report.stats = std::move(made.stats);
  }
  if (form != FieldForm::Slabs) timeStep(report.after, "write", [&] { generator.write(); });
  for (const fs::path& path :
       {arguments.field, arguments.triangleIds, arguments.winding, arguments.confidence})
    if (!path.empty()) report.written.push_back(path);
  if (isReported(arguments))
    timeStep(report.after, "report",
             [&] { writeReports(arguments, mesh, generator.field(), report, frames); });
}

/// Appends figures to those of other meshes, if there are others.
Outcome makeOne(const GenerateArguments& arguments, Json* others = nullptr) {
  const Clock::time_point start = Clock::now();
  Report report;
  Mesh mesh;
  FileGenerator generator;
  timeStep(report.before, "load",
           [&] { mesh = loadMesh(arguments.mesh, arguments.format.input, arguments.units, true); });
  warnOfLength("--thickness", arguments.options.thickness, bounds(mesh));
  make(arguments, mesh, {}, "", generator, report, others);
  report.elapsedMilliseconds = millisecondsSince(start);
  print(arguments, report);
  return {.done = "made", .trianglesBefore = report.found.triangles, .figures = {}};
}

/// Returns the arguments with the files of one frame.
GenerateArguments argumentsOf(const GenerateArguments& arguments, const Sequence& sequence, size_t i) {
  GenerateArguments one = arguments;
  one.mesh = sequence.input(i);
  for (const Output& output : frameOutputs(one))
    if (!output.path.empty()) output.path = framePath(output.path, sequence.frame(i));
  return one;
}

/// Throws `Error(Usage)` if a frame would replace a file that is read.
void checkFrames(const GenerateArguments& arguments, const Sequence& sequence) {
  std::vector<fs::path> inputs{arguments.offsets};
  for (size_t i = 0; i < sequence.size(); ++i) inputs.push_back(sequence.input(i));
  for (size_t i = 0; i < sequence.size(); ++i) {
    GenerateArguments one = argumentsOf(arguments, sequence, i);
    if (!arguments.format.mayOverwrite) checkInputs(outputs(one), inputs);
  }
}

Mesh meshOf(Sequence& sequence, size_t i) {
  std::variant<Mesh, Field> read = sequence.read(i);
  if (Mesh* mesh = std::get_if<Mesh>(&read)) return std::move(*mesh);
  throw Error(ErrorCode::Usage, displayName(sequence.input(i)) +
                                    ": is a field, and generate takes a mesh; raymap render draws fields");
}

/// Makes a field for each frame, all on one grid. Holds one at a time.
void makeFrames(const GenerateArguments& arguments) {
  const Clock::time_point start = Clock::now();
  Sequence sequence(arguments.frames, arguments.mesh, arguments.format.input, arguments.units, true);
  checkFrames(arguments, sequence);
  const Box bounds = arguments.grid.box ? *arguments.grid.box : sequence.bounds();
  FileGenerator generator;
  Json frames = Json::array();
  for (size_t i = 0; i < sequence.size(); ++i) {
    const GenerateArguments one = argumentsOf(arguments, sequence, i);
    Report report;
    Mesh mesh;
    timeStep(report.before, "load", [&] { mesh = meshOf(sequence, i); });
    make(one, mesh, bounds, sequence.title(i), generator, report, &frames);
    if (i == 0) printGrid(report.grid);
    for (const fs::path& path : report.written) printWritten(path);
    std::fflush(stdout);
    if (!arguments.stats.empty()) frames.back()["frame"] = sequence.frame(i);
  }
  if (!arguments.stats.empty()) {
    writeJson(arguments.stats, {{"raymap", version().text}, {"frames", std::move(frames)}});
    printWritten(arguments.stats);
  }
  std::printf("%s in %.1f s, peak memory %s\n", counted(sequence.size(), "frame").c_str(),
              millisecondsSince(start) / 1000.0, sizeText(peakMemory()).c_str());
}

/// Throws `Error(Usage)` if the field's format has no place for what is asked for.
void checkFormat(const GenerateArguments& arguments) {
  const auto isOneOf = [&](const std::vector<std::string>& extensions) {
    return hasExtension(arguments.field, extensions) ||
           hasExtension(named(arguments.field, arguments.format.output), extensions);
  };
  if (!arguments.gridName.empty() && !isOneOf({".vdb", ".nvdb"}))
    throw Error(ErrorCode::Usage, "--grid-name is for a .vdb or .nvdb, and " + displayName(arguments.field) +
                                      " is none; leave it out");
  if (arguments.half && isOneOf({".nrrd", ".vti"}))
    throw Error(ErrorCode::Usage,
                "--half is for a .vdb, .nvdb, .npy or .npz, and " + displayName(arguments.field) +
                    " is none: its format has no type for numbers of 16 bits; leave it out");
}

/// Makes a field of each mesh in a folder.
void makeEach(GenerateArguments& arguments) {
  for (const Output& output : frameOutputs(arguments))
    if (output.option != "--output" && !output.path.empty())
      throw Error(ErrorCode::Usage, output.option +
                                        " names one file, and several meshes would need as many; "
                                        "leave it out, or make one field at a time");
  if (!arguments.frames.frames.empty())
    throw Error(ErrorCode::Usage,
                "--frames makes several fields of one input, and --output must say how to "
                "number them, as in " +
                    (arguments.field / "%04d.vdb").string());
  const std::vector<FileJob> jobs = prepareJobs(arguments.format, arguments.meshes, arguments.field,
                                                meshExtensions(), fieldExtensions(), arguments.stats, ".vdb");
  arguments.field = jobs.front().output;
  checkFormat(arguments);
  testBeforeFirstUse(arguments.machine.device);
  doAll(jobs, arguments.stats, [&](const FileJob& job) {
    GenerateArguments each = arguments;
    each.mesh = job.input;
    each.field = job.output;
    Json figures = Json::array();
    Outcome outcome = makeOne(each, &figures);
    if (!figures.empty()) outcome.figures = std::move(figures.back());
    return outcome;
  });
}

void run(GenerateArguments& arguments) {
  finishOptions(arguments);
  if (arguments.meshes.size() > 1 || isFolder(arguments.field)) return makeEach(arguments);
  arguments.mesh = arguments.meshes.front();
  prepareFiles(arguments.format, {{arguments.mesh, meshExtensions()}}, outputs(arguments));
  checkFormat(arguments);
  if (!arguments.format.mayOverwrite) checkInputs(outputs(arguments), {arguments.offsets});
  testBeforeFirstUse(arguments.machine.device);
  if (arguments.frames.frames.empty())
    makeOne(arguments);
  else
    makeFrames(arguments);
}

void addOutputOptions(Command& command, GenerateArguments& arguments) {
  Argument& output = addOutput(command, arguments.field, "Field to write", fieldExtensions());
  output.isRequired = true;
  output.help += "; or a folder, for a field of each input, with its name";
  addOptions(command, {{"--format", &arguments.format.given},
                       {"--triangle-ids", &arguments.triangleIds},
                       {"--winding", &arguments.winding},
                       {"--confidence", &arguments.confidence}});
  addFigureOptions(command, arguments.stats);
  addOptions(command, {{"--report", &arguments.report},
                       {"--report-picture", &arguments.reportPicture},
                       {"--grid-name", &arguments.gridName},
                       {"--half", &arguments.half},
                       {"--overwrite", &arguments.format.mayOverwrite}});
}

}  // namespace

void addGenerate(Program& program) {
  Command& command =
      program.addCommand("generate", "Make a signed distance field from a mesh", kGenerateFooter);
  auto& arguments = command.runs<GenerateArguments>(run);
  addOperand(command, "MESH...", &arguments.meshes,
             "Mesh to read: OBJ, PLY, STL, OFF, glTF, GLB, 3MF, FBX or DAE. Several need a folder as output");
  addOutputOptions(command, arguments);
  addFrameOptions(command, arguments.frames);
  addUnitOptions(command, arguments.units);
  addFieldOptions(command, arguments);
  addOptions(command,
             {{"--full-inside", &arguments.fullInside}, {"--allow-empty", &arguments.options.allowEmpty}});
}

}  // namespace raymap
