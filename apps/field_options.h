#pragma once

#include <raymap/generate.h>
#include <raymap/grid.h>

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_units.h"
#include "parser.h"
#include "terminal.h"

namespace raymap {

/// Arguments of every command that turns a mesh into a field.
struct FieldArguments {
  GridOptions grid;
  std::vector<double> bounds;
  std::vector<int> shape;
  std::filesystem::path offsets;
  FieldOptions options;
  FieldOptions asked;  ///< Those of the command line, before --thickness takes the place of the sign.
  MachineOptions machine;
  MeshUnits units;
};

/// Adds the options of all of them, in groups, to a command.
void addFieldOptions(Command& command, FieldArguments& arguments);

// Add some of them.
void addSpacingOptions(Command& command, GridOptions& grid);
void addMethodOptions(Command& command, FieldArguments& arguments);
void addGridOptions(Command& command, FieldArguments& arguments);
/// Adds the limit, which holds for all of the process from the end of parsing on.
void addMemoryLimit(Command& command, size_t& limit);
void addCpuOptions(Command& command, MachineOptions& machine);
void addMachineOptions(Command& command, MachineOptions& machine);

/// Converts arguments given as text into `grid` and `options`. Throws `Error(Usage)` if they contradict each
/// other.
void finishFieldArguments(FieldArguments& arguments);

/// Returns the options with progress on `line`, which must outlive them, and warnings on stderr. `title`
/// begins the name of each stage.
MachineOptions withProgress(MachineOptions machine, ProgressLine& line, const std::string& title = "");

/// Returns the extensions of meshes and fields that can be read.
std::vector<std::string> meshAndFieldExtensions();

/// Makes the field of a mesh on a grid.
Field makeField(const Mesh& mesh, const Grid& grid, const FieldArguments& arguments);

/// Reads a field, or reads a mesh and makes its field. A large level set is read as a narrow band. `format`
/// counts if the file's name does not tell, and `grid` names the grid to read. A mesh is turned to the axis
/// that is up in the file to write, `result`, if there is one.
Field loadOrMakeField(const std::filesystem::path& path, const FieldArguments& arguments,
                      const std::string& format, const std::string& grid,
                      const std::filesystem::path& result);

}  // namespace raymap
