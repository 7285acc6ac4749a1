#pragma once

#include <raymap/diagnostics.h>
#include <raymap/io.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "checks.h"
#include "report.h"

namespace raymap {

/// A mesh, and how its file will hold it.
struct StoredMesh {
  std::filesystem::path path;
  MeshWriteOptions options;
  Mesh exact;                      ///< The mesh before it is rounded.
  Mesh stored;                     ///< The mesh as the file holds it, moved back by the offset.
  MeshAttributes attributes = {};  ///< Attributes of the file; to be named in `options`.
};

/// How to store a mesh.
struct StoreOptions {
  bool recenter = false;                     ///< Whether to move its centre to about 0.
  LengthUnit unit = LengthUnit::Millimetre;  ///< Unit that a .3mf states.
  std::string_view format = {};  ///< Extension that is used where the path has none that is known.
};

/// Returns how to write a mesh. Its offset is of whole multiples of a power of ten, so that people can type
/// it.
MeshWriteOptions writeOptions(const MeshView& mesh, const StoreOptions& options);

/// Rounds a mesh as the file will.
StoredMesh storeMesh(const std::filesystem::path& path, Mesh mesh, const StoreOptions& options);

/// Diagnoses the stored mesh if it differs from the exact one. Throws `Error(Unsupported)` if rounding broke
/// it. The message names formats that hold it.
void checkStored(const StoredMesh& mesh);
/// Does the same where the stored mesh is diagnosed already, and has as many pairs of faces that cross.
/// Throws if rounding made faces cross, too.
void checkStored(const StoredMesh& mesh, const Diagnostics& found, size_t crossing);

/// Throws `Error(Usage)` if a tolerance keeps all triangles while their number is limited; 0 = no limit.
void checkSimplification(const std::optional<double>& tolerance, size_t triangles);

/// Throws `Error(Usage)` if --split has no file name to number.
void checkSplit(bool isSplit, const std::filesystem::path& output);

/// Returns the inputs that outputs must not replace.
std::vector<std::filesystem::path> inputsKept(const StreamFormat& format, const std::filesystem::path& input);

/// Writes each part of a mesh that is apart (`splitParts`) into a file of its own: NAME_1.stl and so on.
/// Appends the figures of each to `written`, and numbers go on after those. Warns once of attributes that the
/// format has no place for. Throws `Error(Usage)` if a part would replace an input in `kept`.
template <class AnyMesh>
void writeParts(const std::filesystem::path& path, const AnyMesh& mesh, const MeshWriteOptions& options,
                const std::vector<std::filesystem::path>& kept, Json& written);

/// Prints a table of the parts that were written.
void printParts(const Json& written);

/// Prints the file that was written, and its offset.
void printWritten(const std::filesystem::path& path, const MeshWriteOptions& options);
/// Prints the offset alone, if there is one.
void printOffset(const MeshWriteOptions& options);

}  // namespace raymap
