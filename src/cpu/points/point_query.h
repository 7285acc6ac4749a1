#pragma once

#include "cpu/points/prepared_surface.h"

namespace raymap::cpu {

/// Answers a query with all threads of the caller's arena.
void queryPoints(const PreparedSurface& surface, const PointsView& points, const QueryOptions& options,
                 Progress& progress, QueryResult& result);
/// Does the same for a surface that is taken to have no sign.
void queryUnsigned(const PreparedSurface& surface, const PointsView& points, const QueryOptions& options,
                   Progress& progress, QueryResult& result);

}  // namespace raymap::cpu
