#pragma once

#include <raymap/raymap.h>

#include <filesystem>
#include <limits>
#include <vector>

#include "testing/broken_meshes.h"
#include "testing/shapes.h"

namespace raymap {

/// Reads a level set as a narrow band.
inline Field readBand(const std::filesystem::path& path, ReadOptions options = {}) {
  options.levelSet = LevelSet::Narrow;
  return readField(path, options);
}

/// Bands of a torus with holes on a lattice around it and on one that cuts it, and of a ball with tiles.
inline std::vector<Field> someBands() {
  std::vector<Field> bands;
  const Mesh mesh = withHoles(shapes::torus(1.0, 0.35, 40, 20), 3, 0.2, 7);
  const Surface surface(mesh);
  const Box part{{-0.5, -0.4, -0.2}, {1.2, 1.1, 0.3}};
  for (const Grid& grid :
       {fitGrid(mesh, {.resolution = 60}), fitGrid(mesh, {.voxelSize = 0.04, .box = part})})
    for (const BandOptions& options :
         {BandOptions{.triangle = true, .winding = true, .confidence = true},
          BandOptions{.outside = 1.5, .inside = 4.25},
          BandOptions{.outside = 4.0, .inside = std::numeric_limits<double>::infinity()}})
      bands.push_back(surface.generateBand(grid, options));
  const Mesh ball = shapes::sphere(1.0, 3);
  bands.push_back(Surface(ball).generateBand(fitGrid(ball, {.resolution = 120})));
  return bands;
}

}  // namespace raymap
