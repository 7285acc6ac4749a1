#include "field_options.h"

#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/names.h>

#include <span>
#include <string>

#include "checks.h"
#include "first_use.h"
#include "read_offsets.h"
#include "terminal.h"
#include "warnings.h"

namespace raymap {

namespace {

/// Accepts the names of a type's values.
template <class Enum>
CLI::IsMember oneOf() {
  const std::span<const std::string_view> accepted = names<Enum>();
  return CLI::IsMember(std::vector<std::string>(accepted.begin(), accepted.end()));
}

void addGridOptions(CLI::App& command, FieldArguments& arguments) {
  addSpacingOptions(command, arguments.grid, kDefaultResolution);
  CLI::Option* bounds = command.add_option(
      "--bounds", arguments.bounds, "Box to cover, x0 y0 z0 x1 y1 z1 (default: the mesh's bounds, padded)");
  bounds->expected(6)->group("Grid");
  command
      .add_option(
          "--padding", arguments.grid.padding,
          "Padding of the mesh's bounds on every side, as a share of their longest side (default 0.1)")
      ->check(numberFrom(0))
      ->excludes(bounds)
      ->group("Grid");
}

void addMethodOptions(CLI::App& command, FieldArguments& arguments) {
  FieldOptions& options = arguments.options;
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command.add_option(name, value, help)->group("Method");
  };
  add("--distance", arguments.distance,
      "Exact distance to the closest triangle (default exact), or a faster approximation")
      ->check(oneOf<DistanceMode>());
  add("--sign", arguments.sign, "Method that decides inside and outside (default harmonic)")
      ->check(oneOf<SignMode>());
  addOrientationOption(command, arguments);
  add("--passes", options.passes, "Passes of --sign paths, steps of --sign evolution (default 5)")
      ->check(wholeNumberFrom(1));
  add("--sampling", arguments.sampling,
      "Sampling of --sign paths and evolution: raymap (default), or paper, the paper's own")
      ->check(oneOf<Sampling>());
  add("--offsets", arguments.offsets,
      "Text file of offset points for --sign paths and evolution, a line x y z each, in samples")
      ->type_name("FILE");
  addThresholdOption(command, arguments);
  add("--band", options.band, "Clamp distances to this many samples; 0 = do not clamp (default)")
      ->check(numberFrom(0));
  command
      .add_flag("--close-holes", options.closeHoles,
                "Also measure the distance to the surface missing in holes, placed where the winding number "
                "crosses the threshold")
      ->group("Method");
  add("--thickness", options.thickness,
      "Make a solid of this thickness around the surface instead of a sign, in the mesh's units: for "
      "sheets")
      ->check(numberFrom(0, true));
  command.add_flag("--invert", options.invert, "Make inside positive and outside negative")->group("Method");
}

}  // namespace

void addSpacingOptions(CLI::App& command, GridOptions& grid, int defaultResolution) {
  CLI::Option* resolution = command.add_option(
      "--resolution", grid.resolution,
      "Samples along the longest side (default " + std::to_string(defaultResolution) + ")");
  resolution->check(wholeNumberFrom(1))->group("Grid");
  command
      .add_option("--voxel-size", grid.voxelSize,
                  "Distance between samples, in the mesh's units, instead of --resolution")
      ->check(numberFrom(0, true))
      ->excludes(resolution)
      ->group("Grid");
}

void addOrientationOption(CLI::App& command, FieldArguments& arguments) {
  command
      .add_option(
          "--orientation", arguments.orientation,
          "Reverse faces that point the wrong way: auto (default), if the field then fits clearly better; "
          "keep, never; repair, whenever it fits no worse")
      ->check(oneOf<Orientation>())
      ->group("Method");
}

void addThresholdOption(CLI::App& command, FieldArguments& arguments) {
  command
      .add_option("--threshold", arguments.options.threshold,
                  "A point is inside if |winding number| exceeds this (default 0.5)")
      ->check(numberFrom(0, true))
      ->group("Method");
}

void addMachineOptions(CLI::App& command, FieldArguments& arguments) {
  command
      .add_option(
          "--device", arguments.machine.device,
          "Device that computes the field: cpu, vulkan, vulkan:K (see raymap devices), or auto (default), a "
          "GPU if there is one, else the CPU")
      ->group("Machine");
  addCpuOptions(command, arguments);
}

void addCpuOptions(CLI::App& command, FieldArguments& arguments) {
  command
      .add_option("--threads", arguments.machine.threads,
                  "Number of CPU threads; 0 = RAYMAP_THREADS, or else all (default)")
      ->check(wholeNumberFrom(0))
      ->group("Machine");
  command
      .add_option("--memory-limit", arguments.machine.memoryLimit,
                  "Most memory to use, e.g. 2GB (default: all that is available)")
      ->transform(sizeInBytes())
      ->type_name("SIZE")
      ->group("Machine");
}

void addFieldOptions(CLI::App& command, FieldArguments& arguments) {
  addGridOptions(command, arguments);
  addMethodOptions(command, arguments);
  addMachineOptions(command, arguments);
}

void finishFieldArguments(FieldArguments& arguments) {
  arguments.options.distance = fromName<DistanceMode>(arguments.distance);
  arguments.options.sign = fromName<SignMode>(arguments.sign);
  arguments.options.orientation = fromName<Orientation>(arguments.orientation);
  arguments.options.sampling = fromName<Sampling>(arguments.sampling);
  const bool walksPaths = arguments.sign == "paths" || arguments.sign == "evolution";
  if (!walksPaths && (arguments.sampling != "raymap" || !arguments.offsets.empty()))
    throw Error(ErrorCode::Usage, "--sampling and --offsets need --sign paths or evolution");
  if (!arguments.offsets.empty()) arguments.options.offsets = readOffsets(arguments.offsets);
  arguments.grid.thickness = arguments.options.thickness;
  if (arguments.options.thickness > 0.0) {
    if (arguments.sign != "harmonic" && arguments.sign != "none")
      throw Error(ErrorCode::Usage, "--thickness takes the place of --sign; leave one of them out");
    arguments.options.sign = SignMode::None;
  }
  if (arguments.options.sign == SignMode::None && arguments.options.closeHoles)
    throw Error(ErrorCode::Usage, "--close-holes needs a sign; leave out --sign none and --thickness");
  if (const std::vector<double>& b = arguments.bounds; !b.empty()) {
    arguments.grid.box = Box{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
    if (!(b[0] < b[3] && b[1] < b[4] && b[2] < b[5]))
      throw Error(ErrorCode::Usage, "--bounds: each of x0 y0 z0 must be less than its x1 y1 z1");
  }
}

MachineOptions withProgress(MachineOptions machine, ProgressLine& line) {
  machine.progress = line.callback();
  machine.warn = warn;
  return machine;
}

std::vector<std::string> meshAndFieldExtensions() {
  std::vector<std::string> extensions = meshExtensions();
  for (const std::string& extension : fieldExtensions()) extensions.push_back(extension);
  return extensions;
}

Field loadField(const std::filesystem::path& path, const FieldArguments& arguments,
                const std::string& format) {
  std::variant<Mesh, Field> read = loadMeshOrField(path, format);
  if (Field* field = std::get_if<Field>(&read)) return std::move(*field);
  const Mesh& mesh = std::get<Mesh>(read);
  MachineOptions machine = arguments.machine;
  testBeforeFirstUse(machine.device);
  ProgressLine line;
  return generate(mesh, fitGrid(mesh, arguments.grid), arguments.options, withProgress(machine, line)).field;
}

}  // namespace raymap
