#include "scene/drawn_field.h"

#include <cmath>
#include <utility>

namespace raymap {

DrawnField::DrawnField(const Field& field)
    : dense_(&field),
      inside_(field.clampDistance > 0.0 ? field.clampDistance : INFINITY),
      outside_(inside_),
      whole_(field) {}

DrawnField::DrawnField(const SparseField& band)
    : inside_(band.inside),
      outside_(band.outside),
      tree_(std::make_unique<const LeafTree>(band)),
      space_(std::in_place, band),
      sparse_(SparseSampler({band.grid.dims, TreeReader{tree_.get()}}, band.grid.spacing)) {}

DrawnField::Reading DrawnField::reading(const glm::dvec3& p) const {
  constexpr double kNearly = 1.0 - 1e-6;  // Files round clamped distances, and so do units.
  const glm::ivec3 dims = grid().dims;
  const glm::dvec3 q = glm::clamp(p, glm::dvec3(0.0), last());
  const glm::ivec3 cell = glm::min(glm::ivec3(q), glm::max(dims - 2, 0));
  Reading found{.value = value(p), .mayBeLess = false, .mayBeMore = q != p};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 sample = glm::min(cell + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2), dims - 1);
    const float distance =
        dense_ ? dense_->distance[dense_->grid.index(sample)] : tree_->blockWith(sample).at(sample);
    found.mayBeLess |= distance <= -kNearly * inside_;
    found.mayBeMore |= distance >= kNearly * outside_;
  }
  return found;
}

std::optional<DrawnField::Plateau> DrawnField::plateau(const glm::dvec3& p,
                                                       const glm::dvec3& direction) const {
  if (dense_) return std::nullopt;
  const bool isInGrid =
      glm::all(glm::greaterThanEqual(p, glm::dvec3(0.0))) && glm::all(glm::lessThanEqual(p, last()));
  if (!isInGrid) return std::nullopt;
  const glm::ivec3 sample(p);
  float distance = float(band()->outside);
  std::optional<SampleBox> box = space_->boxAround(sample);
  if (!box) {
    const std::optional<LeafTree::EmptyCube> cube = tree_->emptyCube(sample);
    if (!cube) return std::nullopt;
    box = {cube->low, cube->low + (cube->side - 1)};
    distance = cube->distance;
  }
  // Values are constant up to the last sample of the box. Beyond it, those of the next box count too.
  const glm::dvec3 low(box->first), high(box->last);
  if (glm::any(glm::greaterThan(p, high))) return std::nullopt;
  double length = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const double way = direction[axis];
    if (way != 0.0) length = std::min(length, ((way > 0.0 ? high : low)[axis] - p[axis]) / way);
  }
  return Plateau{distance / grid().spacing, length};
}

}  // namespace raymap
