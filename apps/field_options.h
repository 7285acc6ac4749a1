#pragma once

#include <raymap/generate.h>
#include <raymap/grid.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "terminal.h"

namespace raymap {

/// Arguments of every command that turns a mesh into a field.
struct FieldArguments {
  GridOptions grid;
  std::vector<double> bounds;
  std::string distance = "exact", sign = "harmonic", orientation = "auto", sampling = "raymap";
  std::filesystem::path offsets;
  FieldOptions options;
  MachineOptions machine;
};

/// Adds the options of all of them, in groups, to a command.
void addFieldOptions(CLI::App& command, FieldArguments& arguments);

// Add some of them.
void addSpacingOptions(CLI::App& command, GridOptions& grid, int defaultResolution);
void addOrientationOption(CLI::App& command, FieldArguments& arguments);
void addMachineOptions(CLI::App& command, FieldArguments& arguments);
void addCpuOptions(CLI::App& command, FieldArguments& arguments);
void addThresholdOption(CLI::App& command, FieldArguments& arguments);

/// Converts arguments given as text into `grid` and `options`. Throws `Error(Usage)` if they contradict each
/// other.
void finishFieldArguments(FieldArguments& arguments);

/// Returns the options with progress on `line`, which must outlive them, and warnings on stderr.
MachineOptions withProgress(MachineOptions machine, ProgressLine& line);

/// Returns the extensions of meshes and fields that can be read.
std::vector<std::string> meshAndFieldExtensions();

/// Reads a field, or reads a mesh and makes its field. `format` counts if the file's name does not tell.
Field loadField(const std::filesystem::path& path, const FieldArguments& arguments,
                const std::string& format);

}  // namespace raymap
