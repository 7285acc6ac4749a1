#include <raymap/json.h>
#include <raymap/named_options.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <limits>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>

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
      a field for each frame of an animation, all on one grid)";

struct GenerateArguments : FieldArguments {
  StreamFormat format;
  FrameArguments frames;
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
  options.triangle = !arguments.triangleIds.empty();
  options.winding = !arguments.winding.empty();
  const bool isSigned = options.sign != SignMode::None;
  options.confidence = !arguments.confidence.empty() || (isSigned && !arguments.report.empty());
  if (!isSigned && (options.winding || options.confidence))
    throw Error(ErrorCode::Usage,
                "--winding and --confidence need a sign; leave out --sign none and --thickness");
  if (options.distance == DistanceMode::Raster && options.triangle)
    throw Error(ErrorCode::Usage, "--triangle-ids needs another distance; leave out --distance raster");
}

bool isWritten(const GenerateArguments& arguments, const fs::path& path,
               const std::vector<std::string>& extensions) {
  return std::ranges::find(extensions, arguments.format.output) != extensions.end() ||
         hasExtension(path, extensions);
}

void writeAll(const GenerateArguments& arguments, const Field& field, Report& report) {
  const auto write = [&](const fs::path& path, FieldArray array) {
    if (path.empty()) return;
    writeField(path, field,
               {.array = array,
                .format = arguments.format.output,
                .gridName = array == FieldArray::Distance ? std::string_view(arguments.gridName) : "",
                .half = arguments.half && isWritten(arguments, path, {".npy", ".npz", ".vdb", ".nvdb"})});
    report.written.push_back(path);
  };
  write(arguments.field, FieldArray::Distance);
  write(arguments.triangleIds, FieldArray::Triangle);
  write(arguments.winding, FieldArray::Winding);
  write(arguments.confidence, FieldArray::Confidence);
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
  const Grid& grid = report.grid;
  return {{"raymap", version().text},
          {"mesh", arguments.mesh.string()},
          {"steps", toJson(report.steps())},
          {"diagnostics", toJson(report.found)},
          {"grid",
           {{"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
            {"origin", toJson(grid.origin)},
            {"spacing", grid.spacing},
            {"samples", grid.sampleCount()}}},
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
            {"stats", toJson(report.stats)}};
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

/// Returns whether the field is what a `Surface` gives at the samples.
bool isOfSurface(const GenerateArguments& arguments) {
  const FieldOptions& o = arguments.options;
  return o.distance == DistanceMode::Exact && o.sign == SignMode::Harmonic && !o.closeHoles && !o.invert &&
         o.thickness == 0.0 && !arguments.machine.device.starts_with("vulkan");
}

/// Returns whether the field has the distance alone.
bool isAlone(const GenerateArguments& arguments) {
  const FieldOptions& o = arguments.options;
  return !o.triangle && !o.winding && !o.confidence;
}

/// Returns whether a field is made near the surface alone, which takes less time and memory for so many
/// samples. Only a .vdb and a .nvdb have no place for the others.
bool isNarrowBand(const GenerateArguments& arguments, const Grid& grid) {
  constexpr size_t kManySamples = size_t{1} << 24;
  const bool isPossible = arguments.options.band > 0.0 &&
                          isWritten(arguments, arguments.field, {".vdb", ".nvdb"}) &&
                          isOfSurface(arguments) && isAlone(arguments);
  if (arguments.fullInside && !isPossible)
    throw Error(ErrorCode::Usage,
                "--full-inside needs --band and a .vdb or .nvdb, with --distance exact and --sign harmonic "
                "on the CPU, without --close-holes, --invert, --thickness, --triangle-ids, --winding and "
                "--confidence");
  return isPossible && (arguments.fullInside || grid.sampleCount() > kManySamples);
}

bool isReported(const GenerateArguments& arguments) {
  return !arguments.stats.empty() || !arguments.report.empty() || !arguments.reportPicture.empty();
}

/// Makes and writes a field near the surface alone. Takes the mesh if no report needs it.
void makeBand(const GenerateArguments& arguments, Mesh& mesh, Report& report, const MachineOptions& machine) {
  const FieldOptions& options = arguments.options;
  const SurfaceOptions asked{.orientation = options.orientation,
                             .threshold = options.threshold,
                             .compact = isCompactBetter(report.grid, mesh.triangles.size())};
  const Surface surface = isReported(arguments) ? Surface(MeshView(mesh), asked, machine)
                                                : Surface(std::move(mesh), asked, machine);
  report.stats = surface.stats();
  SparseField band;
  timeStep(report.stats.stages, "narrow_band", [&] {
    const double inside = arguments.fullInside ? std::numeric_limits<double>::infinity() : options.band;
    band = surface.generateBand(report.grid, {.outside = options.band, .inside = inside}, machine);
  });
  report.stats.milliseconds += report.stats.stages.back().milliseconds;
  report.stats.bytes = std::max(report.stats.bytes, surface.bytes() + band.bytes());
  timeStep(report.after, "write", [&] {
    writeBand(arguments.field, band,
              {.format = arguments.format.output, .gridName = arguments.gridName, .half = arguments.half});
  });
  report.written.push_back(arguments.field);
}

/// Returns the most bytes that are held while a slab of so many planes is made, and the one before written.
size_t slabBytes(const Surface& surface, const Grid& grid, int planes, const RegionOptions& options,
                 const MachineOptions& machine) {
  return surface.regionBytes({grid.dims.x, grid.dims.y, 2 * planes}, options, machine);
}

/// Returns how many planes of a grid are made at a time: few enough for the limit of memory, and no more than
/// the speed gains from.
int slabThickness(const Surface& surface, const Grid& grid, const RegionOptions& options,
                  const MachineOptions& machine) {
  constexpr size_t kManySamples = size_t{1} << 27;
  constexpr int kBest = 32;  // Regions are made in blocks of so many planes.
  const size_t plane = size_t(grid.dims.x) * size_t(grid.dims.y);
  auto planes = int(std::max<size_t>(kManySamples / plane, 1));
  if (planes > kBest) planes -= planes % kBest;
  planes = std::min(planes, grid.dims.z);
  // Leaves a quarter: more may be held when a later slab is checked.
  const size_t left = memoryLeft() / 4 * 3, most = surface.bytes() + left;
  const auto fits = [&] { return slabBytes(surface, grid, planes, options, machine) <= most; };
  while (planes > 1 && !fits()) planes = planes > kBest ? (planes - 1) / kBest * kBest : planes / 2;
  return planes;
}

/// Returns a text that names all that the samples of a field of a surface depend on besides their positions.
std::string keyOf(const Mesh& mesh, const GenerateArguments& arguments) {
  const auto hash = [](const auto& array) {
    const auto bytes = std::as_bytes(std::span(array));
    return std::to_string(
        std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  };
  const Json key = {version().text,
                    hash(mesh.vertices),
                    hash(mesh.triangles),
                    toJson(mesh.origin),
                    name(arguments.options.orientation),
                    arguments.options.threshold,
                    arguments.options.band};
  return key.dump();
}

/// Returns the files of a field that is written slab by slab, as `writeAll` writes them of a whole one.
std::vector<SlabFile> slabFiles(const GenerateArguments& arguments) {
  std::vector<SlabFile> files{{.path = arguments.field}};
  const bool isVti = hasExtension(arguments.field, {".vti"}) ||
                     (arguments.format.output == ".vti" && !hasExtension(arguments.field, fieldExtensions()));
  const auto add = [&](const fs::path& path, FieldArray array) {
    if (path.empty()) return;
    if (isVti) files.front().arrays.push_back(array);
    files.push_back({.path = path, .arrays = {array}});
  };
  add(arguments.triangleIds, FieldArray::Triangle);
  add(arguments.winding, FieldArray::Winding);
  add(arguments.confidence, FieldArray::Confidence);
  return files;
}

/// Makes a field that does not fit into memory, and writes it slab by slab.
void makeSlabs(const GenerateArguments& arguments, const Mesh& mesh, Report& report,
               const MachineOptions& machine) {
  const FieldOptions& options = arguments.options;
  const Surface surface(mesh, {.orientation = options.orientation, .threshold = options.threshold}, machine);
  report.stats = surface.stats();
  const Grid& grid = report.grid;
  const RegionOptions region{.band = options.band,
                             .triangle = options.triangle,
                             .winding = options.winding,
                             .confidence = options.confidence};
  const int planes = slabThickness(surface, grid, region, machine);
  bool isFirst = true;
  const auto slab = [&](int begin, int end) {
    if (isFirst)
      printNote("the field does not fit into memory, so it is written in slabs of " +
                counted(size_t(planes), "plane"));
    MachineOptions one = machine;
    if (!std::exchange(isFirst, false)) one.warn = {};  // Once is enough.
    one.progress = [&](std::string_view stage, double done) {
      return machine.progress(stage, (double(begin) + done * double(end - begin)) / double(grid.dims.z));
    };
    return surface.generateRegion(grid, {{0, 0, begin}, {grid.dims.x, grid.dims.y, end - begin}}, region,
                                  one);
  };
  const Field about{
      .grid = grid, .clampDistance = options.band * grid.spacing, .surfaceBounds = bounds(surface.mesh())};
  const SlabOptions slabs{.planes = planes,
                          .format = arguments.format.output,
                          .key = keyOf(mesh, arguments),
                          .warn = machine.warn};
  const std::vector<SlabFile> files = slabFiles(arguments);
  timeStep(report.stats.stages, "slabs", [&] { writeFieldInSlabs(files, about, slab, slabs); });
  report.stats.milliseconds += report.stats.stages.back().milliseconds;
  report.stats.bytes = std::max(report.stats.bytes, slabBytes(surface, grid, planes, region, machine));
  for (const SlabFile& file : files) report.written.push_back(file.path);
}

/// Makes a field of all samples, or writes it slab by slab if it does not fit into memory.
void makeDense(const GenerateArguments& arguments, const Mesh& mesh, Generator& generator, Field& field,
               Report& report, const MachineOptions& machine) {
  const bool mayBeSlabs = !arguments.half && !mesh.triangles.empty() && isOfSurface(arguments) &&
                          arguments.report.empty() &&
                          std::ranges::all_of(slabFiles(arguments), [&](const SlabFile& file) {
                            return isWritten(arguments, file.path, slabExtensions());
                          });
  if (!mayBeSlabs || report.grid.sampleCount() < kNoTriangle) {
    try {
      report.stats = generator.generate(mesh, report.grid, arguments.options, field, machine);
      return;
    } catch (const Error& error) {
      if (!mayBeSlabs || error.code() != ErrorCode::Memory) throw;
    }
  }
  generator = {};  // Its memory goes to the slabs.
  makeSlabs(arguments, mesh, report, machine);
}

/// Makes the field of a mesh on a grid about `bounds`, and writes it. `title` begins the names of stages.
/// May take the mesh.
void make(const GenerateArguments& arguments, Mesh& mesh, const std::optional<Box>& bounds,
          const std::string& title, Generator& generator, Field& field, Report& report, Json* frames) {
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
    if (!isEmpty && isNarrowBand(arguments, report.grid))
      makeBand(arguments, mesh, report, machine);
    else
      makeDense(arguments, mesh, generator, field, report, machine);
  }
  if (report.written.empty()) timeStep(report.after, "write", [&] { writeAll(arguments, field, report); });
  if (isReported(arguments))
    timeStep(report.after, "report", [&] { writeReports(arguments, mesh, field, report, frames); });
}

void makeOne(const GenerateArguments& arguments) {
  const Clock::time_point start = Clock::now();
  Report report;
  Mesh mesh;
  Generator generator;
  Field field;
  timeStep(report.before, "load",
           [&] { mesh = loadMesh(arguments.mesh, arguments.format.input, arguments.units, true); });
  warnOfLength("--thickness", arguments.options.thickness, bounds(mesh));
  make(arguments, mesh, {}, "", generator, field, report, nullptr);
  report.elapsedMilliseconds = millisecondsSince(start);
  print(arguments, report);
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
  Generator generator;
  Field field;
  Json frames = Json::array();
  for (size_t i = 0; i < sequence.size(); ++i) {
    const GenerateArguments one = argumentsOf(arguments, sequence, i);
    Report report;
    Mesh mesh;
    timeStep(report.before, "load", [&] { mesh = meshOf(sequence, i); });
    make(one, mesh, bounds, sequence.title(i), generator, field, report, &frames);
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

void run(GenerateArguments& arguments) {
  finishOptions(arguments);
  prepareFiles(arguments.format, {{arguments.mesh, meshExtensions()}}, outputs(arguments));
  if (!arguments.gridName.empty() && !isWritten(arguments, arguments.field, {".vdb", ".nvdb"}))
    throw Error(ErrorCode::Usage, "--grid-name is for a .vdb or .nvdb, and " + displayName(arguments.field) +
                                      " is none; leave it out");
  if (arguments.half && isWritten(arguments, arguments.field, {".nrrd", ".vti"}))
    throw Error(ErrorCode::Usage,
                "--half is for a .vdb, .nvdb, .npy or .npz, and " + displayName(arguments.field) +
                    " is none: its format has no type for numbers of 16 bits; leave it out");
  if (!arguments.format.mayOverwrite) checkInputs(outputs(arguments), {arguments.offsets});
  testBeforeFirstUse(arguments.machine.device);
  if (arguments.frames.frames.empty())
    makeOne(arguments);
  else
    makeFrames(arguments);
}

void addOutputOptions(Command& command, GenerateArguments& arguments) {
  addOutput(command, arguments.field, "Field to write", fieldExtensions()).isRequired = true;
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
  addOperand(command, "MESH", &arguments.mesh,
             "Mesh to read: OBJ, PLY, STL, OFF, glTF, GLB, 3MF, FBX or DAE");
  addOutputOptions(command, arguments);
  addFrameOptions(command, arguments.frames);
  addUnitOptions(command, arguments.units);
  addFieldOptions(command, arguments);
  addOptions(command,
             {{"--full-inside", &arguments.fullInside}, {"--allow-empty", &arguments.options.allowEmpty}});
}

}  // namespace raymap
