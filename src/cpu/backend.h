#pragma once

#include "cell_distance.h"
#include "cell_mesh.h"
#include "crossings.h"
#include "distance_transform.h"
#include "exact_distance.h"
#include "progress.h"
#include "raster_distance.h"
#include "ray_map.h"
#include "refine.h"
#include "sign.h"
#include "voxel_grid.h"
#include "winding.h"

namespace raymap {

/// The CPU's twin of every stage of pipeline.h. Holds all buffers, and keeps them between runs.
class CpuBackend {
 public:
  void begin(const Mesh& mesh, const Grid& grid, const Options& options, Progress& progress);
  void voxelGrid();
  void cellDistance();
  void distanceTransform();
  void refine();
  void rasterDistance();
  void exactDistance();
  void crossings();
  void rayMap();
  void winding();
  void sign();
  void finish(Field& field);
};

}  // namespace raymap
