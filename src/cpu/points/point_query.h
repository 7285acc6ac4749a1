#pragma once

#include "cpu/points/prepared_surface.h"

namespace raymap::cpu {

/// Answers a query with all threads of the caller's arena.
void queryPoints(const PreparedSurface& surface, const PointsView& points, const QueryOptions& options,
                 Progress& progress, QueryResult& result);
/// Does the same for a surface that is taken to have no sign.
void queryUnsigned(const PreparedSurface& surface, const PointsView& points, const QueryOptions& options,
                   Progress& progress, QueryResult& result);

/// Winding numbers, and how far each may be wrong: infinite if only its side of the threshold is known.
struct DoubtfulNumbers {
  Buffer<double> winding, doubt;
};

/// Finds winding numbers at the points as fast as their side of the threshold.
void queryNumbers(const PreparedSurface& surface, const PointsView& points, Progress& progress,
                  DoubtfulNumbers& numbers);

}  // namespace raymap::cpu
