#pragma once

#include <raymap/field.h>
#include <raymap/io.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "parser.h"

namespace raymap {

/// Units of the numbers of a file, and where the mesh lies. Vectors are empty if they are not given.
struct MeshUnits {
  std::string from;  ///< Unit of the file's numbers; empty: the one that its format has.
  std::string to;    ///< Unit of all lengths, for a file whose unit is known; empty: that of the file.
  std::string unit;  ///< The same; a file without a unit is taken to be in it.
  double scale = 1.0;
  std::optional<double> height;   ///< Takes the place of `scale`: how high the mesh becomes.
  std::vector<double> fit;        ///< The same: sides of the box that it fits into.
  std::vector<double> up;         ///< Direction that is up; empty: the mesh is not turned.
  std::vector<double> rotate;     ///< Degrees about x, then y, then z.
  std::vector<double> translate;  ///< In the unit of the result.
  std::vector<double> upright;    ///< Direction that is up in a picture of a mesh that is not turned.
  bool recenter = false;
};

/// Adds `--from`, `--to`, `--unit`, `--scale`, `--height`, `--fit`, `--rotate` and `--translate`.
void addUnitOptions(Command& command, MeshUnits& units);

/// Adds those, `--up` and `--recenter` to a command that writes a mesh.
void addMeshOutputOptions(Command& command, MeshUnits& units);

/// Adds the options of a command that makes a mesh of a mesh: both files, their formats, figures and units.
template <class Arguments>
void addMeshFileOptions(Command& command, Arguments& arguments) {
  addOperand(command, "MESH...", &arguments.meshes,
             "Mesh to read: OBJ, PLY, STL, OFF, glTF, GLB, 3MF, FBX or DAE. Several need a folder as output");
  Argument& output = addOutput(command, arguments.result, "Mesh to write", writableMeshExtensions());
  output.isRequired = true;
  output.help += "; or a folder, for a mesh of each input, with its name";
  addOptions(command, {{"--format", &arguments.format.given}});
  addFigureOptions(command, arguments.stats);
  addOptions(command, {{"--overwrite", &arguments.format.mayOverwrite}});
  addMeshOutputOptions(command, arguments.units);
}

/// Returns the names of units, as `--unit` takes them.
std::vector<std::string> unitNames();

/// Throws `Error(Usage)` if the options contradict the file to write.
void checkMeshUnits(const MeshUnits& units, const std::filesystem::path& result);

/// Warns of a length of an option that exceeds the whole shape: its unit is probably another one.
void warnOfLength(const char* option, double length, const Box& shape);

/// Returns the unit of the lengths of the converted mesh, if it is known.
std::optional<LengthUnit> unitOf(const MeshUnits& units, const std::filesystem::path& mesh);

/// Returns the unit that a file of the converted mesh states.
LengthUnit writtenUnit(const MeshUnits& units, const std::filesystem::path& mesh);

/// Returns the direction down in a file: y is up in a glTF or DAE, and in a FBX from most programs, else z.
glm::dvec3 downIn(const std::filesystem::path& file);

/// Returns which way is up in a file, and why: "y, as in every .glb".
std::string describeUp(const std::filesystem::path& file);

/// A mesh in double precision.
struct DoubleMesh {
  std::vector<glm::dvec3> vertices;
  std::vector<glm::uvec3> triangles;
  glm::dvec3 origin{0.0};

  operator MeshView() const { return {vertices, triangles, origin}; }
};

/// Turns, scales and moves a mesh, in this order. Returns the factor beside that of the units. Throws
/// `Error(Usage)` if `to` is given and the unit of the file is not known.
double convertUnits(Mesh& mesh, const MeshUnits& units, const std::filesystem::path& from);
/// Turns it to the axis that is up in the file to write, too. Warns if that format's unit is another one than
/// the mesh's.
double convertUnits(Mesh& mesh, const MeshUnits& units, const std::filesystem::path& from,
                    const std::filesystem::path& result);
double convertUnits(DoubleMesh& mesh, const MeshUnits& units, const std::filesystem::path& from,
                    const std::filesystem::path& result);
/// Scales and moves a field. Throws `Error(Usage)` if the options would turn it, or as above.
void convertUnits(Field& field, const MeshUnits& units, const std::filesystem::path& from);

// Read a file as the functions of terminal.h do, and convert it.
std::variant<Mesh, Field> loadMeshOrField(const std::filesystem::path& path, const std::string& format,
                                          const std::string& grid, const MeshUnits& units);
Mesh loadMesh(const std::filesystem::path& path, const std::string& format, const MeshUnits& units,
              bool allowEmpty = false);

/// Returns the path of a file with the format that --format names appended. Its extension tells the format.
std::filesystem::path named(const std::filesystem::path& path, const std::string& format);

/// Returns "mm" or another name as `--unit` takes it.
std::string nameOf(LengthUnit unit);

}  // namespace raymap
