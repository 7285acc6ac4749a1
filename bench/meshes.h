#pragma once

#include <raymap/mesh.h>

#include <string>

namespace raymap::bench {

/// The meshes of the benchmarks: `scan` (the Stanford bunny, an error where it is not at hand), `holes` (the
/// same with five more holes cut into it), `million` (the same cut finer, more than a million triangles,
/// gently displaced so that no patch is flat), `sphere` (a bumpy sphere of similar size); anything else is
/// the name of a file.
Mesh benchMesh(const std::string& name);

}  // namespace raymap::bench
