#pragma once

#include <raymap/field.h>
#include <raymap/repair.h>

#include <vector>

namespace raymap {

/// A straight hole with flat ends.
struct DrainHole {
  glm::dvec3 start, end;
  double radius;

  /// Returns a lower bound on the distance to the hole, negative inside it.
  double distance(const glm::dvec3& p) const;
};

/// A connected part of the space inside the walls. Points are in samples.
struct Hollow {
  glm::dvec3 lowest, highest;
  double deepest = 0.0;  ///< Largest distance from the walls, in the field's units; infinite beyond the band.
  std::vector<glm::dvec3> floors;  ///< Points on level floors, for further holes.
};

/// Returns the hollows of a solid with walls `wall` thick. Fills hollows less than `least` deep, and adds
/// their number to `filled`. A narrow band must be deeper than both together.
std::vector<Hollow> findHollows(Field& solid, double wall, double least, const glm::dvec3& down,
                                size_t& filled);

/// Removes everything deeper inside the solid than `wall`.
void hollowOut(Field& solid, double wall);

/// Returns a hole from a point of a hollow straight along `direction`, until it has left the solid.
DrainHole placeHole(const Field& solid, const glm::dvec3& start, double radius, const glm::dvec3& direction);

/// Returns up to `count` holes of a hollow: down from its lowest point, as a vent up from its highest one,
/// and down from the level floors that are farthest from the others. Returns fewer if there are no more
/// floors at least two diameters apart.
std::vector<DrainHole> placeHoles(const Field& solid, const Hollow& hollow, int count, double radius,
                                  const glm::dvec3& down);
void drill(Field& solid, const DrainHole& hole);

/// Returns where the axis of a hole leaves the solid, and its direction.
DrainHolePlace exitOf(const Field& solid, const DrainHole& hole);

}  // namespace raymap
