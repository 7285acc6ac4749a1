#pragma once

#include <raymap/local_thickness.h>

#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Returns points on the faces of a mesh that stand for equal areas, in the order of the faces. Places within
/// a face follow the R2 sequence (Roberts 2018).
std::vector<FacePoint> spreadPoints(const MeshView& view, size_t count);

}  // namespace raymap
