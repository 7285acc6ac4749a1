#include "picture/drawn_field.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "picture/drawn_field_shared.h"

namespace raymap {

namespace {

constexpr size_t kCubesPerWord = 4;

void addNodes(const LeafTree& tree, std::vector<uint32_t>& words) {
  static_assert(LeafTree::kSlotBits == kLeafBits && LeafTree::kOutside == kAllOutside &&
                LeafTree::kInside == kAllInside);
  for (const LeafTree::Node& node : tree.nodes())
    for (const int64_t content : node) words.push_back(uint32_t(int32_t(content)));
}

void addCubes(const EmptySpace& space, std::vector<uint32_t>& words) {
  const std::vector<uint8_t>& away = space.away();
  for (size_t first = 0; first < away.size(); first += kCubesPerWord) {
    uint32_t word = 0;
    for (size_t n = 0; n < std::min(kCubesPerWord, away.size() - first); ++n)
      word |= uint32_t{away[first + n]} << 8 * n;
    words.push_back(word);
  }
}

}  // namespace

DrawnField::DrawnField(const Field& field) : field_(&field) {
  if (const auto& band = field.narrow) {
    inside_ = band->inside;
    outside_ = band->outside;
    tree_ = std::make_unique<const LeafTree>(field);
    space_.emplace(field);
    sparse_.emplace(SparseTrilinear<TreeReader>(field.grid.dims, TreeReader{tree_.get()}),
                    field.grid.spacing);
  } else {
    inside_ = outside_ = field.clampDistance > 0.0 ? field.clampDistance : INFINITY;
    whole_.emplace(field);
  }
}

DrawnField::DrawnField(const Field& elsewhere, double inside, double outside) : DrawnField(elsewhere) {
  isBandElsewhere_ = true;
  inside_ = inside;
  outside_ = outside;
}

size_t DrawnField::leafIndexCount() const {
  return tree_ ? size_t(kLeafIndexHeader) + tree_->nodes().size() * std::tuple_size<LeafTree::Node>() +
                     (space_->away().size() + kCubesPerWord - 1) / kCubesPerWord
               : 0;
}

std::vector<uint32_t> DrawnField::leafIndex(double scale) const {
  const auto bitsOf = [&](double distance) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return std::bit_cast<uint32_t>(float(std::clamp(scale * distance, -kMost, kMost)));
  };
  std::vector<uint32_t> words(size_t(kLeafIndexHeader), 0);
  words.reserve(leafIndexCount());
  words[kIndexRootBits] = uint32_t(tree_->rootBits());
  words[kIndexOutside] = bitsOf(outside_);
  words[kIndexInside] = bitsOf(-inside_);
  words[kIndexCubeBits] = uint32_t(space_->bits());
  for (int axis = 0; axis < 3; ++axis) words[kIndexCubeDims + axis] = uint32_t(space_->dims()[axis]);
  addNodes(*tree_, words);
  words[kIndexCubes] = uint32_t(words.size());
  addCubes(*space_, words);
  return words;
}

DrawnField::Reading DrawnField::reading(const glm::dvec3& p) const {
  constexpr double kNearly = 1.0 - 1e-6;  // Files round clamped distances, and so do units.
  const glm::ivec3 dims = grid().dims;
  const glm::dvec3 q = glm::clamp(p, glm::dvec3(0.0), last());
  const glm::ivec3 cell = glm::min(glm::ivec3(q), glm::max(dims - 2, 0));
  Reading found{.value = value(p), .mayBeLess = false, .mayBeMore = q != p};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 sample = glm::min(cell + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2), dims - 1);
    const float distance =
        tree_ ? tree_->blockWith(sample).at(sample) : field_->distance[grid().index(sample)];
    found.mayBeLess |= distance <= -kNearly * inside_;
    found.mayBeMore |= distance >= kNearly * outside_;
  }
  return found;
}

std::optional<DrawnField::Plateau> DrawnField::plateau(const glm::dvec3& p,
                                                       const glm::dvec3& direction) const {
  if (!tree_) return std::nullopt;
  const bool isInGrid =
      glm::all(glm::greaterThanEqual(p, glm::dvec3(0.0))) && glm::all(glm::lessThanEqual(p, last()));
  if (!isInGrid) return std::nullopt;
  const glm::ivec3 sample(p);
  auto distance = float(outside_);
  std::optional<SampleBox> box = space_->boxAround(sample);
  if (!box) {
    const std::optional<LeafTree::EmptyCube> cube = tree_->emptyCube(sample);
    if (!cube) return std::nullopt;
    box = {cube->low, cube->low + (cube->side - 1)};
    distance = cube->distance;
  }
  // Values are constant up to the last sample of the box. Beyond it, those of the next box are used too.
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
