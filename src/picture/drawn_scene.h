#pragma once

#include <utility>

#include "picture/camera.h"
#include "picture/colour.h"
#include "picture/drawn_scene_shared.h"
#include "picture/shape.h"
#include "picture/shown_numbers.h"

namespace raymap {

inline const Colour kSun = 3.0 * srgb(255, 244, 228);
inline const Colour kSky = 0.85 * srgb(214, 230, 255);
inline const Colour kBounce = 0.42 * srgb(255, 226, 198);
inline const Colour kClay = srgb(226, 158, 104);
inline const Colour kBackgroundTop = srgb(250, 251, 252);
inline const Colour kBackgroundBottom = srgb(222, 226, 231);

/// Direction to the light, along the camera's right and forward and the scene's up.
inline constexpr glm::dvec3 kLightOfCamera{-0.45, -0.55, 0.95};

/// Contents of a picture, to be drawn on any device. One round light and a sky light the shape. A bright
/// floor shows only the shadow.
struct DrawnScene {
  /// Throws as `renderField` does.
  DrawnScene(DrawnField field, const RenderOptions& options)
      : up(unitVector(options.up, "up vector")),
        shape(std::move(field), options),
        camera(options, shape),
        toLight(glm::normalize(kLightOfCamera.x * camera.right() + kLightOfCamera.y * camera.forward() +
                               kLightOfCamera.z * up)),
        lineStep(roundedUp(shape.depth() / 12.0 * spacing()) / spacing()) {
    if (options.slice) slice = toSamples(*options.slice, shape.field().grid());
    if (options.other || options.array != FieldArray::Distance) numbers.emplace(shape.field(), options);
  }

  DrawnScene(const DrawnScene&) = delete;  // `numbers` keeps a reference to the shape's field.

  double spacing() const { return shape.field().grid().spacing; }

  glm::dvec3 up;
  Shape shape;
  Camera camera;
  glm::dvec3 toLight;
  double lineStep;                  ///< Distance between the lines on the cut face and the slice, in samples.
  std::optional<Plane> slice = {};  ///< In samples; its normal is a unit vector.
  std::optional<ShownNumbers> numbers = {};  ///< None: distances are in colour.
};

/// Motion of a grid's samples: a point of the scene at q, in samples, lies at `turn` * q + `shift` of the
/// grid.
struct GridMotion {
  glm::dmat3 turn{1.0};
  glm::dvec3 shift{0.0};
};

/// Takes what shaders need to the coordinates of a grid that has moved.
void move(const GridMotion& motion, RenderShape& shape, RenderSceneData& scene);

/// Returns what shaders need of a shape, and of all else.
RenderShape describe(const Shape& shape);
RenderSceneData describe(const DrawnScene& scene);
RenderColours describeColours(const DrawnScene& scene);

}  // namespace raymap
