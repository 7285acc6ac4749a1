#pragma once

#include <raymap/field.h>
#include <raymap/region.h>

#include <optional>

#include "base/progress.h"
#include "cpu/points/lattice_query.h"
#include "cpu/points/prepared_surface.h"

namespace raymap::cpu {

/// Side of the cubes of samples in which regions are made. They lie at multiples of it.
inline constexpr int kRegionBlock = LatticeQuery::kDistanceSide;

/// Returns the most bytes that a region of this size holds while the caller's threads make it, or a bound of
/// them that no memory has.
size_t regionBytes(const glm::ivec3& size, const RegionOptions& options);

/// Returns the clamped distance of all samples of a region, if a few queries tell that all lie beyond the
/// band on one side.
std::optional<double> farDistance(const PreparedSurface& surface, const Grid& lattice, const Region& region,
                                  double band);

/// Returns what a surface gives at the samples of a region, which lies on the lattice.
Field makeRegion(const PreparedSurface& surface, const Grid& lattice, const Region& region,
                 const RegionOptions& options, Progress& progress);

}  // namespace raymap::cpu
