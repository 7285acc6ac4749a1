#pragma once

#include <raymap/narrow_band.h>

#include <optional>

#include "cpu/points/prepared_surface.h"
#include "field/field_sampler.h"
#include "method/close_holes_patch.h"

namespace raymap {

/// A narrow band, and the surface that closes the holes of its mesh.
struct ClosedBand {
  Field field = {};
  size_t patchTriangles = 0;
  double patchArea = 0.0;  ///< In the mesh's units squared.
};

/// Returns a narrow band of a signed surface. If `closesHoles`, its distances lead to the surface that closes
/// holes, too, as those of `FieldOptions::closeHoles`; but where holes reach over more than 2^32 samples,
/// they close in steps. The surface and the band take at most `most` bytes.
ClosedBand makeClosedBand(const cpu::PreparedSurface& surface, const Grid& grid, const BandOptions& options,
                          bool closesHoles, size_t most, Progress& progress);

/// Returns the distances of a narrow band to all points less than `radius` from a mesh, `width` beyond them.
Field makePlateBand(const PackedMesh& mesh, const Grid& grid, double radius, double width, size_t most,
                    Progress& progress);

/// Unites a solid with another on the same grid, which has no tiles. Both are narrow bands.
void unite(Field& solid, const Field& other);

/// Interpolates the distances of a solid, dense or a narrow band, at points in samples. From any thread.
class SolidSampler {
 public:
  /// Keeps references to the solid and its samples, which must not change.
  explicit SolidSampler(const Field& solid) {
    if (solid.narrow)
      band_.emplace(solid);
    else
      dense_.emplace(solid);
  }

  double value(const glm::dvec3& p) const { return band_ ? band_->value(p) : dense_->value(p); }

 private:
  std::optional<FieldSampler> dense_;
  std::optional<SparseSampler> band_;
};

}  // namespace raymap
