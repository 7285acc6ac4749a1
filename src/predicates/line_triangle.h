#pragma once

// A line and a triangle.
//
// Precision: double. A side is right unless rounding decides it. The faces at an edge always agree about it,
// so a line enters and leaves a closed surface equally often. Ties: a line that meets an edge or a corner
// is taken as moved by an infinitely small step, and so passes one of the faces on each side.

#include <glm/glm.hpp>
#include <optional>

namespace raymap {

/// How a line passes a triangle. `side` is +1 if the corners run counter-clockwise around the line, -1 if
/// clockwise, and 0 if the line passes beside the triangle. It meets the triangle in the sum of the corners
/// times `weights`, divided by the sum of the weights.
struct LinePassage {
  int side = 0;
  glm::dvec3 weights{0.0};
};

/// Finds how the line through the origin passes a triangle that is seen along the line. The line is taken as
/// moved along -x, and less along -y.
LinePassage passLine(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c);

/// Returns x where the line along x through (y, z) crosses a triangle. The line is taken as moved along y,
/// and less along z.
std::optional<double> crossingAt(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double y,
                                 double z);

}  // namespace raymap
