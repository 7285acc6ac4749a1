#pragma once

// Krayer & Müller 2019, "Generating signed distance fields on the GPU with ray maps": the whole method, over
// any backend. Each stage is a file stem: `find -name 'ray_map*'` shows its CPU and GPU code, its shaders and
// its test.

#include "method/backend.h"
#include "method/close_holes_patch.h"
#include "method/orientation_sides.h"

namespace raymap {

template <Backend B>
void findDistances(B& backend, const Options& options) {
  const auto stage = [&](const char* name, void (B::*run)()) {
    backend.stage(name, [&] { (backend.*run)(); });
  };
  if (options.distance == DistanceMode::Exact) {
    stage("exact_distance", &B::exactDistance);  // Ours: the true closest triangle.
    return;
  }
  if (options.distance == DistanceMode::Raster) {
    stage("raster_distance", &B::rasterDistance);  // §3.3, end: each triangle writes to the cells it touches.
  } else {
    stage("voxel_grid", &B::voxelGrid);        // §3.1: which triangles touch which cell.
    stage("cell_distance", &B::cellDistance);  // §3.3: how close they come to its centre.
  }
  stage("distance_transform", &B::distanceTransform);  // §3.3, Alg. 1-2: the nearest occupied cell.
  stage("refine", &B::refine);                         // §3.3, end: the distance to its triangles.
}

template <Backend B>
void findSigns(B& backend, const Options& options) {
  const auto stage = [&](const char* name, void (B::*run)()) {
    backend.stage(name, [&] { (backend.*run)(); });
  };
  stage("crossings", &B::crossings);  // §3.5: signed crossings of every lattice edge.
  stage("ray_map", &B::rayMap);       // §3.5, Eq. 3-8: their sums towards infinity.
  backend.stage("winding", [&] { backend.winding(options.sign); });  // §3.5, Eq. 9-11, or the harmonic solve.
  // Ours: reverses faces along which the field rises, then runs the three stages above again, up to 13 times.
  if constexpr (HostBackend<B>) backend.stage("orientation", [&] { orientFaces(backend); });
  // Barill et al. 2018, where the winding number is near the threshold.
  if (options.sign == SignMode::Harmonic) stage("winding_dipoles", &B::windingDipoles);
  // §4, end: adds surface where the sign changes and no triangle is.
  if constexpr (HostBackend<B>)
    if (options.closeHoles) backend.stage("close_holes", [&] { closeHoles(backend); });
  stage("sign", &B::sign);  // §3.5: threshold, confidence.
}

template <Backend B>
void runPipeline(B& backend) {
  const Options& options = backend.options();
  do {
    backend.stage("begin",
                  [&] { backend.begin(); });  // The mesh in cell units: sample (i, j, k) at (i, j, k).
    findDistances(backend, options);          // Unsigned, and the closest triangle.
    if (options.sign != SignMode::None) findSigns(backend, options);
    backend.stage("finish", [&] { backend.finish(); });  // Mesh units.
  } while (!backend.complete());  // Only now does a GPU know how long its lists of cells had to be.
}

/// Adds what a run found out about the mesh to its statistics.
template <HostBackend B>
void describeMesh(B& backend, const Grid& grid, Stats& stats) {
  const FaceSides& sides = backend.faceSides();
  stats.doubtfulShare = mayTurnFaces(backend.options()) ? sides.doubtfulShare : backend.doubtfulShare();
  stats.misfitGiven = sides.misfitGiven;
  stats.misfit = sides.misfit;
  stats.turnedFaces = sides.turnedFaces();
  stats.patchTriangles = backend.patch().triangles.size();
  stats.patchArea = backend.patch().area() * grid.spacing * grid.spacing;
}

}  // namespace raymap
