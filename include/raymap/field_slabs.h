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

/// How to write a field in slabs of planes along z.
struct SlabOptions {
  int thickness = 1;  ///< Most planes of a slab.
  FieldArray array = FieldArray::Distance;
  std::string_view format = {};  ///< Extension that counts where the path has none that is known.
  /// Text that names all that the samples depend on besides their positions, such as a hash of the mesh. With
  /// it, a call that fails or is killed leaves `PATH.part`, and `PATH.part.done`, which says how much of it
  /// is whole. The next call with the same text and grid goes on from there.
  std::string key = {};
  WarningCallback warn = {};  ///< Called if an earlier part file is not used, or one is left.
};

/// Function that returns the planes [begin, end) of a field along z, as a field with the array to write.
using PlaneSource = std::function<Field(int begin, int end)>;

/// Writes one array of a field that need not fit into memory as .nrrd, .npy or .vti. Asks for the slabs in
/// order. `about` tells what else the file holds; its arrays do not count. The bytes are those that
/// `writeField` writes of the whole field with this array alone. The file appears whole or not at all. Throws
/// `Error`: Usage for another extension, a grid or a thickness that makes no sense, or planes that do not fit
/// the grid; File, also if the disk has not space enough or another call writes `PATH.part`; what `planes`
/// throws.
RAYMAP_API void writeFieldInSlabs(const std::filesystem::path& path, const Field& about,
                                  const PlaneSource& planes, const SlabOptions& options = {});

/// Returns the extensions that `writeFieldInSlabs` knows.
RAYMAP_API std::vector<std::string> slabExtensions();

}  // namespace raymap
