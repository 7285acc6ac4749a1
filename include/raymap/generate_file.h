#pragma once

// Fields in files. A field that memory does not hold is made in pieces, which are written one after another.

#include <raymap/export.h>
#include <raymap/generate.h>
#include <raymap/io.h>
#include <raymap/region.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace raymap {

/// How a field is made: in one piece or in many.
struct FieldPlan {
  FieldForm form = FieldForm::Whole;  ///< Pieces in which it is made.
  int planes = 0;                     ///< Number of planes along z that are made at a time.
  /// Most bytes that its samples take at a time, in slabs with the work on them; 0 for a narrow band, whose
  /// bytes grow with the surface.
  size_t bytes = 0;
};

/// Files of a field, and how they are written. An empty path is not wanted; only that of the distance must be
/// there.
struct FieldFiles {
  /// Distances. All but a .npy and a .nrrd hold the other arrays of the options, too.
  std::filesystem::path distance = {};
  std::filesystem::path triangle = {};    ///< Closest triangles, which are then computed.
  std::filesystem::path winding = {};     ///< Winding numbers, which are then computed.
  std::filesystem::path confidence = {};  ///< Confidence in the sign, which is then computed.
  std::string format = {};                ///< Extension that is used where a path has none that is known.
  std::string gridName = {};              ///< Name of the distance's grid in a .vdb or .nvdb; empty: its own.
  /// Whether numbers take 16 bits, in files that can store them; see `FieldWriteOptions`. The file of the
  /// distance must be one.
  bool half = false;
  /// Whether only distances outside are clamped to the band. Such a field is a narrow band of a `Surface`.
  bool fullInside = false;
  /// Whether all samples must be in memory at the end, for `FileGenerator::field`.
  bool keepsField = false;
  /// Called with the plan when the work begins; again if memory does not hold a whole field after all, so
  /// that it is made in slabs.
  std::function<void(const FieldPlan& plan)> planned = {};
};

/// Report of `generateFile`.
struct FileReport {
  FieldPlan plan = {};  ///< How the field was made.
  Stats stats = {};     ///< Costs, and findings about the mesh.
};

/// Returns how `FileGenerator::make` begins with a field.
///
/// - A narrow band: for a `band` and a .vdb or .nvdb of more than 2^24 samples, or with `fullInside`.
/// - Slabs: for a .npy, .nrrd or .vti with numbers of 32 bits, if memory does not hold all samples.
/// - Else the whole field, as by `raymap::generate`.
///
/// Narrow bands and slabs are made by a `Surface`: on the CPU, with exact distances and the sign `Harmonic`,
/// without `closeHoles`, `invert` and `thickness`; a narrow band without further arrays. All else is whole.
/// Uses only the limits of memory of `machine`, and whether it names a GPU. Throws `Error(Usage)` for files
/// that make no sense.
RAYMAP_API FieldPlan planFile(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                              const FieldFiles& files, const MachineOptions& machine = {});

/// Makes fields for files, and keeps its memory and its device between calls, for meshes that change every
/// frame. Used by one thread at a time.
class RAYMAP_API FileGenerator {
 public:
  /// Makes a field as `planFile` says; in slabs, if memory does not hold it otherwise. Writes the files of
  /// slabs, which go on from what an earlier call has left there; see `writeFieldInSlabs`. All of `machine`
  /// is used. Throws `Error` as `planFile`, `Generator::generate`, `Surface` and `writeFieldInSlabs` do.
  FileReport make(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                  const FieldFiles& files, const MachineOptions& machine = {});
  /// Does the same, and may take the mesh, to free it early.
  FileReport make(Mesh&& mesh, const Grid& grid, const FieldOptions& options, const FieldFiles& files,
                  const MachineOptions& machine = {});
  /// Writes the files of the last field, unless that was written in slabs or failed. Throws `Error` as
  /// `writeField` does.
  void write() const;

  /// Returns the last field; an empty one if it was made in slabs.
  const Field& field() const { return field_; }

 private:
  FileReport run(const MeshView& mesh, Mesh* taken, const Grid& grid, const FieldOptions& asked,
                 const MachineOptions& machine);

  Generator generator_;
  FieldFiles files_;
  FieldForm form_ = FieldForm::Slabs;
  Field field_;
};

/// Makes a field and writes its files. The file of a whole field has the bytes that `writeField` writes of
/// `raymap::generate`; one in slabs, those of `Surface::generateRegion`. Each file appears whole or not at
/// all. Throws `Error` as `FileGenerator` does.
RAYMAP_API FileReport generateFile(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                                   const FieldFiles& files, const MachineOptions& machine = {});

/// Writes the field of all samples of a narrow band, as `writeField` writes that of `toDense`. In a .npy,
/// .nrrd or .vti with numbers of 32 bits it need not fit into memory. Throws `Error` as these do, and as
/// `writeFieldInSlabs` does.
RAYMAP_API void writeDense(const std::filesystem::path& path, const Field& band,
                           const FieldWriteOptions& options = {});

}  // namespace raymap
