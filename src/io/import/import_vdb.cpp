// Reads a .vdb with OpenVDB, for `raymap-import`.

#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Dense.h>
#include <raymap/error.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/text.h"
#include "io/field/vdb.h"
#include "io/import/import_band.h"
#include "io/import/import_grids.h"
#include "io/import/import_stream.h"
#include "io/import/raymap_import.h"

namespace raymap {

namespace {

/// Returns the name of the array that a grid holds.
std::string arrayOf(const openvdb::GridBase& grid) {
  const auto array = grid.getMetadata<openvdb::StringMetadata>(kVdbArrayKey);
  return array ? array->value() : grid.getName();
}

bool isOurs(const openvdb::GridBase& grid) {
  static const std::set<std::string> kNames{"distance", "winding", "confidence", "triangle"};
  return kNames.contains(arrayOf(grid)) && grid.getMetadata<openvdb::Vec3IMetadata>(kVdbDimsKey) &&
         (grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::Int32Grid>());
}

/// Returns whether a grid holds a further array of the field with this name, of several in the file.
bool belongsTo(const openvdb::GridBase& grid, const std::string& field) {
  const auto noted = grid.getMetadata<openvdb::StringMetadata>(kVdbFieldKey);
  return isOurs(grid) && noted && noted->value() == field && grid.getName() != field;
}

bool isDistance(const openvdb::GridBase& grid) {
  return isOurs(grid) && arrayOf(grid) == "distance";
}

/// Throws `Error(Usage)` unless one of the grids has this name, and Unsupported unless its values can be
/// read.
void checkName(const std::string& name, const openvdb::GridPtrVec& grids) {
  std::string known;
  for (const auto& grid : grids) {
    if (grid->getName() == name) {
      if (grid->isType<openvdb::FloatGrid>() || grid->isType<openvdb::Int32Grid>()) return;
      throw Error(ErrorCode::Unsupported, "its grid " + excerpt(name, kLongestName) +
                                              " holds neither floats nor whole numbers of 32 bits");
    }
    known += (known.empty() ? "" : ", ") + excerpt(grid->getName(), kLongestName);
  }
  throw Error(ErrorCode::Usage, "it has no grid " + excerpt(name, kLongestName) + "; its grids are " + known);
}

/// Returns the names of the grids to read: all that raymap wrote of one field, the distance first, or else
/// the first level set, or else the first grid of floats, or else of integers. If a name is given, the grid
/// with it, and what raymap wrote with it.
std::vector<std::string> chooseGrids(const openvdb::GridPtrVec& grids, const std::string& name) {
  std::vector<std::string> ours, distances, levelSets, floats, integers;
  for (const auto& grid : grids) {
    if (isOurs(*grid)) (isDistance(*grid) ? distances : ours).push_back(grid->getName());
    const bool isLevelSet = grid->getGridClass() == openvdb::GRID_LEVEL_SET;
    if (grid->isType<openvdb::FloatGrid>()) (isLevelSet ? levelSets : floats).push_back(grid->getName());
    if (grid->isType<openvdb::Int32Grid>()) integers.push_back(grid->getName());
  }
  const size_t fields = distances.size();
  ours.insert(ours.begin(), distances.begin(), distances.end());
  if (std::set<std::string>(ours.begin(), ours.end()).size() < ours.size())
    throw Error(ErrorCode::Input, "two of its grids have the same name");
  if (!name.empty()) checkName(name, grids);
  if (fields > 1) {
    std::vector<std::string> chosen{name.empty() ? ours.front() : name};
    for (const auto& grid : grids)
      if (belongsTo(*grid, chosen.front())) chosen.push_back(grid->getName());
    return chosen;
  }
  if (!name.empty() && (fields == 0 || name != ours.front())) return {name};
  if (!ours.empty()) return ours;
  for (const auto* names : {&levelSets, &floats, &integers})
    if (!names->empty()) return {names->front()};
  throw Error(ErrorCode::Unsupported, "it holds no grid of floats");
}

/// Returns the names of the other grids, a line each.
std::string othersThan(const std::vector<std::string>& chosen, const openvdb::GridPtrVec& grids) {
  std::set<std::string> first(chosen.begin(), chosen.end());
  std::string names;
  for (const auto& grid : grids)
    if (first.erase(grid->getName()) == 0) names += grid->getName() + "\n";
  return names;
}

/// Returns the largest magnitude of a foreign level set's distances, its background; 0 if that is none. Only
/// a narrow band has no active value beyond it.
double bandOf(const openvdb::GridBase& base) {
  constexpr float kRounding = 1.00001F;
  if (base.getGridClass() != openvdb::GRID_LEVEL_SET || !base.isType<openvdb::FloatGrid>()) return 0.0;
  const auto& grid = static_cast<const openvdb::FloatGrid&>(base);
  const float background = grid.background();
  if (!std::isfinite(background) || background <= 0.0F) return 0.0;
  for (auto value = grid.cbeginValueOn(); value; ++value)
    if (!(std::abs(*value) <= background * kRounding)) return 0.0;
  return background;
}

/// Returns the index of the first sample of a grid that raymap wrote. Throws `Error(Input)` if the indices of
/// its samples may exceed 32 bits.
openvdb::Coord lowOf(const openvdb::GridBase& grid) {
  const auto low = grid.getMetadata<openvdb::Vec3IMetadata>(kVdbLowKey);
  if (!low) return openvdb::Coord(0);
  constexpr int kMost = 1 << 30;
  const auto dims = grid.getMetadata<openvdb::Vec3IMetadata>(kVdbDimsKey);
  for (int axis = 0; axis < 3; ++axis)
    if (low->value()[axis] < -kMost || low->value()[axis] > kMost || !dims || dims->value()[axis] > kMost)
      throw Error(ErrorCode::Input,
                  std::string("its ") + kVdbLowKey + " or " + kVdbDimsKey + " is no place of samples");
  return openvdb::Coord(low->value());
}

/// Gives clamped samples the values that they had before they were stored as the background.
void restoreClamped(openvdb::GridBase& base) {
  const auto noted = base.getMetadata<openvdb::Vec2SMetadata>(kVdbClampedKey);
  if (!noted || !base.isType<openvdb::FloatGrid>()) return;
  auto& grid = static_cast<openvdb::FloatGrid&>(base);
  const float outside = noted->value()[0], inside = noted->value()[1], background = grid.background();
  constexpr float kLeast = 0.99f;  // Stored widths are larger by a step of 16 bits at most.
  if (!(outside >= kLeast * background && outside <= background && inside > 0.0f)) return;
  openvdb::tools::changeAsymmetricLevelSetBackground(grid.tree(), outside, -inside, /*threaded=*/false);
  // 16 bits may have rounded active values up.
  for (auto value = grid.beginValueOn(); value; ++value) value.setValue(std::clamp(*value, -inside, outside));
}

/// Says where the samples of a box lie.
void place(const openvdb::GridBase& grid, const openvdb::CoordBBox& box, VdbHeader& header) {
  const openvdb::Vec3d origin = grid.transform().indexToWorld(box.min());
  for (int axis = 0; axis < 3; ++axis) {
    header.dims[axis] = int64_t{box.max()[axis]} - box.min()[axis] + 1;
    header.origin[axis] = origin[axis];
  }
}

/// Returns what a grid is, with the box of its samples.
VdbHeader headerOf(const openvdb::GridBase& grid, openvdb::CoordBBox& box) {
  const auto& transform = grid.transform();
  const openvdb::Vec3d size = transform.voxelSize();
  const openvdb::Vec3d zero = transform.indexToWorld(openvdb::Vec3d(0.0));
  constexpr double kTolerance = 1e-6;
  if (!std::isfinite(size.length()) || !std::isfinite(zero.length()))
    throw Error(ErrorCode::Input, "its grid has a spacing or an origin that is not finite");
  if (!transform.isLinear()) throw Error(ErrorCode::Unsupported, "its grid is not straight; resample it");
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d step(0.0);
    step[axis] = 1.0;
    openvdb::Vec3d world = transform.indexToWorld(step) - zero;
    world[axis] -= size[0];
    if (!(world.length() <= kTolerance * size[0] + 1e-12 * zero.length()))
      throw Error(ErrorCode::Unsupported, "its grid is turned, mirrored or not of cubes; resample it");
  }
  VdbHeader header;
  header.spacing = size[0];
  if (const auto dims = grid.getMetadata<openvdb::Vec3IMetadata>(kVdbDimsKey)) {
    box.min() = lowOf(grid);
    box.max() = box.min() + openvdb::Coord(dims->value()) - openvdb::Coord(1);
  } else {
    box = grid.evalActiveVoxelBoundingBox();
    if (grid.activeVoxelCount() == 0) throw Error(ErrorCode::Input, "its grid has no active voxel");
    header.clampDistance = bandOf(grid);
  }
  for (const char* key : {kVdbFormerClampKey, kVdbClampKey})
    if (const auto found = grid.getMetadata<openvdb::DoubleMetadata>(key))
      header.clampDistance = found->value();
  const auto low = grid.getMetadata<openvdb::Vec3DMetadata>(kVdbSurfaceMinKey),
             high = grid.getMetadata<openvdb::Vec3DMetadata>(kVdbSurfaceMaxKey);
  header.hasSurface = low && high ? 1 : 0;
  for (int axis = 0; axis < 3 && header.hasSurface != 0; ++axis) {
    header.surface[axis] = low->value()[axis];
    header.surface[3 + axis] = high->value()[axis];
  }
  place(grid, box, header);
  arrayOf(grid).copy(header.name.data(), header.name.size() - 1);
  header.isWhole = grid.isType<openvdb::Int32Grid>() ? 1 : 0;
  return header;
}

/// Writes the samples a few slices at a time, so the whole grid is never in memory twice.
template <class GridType>
void putSamples(const GridType& grid, const openvdb::CoordBBox& box) {
  constexpr int kSlices = 8;  // Side of a leaf node.
  for (int z = box.min().z(); z <= box.max().z(); z += kSlices) {
    openvdb::CoordBBox slab = box;
    slab.min().z() = z;
    slab.max().z() = std::min(z + kSlices - 1, box.max().z());
    openvdb::tools::Dense<typename GridType::ValueType, openvdb::tools::LayoutXYZ> dense(slab);
    openvdb::tools::copyToDense(grid, dense, /*serial=*/true);
    put(dense.data(), dense.valueCount() * sizeof(typename GridType::ValueType));
  }
}

/// Returns whether a grid is sent as a narrow band. Throws `Error(Unsupported)` if it must be and cannot.
bool isSentAsBand(const openvdb::GridBase& grid, const VdbHeader& header, uint64_t mostDense) {
  const double samples = double(header.dims[0]) * double(header.dims[1]) * double(header.dims[2]);
  if (samples <= double(mostDense)) return false;
  const bool isLevelSet = grid.getGridClass() == openvdb::GRID_LEVEL_SET && grid.isType<openvdb::FloatGrid>();
  if (!isLevelSet && mostDense == 0)
    throw Error(ErrorCode::Unsupported, "its grid " + excerpt(grid.getName(), kLongestName) +
                                            " is no level set of floats, so it " +
                                            "is no narrow band; read it as a field");
  return isLevelSet;
}

/// Returns the leaves of a grid, and says what they are. A grid of another program is placed anew: its
/// lattice begins and ends with whole leaves.
BandShape shapeOf(const openvdb::GridBase& grid, openvdb::CoordBBox box, VdbHeader& header) {
  if (!isOurs(grid)) box = leafBoxOf(box);
  place(grid, box, header);
  if (std::ranges::max(header.dims) > kMostDims)
    throw Error(ErrorCode::Unsupported, "its grid has " + std::to_string(std::ranges::max(header.dims)) +
                                            " samples along an axis, more than " + std::to_string(kMostDims) +
                                            "; crop it");
  BandShape shape(static_cast<const openvdb::FloatGrid&>(grid), box);
  shape.describe(header);
  return shape;
}

void putValues(const openvdb::GridBase& grid, const openvdb::CoordBBox& box,
               const std::optional<BandShape>& band) {
  const auto put = [&]<class GridType>(const GridType& typed) {
    band ? band->putValues(typed) : putSamples(typed, box);
  };
  if (grid.isType<openvdb::Int32Grid>())
    put(static_cast<const openvdb::Int32Grid&>(grid));
  else
    put(static_cast<const openvdb::FloatGrid&>(grid));
}

}  // namespace

void sendGrids(const openvdb::GridPtrVec& grids, const GridReader& read, const std::string& gridName,
               uint64_t mostDense) {
  constexpr rlimit kNoLimit{RLIM_INFINITY, RLIM_INFINITY};
  const std::vector<std::string> names = chooseGrids(grids, gridName);
  std::optional<BandShape> band;
  for (size_t g = 0; g < names.size(); ++g) {
    const openvdb::GridBase::Ptr grid = read(names[g]);
    restoreClamped(*grid);
    openvdb::CoordBBox box;
    VdbHeader header = headerOf(*grid, box);
    header.gridsAfter = names.size() - 1 - g;
    if (g == 0) {
      if (isSentAsBand(*grid, header, mostDense)) band = shapeOf(*grid, box, header);
      // The remaining time grows with the number of samples, which the parent process limits.
      setrlimit(RLIMIT_CPU, &kNoLimit);
      sendSuccess(othersThan(names, grids));
    }
    put(&header, sizeof header);
    if (g == 0 && band) band->put();
    putValues(*grid, box, band);
  }
}

void sendVdb(int descriptor, const std::string& gridName, uint64_t mostDense) {
  openvdb::initialize();
  useOneThread();
  openvdb::io::File file("/proc/self/fd/" + std::to_string(descriptor));
#ifdef OPENVDB_USE_DELAYED_LOADING
  file.setCopyMaxBytes(0);
#endif
  file.open(false);
  sendGrids(
      *file.readAllGridMetadata(), [&](const std::string& name) { return file.readGrid(name); }, gridName,
      mostDense);
}

}  // namespace raymap
