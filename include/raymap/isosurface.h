#pragma once

#include <raymap/callbacks.h>
#include <raymap/field.h>

namespace raymap {

struct IsosurfaceOptions {
  double iso = 0.0;      ///< The distance at which the surface lies, in the mesh's units.
  int threads = 0;       ///< 0 = all.
  WarningCallback warn;  ///< Called if the solid reaches the grid's box.
  ProgressCallback progress;
};

/// The surface of the solid where the field is below `iso`, facing out of it. Whatever the samples, every
/// edge has exactly two faces, which agree in orientation, the faces around each vertex make one disc, and no
/// face is degenerate or double. A solid that reaches the grid's box is closed there. The field's distances
/// say where the surface bends: corners and sharp edges are kept (dual contouring). Same field, same mesh,
/// for any number of threads.
///
/// Throws `Error`: Usage if there is no surface at `iso`, Input if a sample is not finite, Memory, Cancelled.
Mesh isosurface(const Field& field, const IsosurfaceOptions& options = {});

}  // namespace raymap
