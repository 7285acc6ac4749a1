#pragma once

#include <raymap/diagnostics.h>

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/disjoint_sets.h"
#include "mesh/holes.h"
#include "mesh/model.h"

namespace raymap {

/// Parts of a surface that are connected through shared vertices.
class Components {
 public:
  explicit Components(const Model& mesh);

  size_t count() const { return roots_.size(); }
  /// Returns the component of a position that a half edge has.
  uint32_t componentOf(uint32_t position);

 private:
  DisjointSets sets_;
  std::vector<uint32_t> roots_;  ///< Lowest position of each component, ascending.
};

/// Sets the counts of components that are open, inward or sheets. The area, the volume and the bounds must be
/// known.
void measureComponents(const Model& mesh, Components& components, std::span<const TracedHole> holes,
                       Diagnostics& found);

/// Components that are sheets.
struct SheetFaces {
  std::vector<uint32_t> faces;  ///< Ascending.
  bool mayBoundSolid = false;   ///< Whether all else has the area to close the holes of the largest one.
  bool boundSolid = false;      ///< Whether they bound a solid together, but for gaps between them.
};

SheetFaces findSheets(const Model& mesh, Components& components, std::span<const TracedHole> holes);

}  // namespace raymap
