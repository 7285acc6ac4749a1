#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

namespace raymap {

/// A point of a mesh's surface, in the mesh's units, and the area that it stands for.
struct FacePoint {
  glm::dvec3 position;
  uint32_t triangle;
  double area = 0.0;
};

/// Kind of part that a point of a mesh's surface bounds.
enum class Part : uint8_t {
  Wall,  ///< Side of a plate, a rod or any body: another side lies opposite.
  Edge,  ///< Side of a wedge or a spike, which runs out to an edge or a tip.
  /// Surface beside a blunt edge or corner: the other side is too oblique, or a third too near. Also faces
  /// narrower than 0.00002 of the mesh's diagonal.
  Corner,
  Solid,   ///< Surface of a solid whose other side is farther than `ThicknessOptions::maxThickness`.
  Sheet,   ///< Face that bounds nothing: it is outside on both sides.
  Buried,  ///< Face that is inside on both sides.
};

/// Thickness of a mesh at a point of its surface.
///
/// It is the local thickness: the diameter of the ball inside that touches the point and the side opposite. A
/// side lies opposite if its normal and the reversed normal of the point are at most 40 degrees apart. So
/// edges blunter than that are not thin, and a cube is as thick near its edges as in the middle.
struct Thickness {
  Part part = Part::Solid;
  /// Diameter of the ball that touches the point and the side opposite, in the mesh's units. 0 for a sheet;
  /// infinite where no side lies opposite.
  float diameter = 0.0f;
  glm::vec3 inward{0.0f};  ///< Unit vector into the solid; 0 for sheets, buried and narrow faces.

  bool operator==(const Thickness&) const = default;
};

/// How to measure thickness.
struct ThicknessOptions {
  /// Largest thickness to find. Thicker parts are taken as infinitely thick. The smaller, the faster.
  double maxThickness = std::numeric_limits<double>::infinity();
};

}  // namespace raymap
