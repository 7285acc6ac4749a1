#pragma once

// The rules by which a field is made whole, as a narrow band or in slabs.

#include <raymap/field_slabs.h>
#include <raymap/generate_file.h>

#include <string>
#include <vector>

namespace raymap {

/// Returns the options with the arrays that have files of their own.
FieldOptions withArraysOf(const FieldFiles& files, FieldOptions options);

/// Returns the files of a field, that of the distance first, with the arrays that slabs write into each.
std::vector<SlabFile> slabFiles(const FieldFiles& files, const FieldOptions& options);

/// Returns whether a field may be made in slabs. The options have the arrays of the files.
bool maySlabs(const MeshView& mesh, const FieldOptions& options, const FieldFiles& files,
              const MachineOptions& machine);

/// Returns the plan of a field in slabs, few enough planes each for the memory left. `held` is what a call
/// holds already.
FieldPlan planSlabs(const Grid& grid, const FieldOptions& options, const MachineOptions& machine,
                    size_t held = 0);

/// Returns how a field is made. The options have the arrays of the files. `held` is what its arrays hold
/// already.
FieldPlan planField(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                    const FieldFiles& files, const MachineOptions& machine, size_t held = 0);

/// Returns what a region has of a field with these options.
RegionOptions regionOptions(const FieldOptions& options);

/// Returns a text that names all that the samples of a field of a surface depend on besides their positions.
/// The mesh is packed, as a `Surface` keeps it.
std::string keyOf(const MeshView& mesh, const FieldOptions& options);

}  // namespace raymap
