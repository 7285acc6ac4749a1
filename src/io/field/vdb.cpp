// Writes fields as level sets of OpenVDB and NanoVDB; import/read_vdb.cpp and import/import_vdb.cpp read
// them.

#include "io/field/vdb.h"

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Activate.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Prune.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "io/field/nvdb.h"
#include "io/field/vdb_module.h"

namespace raymap {

namespace {

/// Archive that writes to a stream. OpenVDB's own file class neither does so nor notices a full disk.
class StreamArchive : public openvdb::io::Archive {
 public:
  void writeTo(std::ostream& out, const openvdb::GridPtrVec& grids) const {
    Archive::write(out, grids, out.tellp() != std::ostream::pos_type(-1), openvdb::MetaMap());
  }
};

/// Returns the index of a grid's first sample in a file: 0, 0, 0, or where it lies in multiples of the
/// spacing, if it lies on whole leaves. All such grids of one spacing have the same transform.
openvdb::Coord lowOf(const Grid& grid) {
  constexpr double kMost = 0x1p30;
  openvdb::Coord low;
  for (int axis = 0; axis < 3; ++axis) {
    const double steps = std::round(grid.origin[axis] / grid.spacing);
    if (!(std::abs(steps) < kMost) || steps * grid.spacing != grid.origin[axis]) return {};
    low[axis] = int(steps);
    if (low[axis] % NarrowBand::kLeafSide != 0) return {};
  }
  return low;
}

openvdb::CoordBBox boxOf(const Grid& grid) {
  const openvdb::Coord low = lowOf(grid);
  return {low, low.offsetBy(grid.dims.x - 1, grid.dims.y - 1, grid.dims.z - 1)};
}

/// Throws `Error(Memory)` if a tree of so many leaves does not fit: OpenVDB's classes end the program when
/// memory runs out.
void checkTree(uint64_t leaves) {
  constexpr uint64_t kLeafBytes = NarrowBand::kLeafSamples * sizeof(float) + 256;  // With its masks.
  vdbHost().checkFormatMemory(leaves * kLeafBytes);
}

/// Returns how many leaves of a grid have samples of different values. The others become tiles.
template <class Value>
uint64_t countMixedLeaves(const Grid& grid, const Value* values) {
  constexpr int kSide = NarrowBand::kLeafSide;
  const glm::ivec3 leaves = (grid.dims + (kSide - 1)) / kSide;
  const auto isMixed = [&](const glm::ivec3& low) {
    const glm::ivec3 high = glm::min(low + kSide, grid.dims);
    const Value first = values[grid.index(low)];
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y) {
        const Value* row = values + grid.index({low.x, y, z});
        if (std::any_of(row, row + (high.x - low.x), [&](Value v) { return v != first; })) return true;
      }
    return false;
  };
  std::atomic<uint64_t> count{0};
  vdbHost().parallelFor(size_t(leaves.z), 1, [&](size_t slab, size_t) {
    for (int y = 0; y < leaves.y; ++y)
      for (int x = 0; x < leaves.x; ++x) count += isMixed(kSide * glm::ivec3(x, y, int(slab))) ? 1 : 0;
  });
  return count;
}

/// Returns a tree with the value of every sample. Background values are inactive; with `mirrored`, so are
/// values of the negated background. Where either fills a block, the block takes no memory.
template <class GridType>
openvdb::GridBase::Ptr makeGrid(const Field& field, const NamedArray& array,
                                typename GridType::ValueType background, bool mirrored) {
  using Value = typename GridType::ValueType;
  const auto* values = reinterpret_cast<const Value*>(array.bytes.data());
  checkTree(countMixedLeaves(field.grid, values));
  const openvdb::tools::Dense<const Value, openvdb::tools::LayoutXYZ> dense(boxOf(field.grid), values);
  // OpenVDB makes the empty grid itself: its classes would take ten seconds to compile here.
  openvdb::GridBase::Ptr made = openvdb::GridBase::createGrid(GridType::gridType());
  auto& grid = static_cast<GridType&>(*made);
  openvdb::tools::changeBackground(grid.tree(), background);
  openvdb::tools::copyFromDense(dense, grid, Value(0));
  if (mirrored) {
    openvdb::tools::deactivate(grid.tree(), Value(-background));
    openvdb::tools::prune(grid.tree());
  }
  return made;
}

/// Magnitudes on both sides of a surface.
struct Sides {
  float outside = 0.0F, inside = 0.0F;
  bool operator==(const Sides&) const = default;
};

/// Returns the largest magnitudes of values for which `isActive(value)` holds.
template <class IsActive>
Sides farthestOf(std::span<const float> values, IsActive&& isActive) {
  Sides farthest;
  for (const float value : values) {
    if (!isActive(value)) continue;
    farthest.outside = std::max(farthest.outside, value);
    farthest.inside = std::max(farthest.inside, -value);
  }
  return farthest;
}

/// Returns the larger magnitude for both sides, whose inactive values have one magnitude in a level set.
Sides sameOnBothSides(const Sides& sides) {
  return {std::max(sides.outside, sides.inside), std::max(sides.outside, sides.inside)};
}

/// Returns the least half float that is not below a number.
openvdb::math::half halfFrom(float number) {
  openvdb::math::half half(number);
  if (float(half) < number) half.setBits(uint16_t(half.bits() + 1));
  return half;
}

/// Returns the least number that a file can hold, is not below the width of a band, and is above all stored
/// distances. `farthest` is the largest of these, and `range` that of a leaf with both sides; both count only
/// with 16 bits.
float storedWidth(double width, float farthest, float range, const VdbStorage& storage) {
  float least = float(width);
  if (double(least) < width) least = std::nextafter(least, INFINITY);
  if (!storage.half || !std::isfinite(least)) return least;
  if (storage.inSteps) {
    constexpr float kSteps = 65535.0F;
    return std::max(least, std::nextafter(farthest + range / kSteps, INFINITY));
  }
  openvdb::math::half half = halfFrom(least);
  if (const openvdb::math::half stored(farthest); float(stored) >= float(half))
    half.setBits(uint16_t(stored.bits() + 1));
  return half;
}

Sides storedWidths(const glm::dvec2& widths, const Sides& farthest, const VdbStorage& storage) {
  const float range = farthest.outside + farthest.inside;
  return {storedWidth(widths.x, farthest.outside, range, storage),
          storedWidth(widths.y, farthest.inside, range, storage)};
}

/// Replaces the values of inactive samples, and notes those that they had.
void replaceInactive(openvdb::FloatGrid& grid, const Sides& had, const Sides& stored) {
  if (had == stored) return;
  openvdb::tools::changeAsymmetricLevelSetBackground(grid.tree(), stored.outside, -stored.inside);
  grid.insertMeta(kVdbClampedKey, openvdb::Vec2SMetadata({had.outside, had.inside}));
}

/// Value of clamped samples, the width of the band, and what the background means.
struct Background {
  float value;
  double width;
  const char* meaning;
};

/// Returns the band of clamped distances. Without one, returns a value above all distances, so that every
/// sample is active.
Background backgroundOf(const Field& field) {
  constexpr double kRounding = 1e-5;
  const float largest = vdbHost().largestMagnitude(field.distance);
  const double clamp = field.clampDistance;
  if (clamp > 0.0 && largest <= clamp * (1.0 + kRounding)) {
    const float value = largest < clamp * (1.0 - kRounding) ? float(clamp) : largest;
    return {value, std::max(clamp, double(value)), "band: distances are clamped to this magnitude"};
  }
  const float above =
      largest > 0.0F ? std::min(std::nextafter(largest, INFINITY), FLT_MAX) : float(field.grid.spacing);
  return {above, above,
          "no band: more than every distance in the grid; outside of the grid nothing is known"};
}

/// Returns the grid of a field's distances, and says what its background means.
openvdb::GridBase::Ptr distanceGridOf(const Field& field, const NamedArray& array, const VdbStorage& storage,
                                      const char*& meaning) {
  const Background background = backgroundOf(field);
  meaning = background.meaning;
  openvdb::GridBase::Ptr made = makeGrid<openvdb::FloatGrid>(field, array, background.value, true);
  auto& grid = static_cast<openvdb::FloatGrid&>(*made);
  Sides farthest;
  if (storage.half)
    farthest = farthestOf(field.distance, [&](float v) { return std::abs(v) < background.value; });
  replaceInactive(grid, {background.value, background.value},
                  storedWidths(glm::dvec2(background.width), sameOnBothSides(farthest), storage));
  grid.setGridClass(openvdb::GRID_LEVEL_SET);
  return made;
}

/// Which array a grid holds, its name, the size of its numbers, and, of several fields, the name of its own.
struct GridLabel {
  std::string_view array;
  std::string name;
  bool half;
  std::string_view field = {};

  /// Returns the label of an array. The storage names the first one of a file.
  static GridLabel of(std::string_view array, bool isFirst, const VdbStorage& storage) {
    return {array, std::string(isFirst && !storage.gridName.empty() ? storage.gridName : array),
            storage.half};
  }
  /// Returns the label of an array of one of several bands.
  static GridLabel ofSeveral(std::string_view array, const VdbStorage& storage) {
    const std::string_view band = storage.gridName;
    return {array, array == "distance" ? std::string(band) : arrayGridName(band, array), storage.half, band};
  }
};

/// Writes what a grid is. A clamp distance of 0 is unknown.
void describe(openvdb::GridBase& grid, const GridLabel& label, const char* meaning, const Grid& g,
              double clampDistance, const Box& surfaceBounds) {
  auto transform = openvdb::math::Transform::createLinearTransform(g.spacing);
  const openvdb::Coord low = lowOf(g);
  if (low == openvdb::Coord(0))
    transform->postTranslate({g.origin.x, g.origin.y, g.origin.z});
  else
    grid.insertMeta(kVdbLowKey, openvdb::Vec3IMetadata(low.asVec3i()));
  grid.setTransform(transform);
  grid.setName(label.name);
  grid.setSaveFloatAsHalf(label.half && grid.isType<openvdb::FloatGrid>());
  grid.setCreator("raymap");
  grid.insertMeta(kVdbBackgroundKey, openvdb::StringMetadata(meaning));
  grid.insertMeta(kVdbArrayKey, openvdb::StringMetadata(std::string(label.array)));
  if (!label.field.empty()) grid.insertMeta(kVdbFieldKey, openvdb::StringMetadata(std::string(label.field)));
  grid.insertMeta(kVdbDimsKey, openvdb::Vec3IMetadata({g.dims.x, g.dims.y, g.dims.z}));
  if (clampDistance > 0.0) grid.insertMeta(kVdbClampKey, openvdb::DoubleMetadata(clampDistance));
  if (const auto& [low, high] = surfaceBounds; !surfaceBounds.isEmpty()) {
    grid.insertMeta(kVdbSurfaceMinKey, openvdb::Vec3DMetadata({low.x, low.y, low.z}));
    grid.insertMeta(kVdbSurfaceMaxKey, openvdb::Vec3DMetadata({high.x, high.y, high.z}));
  }
}

openvdb::GridBase::Ptr gridOf(const Field& field, const NamedArray& array, const GridLabel& label,
                              const VdbStorage& storage) {
  openvdb::GridBase::Ptr grid;
  const char* meaning = "outside of the grid nothing is known";
  if (array.type == ElementType::UInt32) {
    grid = makeGrid<openvdb::Int32Grid>(field, array, -1, false);  // kNoTriangle in 32 signed bits.
  } else if (array.name == "distance") {
    grid = distanceGridOf(field, array, storage, meaning);
  } else {
    grid = makeGrid<openvdb::FloatGrid>(field, array, 0.0F, false);
  }
  describe(*grid, label, meaning, field.grid, field.clampDistance, field.surfaceBounds);
  return grid;
}

/// Replaces the random identifier that OpenVDB gives each file by one computed from the contents. Equal
/// fields then make equal files.
void replaceIdentifier(std::ostream& out, const std::vector<std::span<const std::byte>>& arrays) {
  // The magic number, the versions and the offsets flag come first.
  constexpr std::streamoff kIdentifierOffset = 21;
  const auto end = out.tellp();
  if (end == std::ostream::pos_type(-1)) return;
  uLong check = 0;
  size_t count = 0;
  for (const std::span<const std::byte> array : arrays) {
    check = crc32_z(check, reinterpret_cast<const Bytef*>(array.data()), array.size());
    count += array.size();
  }
  std::array<char, 37> text{};
  std::snprintf(text.data(), text.size(), "%08x-0000-4000-8000-%012zx", static_cast<unsigned>(check), count);
  out.seekp(kIdentifierOffset).write(text.data(), 36).seekp(end);
}

/// Returns a tree with the leaves of a narrow band. Values that are not active take part in none of OpenVDB's
/// tools.
template <class GridType, class Stored, class IsActive>
openvdb::GridBase::Ptr makeLeaves(const Field& band, std::span<const Stored> values,
                                  typename GridType::ValueType background, IsActive&& isActive) {
  using Leaf = typename GridType::TreeType::LeafNodeType;
  constexpr int kSide = NarrowBand::kLeafSide;
  static_assert(Leaf::DIM == kSide);
  checkTree(band.narrow->leaves.size());
  openvdb::GridBase::Ptr made = openvdb::GridBase::createGrid(GridType::gridType());
  auto& tree = static_cast<GridType&>(*made).tree();
  openvdb::tools::changeBackground(tree, background);
  std::vector<Leaf*> leaves;
  const openvdb::Coord first = lowOf(band.grid);
  for (const glm::ivec3& low : band.narrow->leaves)
    leaves.push_back(tree.touchLeaf(first.offsetBy(low.x, low.y, low.z)));
  vdbHost().parallelFor(leaves.size(), 256, [&](size_t begin, size_t end) {
    for (size_t l = begin; l < end; ++l) {
      const Stored* from = values.data() + l * NarrowBand::kLeafSamples;
      for (int z = 0; z < kSide; ++z)
        for (int y = 0; y < kSide; ++y)
          for (int x = 0; x < kSide; ++x, ++from) {
            const auto place = static_cast<openvdb::Index>((x * kSide + y) * kSide + z);  // z fastest.
            leaves[l]->setValueOnly(place, static_cast<typename GridType::ValueType>(*from));
            leaves[l]->setActiveState(place, isActive(*from));
          }
    }
  });
  return made;
}

std::vector<std::span<const std::byte>> bytesOf(const std::vector<NamedArray>& arrays) {
  std::vector<std::span<const std::byte>> bytes;
  for (const NamedArray& array : arrays) bytes.push_back(array.bytes);
  return bytes;
}

std::vector<std::span<const std::byte>> bytesOf(std::span<const NamedField> bands) {
  std::vector<std::span<const std::byte>> bytes;
  const auto add = [&](const auto& array) { bytes.push_back(std::as_bytes(std::span(array))); };
  for (const NamedField& each : bands) {
    const Field& band = *each.field;
    add(band.narrow->leaves);
    add(band.distance);
    add(band.triangle);
    add(band.winding);
    add(band.confidence);
  }
  return bytes;
}

void putVdb(std::ostream& out, openvdb::GridPtrVec& grids) {
  StreamArchive().writeTo(out, grids);
}

/// Makes grids and writes them by `putVdb` or `putNvdb`.
void writeGrids(std::ostream& out, FunctionView<openvdb::GridPtrVec&> make,
                void (*put)(std::ostream& out, openvdb::GridPtrVec& grids)) {
  openvdb::initialize();  // Thread-safe; later calls do nothing.
  try {
    vdbHost().withCallersThreads([&] {
      openvdb::GridPtrVec grids;
      make(grids);
      put(out, grids);
    });
  } catch (const openvdb::Exception& e) {
    throw Error(ErrorCode::File, std::string("OpenVDB cannot write the field: ") + e.what());
  }
}

/// Returns the grid of a band's distances. What lies inside and in no leaf is filled with one value.
openvdb::GridBase::Ptr distanceGridOf(const Field& band, const VdbStorage& storage) {
  const auto isActive = [&](float value) { return band.narrow->isActive(value); };
  openvdb::GridBase::Ptr made = makeLeaves<openvdb::FloatGrid>(band, std::span<const float>(band.distance),
                                                               float(band.narrow->outside), isActive);
  auto& grid = static_cast<openvdb::FloatGrid&>(*made);
  const openvdb::CoordBBox lattice = boxOf(band.grid);
  for (const NarrowBand::Tile& tile : band.narrow->tiles) {
    openvdb::CoordBBox box =
        openvdb::CoordBBox::createCube(lattice.min().offsetBy(tile.low.x, tile.low.y, tile.low.z), tile.side);
    box.intersect(lattice);
    grid.tree().root().sparseFill(box, -float(band.narrow->inside), false);
  }
  Sides farthest = storage.half ? farthestOf(band.distance, isActive) : Sides{};
  if (band.narrow->inside == band.narrow->outside) farthest = sameOnBothSides(farthest);
  replaceInactive(grid, {float(band.narrow->outside), float(band.narrow->inside)},
                  storedWidths({band.narrow->outside, band.narrow->inside}, farthest, storage));
  openvdb::tools::prune(grid.tree());
  grid.setGridClass(openvdb::GRID_LEVEL_SET);
  return made;
}

/// Adds a grid for each array of a band.
void addGrids(const Field& band, bool isOneOfSeveral, const VdbStorage& storage, openvdb::GridPtrVec& grids) {
  const double clampDistance = band.narrow->inside == band.narrow->outside ? band.narrow->outside : 0.0;
  const auto add = [&](std::string_view name, const char* meaning, openvdb::GridBase::Ptr grid) {
    const GridLabel label = isOneOfSeveral ? GridLabel::ofSeveral(name, storage)
                                           : GridLabel::of(name, name == "distance", storage);
    describe(*grid, label, meaning, band.grid, clampDistance, band.surfaceBounds);
    grids.push_back(std::move(grid));
  };
  constexpr const char* kUnknown = "beyond the band nothing is known";
  const auto always = [](float) { return true; };
  add("distance", "band: distances are clamped to this magnitude", distanceGridOf(band, storage));
  grids.back()->insertMeta(kVdbOutsideKey, openvdb::DoubleMetadata(band.narrow->outside));
  grids.back()->insertMeta(kVdbInsideKey, openvdb::DoubleMetadata(band.narrow->inside));
  if (!band.triangle.empty())
    add("triangle", kUnknown,
        makeLeaves<openvdb::Int32Grid>(band, std::span<const uint32_t>(band.triangle), -1,
                                       [](uint32_t id) { return id != kNoTriangle; }));
  if (!band.winding.empty())
    add("winding", kUnknown,
        makeLeaves<openvdb::FloatGrid>(band, std::span<const float>(band.winding), 0.0F, always));
  if (!band.confidence.empty())
    add("confidence", kUnknown,
        makeLeaves<openvdb::FloatGrid>(band, std::span<const float>(band.confidence), 0.0F, always));
}

void addGrids(const Field& field, const NamedArray& array, const VdbStorage& storage,
              openvdb::GridPtrVec& grids) {
  for (const NamedArray& each : vdbHost().arraysWith(field, array))
    grids.push_back(gridOf(field, each, GridLabel::of(each.name, each.name == array.name, storage), storage));
}

void addGrids(std::span<const NamedField> bands, const VdbStorage& storage, openvdb::GridPtrVec& grids) {
  for (const NamedField& each : bands)
    addGrids(*each.field, bands.size() > 1, {each.name, storage.half, storage.inSteps}, grids);
}

void writeVdb(std::ostream& out, const Field& field, const NamedArray& array, const VdbStorage& storage) {
  writeGrids(
      out, [&](openvdb::GridPtrVec& grids) { addGrids(field, array, storage, grids); }, putVdb);
  replaceIdentifier(out, bytesOf(vdbHost().arraysWith(field, array)));
}

void writeVdb(std::ostream& out, std::span<const NamedField> bands, const VdbStorage& storage) {
  writeGrids(
      out, [&](openvdb::GridPtrVec& grids) { addGrids(bands, storage, grids); }, putVdb);
  replaceIdentifier(out, bytesOf(bands));
}

void writeNvdb(std::ostream& out, const Field& field, const NamedArray& array, const VdbStorage& storage) {
  const VdbStorage inSteps{storage.gridName, storage.half, true};
  writeGrids(
      out, [&](openvdb::GridPtrVec& grids) { addGrids(field, array, inSteps, grids); }, putNvdb);
}

void writeNvdb(std::ostream& out, std::span<const NamedField> bands, const VdbStorage& storage) {
  const VdbStorage inSteps{storage.gridName, storage.half, true};
  writeGrids(
      out, [&](openvdb::GridPtrVec& grids) { addGrids(bands, inSteps, grids); }, putNvdb);
}

}  // namespace

const VdbWriters kVdbWriters{.vdb = {writeVdb, writeVdb}, .nvdb = {writeNvdb, writeNvdb}};

}  // namespace raymap
