#pragma once

#include <raymap/animation.h>
#include <raymap/callbacks.h>
#include <raymap/field.h>
#include <raymap/mesh.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace raymap {

/// Reads OBJ, PLY, STL, OFF, glTF/GLB, 3MF, FBX or DAE, told apart by extension (content for STL kinds).
/// Node transforms and instances are applied, polygons cut into triangles, several meshes joined.
/// Throws `Error(File)` or `Error(Input)` naming the file, the element and the value.
Mesh readMesh(const std::filesystem::path& path, const WarningCallback& warn = {});

/// Reads a glTF or GLB file with its skins and one of its animations; without any, the mesh stands still. Of
/// more than four joints of a vertex the four that count most are kept; morphs stay at rest. Throws as
/// `readMesh` does.
AnimatedMesh readAnimatedMesh(const std::filesystem::path& path, size_t animation = 0,
                              const WarningCallback& warn = {});

/// Writes .ply (binary), .obj, .stl (binary) or .glb by extension, whole or not at all like `writeField`. An
/// STL has single precision and no shared vertices; the others give back the very mesh.
void writeMesh(const std::filesystem::path& path, const Mesh& mesh);

/// File name endings, with the dot and in lower case, that `readMesh`, `writeMesh`, and `readField` and
/// `writeField` know.
std::vector<std::string> meshExtensions();
std::vector<std::string> writableMeshExtensions();
std::vector<std::string> fieldExtensions();

/// Reads .nrrd, .npz, .npy, .vti or .vdb. A .npy has no grid: origin 0, spacing 1.
Field readField(const std::filesystem::path& path);

/// Writes .nrrd, .npz, .npy, .vti or .vdb by extension: beside the target first, then renamed, so that the
/// file appears whole or not at all. `name` selects the array: distance, winding, confidence or triangle.
void writeField(const std::filesystem::path& path, const Field& field, std::string_view name = "distance");

}  // namespace raymap
