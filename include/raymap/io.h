#pragma once

#include <raymap/animation.h>
#include <raymap/callbacks.h>
#include <raymap/field.h>
#include <raymap/mesh_attributes.h>
#include <raymap/mesh_view.h>
#include <raymap/narrow_band.h>
#include <raymap/query.h>
#include <raymap/sample.h>
#include <raymap/sample_points.h>
#include <raymap/units.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace raymap {

// A path may be a pipe, /dev/stdin, /dev/stdout or /dev/fd/N. Where a path has no extension that is known,
// `format` is used in its place: an extension, such as ".stl". Without either, a file to read is recognised
// by its first bytes, if these leave no doubt.

/// As what a level set of a .vdb or .nvdb is read.
enum class LevelSet {
  Dense,         ///< A field of all samples.
  Narrow,        ///< A narrow band; a file without a level set is refused.
  NarrowIfLarge  ///< A narrow band if it has more than 2^24 samples.
};

/// How to read a file.
struct ReadOptions {
  std::string_view format = {};    ///< Extension that is used where the path has none that is known.
  WarningCallback warn = {};       ///< Called with what is odd in the file, but does not stop the call.
  bool allowEmpty = false;         ///< Whether a mesh may have no triangles; see `FieldOptions`.
  std::string_view gridName = {};  ///< Grid to read of a .vdb or .nvdb; empty: the first level set.
  LevelSet levelSet = LevelSet::Dense;
  /// Further arrays of a .npz that the caller reads, so that no warning says that they are left out.
  std::span<const std::string_view> alsoRead = {};
  /// Receives all positions of a mesh in double precision, if the returned mesh rounds any; else it is
  /// emptied.
  std::vector<glm::dvec3>* exact = nullptr;
  /// Receives what the mesh file says beside positions and triangles.
  MeshAttributes* attributes = nullptr;
};

/// Reads OBJ, PLY, STL, OFF, glTF/GLB, 3MF, FBX or DAE. The extension decides which; text and binary STL
/// differ by content. Applies node transforms and instances, cuts polygons into triangles, joins all meshes
/// of the file. Positions are as the file has them; those of a 3MF are in millimetres. Throws `Error`: File,
/// Memory, or Input that names the file, the element and the value; Unsupported.
RAYMAP_API Mesh readMesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads a glTF or GLB file with its skins, its morph targets and one of its animations; a mesh without any
/// stands still. Keeps the four joints of a vertex that have the largest weights. Throws as `readMesh` does.
RAYMAP_API AnimatedMesh readAnimatedMesh(const std::filesystem::path& path, size_t animation = 0,
                                         const ReadOptions& options = {});
/// Reads the animation with this name, or else with this number, from 0 on; the first if `clip` is empty,
/// with a warning if there are several. Throws `Error`: Usage, which lists the names, if there is none such;
/// Input if it moves nothing.
RAYMAP_API AnimatedMesh readAnimatedMesh(const std::filesystem::path& path, const std::string& clip,
                                         const ReadOptions& options = {});

/// How to write a mesh.
struct MeshWriteOptions {
  glm::dvec3 offset{0.0};  ///< Subtracted from every position. Unless it is 0, the file notes it.
  LengthUnit unit = LengthUnit::Millimetre;  ///< Unit that a .3mf states for the mesh's lengths.
  std::string_view format = {};  ///< Extension that is used where the path has none that is known.
  WarningCallback warn = {};     ///< Called if the format moves vertices or has no place for attributes.
  const MeshAttributes* attributes = nullptr;  ///< Attributes of the mesh, as far as the format has them.
};

/// Writes .ply (binary), .obj, .stl (binary), .glb or .3mf by extension. The file appears whole or not at
/// all. An STL has single precision and no shared vertices; a .glb has single precision about an origin. The
/// other formats keep every position, also those of a view in double precision.
/// Warns if single precision moves a vertex by more than 1e-5 of the longest side of the mesh's bounds, and
/// of attributes that are not in the file: an .obj and a .glb hold all, a .ply colours and texture
/// coordinates of vertices. An .obj and a .glb lack how each other's materials look. A .3mf joins equal
/// positions if no triangles share a vertex (as those of an STL), leaves out triangles that name a vertex
/// twice, as its standard demands; its title is the file's name. Throws `Error`: Usage for another extension
/// or an offset that is not finite, Input (see `validate`), File, Unsupported if the format cannot hold so
/// many triangles.
RAYMAP_API void writeMesh(const std::filesystem::path& path, const MeshView& mesh,
                          const MeshWriteOptions& options = {});

/// Returns a mesh as `writeMesh` would round it for this extension, moved back by the offset. Far from 0,
/// rounding can make faces degenerate. Throws `Error(Usage)` for another extension or an offset that is not
/// finite, Input (see `validate`).
RAYMAP_API Mesh asStored(const std::filesystem::path& path, const MeshView& mesh,
                         const MeshWriteOptions& options = {});

/// Returns the unit of the lengths that `readMesh` gives for a file of this extension: millimetres for .3mf,
/// metres for .gltf, .glb and .dae. The other formats state none.
RAYMAP_API std::optional<LengthUnit> meshUnit(const std::filesystem::path& path);

/// Returns the file name extensions that `readMesh` knows, with the dot and in lower case.
RAYMAP_API std::vector<std::string> meshExtensions();
/// Returns those that `writeMesh` knows.
RAYMAP_API std::vector<std::string> writableMeshExtensions();
/// Returns those that `readField` and `writeField` know.
RAYMAP_API std::vector<std::string> fieldExtensions();

/// Reads .nrrd, .npz, .npy, .vti, .vdb or .nvdb. A .npy has no grid: its origin is 0, its spacing 1. Warns of
/// arrays of the file that a field has no place for.
///
/// `levelSet` decides whether a level set of a .vdb or .nvdb, whichever program wrote it, is read as a narrow
/// band. Time and memory then grow with its leaves. Every sample has the value that OpenVDB gives.
///
/// Narrow bands of `writeField` come back bit for bit, unless distances have 16 bits. Tiles come as the
/// largest cubes that there are. The lattice of another program's grid begins and ends with whole leaves of 8
/// samples, so it may be larger than that of a dense field. Its widths are the background outside, and the
/// least inactive value inside. If none is inactive there, the band has the same width inside, or none if a
/// value is deeper. Arrays of a field of all samples are kept in its leaves alone.
///
/// Warns of grids that are not read, unless one is named. Throws `Error`: Usage for another extension or a
/// name that no grid has, which lists the names; Unsupported for a grid that is turned, mirrored or not of
/// cubes, and, as a narrow band, for one that is no level set of floats or has more than 2^24 samples along
/// an axis; File, Input, Memory.
RAYMAP_API Field readField(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads a mesh or a field, whichever the file holds, as `readMesh` and `readField` do.
RAYMAP_API std::variant<Mesh, Field> read(const std::filesystem::path& path, const ReadOptions& options = {});

/// How to write a field.
struct FieldWriteOptions {
  /// Array to write. With the distance, all but .npy and .nrrd hold all other arrays of the field too.
  FieldArray array = FieldArray::Distance;
  std::string_view format = {};    ///< Extension that is used where the path has none that is known.
  std::string_view gridName = {};  ///< Name of the array's grid in a .vdb or .nvdb; empty: its own.
  /// Whether a .vdb, .nvdb, .npy or .npz stores numbers that are not whole in 16 bits: a .nvdb as NanoVDB's
  /// Fp16, each off by at most 1/131070 of the range of values in its leaf of 8 x 8 x 8 samples; the others
  /// as half floats, each off by at most 1/2048 of itself. Distances that are closer to 0 may change their
  /// sign.
  bool half = false;
};

/// Writes one array of a field as .nrrd, .npz, .npy, .vti, .vdb or .nvdb. The file appears whole or not
/// at all. Throws `Error`: Usage for another extension, an array that the field does not have or a grid
/// without samples or with numbers that are not finite, a name or 16 bits for a format without, half floats
/// for distances beyond 65472 or samples closer than 0.0001, and 16 bits in a .nvdb for numbers that are not
/// finite or beyond 1e38; File.
///
/// A narrow band is written with all its arrays as .vdb or .nvdb. Memory and file grow with the surface.
/// Throws Usage for another extension or array than the distance, too, and Unsupported in a build without
/// OpenVDB.
RAYMAP_API void writeField(const std::filesystem::path& path, const Field& field,
                           const FieldWriteOptions& options = {});

/// Writes several narrow bands as grids of one file; `ReadOptions::gridName` chooses one. The further arrays
/// of a band 'body' are grids as 'body.winding', and are read with it. Throws as `writeField` does, and Usage
/// if there is no band, a field is none, two grids have one name or one has none, and for
/// `FieldWriteOptions::gridName`.
RAYMAP_API void writeFields(const std::filesystem::path& path, std::span<const NamedField> bands,
                            const FieldWriteOptions& options = {});

/// Reads points in double precision, in the order of the file:
/// - .csv: columns x, y and z of a header row; without one, three columns. Separated by commas, semicolons or
///   blanks.
/// - .xyz, .txt: the same; without a header the first three columns.
/// - .npy: shape (N, 3), or any whose last axis has length 3, then in C order.
/// - .ply: the vertices, whether there are faces or not.
///
/// NaN and infinities are numbers. Throws `Error`: Usage for another extension, File, Memory, Unsupported, or
/// Input that names the file, the line and the value.
RAYMAP_API std::vector<glm::dvec3> readPoints(const std::filesystem::path& path,
                                              const ReadOptions& options = {});

/// How to write the results of a query.
struct QueryWriteOptions {
  bool colour = false;  ///< Whether a .ply gets the colour of each distance, as in slices of a field.
  std::string_view format = {};  ///< Extension that is used where the path has none that is known.
  /// Arrays of a result without points, which does not tell what was asked for.
  std::vector<std::string> arrays = {"distance"};
};

/// Writes all arrays of a result, by extension:
/// - .csv: a row per point, x, y, z first. No triangle is -1.
/// - .npy: the only array, without the points.
/// - .npz: every array under its name, without the points.
/// - .ply: vertices with the arrays as properties. Numbers have single precision, positions double.
///
/// The file appears whole or not at all. Throws `Error`: Usage for another extension, or for results that do
/// not fit the points or the format; File.
RAYMAP_API void writeQuery(const std::filesystem::path& path, std::span<const glm::dvec3> points,
                           const QueryResult& result, const QueryWriteOptions& options = {});

/// Writes samples of a field in the same way. Throws as `writeQuery` does.
RAYMAP_API void writeSamples(const std::filesystem::path& path, std::span<const glm::dvec3> points,
                             const Samples& samples, const QueryWriteOptions& options = {});

/// Writes points with distances, by extension:
/// - .npz: `pos` and `neg`, the `sampleRows` of points that are not inside and that are, as DeepSDF reads
/// them;
///   `centre` and `scale`.
/// - .csv, .ply: the points in their order, with distances and gradients, as `writeQuery` writes them.
///
/// `format` is used if the path has no extension that is known. The file appears whole or not at all. Throws
/// `Error`: Usage for another extension, File.
RAYMAP_API void writePointSamples(const std::filesystem::path& path, const PointSamples& samples,
                                  std::string_view format = {});

/// Returns the extensions that `readPoints` knows.
RAYMAP_API std::vector<std::string> pointExtensions();
/// Returns those that `writeQuery` knows.
RAYMAP_API std::vector<std::string> queryExtensions();
/// Returns those that `writePointSamples` knows.
RAYMAP_API std::vector<std::string> sampleExtensions();

}  // namespace raymap
