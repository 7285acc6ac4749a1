#pragma once

// Krayer & Müller 2019, "Generating signed distance fields on the GPU with ray maps": the whole method, over
// any backend. Each stage is a file stem: src/cpu/<stem>.cpp, tests/<stem>_test.cpp.

#include <concepts>

#include "progress.h"

namespace raymap {

/// What a backend must offer. It holds the mesh, the grid and every intermediate result.
template <class B>
concept Backend = requires(B b, const Mesh& mesh, const Grid& grid, const Options& options,
                           Progress& progress, Field& field) {
  b.begin(mesh, grid, options, progress, field);
  b.voxelGrid();
  b.cellDistance();
  b.distanceTransform();
  b.refine();
  b.rasterDistance();
  b.exactDistance();
  b.crossings();
  b.rayMap();
  b.winding();
  b.orientation();
  b.windingDipoles();
  b.closeHoles();
  b.sign();
  b.finish();
};

template <Backend B>
void runPipeline(B& backend, const Mesh& mesh, const Grid& grid, const Options& options, Progress& progress,
                 Field& field) {
  const auto stage = [&](const char* name, void (B::*run)()) {
    progress.stage(name, [&] { (backend.*run)(); });
  };

  // The mesh in cell units, where sample (i, j, k) lies at (i, j, k).
  progress.stage("begin", [&] { backend.begin(mesh, grid, options, progress, field); });

  // Unsigned distance, and the closest triangle.
  if (options.distance == DistanceMode::Exact) {
    stage("exact_distance", &B::exactDistance);  // Ours: the true closest triangle.
  } else {
    if (options.distance == DistanceMode::Raster) {
      stage("raster_distance",
            &B::rasterDistance);  // §3.3, end: every triangle writes its distance to the cells.
    } else {
      stage("voxel_grid", &B::voxelGrid);        // §3.1: which triangles touch which cell.
      stage("cell_distance", &B::cellDistance);  // §3.3: how close they come to its centre.
    }
    stage("distance_transform", &B::distanceTransform);  // §3.3, Alg. 1-2: the nearest occupied cell.
    stage("refine", &B::refine);                         // §3.3, end: the distance to its triangles.
  }

  // Sign.
  if (options.sign != SignMode::None) {
    stage("crossings", &B::crossings);             // §3.5: signed crossings of every lattice edge.
    stage("ray_map", &B::rayMap);                  // §3.5, Eq. 3-8: their sums towards infinity.
    stage("winding", &B::winding);                 // §3.5, Eq. 9-11, and the harmonic solve.
    stage("orientation", &B::orientation);         // Ours: turns the faces along which it rises.
    stage("winding_dipoles", &B::windingDipoles);  // Barill et al. 2018, near the threshold.
    if (options.closeHoles)
      stage("close_holes", &B::closeHoles);  // §4, end: surface where the sign changes and none is.
    stage("sign", &B::sign);                 // §3.5: threshold, confidence.
  }
  stage("finish", &B::finish);  // Mesh units.
}

}  // namespace raymap
