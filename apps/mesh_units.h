#pragma once

#include <raymap/io.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

namespace raymap {

/// Options of a command that reads a mesh and writes one: what its numbers mean.
struct MeshUnits {
  std::string unit;  ///< Unit of all lengths; empty: that of the mesh's file.
  double scale = 1.0;
  std::string up;  ///< "y" or "z"; empty: the mesh is not turned.

  bool areGiven() const { return !unit.empty() || scale != 1.0 || !up.empty(); }
};

void addMeshUnits(CLI::App& command, MeshUnits& units);

/// Throws `Error(Usage)` if the options contradict the file to write.
void checkMeshUnits(const MeshUnits& units, const std::filesystem::path& result);

/// Returns the unit of the lengths of the converted mesh, if it is known.
std::optional<LengthUnit> unitOf(const MeshUnits& units, const std::filesystem::path& mesh);

/// Returns the unit that a file of the converted mesh states.
LengthUnit writtenUnit(const MeshUnits& units, const std::filesystem::path& mesh);

/// Returns the direction down in a file to write: y is up in a .glb, else z.
glm::dvec3 downIn(const std::filesystem::path& result);

/// Brings a mesh to the unit, the scale and the axis of the file to write. Warns if that format's unit is
/// another one than the mesh's.
void convertUnits(Mesh& mesh, const MeshUnits& units, const std::filesystem::path& from,
                  const std::filesystem::path& result);

/// Returns the path of a file with the format that --format names appended. Its extension tells the format.
std::filesystem::path named(const std::filesystem::path& path, const std::string& format);

/// Returns "mm" or another name as `--unit` takes it.
std::string nameOf(LengthUnit unit);

}  // namespace raymap
