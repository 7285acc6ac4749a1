#include "field_options.h"

#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/memory.h>
#include <string>

#include "first_use.h"
#include "library_options.h"
#include "read_offsets.h"
#include "terminal.h"
#include "warnings.h"

namespace raymap {

void addMethodOptions(Command& command, FieldArguments& arguments) {
  addLibraryOptions(command, arguments.options, {"triangle", "winding", "confidence", "allow_empty"});
  addOptions(command, {{"--offsets", &arguments.offsets}});
}

void addSpacingOptions(Command& command, GridOptions& grid) {
  addLibraryOptions(command, grid, {"padding", "thickness", "align"});
}

void addGridOptions(Command& command, FieldArguments& arguments) {
  addLibraryOptions(command, arguments.grid, {"thickness"});
  addOptions(command, {{"--shape", &arguments.shape}, {"--bounds", &arguments.bounds}});
}

void addMemoryLimit(Command& command, size_t& limit) {
  addOptions(command, {{"--memory-limit", &limit}});
  command.prepare = [&limit] { limitMemory(limit, true); };
}

void addCpuOptions(Command& command, MachineOptions& machine) {
  addLibraryOptions(command, machine, {"device", "memory_limit"});
  addMemoryLimit(command, machine.memoryLimit);
}

void addMachineOptions(Command& command, MachineOptions& machine) {
  addLibraryOptions(command, machine, {"memory_limit"});
  addMemoryLimit(command, machine.memoryLimit);
}

void addFieldOptions(Command& command, FieldArguments& arguments) {
  addGridOptions(command, arguments);
  addMethodOptions(command, arguments);
  addMachineOptions(command, arguments.machine);
}

void finishFieldArguments(FieldArguments& arguments) {
  const SignMode sign = arguments.options.sign;
  const bool walksPaths = sign == SignMode::Paths || sign == SignMode::Evolution;
  if (!walksPaths && (arguments.options.sampling != Sampling::Spread || !arguments.offsets.empty()))
    throw Error(ErrorCode::Usage, "--sampling and --offsets need --sign paths or evolution");
  if (!arguments.offsets.empty()) arguments.options.offsets = readOffsets(arguments.offsets);
  arguments.asked = arguments.options;
  arguments.grid.thickness = arguments.options.thickness;
  if (arguments.options.thickness > 0.0) {
    if (sign != SignMode::Harmonic && sign != SignMode::None)
      throw Error(ErrorCode::Usage, "--thickness takes the place of --sign; leave one of them out");
    arguments.options.sign = SignMode::None;
  }
  if (arguments.options.sign == SignMode::None && arguments.options.closeHoles)
    throw Error(ErrorCode::Usage, "--close-holes needs a sign; leave out --sign none and --thickness");
  if (const std::vector<int>& n = arguments.shape; !n.empty()) arguments.grid.dims = {n[0], n[1], n[2]};
  if (const std::vector<double>& b = arguments.bounds; !b.empty()) {
    arguments.grid.box = Box{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
    if (!(b[0] < b[3] && b[1] < b[4] && b[2] < b[5]))
      throw Error(ErrorCode::Usage, "--bounds: each of x0 y0 z0 must be less than its x1 y1 z1");
  }
}

MachineOptions withProgress(MachineOptions machine, ProgressLine& line, const std::string& title) {
  machine.progress = [report = line.callback(), title](std::string_view stage, double done) {
    return title.empty() ? report(stage, done) : report(title + std::string(stage), done);
  };
  machine.warn = warn;
  return machine;
}

std::vector<std::string> meshAndFieldExtensions() {
  std::vector<std::string> extensions = meshExtensions();
  for (const std::string& extension : fieldExtensions()) extensions.push_back(extension);
  return extensions;
}

Field makeField(const Mesh& mesh, const Grid& grid, const FieldArguments& arguments) {
  MachineOptions machine = arguments.machine;
  testBeforeFirstUse(machine.device);
  ProgressLine line;
  return generate(mesh, grid, arguments.options, withProgress(machine, line)).field;
}

namespace {

Field makeFieldOf(Mesh& mesh, const std::filesystem::path& file, const FieldArguments& arguments,
                  const std::filesystem::path& result) {
  if (result.empty())
    convertUnits(mesh, arguments.units, file);
  else
    convertUnits(mesh, arguments.units, file, result);
  warnOfLength("--thickness", arguments.options.thickness, bounds(mesh));
  return makeField(mesh, fitGrid(mesh, arguments.grid), arguments);
}

}  // namespace

Field loadOrMakeField(const std::filesystem::path& path, const FieldArguments& arguments,
                      const std::string& format, const std::string& grid,
                      const std::filesystem::path& result) {
  std::variant<Mesh, Field> read = loadMeshOrField(path, format, grid);
  if (Mesh* mesh = std::get_if<Mesh>(&read))
    return makeFieldOf(*mesh, named(path, format), arguments, result);
  Field& field = std::get<Field>(read);
  convertUnits(field, arguments.units, named(path, format));
  return std::move(field);
}

}  // namespace raymap
