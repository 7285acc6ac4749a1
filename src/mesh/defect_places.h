#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "mesh/defects.h"

namespace raymap {

/// A hole, or edges or faces of one kind that touch each other.
struct DefectPlace {
  glm::dvec3 centre{0.0};  ///< In the mesh's units.
  double diameter = 0.0;   ///< In the mesh's units.
  size_t count = 0;        ///< Number of its edges or faces.
};

/// Defects of one kind.
struct DefectKind {
  std::string_view name;                 ///< What they are, in the plural.
  std::string_view unit;                 ///< What `DefectPlace::count` counts: "edge" or "face".
  size_t count = 0;                      ///< Number of all edges or faces of this kind.
  bool isComplete = true;                ///< False if the search stopped early: there are at least so many.
  std::vector<DefectPlace> places = {};  ///< The largest first.
};

/// Returns where a mesh has defects, by kind. Leaves out kinds that it does not have.
std::vector<DefectKind> findPlaces(const PackedMesh& mesh, const Defects& defects);

}  // namespace raymap
