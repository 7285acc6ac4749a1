#pragma once

#include <raymap/export.h>
#include <raymap/field.h>
#include <raymap/machine.h>
#include <raymap/region.h>

#include <string_view>

namespace raymap {

/// How wide a narrow band is, and which arrays it has besides the distance.
struct BandOptions {
  double outside = 3.0;     ///< Width of the band outside of the surface, in samples.
  double inside = 3.0;      ///< Width of the band inside, in samples; infinite for the whole interior.
  bool triangle = false;    ///< Whether to compute closest triangles.
  bool winding = false;     ///< Whether to compute winding numbers. Needs a sign.
  bool confidence = false;  ///< Whether to compute the confidence in the sign. Needs a sign.
};

/// A field, and the name of its grid in a file.
struct NamedField {
  std::string_view name;
  const Field* field = nullptr;
};

/// Throws `Error(Usage)` unless the grid makes sense and each array that is not empty has its values: one per
/// sample, or 512 per leaf. A narrow band must have positive widths, and leaves and tiles in their order on
/// the grid. Fields from this library are valid.
RAYMAP_API void validate(const Field& field);

/// Returns the field of all samples of a narrow band. Distances are those of `Field::distanceAt`.
/// `clampDistance` is the smaller of both widths: on the wider side, distances beyond it are kept, and are
/// right. Samples in no leaf have `kNoTriangle` and NaN for winding number and confidence. `machine.threads`
/// and `memoryLimit` are used. Throws `Error`: Usage for a field that is no narrow band or not valid, Memory
/// if the field does not fit.
RAYMAP_API Field toDense(const Field& band, const MachineOptions& machine = {});
/// Returns the field of a box of samples. Throws `Error(Usage)`, too, if it does not lie on the grid.
RAYMAP_API Field toDense(const Field& band, const Region& region, const MachineOptions& machine = {});

/// Returns the samples of a field near its surface, as a narrow band. Leaves are those cubes of 8 x 8 x 8
/// samples that have an active sample, or samples of both sides. Distances are clamped to the band.
/// `machine.threads` and `memoryLimit` are used. Throws `Error`: Usage for a field that is a narrow band
/// already, a band that makes no sense or is wider than the field's `clampDistance`, and for arrays that the
/// field lacks; Input if a distance is NaN; Memory.
RAYMAP_API Field toSparse(const Field& field, const BandOptions& options = {},
                          const MachineOptions& machine = {});

}  // namespace raymap
