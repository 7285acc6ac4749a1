// Leaves and tiles of OpenVDB's level sets, for `raymap-import`. On this thread alone, as import_vdb.cpp.

#include "io/import/import_band.h"

#include <openvdb/openvdb.h>
#include <raymap/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "field/join_tiles.h"
#include "io/field/vdb.h"
#include "io/import/raymap_import.h"

namespace raymap {

namespace {

constexpr int kSide = NarrowBand::kLeafSide;
constexpr size_t kLeafSamples = NarrowBand::kLeafSamples;
using Leaf = openvdb::FloatTree::LeafNodeType;
static_assert(Leaf::DIM == kSide);

/// Visits the samples of a leaf: their places in OpenVDB's order, z fastest, and where they lie in it.
template <class Visit>
void forEachInLeaf(Visit&& visit) {
  openvdb::Index place = 0;
  for (int x = 0; x < kSide; ++x)
    for (int y = 0; y < kSide; ++y)
      for (int z = 0; z < kSide; ++z) visit(place++, glm::ivec3(x, y, z));
}

/// Returns an iterator over the tiles of a tree.
auto tilesOf(const openvdb::FloatTree& tree) {
  auto tile = tree.cbeginValueAll();
  tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  return tile;
}

/// Returns the width of a band that a grid notes, or 0.
double notedWidth(const openvdb::FloatGrid& grid, const char* key) {
  for (const char* each : {key, kVdbClampKey})
    if (const auto noted = grid.getMetadata<openvdb::DoubleMetadata>(each)) return noted->value();
  return 0.0;
}

}  // namespace

openvdb::CoordBBox leafBoxOf(const openvdb::CoordBBox& active) {
  constexpr int kWithin = kSide - 1;
  openvdb::CoordBBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = active.min()[axis] & ~kWithin;
    box.max()[axis] = active.max()[axis] | kWithin;
  }
  return box;
}

BandShape::BandShape(const openvdb::FloatGrid& grid, const openvdb::CoordBBox& lattice)
    : low_(lattice.min()), background_(grid.background()) {
  for (int axis = 0; axis < 3; ++axis) dims_[axis] = lattice.max()[axis] - lattice.min()[axis] + 1;
  if (!(std::isfinite(background_) && background_ > 0.0f))
    throw Error(ErrorCode::Unsupported,
                "its background is not a positive distance, so it is no level set; convert it to one");
  // Values of 16 bits may differ from the width that is noted.
  const double noted = notedWidth(grid, kVdbOutsideKey);
  outside_ = float(noted) == background_ ? noted : double(background_);
  findInside(grid);
  addTiles(grid.tree());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) add(*leaf);
  std::ranges::sort(leaves_, comesBefore);
  tiles_ = joined(std::move(tiles_), dims_);
}

/// Finds the value of what lies inside and is not active: the least one. If there is none, all values inside
/// are stored, and the band has the width that is noted, or none if any of them lies deeper.
void BandShape::findInside(const openvdb::FloatGrid& grid) {
  float inactive = 0.0f, active = 0.0f;
  const auto count = [&](float value, bool isOn) {
    float& least = isOn ? active : inactive;
    least = std::min(least, value);
  };
  for (auto tile = tilesOf(grid.tree()); tile; ++tile) count(*tile, tile.isValueOn());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    for (openvdb::Index place = 0; place < Leaf::SIZE; ++place)
      count(leaf->getValue(place), leaf->isValueOn(place));
  const double noted = notedWidth(grid, kVdbInsideKey);
  const float width = noted > 0.0 ? float(noted) : background_;
  if (inactive == 0.0f) inactive = active < -width ? -std::numeric_limits<float>::infinity() : -width;
  insideValue_ = inactive;
  inside_ = float(noted) == -inactive ? noted : -inactive == background_ ? outside_ : double(-inactive);
}

bool BandShape::isOnLattice(const glm::ivec3& sample) const {
  return glm::all(glm::greaterThanEqual(sample, glm::ivec3(0))) && glm::all(glm::lessThan(sample, dims_));
}

/// Adds a leaf, unless all its samples on the lattice are those of a tile.
void BandShape::add(const Leaf& leaf) {
  const openvdb::Coord from = leaf.origin() - low_;
  const glm::ivec3 low(from.x(), from.y(), from.z());
  if (!isOnLattice(low)) return;
  bool isOutside = true, isInside = true;
  forEachInLeaf([&](openvdb::Index place, const glm::ivec3& within) {
    if (!isOnLattice(low + within)) return;
    isOutside &= leaf.getValue(place) == background_;
    isInside &= leaf.getValue(place) == insideValue_;
  });
  if (isInside) tiles_.push_back({low, kSide});
  if (!isInside && !isOutside) leaves_.push_back(low);
}

void BandShape::addTiles(const openvdb::FloatTree& tree) {
  const openvdb::CoordBBox lattice(low_, low_.offsetBy(dims_.x - 1, dims_.y - 1, dims_.z - 1));
  for (auto tile = tilesOf(tree); tile; ++tile) {
    if (*tile == background_) continue;
    openvdb::CoordBBox box;
    tile.getBoundingBox(box);
    const int side = box.dim().x();
    box.intersect(lattice);
    if (box.empty()) continue;
    const openvdb::Coord from = box.min() - low_, to = box.max() - low_;
    const glm::ivec3 low(from.x(), from.y(), from.z()), end(to.x() + 1, to.y() + 1, to.z() + 1);
    if (*tile == insideValue_)
      addInside(low, end, side);
    else
      addLeaves(low, end);
  }
}

/// Adds the tiles of a box, whose samples all lie inside: cubes of up to this side.
void BandShape::addInside(const glm::ivec3& low, const glm::ivec3& end, int side) {
  const glm::ivec3 first = low & ~(side - 1);
  for (glm::ivec3 cube = first; cube.z < end.z; cube.z += side)
    for (cube.y = first.y; cube.y < end.y; cube.y += side)
      for (cube.x = first.x; cube.x < end.x; cube.x += side) {
        const glm::ivec3 cubeEnd = glm::min(cube + side, dims_);
        if (glm::all(glm::greaterThanEqual(cube, low)) && glm::all(glm::lessThanEqual(cubeEnd, end)))
          tiles_.push_back({cube, side});
        else
          addInside(glm::max(cube, low), glm::min(cube + side, end), side / 2);
      }
}

/// Adds leaves for a box of samples with one value.
void BandShape::addLeaves(const glm::ivec3& low, const glm::ivec3& end) {
  for (int z = low.z; z < end.z; z += kSide)
    for (int y = low.y; y < end.y; y += kSide)
      for (int x = low.x; x < end.x; x += kSide) leaves_.emplace_back(x, y, z);
}

void BandShape::describe(VdbHeader& header) const {
  header.isBand = 1;
  header.outside = outside_;
  header.inside = inside_;
  header.leaves = leaves_.size();
  header.tiles = tiles_.size();
}

void BandShape::put() const {
  raymap::put(leaves_.data(), leaves_.size() * sizeof(glm::ivec3));
  raymap::put(tiles_.data(), tiles_.size() * sizeof(NarrowBand::Tile));
}

template <class GridType>
void BandShape::putValues(const GridType& grid) const {
  using Value = typename GridType::ValueType;
  constexpr size_t kLeavesAtATime = 64;
  std::vector<Value> values;
  const auto accessor = grid.getConstAccessor();
  for (size_t l = 0; l < leaves_.size(); ++l) {
    const glm::ivec3 low = leaves_[l];
    const openvdb::Coord at = low_.offsetBy(low.x, low.y, low.z);
    const auto* leaf = accessor.probeConstLeaf(at);
    const Value everywhere = leaf ? Value{} : accessor.getValue(at);
    values.resize(values.size() + kLeafSamples, grid.background());
    Value* to = values.data() + values.size() - kLeafSamples;
    forEachInLeaf([&](openvdb::Index place, const glm::ivec3& within) {
      if (isOnLattice(low + within))
        to[(within.z * kSide + within.y) * kSide + within.x] = leaf ? leaf->getValue(place) : everywhere;
    });
    if (values.size() < kLeavesAtATime * kLeafSamples && l + 1 < leaves_.size()) continue;
    raymap::put(values.data(), values.size() * sizeof(Value));
    values.clear();
  }
}

template void BandShape::putValues(const openvdb::FloatGrid& grid) const;
template void BandShape::putValues(const openvdb::Int32Grid& grid) const;

}  // namespace raymap
