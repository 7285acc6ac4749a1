#pragma once

#include <raymap/picture.h>

#include <functional>
#include <string>
#include <vector>

#include "defects.h"
#include "legend.h"
#include "live_field.h"
#include "mesh_pass.h"

namespace raymap::view {

/// A plane that can be switched on and moved.
struct MovingPlane {
  bool isOn = false;
  glm::dvec3 normal{1.0, 0.0, 0.0};
  double offset = 0.0;

  std::optional<Plane> plane() const {
    return isOn ? std::optional(Plane{.normal = normal, .offset = offset}) : std::nullopt;
  }
};

/// All that its user can choose.
struct ViewState {
  FieldSettings field = {};
  RenderOptions view = {};  ///< Its eye, planes, size and frame follow from the rest.
  bool isFieldShown = true;
  MeshStyle mesh = MeshStyle::Hidden;
  bool areDefectsShown = false;
  bool isSecondShown = false;  ///< The second shape instead of the first.
  /// Whether colours show how far the other shape's distances differ, instead of `view.array`.
  bool isDifferenceShown = false;
  bool isOtherOverlaid = false;  ///< Whether the other mesh is seen where it sticks out of this shape.
  bool countsSteps = false;      ///< Whether the panel shows how many steps rays take.
  MovingPlane cut = {}, slice = {};
  bool isPlaying = false;
  double seconds = 0.0;  ///< Time of the animation.
  double speed = 1.0;
  std::string clip = {};
  std::optional<Box> box = {};  ///< Box of the grid of an animated mesh, which all its poses share.
  bool isMeasuring = false;
  bool isHelpShown = false, isPanelShown = true;
};

/// Colours of the slice and the cut, some also of the surface.
struct Colours {
  FieldArray array = FieldArray::Distance;
  bool isDifference = false;
  bool operator==(const Colours&) const = default;

  std::string name() const;
  void choose(ViewState& state) const;
};

/// Returns the colours that there are for a shape, beside another one if that is not null.
std::vector<Colours> coloursOf(const Content& content, const Content* other);

/// A point under the cursor, and the values there that are known.
struct Probed {
  glm::dvec3 position{0.0};
  std::optional<double> distance = {};
  std::optional<double> other = {};  ///< Distance of the other shape.
  std::optional<double> winding = {};
  std::optional<double> confidence = {};
  std::optional<uint32_t> triangle = {};
};

/// Figures and messages that the panel shows.
struct PanelFigures {
  const Content& content;
  const Content* other = nullptr;  ///< The shape that is not shown; null: there is none.
  const Defects& defects;
  Legend legend = {};
  std::optional<double> refined = {};  ///< Share of the finest picture that is drawn; none if all is.
  std::string device = {};             ///< Name of the device, and whether it makes the fields.
  std::string grid = {};               ///< The field's samples and spacing.
  std::vector<Frame::Time> times = {};
  bool isFieldMoved = false;               ///< Whether the field needed no time, as it moved.
  uint64_t fieldBytes = 0;                 ///< Memory of the device that the field and its making take.
  std::optional<Gpu::Memory> memory = {};  ///< Memory as the driver reports it.
  std::optional<double> steps = {};        ///< Mean number of steps of a ray; none if they are not counted.
  const std::vector<float>& history;       ///< Milliseconds of the last frames.
  std::string message = {};                ///< Last error or result.
  std::optional<Probed> probed = {};
  std::vector<glm::dvec3> measured = {};
};

/// Actions that the user asked for by a button or a key.
struct Wishes {
  bool frame = false;                ///< Show all.
  int axis = 0;                      ///< 1, 2 or 3: look along x, y or z; negative: from the other side.
  bool picture = false;              ///< Write a picture.
  bool record = false;               ///< Begin or end to record.
  bool copy = false;                 ///< Copy the command that draws this.
  bool clip = false;                 ///< The clip changed.
  std::optional<size_t> place = {};  ///< Show this place of defects.
  bool nextPlace = false;            ///< Show the next one.
};

}  // namespace raymap::view
