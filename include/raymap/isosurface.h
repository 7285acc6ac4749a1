#pragma once

#include <raymap/field.h>
#include <raymap/machine.h>

namespace raymap {

/// How to make the surface of a field.
struct IsosurfaceOptions {
  double iso = 0.0;  ///< Distance at which the surface lies, in the mesh's units.
};

/// Returns the surface of the solid whose distances are below `iso`, by dual contouring (Ju et al. 2002).
///
/// Faces point out of the solid. Every edge has exactly two faces, which agree in orientation; the faces
/// around each vertex make one disc; no face is degenerate or duplicate. This holds for any samples. The
/// result is closed where the solid reaches the grid's box. Planes are fitted to the distances, so that
/// corners and sharp edges are kept. Same field, same mesh, for any number of threads.
///
/// The surface of a narrow band is, bit for bit, that of the field that `toDense` makes of it, but the time
/// and memory grow with the surface. On the wider side of a band, `iso` may exceed that field's
/// `clampDistance`. Vertices have single precision about the grid's middle: beyond 16384 samples along a
/// side, they lose the cubes that they lie in.
///
/// `machine.threads`, `warn` and `progress` are used. It warns if the solid reaches the grid's box.
///
/// Throws `Error`: Usage if there is no surface at `iso`, Input if a sample is not finite, Memory, Cancelled.
RAYMAP_API Mesh isosurface(const Field& field, const IsosurfaceOptions& options = {},
                           const MachineOptions& machine = {});
/// Does the same, reusing the memory of `result`, which an error leaves empty.
RAYMAP_API void isosurface(const Field& field, const IsosurfaceOptions& options, Mesh& result,
                           const MachineOptions& machine = {});

}  // namespace raymap
