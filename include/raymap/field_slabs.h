#pragma once

#include <raymap/callbacks.h>
#include <raymap/export.h>
#include <raymap/field.h>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace raymap {

/// A file of a field that is written in slabs.
struct SlabFile {
  std::filesystem::path path = {};
  std::vector<FieldArray> arrays = {FieldArray::Distance};  ///< Only a .vti holds several.
};

/// How to write a field in slabs of planes along z.
struct SlabOptions {
  int planes = 1;                ///< Most planes of a slab.
  std::string_view format = {};  ///< Extension that is used where a path has none that is known.
  /// Text that names all that the samples depend on besides their positions, such as a hash of the mesh. With
  /// it, a call that fails or is killed leaves `PATH.part`, and `PATH.part.done`, which says how much of it
  /// is whole. The next call with the same text, grid and files goes on from there.
  std::string key = {};
  WarningCallback warn = {};  ///< Called if an earlier part file is not used, or one is left.
};

/// Function that returns the planes [begin, end) of a field along z, as a field with the arrays to write.
using PlaneSource = std::function<Field(int begin, int end)>;

/// Writes a field that need not fit into memory into one file or several, as .nrrd, .npy or .vti. Asks for
/// the slabs in order, once for all files. `about` tells what else the files hold; its arrays are not used.
/// The bytes are those that `writeField` writes of the whole field with these arrays alone. Each file appears
/// whole or not at all. Throws `Error`: Usage for another extension, several arrays for a format or a pipe
/// that has a place for one, a grid or a number of planes that makes no sense, or planes that do not fit the
/// grid; File, also if the disk has not space enough or another call writes `PATH.part`; what `planes`
/// throws.
RAYMAP_API void writeFieldInSlabs(const std::vector<SlabFile>& files, const Field& about,
                                  const PlaneSource& planes, const SlabOptions& options = {});

/// Returns the extensions that `writeFieldInSlabs` knows.
RAYMAP_API std::vector<std::string> slabExtensions();

}  // namespace raymap
