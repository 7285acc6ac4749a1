#include <raymap/raymap.h>

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <string>
#include <string_view>

#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "first_use.h"
#include "options.h"
#include "report.h"
#include "terminal.h"
#include "view_options.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(Examples:
  raymap generate bunny.obj -o bunny.vdb
      128 samples along the longest side, exact distance, correct signs even for a broken mesh
  raymap generate bunny.obj -o bunny.nrrd --voxel-size 0.5 --bounds 0 0 0 100 80 60
      samples half a unit apart in a given box
  raymap generate car.glb -o car.vdb --resolution 256 --band 3
      distances clamped three samples from the surface, for level sets
  raymap generate scan.ply -o scan.npz --winding w.npy --confidence c.npy --stats scan.json
      also the winding number, the confidence in the sign and figures of the mesh)";

struct Arguments : FieldArguments {
  StreamFormat format;
  fs::path mesh, field, triangleIds, winding, confidence, stats, report, reportPicture;
  bool mayOverwrite = false;
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

std::vector<Output> outputs(Arguments& arguments) {
  return {{"--output", arguments.field, fieldExtensions()},
          {"--triangle-ids", arguments.triangleIds, fieldExtensions()},
          {"--winding", arguments.winding, fieldExtensions()},
          {"--confidence", arguments.confidence, fieldExtensions()},
          {"--stats", arguments.stats, {".json"}},
          {"--report", arguments.report, {".json"}},
          {"--report-picture", arguments.reportPicture, {".png"}}};
}

void finishOptions(Arguments& arguments) {
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

void writeAll(const Arguments& arguments, const Field& field, Report& report) {
  const auto write = [&](const fs::path& path, FieldArray array) {
    if (path.empty()) return;
    writeField(path, field, {.array = array, .format = arguments.format.output});
    report.written.push_back(path);
  };
  write(arguments.field, FieldArray::Distance);
  write(arguments.triangleIds, FieldArray::Triangle);
  write(arguments.winding, FieldArray::Winding);
  write(arguments.confidence, FieldArray::Confidence);
}

Json listOf(const std::vector<glm::ivec3>& offsets) {
  Json json = Json::array();
  for (const glm::ivec3& offset : offsets) json.push_back({offset.x, offset.y, offset.z});
  return json;
}

Json describe(const Arguments& arguments, const Report& report) {
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
          {"options",
           {{"distance", arguments.distance},
            {"sign", arguments.sign},
            {"orientation", arguments.orientation},
            {"passes", arguments.options.passes},
            {"sampling", arguments.sampling},
            {"offsets", listOf(arguments.options.offsets)},
            {"threshold", arguments.options.threshold},
            {"band", arguments.options.band},
            {"invert", arguments.options.invert},
            {"close_holes", arguments.options.closeHoles},
            {"thickness", arguments.options.thickness},
            {"threads", arguments.machine.threads}}},
          {"stats", toJson(report.stats)},
          {"peak_memory_bytes", peakMemory()}};
}

/// Defects of the mesh, and how many signs are uncertain.
Json describeDefects(const Arguments& arguments, const Mesh& mesh, const Field& field, const Report& report) {
  Json json{{"raymap", version().text},
            {"mesh", arguments.mesh.string()},
            {"diagnostics", toJson(Inspection{report.found, findSelfIntersections(mesh)})},
            {"stats", toJson(report.stats)}};
  if (arguments.options.sign == SignMode::None) return json;
  constexpr float kSure = 0.5f;
  const auto guessed = std::count_if(field.confidence.begin(), field.confidence.end(),
                                     [](float confidence) { return confidence < kSure; });
  json["guessed_share"] = double(guessed) / double(field.confidence.size());
  json["guessed_below"] = kSure;
  return json;
}

void print(const Arguments& arguments, const Report& report) {
  const Grid& grid = report.grid;
  const glm::dvec3 size = report.found.bounds.size();
  std::printf("%s: %s, size %.4g x %.4g x %.4g, wrong with it: %s\n", displayName(arguments.mesh).c_str(),
              counted(report.found.triangles, "triangle").c_str(), size.x, size.y, size.z,
              describeDefects(report.found, std::nullopt).c_str());
  std::printf("grid: %d x %d x %d = %s, spacing %g\n", grid.dims.x, grid.dims.y, grid.dims.z,
              counted(grid.sampleCount(), "sample").c_str(), grid.spacing);
  std::printf("%s", describeTimes(report.steps(), report.elapsedMilliseconds).c_str());
  std::printf("field: %.1f ms on %s, peak memory %s", report.stats.milliseconds, report.stats.device.c_str(),
              sizeText(peakMemory()).c_str());
  if (arguments.options.sign != SignMode::None)
    std::printf(", six rays disagree at %.3g %% of the samples", 100.0 * report.stats.doubtfulShare);
  std::printf("\n");
  printOrientation(report.stats);
  if (report.stats.patchTriangles > 0)
    std::printf("closed holes: %s, area %.4g\n", counted(report.stats.patchTriangles, "triangle").c_str(),
                report.stats.patchArea);
  for (const fs::path& path : report.written) printWritten(path);
}

void writeReports(const Arguments& arguments, const Mesh& mesh, const Field& field, Report& report) {
  const auto write = [&](const fs::path& path, auto&& describe) {
    if (path.empty()) return;
    writeJson(path, describe());
    report.written.push_back(path);
  };
  write(arguments.stats, [&] { return describe(arguments, report); });
  write(arguments.report, [&] { return describeDefects(arguments, mesh, field, report); });
  if (arguments.reportPicture.empty()) return;
  const RenderOptions view = defaultView(isZUp(arguments.mesh, arguments.format.input));
  writePng(arguments.reportPicture, renderDefects(mesh, view));
  report.written.push_back(arguments.reportPicture);
}

void run(Arguments& arguments) {
  const Clock::time_point start = Clock::now();
  finishOptions(arguments);
  prepareFiles(arguments.format, {{arguments.mesh, meshExtensions()}}, outputs(arguments));
  if (!arguments.mayOverwrite) checkInputs(outputs(arguments), {arguments.mesh, arguments.offsets});
  testBeforeFirstUse(arguments.machine.device);
  Report report;
  Mesh mesh;
  Field field;
  timeStep(report.before, "load",
           [&] { mesh = loadMesh(arguments.mesh, arguments.format.input, arguments.units); });
  {
    ProgressLine line;
    // The summary line needs no more. The files list everything.
    const bool isBrief = arguments.stats.empty() && arguments.report.empty();
    timeStep(report.before, "diagnose", [&] {
      report.found = diagnose(mesh, {.brief = isBrief}, withProgress(arguments.machine, line));
    });
    timeStep(report.before, "fit", [&] { report.grid = fitGrid(mesh, arguments.grid); });
    report.stats = Generator().generate(mesh, report.grid, arguments.options, field,
                                        withProgress(arguments.machine, line));
  }
  timeStep(report.after, "write", [&] { writeAll(arguments, field, report); });
  if (!arguments.stats.empty() || !arguments.report.empty() || !arguments.reportPicture.empty())
    timeStep(report.after, "report", [&] { writeReports(arguments, mesh, field, report); });
  report.elapsedMilliseconds = millisecondsSince(start);
  print(arguments, report);
}

void addOutputOptions(CLI::App& command, Arguments& arguments) {
  addOption(command, "--output", arguments.field)->required();
  addOption(command, "--format", arguments.format.given);
  addOption(command, "--triangle-ids", arguments.triangleIds);
  addOption(command, "--winding", arguments.winding);
  addOption(command, "--confidence", arguments.confidence);
  addFigureOptions(command, arguments.stats);
  addOption(command, "--report", arguments.report);
  addOption(command, "--report-picture", arguments.reportPicture);
  addOption(command, "--overwrite", arguments.mayOverwrite);
}

}  // namespace

void addGenerate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("generate", "Make a signed distance field from a mesh");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("mesh", arguments->mesh, "Mesh to read: OBJ, PLY, STL, OFF, glTF, GLB, 3MF, FBX or DAE")
      ->type_name("MESH")
      ->required();
  addOutputOptions(*command, *arguments);
  addUnitOptions(*command, arguments->units);
  addFieldOptions(*command, *arguments);
  command->footer(kFooter);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raymap
