#pragma once

#include <raymap/field.h>

#include <vector>

namespace raymap {

/// A straight hole with flat ends.
struct DrainHole {
  glm::dvec3 start, end;
  double radius;

  /// Negative in the hole.
  double distance(const glm::dvec3& p) const;
};

/// A part of the space inside a wall that hangs together.
struct Hollow {
  glm::dvec3 lowest;  ///< Its point farthest down, in samples.
  double deepest;     ///< How far it reaches from the wall.
};

/// Finds the hollows that a solid of walls `wall` thick has. Those not even `least` deep it makes solid.
std::vector<Hollow> findHollows(Field& solid, double wall, double least, const glm::dvec3& down);

/// Takes away what is deeper inside the solid than its walls.
void hollowOut(Field& solid, double wall);

/// A hole from the lowest point of a hollow straight down until it has left the solid.
DrainHole placeHole(const Field& solid, const Hollow& hollow, double radius, const glm::dvec3& down);
void drill(Field& solid, const DrainHole& hole);

}  // namespace raymap
