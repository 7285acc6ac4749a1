#pragma once

#include <raymap/field.h>

#include <filesystem>
#include <string>

namespace raymap {

/// Returns the box of the outermost samples.
Box boxOf(const Grid& grid);

/// Returns the array that a file holds: the distance, or one that `generate` wrote by itself. A narrow band
/// has distances.
FieldArray heldArray(const Field& field);

/// Throws `Error(Usage)` if a file holds another array instead of distances.
void requireDistances(const std::filesystem::path& path, const Field& field);

/// Returns the array to show: the one named by --as, or the file's own if `as` is empty. A file that has only
/// one array of floats holds what --as says: a .npy keeps no name. Throws `Error(Usage)` if the file has no
/// such array.
FieldArray chooseArray(const std::filesystem::path& path, const std::string& as, Field& field);

}  // namespace raymap
