#include <raymap/json.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <utility>
#include <variant>

#include "checks.h"
#include "commands.h"
#include "field_array.h"
#include "field_options.h"
#include "library_options.h"
#include "query_arrays.h"
#include "report.h"
#include "terminal.h"
#include "warnings.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kQueryFooter = R"(Examples:
  raymap query scan.ply points.csv -o distances.csv
      the signed distance of each point, a row each
  raymap query scan.ply points.npy -o d.npz --arrays distance,closest,triangle
      also the closest point of the surface and its triangle, as NumPy arrays
  raymap query cad.stl scan.ply -o deviation.ply --colour
      how far a scan lies from a model, as a coloured point cloud
  raymap query scan.vdb points.csv -o sampled.csv --arrays distance,gradient
      distances and gradients between the samples of a field

Points and results are in the mesh's units. A point that is not finite gets NaN.)";

constexpr const char* kGradient = "gradient";  // An array of fields only.

struct QueryArguments : FieldArguments {
  StreamFormat format;
  fs::path input, points, results, stats;
  std::vector<std::string> arrays{"distance"};
  double maxDistance = std::numeric_limits<double>::infinity();
  bool isUnsigned = false, colour = false;
  const Command* command = nullptr;
};

/// Results of one run, for the summary and the statistics.
struct QueryReport {
  size_t triangles = 0, points = 0, notFinite = 0;
  Grid grid;           ///< Grid of the field; empty for a mesh.
  size_t outside = 0;  ///< Number of points outside of it.
  size_t clamped = 0;  ///< Number of points in it that get a distance to which the field is clamped.
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

bool isAsked(const QueryArguments& arguments, const char* array) {
  return std::ranges::find(arguments.arrays, array) != arguments.arrays.end();
}

QueryOptions askedFor(const QueryArguments& arguments) {
  QueryOptions options;
  for (const AskedArray& array : kQueryArrays) options.*array.isAsked = isAsked(arguments, array.name);
  options.maxDistance = arguments.maxDistance;
  return options;
}

/// Returns whether the results are written in this format.
bool isWritten(const QueryArguments& arguments, const std::string& format) {
  if (hasExtension(arguments.results, queryExtensions())) return hasExtension(arguments.results, {format});
  return arguments.format.output == format;
}

void check(QueryArguments& arguments, const QueryOptions& asked) {
  const std::vector<Output> outputs{{"--output", arguments.results, queryExtensions()},
                                    {"--stats", arguments.stats, {".json"}}};
  prepareFiles(arguments.format,
               {{arguments.input, meshAndFieldExtensions()}, {arguments.points, pointExtensions()}}, outputs);
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw Error(ErrorCode::Usage, what);
  };
  require(!arguments.isUnsigned || !(asked.winding || asked.confidence),
          "the arrays winding and confidence need a sign; leave out --unsigned");
  require(!arguments.colour || (asked.distance && isWritten(arguments, ".ply")),
          "--colour needs the array distance and an output .ply");
  const auto count =
      (isAsked(arguments, kGradient) ? 1 : 0) +
      std::ranges::count_if(kQueryArrays, [&](const AskedArray& array) { return asked.*array.isAsked; });
  require(count == 1 || !isWritten(arguments, ".npy"),
          "a .npy holds one array; name one with --arrays, or write a .npz");
}

std::vector<glm::dvec3> loadPoints(const fs::path& path, const std::string& format) {
  const WaitingLine line("reading " + briefName(path));
  return readPoints(path, {.format = format, .warn = warn});
}

/// Throws `Error(Memory)` if the results do not fit.
void checkResults(size_t bytesPerPoint, size_t points) {
  const size_t bytes = bytesPerPoint * points;
  if (const size_t left = memoryLeft(); bytes > left)
    throw Error(ErrorCode::Memory, "the results of " + counted(points, "point") + " need " + sizeText(bytes) +
                                       ", but only " + sizeText(left) +
                                       " are left; split the file of points, or allow more memory");
}

size_t resultBytes(const QueryOptions& asked) {
  size_t bytes = 0;
  for (const AskedArray& array : kQueryArrays) bytes += asked.*array.isAsked ? array.bytes : 0;
  return bytes;
}

Surface prepare(const Mesh& mesh, const QueryArguments& arguments, const MachineOptions& machine) {
  return Surface(mesh,
                 {.sign = arguments.isUnsigned ? SignMode::None : SignMode::Harmonic,
                  .orientation = arguments.options.orientation,
                  .threshold = arguments.options.threshold},
                 machine);
}

bool isFinite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void count(std::span<const glm::dvec3> points, const auto& distances, QueryReport& report) {
  report.points = points.size();
  report.notFinite = points.size() - static_cast<size_t>(std::ranges::count_if(points, isFinite));
  for (const double distance : distances) {
    if (std::isnan(distance)) continue;
    ++report.known;
    report.inside += distance < 0.0 ? 1 : 0;
    report.least = std::min(report.least, distance);
    report.most = std::max(report.most, distance);
  }
}

/// Returns null without distances.
Json distancesOf(const QueryReport& report) {
  if (report.known == 0) return {};
  return {{"inside", report.inside}, {"min", report.least}, {"max", report.most}};
}

Json describe(const QueryArguments& arguments, const QueryOptions& asked, const QueryReport& report) {
  Json arrays = Json::array();
  for (const AskedArray& array : kQueryArrays)
    if (asked.*array.isAsked) arrays.push_back(array.name);
  return {{"raymap", version().text},
          {"mesh", arguments.input.string()},
          {"triangles", report.triangles},
          {"points",
           {{"file", arguments.points.string()}, {"count", report.points}, {"non_finite", report.notFinite}}},
          {"options",
           {{"arrays", arrays},
            {"unsigned", arguments.isUnsigned},
            {"orientation", name(arguments.options.orientation)},
            {"threshold", arguments.options.threshold},
            {"max_distance", std::isfinite(arguments.maxDistance) ? Json(arguments.maxDistance) : Json()},
            {"threads", arguments.machine.threads}}},
          {"steps", toJson(report.steps())},
          {"stats", toJson(report.surface)},
          {"surface_bytes", report.surfaceBytes},
          {"peak_memory_bytes", peakMemory()},
          {"distances", distancesOf(report)}};
}

/// Describes a query of a field.
Json describe(const QueryArguments& arguments, const QueryReport& report) {
  return {{"raymap", version().text},
          {"field", arguments.input.string()},
          {"grid", figuresOf(report.grid)},
          {"points",
           {{"file", arguments.points.string()},
            {"count", report.points},
            {"non_finite", report.notFinite},
            {"outside", report.outside},
            {"clamped", report.clamped}}},
          {"options", {{"arrays", arguments.arrays}, {"threads", arguments.machine.threads}}},
          {"steps", toJson(report.steps())},
          {"peak_memory_bytes", peakMemory()},
          {"distances", distancesOf(report)}};
}

void print(const QueryArguments& arguments, const QueryReport& report, double elapsedMilliseconds) {
  const bool isField = report.grid.spacing > 0.0;
  std::printf("%s: %s\n", displayName(arguments.input).c_str(),
              isField ? counted(report.grid.sampleCount(), "sample").c_str()
                      : counted(report.triangles, "triangle").c_str());
  std::printf("%s: %s", displayName(arguments.points).c_str(), counted(report.points, "point").c_str());
  if (report.notFinite > 0) std::printf(", %s not finite", grouped(report.notFinite).c_str());
  std::printf("\n");
  if (isVerbose()) {
    std::printf("%s", describeTimes(report.steps(), elapsedMilliseconds).c_str());
    if (!isField) std::printf("prepared mesh: %s\n", sizeText(report.surfaceBytes).c_str());
  }
  std::printf("time: %.2f s, peak memory %s\n", elapsedMilliseconds / 1000.0, sizeText(peakMemory()).c_str());
  if (report.known > 0) {
    std::printf("distance: %.4g to %.4g", report.least, report.most);
    if (!arguments.isUnsigned) std::printf(", %s inside", counted(report.inside, "point").c_str());
    std::printf("\n");
  }
  if (!arguments.isUnsigned) printOrientation(report.surface);
  printWritten(arguments.results);
  if (!arguments.stats.empty()) printWritten(arguments.stats);
}

QueryWriteOptions writing(const QueryArguments& arguments) {
  return {.colour = arguments.colour, .format = arguments.format.output, .arrays = arguments.arrays};
}

void queryMesh(const Mesh& mesh, const QueryArguments& arguments, const QueryOptions& asked,
               std::span<const glm::dvec3> points, QueryReport& report) {
  if (isAsked(arguments, kGradient))
    throw Error(ErrorCode::Usage, "the array gradient is one of fields, and " + arguments.input.string() +
                                      " is a mesh; its array direction leads to the closest point");
  report.triangles = mesh.triangles.size();
  QueryResult result;
  {
    ProgressLine line;
    const MachineOptions machine = withProgress(arguments.machine, line);
    const Surface surface = prepare(mesh, arguments, machine);
    report.surface = surface.stats();
    report.surfaceBytes = surface.bytes();
    checkResults(resultBytes(asked), points.size());
    timeStep(report.after, "query", [&] { surface.query(points, asked, result, machine); });
  }
  timeStep(report.after, "write", [&] {
    const WaitingLine line("writing " + displayName(arguments.results));
    writeQuery(arguments.results, points, result, writing(arguments));
  });
  count(points, result.distance, report);
  if (!arguments.stats.empty()) writeJson(arguments.stats, describe(arguments, asked, report));
}

/// Throws `Error(Usage)` if an option or array is one of meshes.
void checkOfField(const QueryArguments& arguments) {
  const std::string isField = ", and " + arguments.input.string() + " is a field";
  for (const char* option : {"--max-distance", "--unsigned", "--orientation", "--threshold"})
    if (arguments.command->isGiven(option))
      throw Error(ErrorCode::Usage, std::string(option) + " is for meshes" + isField + "; leave it out");
  for (const std::string& array : arguments.arrays)
    if (array != "distance" && array != kGradient)
      throw Error(ErrorCode::Usage, std::string("the array ")
                                        .append(array)
                                        .append(" is one of meshes")
                                        .append(isField)
                                        .append(", which has distance and gradient"));
}

/// Returns whether a point is in the box of the outermost samples.
bool isIn(const Grid& grid, const glm::dvec3& point) {
  const glm::dvec3 p = (point - grid.origin) / grid.spacing;
  return glm::all(glm::greaterThanEqual(p, glm::dvec3(0.0))) &&
         glm::all(glm::lessThanEqual(p, glm::dvec3(grid.dims - 1)));
}

/// Distances to which a field is clamped on both sides of the surface.
struct Clamps {
  double outside, inside;
};

Clamps clampsOf(const Field& field) {
  if (const auto& band = field.narrow) return {band->outside, band->inside};
  return {field.clampDistance, field.clampDistance};
}

/// Returns whether a distance is one to which the field is clamped, but for rounding.
bool isClamped(double distance, const Clamps& clamps) {
  constexpr double kRounding = 1e-6;
  const double clamp = distance < 0.0 ? clamps.inside : clamps.outside;
  return clamp > 0.0 && std::isfinite(clamp) && std::abs(std::abs(distance) - clamp) <= kRounding * clamp;
}

/// Counts the points outside of the grid, and the distances of the others: those outside are bounds.
void count(const Grid& grid, const Clamps& clamps, std::span<const glm::dvec3> points, const Samples& samples,
           QueryReport& report) {
  std::vector<float> distances;
  for (size_t i = 0; i < points.size(); ++i)
    if (isIn(grid, points[i]))
      distances.push_back(samples.distance[i]);
    else
      report.outside += isFinite(points[i]) ? 1 : 0;
  report.clamped = static_cast<size_t>(
      std::ranges::count_if(distances, [&](double distance) { return isClamped(distance, clamps); }));
  count(points, distances, report);
}

/// Warns of distances that the field does not hold.
void warnOfBounds(const QueryArguments& arguments, const QueryReport& report) {
  const auto warnOf = [&](size_t count, const char* one, const char* several, const char* rest) {
    if (count > 0)
      printWarning(displayName(arguments.points) + ": " + grouped(count) + " of " +
                   counted(report.points, "point") + (count == 1 ? one : several) + rest);
  };
  warnOf(report.outside, " lies", " lie",
         " outside of the grid; their distances are lower bounds, and their gradients lead away from it");
  warnOf(
      report.clamped, " is", " are",
      " beyond the distance to which the field is clamped; their distances are lower bounds. A field with a "
      "wider band, or the mesh itself, has the true ones");
}

void queryField(const Field& field, const QueryArguments& arguments, std::span<const glm::dvec3> points,
                QueryReport& report) {
  checkOfField(arguments);
  checkResults(sizeof(float) + sizeof(glm::vec3), points.size());
  report.grid = field.grid;
  Samples samples;
  timeStep(report.after, "query", [&] {
    sample(field, points, {.gradients = isAsked(arguments, kGradient)}, samples, arguments.machine);
  });
  count(field.grid, clampsOf(field), points, samples, report);
  if (!isAsked(arguments, "distance")) samples.distance = {};
  timeStep(report.after, "write", [&] {
    const WaitingLine line("writing " + displayName(arguments.results));
    writeSamples(arguments.results, points, samples, writing(arguments));
  });
  warnOfBounds(arguments, report);
  if (!arguments.stats.empty()) writeJson(arguments.stats, describe(arguments, report));
}

void run(QueryArguments& arguments) {
  const Clock::time_point start = Clock::now();
  const QueryOptions asked = askedFor(arguments);
  check(arguments, asked);
  QueryReport report;
  std::variant<Mesh, Field> input;
  std::vector<glm::dvec3> points;
  timeStep(report.before, "load", [&] {
    input = loadMeshOrField(arguments.input, arguments.format.input, arguments.format.grid, arguments.units);
  });
  timeStep(report.before, "load points",
           [&] { points = loadPoints(arguments.points, arguments.format.input); });
  if (const Mesh* mesh = std::get_if<Mesh>(&input)) {
    queryMesh(*mesh, arguments, asked, points, report);
  } else {
    const Field& field = std::get<Field>(input);
    requireDistances(arguments.input, field);
    queryField(field, arguments, points, report);
  }
  print(arguments, report, millisecondsSince(start));
}

void addResultOptions(Command& command, QueryArguments& arguments) {
  addOutput(command, arguments.results, "Results to write", queryExtensions()).isRequired = true;
  addOptions(command, {{"--format", &arguments.format.given}, {"--grid", &arguments.format.grid}});
  addFigureOptions(command, arguments.stats);
  addOptions(command, {{"--overwrite", &arguments.format.mayOverwrite},
                       {"--arrays", &arguments.arrays},
                       {"--max-distance", &arguments.maxDistance},
                       {"--colour", &arguments.colour}});
}

}  // namespace

void addQuery(Program& program) {
  Command& command = program.addCommand(
      "query", "Measure signed distances of a mesh or a field at given points", kQueryFooter);
  auto& arguments = command.runs<QueryArguments>(run);
  addOperand(command, "MESH|FIELD", &arguments.input, "Mesh or field to measure from");
  addOperand(command, "POINTS", &arguments.points,
             "Points: .csv with columns x, y, z; .npy of shape N x 3; .ply; .xyz or .txt");
  arguments.command = &command;
  addResultOptions(command, arguments);
  addUnitOptions(command, arguments.units);
  addOptions(command, {{"--unsigned", &arguments.isUnsigned},
                       {"--orientation", targetOf(arguments.options.orientation)},
                       {"--threshold", &arguments.options.threshold}});
  addCpuOptions(command, arguments.machine);
}

}  // namespace raymap
