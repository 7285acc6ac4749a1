#pragma once

#include <raymap/mesh.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raymap {

/// Parts solids that touch along edges: where more than two faces of a union share an edge, each solid gets
/// a point of its own beside the middle of the edge, within the solid. The ends of the edge stay shared.
/// Equal positions must be one vertex. Leaves edges as they are whose faces do not alternate. Returns how
/// often a face was cut. `sources` gets the value of the cut face for each face that is added.
size_t partEdges(Mesh& mesh, std::vector<uint32_t>& sources);

}  // namespace raymap
