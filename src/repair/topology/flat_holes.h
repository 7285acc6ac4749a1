#pragma once

#include <raymap/mesh.h>

#include "repair/topology/fill_holes.h"

namespace raymap {

/// Appends faces that close the holes of a mesh whose rims lie in planes. Equal positions of the mesh must be
/// one vertex. Rims inside others bound one face with these, as at the end of a tube with a thick wall.
///
/// Fills all holes of a connected part or none: only then is certain what they bound. Leaves out parts that
/// are flat, and holes where faces lie already, such as cracks between parts that share no vertices.
FilledHoles fillFlatHoles(Mesh& mesh);

}  // namespace raymap
