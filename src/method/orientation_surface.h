#pragma once

// Ours: the faces whose orientation is chosen (orientation_sides.h).

#include <optional>
#include <vector>

#include "mesh/double_sided.h"
#include "mesh/patches.h"
#include "method/turns.h"

namespace raymap {

/// Number of edges at which the double-sided faces of a patch end.
struct Borders {
  uint32_t open = 0;       ///< No other face is there.
  uint32_t closing = 0;    ///< An odd number of single-sided faces is there, which the patch completes.
  uint32_t dividing = 0;   ///< An even number of them is there: they bound a solid without the patch.
  uint32_t branching = 0;  ///< More than two faces are there.

  /// Returns whether the patch ends nowhere. Then it bounds a solid, whatever samples see of it.
  bool areNone() const { return open + closing + dividing + branching == 0; }
};

/// The faces that the sign takes, and what the mesh says of their directions.
struct OrientationSurface {
  std::vector<uint32_t> taken;      ///< The faces that the sign takes, ascending.
  Turns asGiven;                    ///< Takes each face as given or leaves it out.
  std::vector<uint8_t> isDirected;  ///< Whether the given winding order of each face is used.
  Patches patches;                  ///< Patches; a face that is left out has that of its group's first.
  std::vector<float> areas;         ///< Twice the area of each face; 0 if it is left out.
  std::vector<double> patchAreas;   ///< Sum of `areas` over each patch.
  double area = 0.0;                ///< Sum of `areas`.
  std::vector<Borders> borders;     ///< Borders of each patch's double-sided faces; empty if there are none.

  /// Returns the number of patches with an area.
  size_t patchCount() const;
  /// Returns the turns with which all faces of a patch point to the same side.
  Turns aligned() const;
};

/// Takes the faces that `given` takes as given.
OrientationSurface takeAllFaces(const PackedMesh& mesh, Turns given);

/// Takes one face of each double-sided group, whose given winding order is ignored.
OrientationSurface takeSingleFaces(const PackedMesh& mesh, const DoubleSidedFaces& doubleSided);

/// Returns the turns that leave out repeated faces.
Turns withoutRepeated(const DoubleSidedFaces& doubleSided, size_t faceCount);

/// Returns the turns that take the first face of each group as given, and leave out the others and repeated
/// faces.
Turns withoutOthers(const DoubleSidedFaces& doubleSided, size_t faceCount);

/// Returns the turns that the first face of each group needs to stand for its whole group. It is left out
/// where all faces of the group are as given, as they cancel. Returns nothing if a group is neither as given
/// nor its first face alone. Empty turns take all faces as given.
std::optional<Turns> turnsOfFirsts(const DoubleSidedFaces& doubleSided, Turns turns, size_t faceCount);

/// Returns the groups without those whose patch divides a solid or sticks out of one, and without small ones
/// that bound nothing by themselves: their area in the patch is less than half of `leastArea`.
DoubleSidedFaces withoutSheets(const PackedMesh& mesh, const DoubleSidedFaces& doubleSided, double leastArea);

}  // namespace raymap
