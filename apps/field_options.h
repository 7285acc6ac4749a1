#pragma once

#include <raymap/generate.h>
#include <raymap/grid.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace raymap {

/// What every command that turns a mesh into a field asks for.
struct FieldArguments {
  GridOptions grid;
  std::vector<double> bounds;
  std::string distance = "exact", sign = "harmonic", orientation = "auto";
  Options options;
};

/// Adds all of them, in groups, to a command.
void addFieldOptions(CLI::App& command, FieldArguments& arguments);

// And some of them.
void addOrientationOption(CLI::App& command, FieldArguments& arguments);
void addMachineOptions(CLI::App& command, FieldArguments& arguments);

/// Turns what the options say in words into `grid` and `options`. Throws `Error(Usage)` if they contradict
/// each other.
void finishFieldArguments(FieldArguments& arguments);

/// Makes the field with progress and warnings on stderr.
Generated makeField(const Mesh& mesh, const Grid& grid, Options options);

/// Reads a field, or makes one of a mesh: which of them, the file's ending tells.
Field loadField(const std::filesystem::path& path, const FieldArguments& arguments);

}  // namespace raymap
