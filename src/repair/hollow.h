#pragma once

#include <raymap/field.h>

#include <vector>

namespace raymap {

/// A straight hole with flat ends.
struct DrainHole {
  glm::dvec3 start, end;
  double radius;

  /// Returns a lower bound on the distance to the hole, negative inside it.
  double distance(const glm::dvec3& p) const;
};

/// A connected part of the space inside the walls.
struct Hollow {
  glm::dvec3 lowest;  ///< Lowest point, in samples.
  double deepest;     ///< Largest distance from the walls, in the field's units.
};

/// Returns the hollows of a solid with walls `wall` thick. Fills hollows less than `least` deep.
std::vector<Hollow> findHollows(Field& solid, double wall, double least, const glm::dvec3& down);

/// Removes everything deeper inside the solid than `wall`.
void hollowOut(Field& solid, double wall);

/// Returns a hole from the lowest point of a hollow straight down, until it has left the solid.
DrainHole placeHole(const Field& solid, const Hollow& hollow, double radius, const glm::dvec3& down);
void drill(Field& solid, const DrainHole& hole);

}  // namespace raymap
