#include <raymap/json.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "batch.h"
#include "checks.h"
#include "commands.h"
#include "field_info.h"
#include "field_options.h"
#include "mesh_units.h"
#include "report.h"
#include "terminal.h"
#include "verdict.h"
#include "view_options.h"

namespace raymap {

namespace {

constexpr const char* kInfoFooter = R"(Examples:
  raymap info scan.ply
  raymap info scan.ply --json | jq .watertight
  raymap info scan.ply --picture scan.png       (shows where the defects are)
  raymap info scan.ply --fast                   (no faces that cross, no thickness)
  raymap info scan.vdb                          (a field: its grid, arrays and range)
  raymap info *.stl                             (a table with a line for each)

Measured after welding vertices at exactly equal positions. A balanced mesh (every edge used equally often
in both directions) has a definite inside. For any other, 'raymap generate' finds the most likely one.)";

void print(const std::vector<Hole>& holes) {
  constexpr size_t kMost = 5;
  std::printf("%-24s %s\n", "holes", grouped(holes.size()).c_str());
  for (size_t h = 0; h < std::min(holes.size(), kMost); ++h)
    std::printf("  %-22s %s, length %.4g, diameter %.4g, at %.4g %.4g %.4g\n", "",
                counted(holes[h].edges, "edge").c_str(), holes[h].length, holes[h].diameter,
                holes[h].centre.x, holes[h].centre.y, holes[h].centre.z);
  if (holes.size() > kMost)
    std::printf("  %-22s and %s smaller ones\n", "", grouped(holes.size() - kMost).c_str());
}

void print(const std::optional<SelfIntersections>& crossings) {
  const auto print = [&](const char* name, size_t pairs, size_t faces) {
    const std::string text =
        (crossings->complete ? "" : "at least ") + grouped(pairs) + ", of " + counted(faces, "face");
    std::printf("%-24s %s\n", name, text.c_str());
  };
  if (!crossings) {
    std::printf("%-24s %s\n", "crossing pairs of faces", "not counted (--fast)");
    return;
  }
  print("crossing pairs of faces", crossings->pairs, crossings->faces.size());
  print("overlapping in one plane", crossings->coplanarPairs, crossings->coplanarFaces.size());
}

void print(const Diagnostics& found, const std::optional<SelfIntersections>& crossings,
           const std::optional<LengthUnit>& unit, const std::string& up) {
  const auto count = [](const char* name, size_t value) {
    std::printf("%-24s %s\n", name, grouped(value).c_str());
  };
  const auto yes = [](const char* name, bool value) {
    std::printf("%-24s %s\n", name, value ? "yes" : "no");
  };
  const auto vector = [](const char* name, const glm::dvec3& v) {
    std::printf("%-24s %.9g %.9g %.9g\n", name, v.x, v.y, v.z);
  };
  count("triangles", found.triangles);
  count("vertices", found.vertices);
  count("distinct positions", found.weldedVertices);
  if (found.farVertices > 0) count("far vertices", found.farVertices);
  vector("bounds, lowest", found.bounds.min);
  vector("bounds, highest", found.bounds.max);
  vector("size", found.bounds.size());
  std::printf("%-24s %s\n", "unit", unit ? nameOf(*unit).c_str() : "not stated");
  std::printf("%-24s %s\n", "up", up.c_str());
  std::printf("%-24s %g\n%-24s %g\n", "area", found.area, "signed volume", found.signedVolume);
  count("components", found.components);
  yes("watertight", found.watertight);
  yes("consistently oriented", found.consistentlyOriented);
  yes("balanced", found.balanced);
  count("boundary edges", found.boundaryEdges);
  print(found.holes);
  count("non-manifold edges", found.nonManifoldEdges);
  count("flipped edges", found.flippedEdges);
  count("flipped faces", found.flippedFaces);
  count("degenerate faces", found.degenerateFaces);
  count("duplicate faces", found.duplicateFaces);
  count("double-sided faces", found.doubleSidedFaces);
  print(crossings);
}

struct InfoArguments {
  std::filesystem::path input, picture;
  std::vector<std::filesystem::path> others;
  bool isJson = false, isFast = false;
  StreamFormat format;
  MeshUnits units;
  MachineOptions machine;
  ViewArguments camera;
  RenderOptions view;
};

/// Returns the unit of all lengths, if it is known.
std::optional<LengthUnit> unitOf(const InfoArguments& arguments) {
  return unitOf(arguments.units, named(arguments.input, arguments.format.input));
}

/// Findings about a mesh.
struct Examined {
  Diagnostics found;
  std::optional<SelfIntersections> crossings;
  Verdict verdict;
};

Examined examine(const Mesh& mesh, const InfoArguments& arguments) {
  ProgressLine line;
  const MachineOptions machine = withProgress(arguments.machine, line);
  Examined made{.found = diagnose(mesh, {}, machine)};
  if (!arguments.isFast) made.crossings = findSelfIntersections(mesh, machine);
  made.verdict =
      made.crossings ? judge(mesh, made.found, *made.crossings, machine) : judge(made.found, made.crossings);
  return made;
}

/// Row and JSON of one of several files.
struct Line {
  Row row;
  Json json;
};

Line lineOf(const Mesh& mesh, const InfoArguments& arguments) {
  const auto [found, crossings, verdict] = examine(mesh, arguments);
  return {{"", found.watertight ? "yes" : "no", grouped(found.triangles), grouped(found.components),
           numberText("%.6g", found.signedVolume), describeKind(verdict, found, crossings)},
          toJson(verdict, found, crossings, unitOf(arguments))};
}

Line lineOf(const Field& field, const InfoArguments& arguments) {
  const FieldInfo info = inspect(field);
  const std::optional<LengthUnit> unit = unitOf(arguments);
  const glm::ivec3& dims = field.grid.dims;
  return {{"", "-", "-", "-", "-",
           "a field of " + std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " +
               std::to_string(dims.z) + " samples"},
          describe(field, info, unit ? nameOf(*unit) : "")};
}

void inspectMesh(const Mesh& mesh, const InfoArguments& arguments) {
  if (arguments.isFast && !arguments.picture.empty())
    throw Error(ErrorCode::Usage, "--picture shows the faces that cross; leave out --fast");
  const auto [found, crossings, verdict] = examine(mesh, arguments);
  if (!arguments.picture.empty()) writePng(arguments.picture, renderDefects(mesh, arguments.view));
  const std::optional<LengthUnit> unit = unitOf(arguments);
  if (!arguments.isJson) {
    print(found, crossings, unit, describeUp(named(arguments.input, arguments.format.input)));
    std::printf("\n%s",
                describe(verdict, found, crossings, mesh, arguments.input, arguments.machine).c_str());
    return;
  }
  Json json = toJson(verdict, found, crossings, unit);
  json["file"] = arguments.input.string();
  std::cout << textOf(json);
}

/// Draws the surface of a field; where it has no distances, the middle slice.
Picture draw(const Field& field, FieldArray array, const InfoArguments& arguments) {
  if (field.narrow) return draw(toDense(field, arguments.machine), array, arguments);
  constexpr int kAcrossZ = 2;
  if (array != FieldArray::Distance) return renderSlice(field, kAcrossZ, -1, arguments.view.width, array);
  ProgressLine line;
  MachineOptions machine = withProgress(arguments.machine, line);
  machine.device = "cpu";
  return renderField(field, arguments.view, machine);
}

void inspectField(const Field& field, const InfoArguments& arguments) {
  const FieldInfo info = inspect(field);
  if (!arguments.picture.empty()) writePng(arguments.picture, draw(field, info.array, arguments));
  const std::optional<LengthUnit> unit = unitOf(arguments);
  const std::string unitName = unit ? nameOf(*unit) : "";
  if (!arguments.isJson) return print(field, info, unitName);
  Json json = describe(field, info, unitName);
  json["file"] = arguments.input.string();
  std::cout << textOf(json);
}

/// Prints a line about each of several files, also after one that cannot be read. Throws `ExitCode` with the
/// highest exit code of a file, unless that is 0.
void inspectEach(const InfoArguments& arguments, const std::vector<std::filesystem::path>& inputs) {
  std::vector<Row> rows{{"file", "watertight", "triangles", "parts", "volume", "what it is"}};
  Json all = Json::array();
  int code = 0;
  for (const std::filesystem::path& input : inputs) {
    InfoArguments each = arguments;
    each.input = input;
    Line line;
    try {
      const auto read = loadMeshOrField(input, each.format.input, each.format.grid, each.units);
      line = std::visit([&](const auto& found) { return lineOf(found, each); }, read);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::Cancelled) throw;
      const Failure failure = describeFailure();
      printError(failure.message);
      line = {{"", "-", "-", "-", "-", "failed"}, {{"error", failure.kind}, {"message", failure.message}}};
      code = std::max(code, failure.code);
    }
    line.row.front() = displayName(input);
    line.json["file"] = input.string();
    rows.push_back(line.row);
    all.push_back(line.json);
  }
  if (arguments.isJson)
    std::cout << textOf(all);
  else
    printTable(rows);
  finishText();
  if (code != 0) throw ExitCode(code);
}

void run(InfoArguments& arguments) {
  const std::vector<Output> outputs{{"--picture", arguments.picture, {".png"}}};
  std::vector<Input> files{{arguments.input, meshAndFieldExtensions()}};
  for (std::filesystem::path& other : arguments.others) files.push_back({other, meshAndFieldExtensions()});
  prepareFiles(arguments.format, files, outputs);
  if (!arguments.others.empty()) {
    if (!arguments.picture.empty())
      throw Error(ErrorCode::Usage, "--picture shows one file; give one, or leave it out");
    std::vector<std::filesystem::path> inputs{arguments.input};
    inputs.insert(inputs.end(), arguments.others.begin(), arguments.others.end());
    return inspectEach(arguments, inputs);
  }
  arguments.units.upright = arguments.camera.up;
  setView(arguments.camera, isZUp(arguments.input, arguments.format.input), arguments.view);
  const auto read =
      loadMeshOrField(arguments.input, arguments.format.input, arguments.format.grid, arguments.units);
  if (const Mesh* mesh = std::get_if<Mesh>(&read)) return inspectMesh(*mesh, arguments);
  inspectField(std::get<Field>(read), arguments);
}

}  // namespace

void addInfo(Program& program) {
  Command& command = program.addCommand(
      "info", "Report a mesh's size, topology and defects, or a field's grid and range", kInfoFooter);
  auto& arguments = command.runs<InfoArguments>(run);
  addOperand(command, "MESH|FIELD", &arguments.input, "Mesh or field to read");
  addOperand(command, "FILE...", &arguments.others, "Further ones: a line of a table for each").isRequired =
      false;
  addOptions(command, {{"--format", &arguments.format.given}, {"--grid", &arguments.format.grid}});
  addJsonOption(command, arguments.isJson);
  addOptions(command, {{"--overwrite", &arguments.format.mayOverwrite}});
  addUnitOptions(command, arguments.units);
  addOptions(command, {{"--fast", &arguments.isFast}, {"--picture", &arguments.picture}});
  addCpuOptions(command, arguments.machine);
  addViewOptions(command, arguments.camera);
}

}  // namespace raymap
