#pragma once

#include <raymap/units.h>

#include <iosfwd>
#include <string>

#include "io/mesh/mesh_formats.h"

namespace raymap {

/// Unit and texts of a 3MF. Bytes of texts that are no text of XML become '?'. Empty texts are left out.
struct About3mf {
  LengthUnit unit;
  std::string title, description;
};

/// Returns whether a triangle has three different vertices, as 3MF demands. Others are not written.
inline bool isIn3mf(const glm::uvec3& t) {
  return t.x != t.y && t.y != t.z && t.z != t.x;
}

/// Writes a mesh as a 3MF: one item, of one object or of one for each named part. Joins equal positions if no
/// triangles share a vertex, for only those that do are neighbours in a 3MF. Throws `Error(Unsupported)` if
/// no triangle has three different vertices.
void write3mf(std::ostream& out, const WritableMesh& mesh, const About3mf& about);

}  // namespace raymap
