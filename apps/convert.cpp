#include <raymap/raymap.h>

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "batch.h"
#include "checks.h"
#include "commands.h"
#include "field_array.h"
#include "field_options.h"
#include "mesh_output.h"
#include "mesh_units.h"
#include "report.h"
#include "terminal.h"
#include "text.h"
#include "warnings.h"

namespace raymap {

namespace {

struct ConvertArguments {
  StreamFormat format;
  std::filesystem::path input, output;
  std::vector<std::filesystem::path> others;  ///< Further inputs; without -o the output.
  bool half = false, isSplit = false;
  std::string gridName;
  MeshUnits units;
  size_t memoryLimit = 0;
};

/// Returns the formats in which the input can be written, as far as its name tells.
std::vector<std::string> outputExtensions(const ConvertArguments& arguments) {
  if (hasExtension(arguments.input, meshExtensions())) return writableMeshExtensions();
  std::vector<std::string> extensions = fieldExtensions();
  if (hasExtension(arguments.input, extensions)) return extensions;
  for (const std::string& extension : writableMeshExtensions()) extensions.push_back(extension);
  return extensions;
}

template <class AnyMesh>
Outcome writeConvertedMesh(const ConvertArguments& arguments, const MeshAttributes& attributes,
                           AnyMesh& mesh) {
  if (arguments.half || !arguments.gridName.empty())
    throw Error(ErrorCode::Usage, "--grid-name and --half are for a field, and " +
                                      displayName(arguments.input) + " is a mesh; leave them out");
  const std::filesystem::path input = named(arguments.input, arguments.format.input),
                              output = named(arguments.output, arguments.format.output);
  checkMeshUnits(arguments.units, output);
  convertUnits(mesh, arguments.units, input, output);
  MeshWriteOptions options = writeOptions(mesh, {.recenter = arguments.units.recenter,
                                                 .unit = writtenUnit(arguments.units, input),
                                                 .format = arguments.format.output});
  options.attributes = &attributes;
  const size_t triangles = mesh.triangles.size();
  Outcome outcome{
      .done = "converted", .trianglesBefore = triangles, .trianglesAfter = triangles, .figures = {}};
  if (arguments.isSplit) {
    Json& parts = outcome.figures["parts"] = Json::array();
    writeParts(arguments.output, mesh, options, inputsKept(arguments.format, arguments.input), parts);
    printParts(parts);
    printOffset(options);
  } else {
    writeMesh(arguments.output, mesh, options);
    printWritten(arguments.output, options);
  }
  return outcome;
}

/// Writes a mesh, or its positions in double precision if it rounds some.
Outcome writeConverted(const ConvertArguments& arguments, const MeshAttributes& attributes, Mesh& mesh,
                       std::vector<glm::dvec3> exact) {
  if (exact.empty()) return writeConvertedMesh(arguments, attributes, mesh);
  DoubleMesh precise{std::move(exact), std::move(mesh.triangles)};
  return writeConvertedMesh(arguments, attributes, precise);
}

/// Warns of what the file's format has no place for: arrays besides the first, and the grid.
void warnOfDropped(const ConvertArguments& arguments, const Field& field) {
  const std::filesystem::path output = named(arguments.output, arguments.format.output);
  std::string dropped = hasExtension(output, {".npy"}) ? "the grid" : "";
  const std::vector<FieldArray> arrays = field.arrays();
  const bool isDistance = arrays[0] == FieldArray::Distance;  // Other arrays are written alone.
  const bool holdsAll = isDistance && hasExtension(output, {".npz", ".vti", ".vdb", ".nvdb"});
  for (size_t a = 1; a < arrays.size() && !holdsAll; ++a)
    dropped += (dropped.empty() ? "" : ", ") + ("the array " + std::string(name(arrays[a])));
  if (!dropped.empty())
    printWarning(displayName(arguments.output) + ": it has no place for these, which are left out: " +
                 dropped + (isDistance ? "; a .npz, .vti, .vdb or .nvdb holds all" : ""));
}

Outcome writeConverted(const ConvertArguments& arguments, Field& field) {
  if (arguments.isSplit)
    throw Error(ErrorCode::Usage,
                "--split is for a mesh, and " + displayName(arguments.input) + " is a field; leave it out");
  convertUnits(field, arguments.units, named(arguments.input, arguments.format.input));
  const std::filesystem::path output = named(arguments.output, arguments.format.output);
  const FieldWriteOptions options{.array = heldArray(field),
                                  .format = arguments.format.output,
                                  .gridName = arguments.gridName,
                                  .half = arguments.half};
  const bool isMadeDense = field.narrow && !hasExtension(output, {".vdb", ".nvdb"});
  (isMadeDense ? writeDense : writeField)(arguments.output, field, options);
  warnOfDropped(arguments, field);
  printWritten(arguments.output);
  return {.done = "converted", .figures = {}};
}

/// Writes the narrow bands of several files as grids of one, each under the name of its file.
void joinBands(const ConvertArguments& arguments, const std::vector<std::filesystem::path>& inputs) {
  if (!hasExtension(named(arguments.output, arguments.format.output), {".vdb", ".nvdb"}))
    throw Error(ErrorCode::Usage, "several inputs become grids of one .vdb or .nvdb, and " +
                                      displayName(arguments.output) +
                                      " is none; give one input, or another output");
  if (!arguments.gridName.empty())
    throw Error(ErrorCode::Usage,
                "--grid-name names one grid, and each of several inputs gives its grid the "
                "name of its file; leave it out");
  std::vector<Field> bands;
  std::vector<std::string> names;
  for (const std::filesystem::path& input : inputs) {
    const WaitingLine line("reading " + briefName(input));
    bands.push_back(readField(input, {.format = arguments.format.input,
                                      .warn = warn,
                                      .gridName = arguments.format.grid,
                                      .levelSet = LevelSet::Narrow}));
    convertUnits(bands.back(), arguments.units, named(input, arguments.format.input));
    names.push_back(input.stem().string());
  }
  std::vector<NamedField> all;
  for (size_t b = 0; b < bands.size(); ++b) all.push_back({names[b], &bands[b]});
  writeFields(arguments.output, all, {.format = arguments.format.output, .half = arguments.half});
  printWritten(arguments.output);
}

/// Takes the last of two files as the output, unless --output names it.
void findOutput(ConvertArguments& arguments) {
  if (!arguments.output.empty()) return;
  if (arguments.others.size() != 1)
    throw Error(ErrorCode::Usage, "--output is required; see raymap convert --help");
  arguments.output = arguments.others.front();
  arguments.others.clear();
}

Outcome convertOne(const ConvertArguments& arguments) {
  std::vector<glm::dvec3> exact;
  MeshAttributes attributes;
  auto read =
      loadMeshOrField(arguments.input, arguments.format.input, arguments.format.grid, &exact, &attributes);
  if (Mesh* mesh = std::get_if<Mesh>(&read))
    return writeConverted(arguments, attributes, *mesh, std::move(exact));
  return writeConverted(arguments, std::get<Field>(read));
}

/// Converts each input to a file in a folder.
void convertEach(ConvertArguments& arguments) {
  std::vector<std::filesystem::path> inputs{arguments.input};
  std::filesystem::path none;
  inputs.insert(inputs.end(), arguments.others.begin(), arguments.others.end());
  std::vector<std::string> writable = fieldExtensions();
  for (const std::string& extension : writableMeshExtensions()) writable.push_back(extension);
  const std::vector<FileJob> jobs =
      prepareJobs(arguments.format, inputs, arguments.output, meshAndFieldExtensions(), writable, none);
  doAll(jobs, {}, [&](const FileJob& job) {
    ConvertArguments each = arguments;
    each.input = job.input;
    each.output = job.output;
    return convertOne(each);
  });
}

void run(ConvertArguments& arguments) {
  findOutput(arguments);
  checkSplit(arguments.isSplit, arguments.output);
  if (isFolder(arguments.output)) return convertEach(arguments);
  const std::vector<Output> outputs{{"--output", arguments.output, outputExtensions(arguments)}};
  std::vector<Input> files{{arguments.input, meshAndFieldExtensions()}};
  for (std::filesystem::path& other : arguments.others) files.push_back({other, meshAndFieldExtensions()});
  prepareFiles(arguments.format, files, outputs);
  std::vector<std::filesystem::path> inputs{arguments.input};
  inputs.insert(inputs.end(), arguments.others.begin(), arguments.others.end());
  if (inputs.size() > 1) return joinBands(arguments, inputs);
  convertOne(arguments);
}

}  // namespace

void addConvert(Program& program) {
  Command& command = program.addCommand(
      "convert", "Convert a field or a mesh to another format",
      "Examples:\n  raymap convert bunny.vdb -o bunny.nrrd\n  raymap convert bunny.vdb -o bunny.nvdb\n  "
      "raymap convert bunny.3mf -o bunny.ply\n"
      "  raymap convert body.vdb hull.vdb -o both.vdb     (its grids are 'body' and 'hull')\n"
      "  raymap convert car.glb -o car.3mf --unit mm --up y\n"
      "  raymap convert plate.stl -o part.stl --split    (part_1.stl, part_2.stl: each part by itself)\n"
      "  raymap convert *.stl -o printable/ --format 3mf --unit mm");
  auto& arguments = command.runs<ConvertArguments>(run);
  addOperand(command, "FIELD|MESH", &arguments.input, "Field or mesh to read");
  addOperand(command, "FILE...", &arguments.others,
             "File to write, in place of --output; with it, level sets to write into the same file")
      .isRequired = false;
  addOutput(command, arguments.output,
            "File to write. Of a field: " + joined(fieldExtensions(), ", ", " or ") +
                ". Of a mesh: " + joined(writableMeshExtensions(), ", ", " or ") +
                ". Or a folder, for a file of each input, with its name");
  addOptions(command, {{"--format", &arguments.format.given},
                       {"--grid", &arguments.format.grid},
                       {"--grid-name", &arguments.gridName},
                       {"--half", &arguments.half},
                       {"--split", &arguments.isSplit},
                       {"--overwrite", &arguments.format.mayOverwrite}});
  addMeshOutputOptions(command, arguments.units);
  addMemoryLimit(command, arguments.memoryLimit);
}

}  // namespace raymap
