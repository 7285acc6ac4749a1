#pragma once

#include <string>
#include <vector>

#include "io/mesh/mesh_formats.h"

namespace raymap {

/// A part of a mesh with a name.
struct NamedObject {
  std::string name = {};
  std::vector<uint32_t> faces = {};     ///< Numbers of its triangles in the whole mesh; empty: all.
  const WritableMesh* whole = nullptr;  ///< Whole mesh, if that is the part.
  Mesh part = {};                       ///< Triangles of another part, and the vertices that they use.
  WritableMesh own = {};                ///< Those to write; refers to `part`.

  const WritableMesh& mesh() const { return whole ? *whole : own; }
};

/// Returns the part of each triangle; of those without a name, the part that shares vertices with them.
/// Returns nothing if no triangle has a name, or if triangles of different parts share vertices.
std::vector<uint32_t> separateParts(const WritableMesh& mesh);

/// Splits a mesh into its separate parts, which `WritableMesh::partOf` tells, in the order of their first
/// triangles. Without any, the whole mesh is an object without a name.
std::vector<NamedObject> namedObjects(const WritableMesh& mesh);

}  // namespace raymap
