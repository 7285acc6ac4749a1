#pragma once

#include <raymap/field.h>
#include <raymap/grid.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace raymap {

/// An 8-bit sRGB picture: `width` * `height` pixels of red, green and blue, rows from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb = {};
};

/// Largest width and height of a picture, in pixels.
inline constexpr int kMaxPictureSide = 16384;

/// How to draw a field by sphere tracing (Hart 1996).
struct RenderOptions {
  int width = 1024;                         ///< Width of the picture, in pixels.
  int height = 768;                         ///< Height of the picture, in pixels.
  glm::dvec3 direction{-0.6, -0.45, -1.0};  ///< Direction from the camera to the centre of the shape.
  glm::dvec3 up{0.0, 1.0, 0.0};  ///< Direction up in the picture; the floor is perpendicular to it.
  double fieldOfView = 30.0;     ///< Angle from the bottom to the top of the picture, in degrees.
  /// Whether to remove the half before the middle plane, as in the paper's figure 1. The cut face shows the
  /// distance inside.
  bool cut = false;
  double shell =
      0.0;  ///< Thickness of the outer wall of a hollow shape, in the mesh's units; 0 = not hollow.
  /// Box that the camera frames instead of the shape, in the mesh's units. Pictures of a moving shape share
  /// one, so that the camera stands still. The ball around it cuts off what reaches farther.
  std::optional<Box> frame = {};
  /// Place of the camera, in the mesh's units, instead of one from which the shape fills the picture.
  std::optional<glm::dvec3> eye = {};
  double iso = 0.0;  ///< Distance at which the surface lies, in the mesh's units.
  /// Plane of the cut, instead of the middle one: what lies on the side of its normal is removed.
  std::optional<Plane> cutPlane = {};
  /// Plane on which distances are drawn in the colours and with the lines of `renderSlice`.
  std::optional<Plane> slice = {};
  /// Array that colours the slice and the cut face, and that of confidences the surface too. The field must
  /// have it; triangles have no such colours.
  FieldArray array = FieldArray::Distance;
  /// Second field. Its distances less those of the first colour slice, cut face and surface: blue below 0,
  /// red above. If it is on another grid, it is sampled on that of the first. It may be a narrow band if the
  /// first field is one.
  const Field* other = nullptr;
  double range = 0.0;  ///< Least difference in the deepest colour, in the mesh's units; 0 = the spacing.
  bool operator==(const RenderOptions&) const = default;
};

}  // namespace raymap
