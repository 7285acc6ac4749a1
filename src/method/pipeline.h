#pragma once

// Krayer & Müller 2019, "Generating signed distance fields on the GPU with ray maps": the whole method, on
// any backend. Each stage is a file stem: `find -name 'ray_map*'` shows its CPU and GPU code, its shaders and
// its test.

#include "method/backend_concepts.h"
#include "method/close_holes_patch.h"
#include "method/orientation_sides.h"

namespace raymap {

/// Runs all stages that the options ask for.
template <Backend B>
void runPipeline(B& backend) {
  const FieldOptions& options = backend.options();
  do {
    // The mesh in cell units: sample (i, j, k) lies at (i, j, k).
    backend.stage("begin", [&] { backend.begin(); });

    // The unsigned distance and the closest triangle.
    if (options.distance == DistanceMode::Exact) {
      backend.stage("exact_distance", [&] { backend.exactDistance(); });  // Ours: the true closest triangle.
    } else {
      if (options.distance == DistanceMode::Raster) {
        // §3.3, end: each triangle writes its distance to the cells that it touches.
        backend.stage("raster_distance", [&] { backend.rasterDistance(); });
      } else {
        // §3.1: the triangles that touch each cell. §3.3: the distance from its centre to them.
        backend.stage("voxel_grid", [&] { backend.voxelGrid(); });
        backend.stage("cell_distance", [&] { backend.cellDistance(); });
      }
      // §3.3, Alg. 1-2: the nearest occupied cell; then the distance to its triangles.
      backend.stage("distance_transform", [&] { backend.distanceTransform(); });
      backend.stage("refine", [&] { backend.refine(); });
    }

    if (options.sign != SignMode::None) {
      // §3.5: signed crossings of every lattice edge; Eq. 3-8: their sums towards infinity.
      backend.stage("crossings", [&] { backend.crossings(); });
      backend.stage("ray_map", [&] { backend.rayMap(); });
      // §3.5, Eq. 9-11, or the harmonic solve.
      backend.stage("winding", [&] { backend.winding(modeBeforeOrientation(options)); });
      // Ours: reverses faces along whose normals the field rises. It runs the three stages above again for
      // every choice, up to 13 times.
      if constexpr (HostBackend<B>) backend.stage("orientation", [&] { orientFaces(backend); });
      // Barill et al. 2018, where the winding number is near the threshold.
      if (options.sign == SignMode::Harmonic)
        backend.stage("winding_dipoles", [&] { backend.windingDipoles(); });
      // §4, end: adds surface where the sign changes without a triangle.
      if constexpr (HostBackend<B>)
        if (options.closeHoles) backend.stage("close_holes", [&] { closeHoles(backend); });
      // §3.5: threshold, confidence.
      backend.stage("sign", [&] { backend.sign(); });
    }

    // Distances in mesh units.
    backend.stage("finish", [&] { backend.finish(); });
    // Only now does a GPU know the length that its lists of cells need.
  } while (!backend.complete());
}

/// Adds a run's findings about the mesh to its statistics.
template <HostBackend B>
void describeMesh(B& backend, const Grid& grid, Stats& stats) {
  const FaceSides& sides = backend.faceSides();
  stats.doubtfulShare = mayTurnFaces(backend.options()) ? sides.doubtfulShare : backend.doubtfulShare();
  stats.misfitGiven = sides.misfitGiven;
  stats.misfit = sides.misfit;
  stats.turnedFaces = sides.turnedFaces();
  stats.leftOutFaces = sides.leftOutFaces();
  stats.invertedParts = sides.invertedParts;
  stats.orientationFits = sides.fits;
  stats.patchTriangles = backend.patch().triangles.size();
  stats.patchArea = backend.patch().area() * grid.spacing * grid.spacing;
}

}  // namespace raymap
