#include <raymap/raymap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <utility>

#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "options.h"
#include "query_arrays.h"
#include "report.h"
#include "terminal.h"
#include "warnings.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(Examples:
  raymap query scan.ply points.csv -o distances.csv
      the signed distance of each point, a row each
  raymap query scan.ply points.npy -o d.npz --arrays distance,closest,triangle
      also the closest point of the surface and its triangle, as NumPy arrays
  raymap query cad.stl scan.ply -o deviation.ply --colour
      how far a scan lies from a model, as a coloured point cloud

Points and results are in the mesh's units. A point that is not finite gets NaN.)";

struct Arguments : FieldArguments {
  StreamFormat format;
  fs::path mesh, points, results, stats;
  std::vector<std::string> arrays{"distance"};
  double maxDistance = std::numeric_limits<double>::infinity();
  bool isUnsigned = false, colour = false, mayOverwrite = false;
};

/// Results of one run, for the summary and the statistics.
struct Report {
  size_t triangles = 0, points = 0, notFinite = 0;
  Stats surface;
  size_t surfaceBytes = 0;
  std::vector<Stats::Stage> before, after;  ///< Steps of the command before and after the surface's stages.
  size_t inside = 0, known = 0;             ///< Number of points inside, and of those with a distance.
  double least = INFINITY, most = -INFINITY;

  /// Returns all steps, in order.
  std::vector<Stats::Stage> steps() const {
    std::vector<Stats::Stage> all = before;
    for (const auto* more : {&surface.stages, &after}) all.insert(all.end(), more->begin(), more->end());
    return all;
  }
};

QueryOptions askedFor(const Arguments& arguments) {
  QueryOptions options;
  for (const AskedArray& array : kQueryArrays)
    options.*array.isAsked = std::ranges::find(arguments.arrays, array.name) != arguments.arrays.end();
  options.maxDistance = arguments.maxDistance;
  return options;
}

/// Returns whether the results are written in this format.
bool isWritten(const Arguments& arguments, const std::string& format) {
  if (hasExtension(arguments.results, queryExtensions())) return hasExtension(arguments.results, {format});
  return arguments.format.output == format;
}

void check(Arguments& arguments, const QueryOptions& asked) {
  const std::vector<Output> outputs{{"--output", arguments.results, queryExtensions()},
                                    {"--stats", arguments.stats, {".json"}}};
  prepareFiles(arguments.format, {{arguments.mesh, meshExtensions()}, {arguments.points, pointExtensions()}},
               outputs);
  if (!arguments.mayOverwrite) checkInputs(outputs, {arguments.mesh, arguments.points});
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw Error(ErrorCode::Usage, what);
  };
  require(!arguments.isUnsigned || !(asked.winding || asked.confidence),
          "the arrays winding and confidence need a sign; leave out --unsigned");
  require(!arguments.colour || (asked.distance && isWritten(arguments, ".ply")),
          "--colour needs the array distance and an output .ply");
  const auto count =
      std::ranges::count_if(kQueryArrays, [&](const AskedArray& array) { return asked.*array.isAsked; });
  require(count == 1 || !isWritten(arguments, ".npy"),
          "a .npy holds one array; name one with --arrays, or write a .npz");
}

std::vector<glm::dvec3> loadPoints(const fs::path& path, const std::string& format) {
  const WaitingLine line("reading " + displayName(path.filename()));
  return readPoints(path, {.format = format, .warn = warn});
}

/// Returns how much of the limit is left for the surface when points and results are held too; 0: no limit.
size_t limitOfSurface(const Arguments& arguments, const QueryOptions& asked, size_t points) {
  const size_t limit = arguments.machine.memoryLimit;
  if (limit == 0) return 0;
  size_t bytes = sizeof(glm::dvec3);
  for (const AskedArray& array : kQueryArrays) bytes += asked.*array.isAsked ? array.bytes : 0;
  bytes *= points;
  if (bytes >= limit)
    throw Error(ErrorCode::Memory,
                counted(points, "point") + " and their results need " + sizeText(bytes) +
                    ", which leaves nothing of the " + sizeText(limit) +
                    " of --memory-limit for the mesh; split the file of points, or allow more");
  return limit - bytes;
}

Surface prepare(const Mesh& mesh, const Arguments& arguments, size_t memoryLimit, MachineOptions machine) {
  machine.memoryLimit = memoryLimit;
  return Surface(mesh,
                 {.sign = arguments.isUnsigned ? SignMode::None : SignMode::Harmonic,
                  .orientation = fromName<Orientation>(arguments.orientation),
                  .threshold = arguments.options.threshold},
                 machine);
}

void count(std::span<const glm::dvec3> points, const QueryResult& result, Report& report) {
  report.points = points.size();
  report.notFinite = static_cast<size_t>(std::ranges::count_if(points, [](const glm::dvec3& p) {
    return !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z);
  }));
  for (const double distance : result.distance) {
    if (std::isnan(distance)) continue;
    ++report.known;
    report.inside += distance < 0.0 ? 1 : 0;
    report.least = std::min(report.least, distance);
    report.most = std::max(report.most, distance);
  }
}

Json describe(const Arguments& arguments, const QueryOptions& asked, const Report& report) {
  Json arrays = Json::array();
  for (const AskedArray& array : kQueryArrays)
    if (asked.*array.isAsked) arrays.push_back(array.name);
  Json json{
      {"raymap", version().text},
      {"mesh", arguments.mesh.string()},
      {"triangles", report.triangles},
      {"points",
       {{"file", arguments.points.string()}, {"count", report.points}, {"non_finite", report.notFinite}}},
      {"options",
       {{"arrays", arrays},
        {"unsigned", arguments.isUnsigned},
        {"orientation", arguments.orientation},
        {"threshold", arguments.options.threshold},
        {"max_distance", std::isfinite(arguments.maxDistance) ? Json(arguments.maxDistance) : Json()},
        {"threads", arguments.machine.threads}}},
      {"steps", toJson(report.steps())},
      {"stats", toJson(report.surface)},
      {"surface_bytes", report.surfaceBytes},
      {"peak_memory_bytes", peakMemory()}};
  if (report.known > 0)
    json["distances"] = {{"inside", report.inside}, {"min", report.least}, {"max", report.most}};
  return json;
}

void print(const Arguments& arguments, const Report& report, double elapsedMilliseconds) {
  std::printf("%s: %s\n", displayName(arguments.mesh).c_str(), counted(report.triangles, "triangle").c_str());
  std::printf("%s: %s", displayName(arguments.points).c_str(), counted(report.points, "point").c_str());
  if (report.notFinite > 0) std::printf(", %s not finite", grouped(report.notFinite).c_str());
  std::printf("\n");
  std::printf("%s", describeTimes(report.steps(), elapsedMilliseconds).c_str());
  std::printf("surface: %s, peak memory %s\n", sizeText(report.surfaceBytes).c_str(),
              sizeText(peakMemory()).c_str());
  if (report.known > 0) {
    std::printf("distance: %.4g to %.4g", report.least, report.most);
    if (!arguments.isUnsigned) std::printf(", %s inside", counted(report.inside, "point").c_str());
    std::printf("\n");
  }
  if (!arguments.isUnsigned) printOrientation(report.surface);
  printWritten(arguments.results);
  if (!arguments.stats.empty()) printWritten(arguments.stats);
}

void writeResults(const Arguments& arguments, std::span<const glm::dvec3> points, const QueryResult& result) {
  const WaitingLine line("writing " + displayName(arguments.results));
  writeQuery(arguments.results, points, result,
             {.colour = arguments.colour, .format = arguments.format.output});
}

void run(Arguments& arguments) {
  const Clock::time_point start = Clock::now();
  const QueryOptions asked = askedFor(arguments);
  check(arguments, asked);
  Report report;
  Mesh mesh;
  std::vector<glm::dvec3> points;
  QueryResult result;
  timeStep(report.before, "load",
           [&] { mesh = loadMesh(arguments.mesh, arguments.format.input, arguments.units); });
  timeStep(report.before, "load points",
           [&] { points = loadPoints(arguments.points, arguments.format.input); });
  report.triangles = mesh.triangles.size();
  {
    ProgressLine line;
    const MachineOptions machine = withProgress(arguments.machine, line);
    const Surface surface =
        prepare(mesh, arguments, limitOfSurface(arguments, asked, points.size()), machine);
    report.surface = surface.stats();
    report.surfaceBytes = surface.bytes();
    timeStep(report.after, "query", [&] { surface.query(points, asked, result, machine); });
  }
  timeStep(report.after, "write", [&] { writeResults(arguments, points, result); });
  count(points, result, report);
  if (!arguments.stats.empty()) writeJson(arguments.stats, describe(arguments, asked, report));
  print(arguments, report, millisecondsSince(start));
}

void addResultOptions(CLI::App& command, Arguments& arguments) {
  addOption(command, "--output", arguments.results)->required();
  addOption(command, "--format", arguments.format.given);
  addFigureOptions(command, arguments.stats);
  addOption(command, "--overwrite", arguments.mayOverwrite);
  addOption(command, "--arrays", arguments.arrays);
  addOption(command, "--max-distance", arguments.maxDistance);
  addOption(command, "--colour", arguments.colour);
}

}  // namespace

void addQuery(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("query", "Measure signed distances and closest points of a mesh at given points");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("mesh", arguments->mesh, "Mesh to measure from")->type_name("MESH")->required();
  command
      ->add_option("points", arguments->points,
                   "Points: .csv with columns x, y, z; .npy of shape N x 3; .ply; .xyz or .txt")
      ->type_name("POINTS")
      ->required();
  addResultOptions(*command, *arguments);
  addUnitOptions(*command, arguments->units);
  addOption(*command, "--unsigned", arguments->isUnsigned);
  addOption(*command, "--orientation", arguments->orientation);
  addOption(*command, "--threshold", arguments->options.threshold);
  addCpuOptions(*command, arguments->machine);
  command->footer(kFooter);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raymap
