#pragma once

#include <raymap/animation.h>
#include <raymap/callbacks.h>
#include <raymap/field.h>
#include <raymap/mesh_view.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace raymap {

/// Reads OBJ, PLY, STL, OFF, glTF/GLB, 3MF, FBX or DAE. The extension decides which; text and binary STL
/// differ by content. Applies node transforms and instances, cuts polygons into triangles, joins all meshes
/// of the file. Throws `Error`: File, or Input that names the file, the element and the value.
RAYMAP_API Mesh readMesh(const std::filesystem::path& path, const WarningCallback& warn = {});

/// Reads a glTF or GLB file with its skins and one of its animations; a mesh without any stands still. Keeps
/// the four joints of a vertex that have the largest weights; morph targets stay at rest. Throws as
/// `readMesh` does.
RAYMAP_API AnimatedMesh readAnimatedMesh(const std::filesystem::path& path, size_t animation = 0,
                                         const WarningCallback& warn = {});

/// Writes .ply (binary), .obj, .stl (binary) or .glb by extension. The file appears whole or not at all. An
/// STL has single precision and no shared vertices; the other formats keep every position and index. Throws
/// `Error`: Usage for another extension, Input (see `validate`), File, Unsupported if the format cannot hold
/// so many triangles.
RAYMAP_API void writeMesh(const std::filesystem::path& path, const MeshView& mesh);

/// Returns the file name extensions that `readMesh` knows, with the dot and in lower case.
RAYMAP_API std::vector<std::string> meshExtensions();
/// Returns those that `writeMesh` knows.
RAYMAP_API std::vector<std::string> writableMeshExtensions();
/// Returns those that `readField` and `writeField` know.
RAYMAP_API std::vector<std::string> fieldExtensions();

/// Reads .nrrd, .npz, .npy, .vti or .vdb. A .npy has no grid: the result has origin 0 and spacing 1. Throws
/// `Error`: Usage for another extension, File, Input, Memory, Unsupported.
RAYMAP_API Field readField(const std::filesystem::path& path);

/// Writes one array of a field as .nrrd, .npz, .npy, .vti or .vdb by extension: "distance", "winding",
/// "confidence" or "triangle". The file appears whole or not at all. Throws `Error`: Usage for another
/// extension, an array that the field does not have or a grid without samples or with numbers that are not
/// finite; File.
RAYMAP_API void writeField(const std::filesystem::path& path, const Field& field,
                           std::string_view name = "distance");

}  // namespace raymap
