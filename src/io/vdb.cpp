// OpenVDB: fields as level sets. The only file that includes it.

#include "vdb.h"

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Activate.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Prune.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ostream>

#include "field_formats.h"

namespace raymap {

namespace {

constexpr const char* kDimsKey = "raymap_dims";
constexpr const char* kBandKey = "raymap_band";

/// OpenVDB's own file class neither writes to a stream nor notices a full disk.
class StreamArchive : public openvdb::io::Archive {
 public:
  void writeTo(std::ostream& out, const openvdb::GridBase::Ptr& grid) const {
    Archive::write(out, openvdb::GridPtrVec{grid}, out.tellp() != std::ostream::pos_type(-1),
                   openvdb::MetaMap());
  }
};

openvdb::CoordBBox boxOf(const Grid& grid) {
  return {openvdb::Coord(0), openvdb::Coord(grid.dims.x - 1, grid.dims.y - 1, grid.dims.z - 1)};
}

/// A tree that holds every sample's value: background ones, and with `mirrored` those of its negative, are
/// inactive and cost nothing where they fill a block.
template <class GridType>
openvdb::GridBase::Ptr makeGrid(const Field& field, const NamedArray& array,
                                typename GridType::ValueType background, bool mirrored) {
  using Value = typename GridType::ValueType;
  const auto* values = reinterpret_cast<const Value*>(array.bytes.data());
  const openvdb::tools::Dense<const Value, openvdb::tools::LayoutXYZ> dense(boxOf(field.grid), values);
  auto grid = GridType::create(background);
  openvdb::tools::copyFromDense(dense, *grid, Value(0));
  if (mirrored) {
    openvdb::tools::deactivate(grid->tree(), Value(-background));
    openvdb::tools::prune(grid->tree());
  }
  return grid;
}

float largestMagnitude(std::span<const float> values) {
  float largest = 0.0F;
  for (const float value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

openvdb::GridBase::Ptr gridOf(const Field& field, const NamedArray& array) {
  openvdb::GridBase::Ptr grid;
  if (array.type == ElementType::UInt32) {
    grid = makeGrid<openvdb::Int32Grid>(field, array, -1, false);  // kNoTriangle in 32 signed bits.
  } else if (array.name == "distance") {
    const float largest = largestMagnitude(field.distance);
    grid = makeGrid<openvdb::FloatGrid>(field, array, largest > 0.0F ? largest : float(field.grid.spacing),
                                        true);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
  } else {
    grid = makeGrid<openvdb::FloatGrid>(field, array, 0.0F, false);
  }
  const Grid& g = field.grid;
  auto transform = openvdb::math::Transform::createLinearTransform(g.spacing);
  transform->postTranslate({g.origin.x, g.origin.y, g.origin.z});
  grid->setTransform(transform);
  grid->setName(std::string(array.name));
  grid->setCreator("raymap");
  grid->insertMeta(kDimsKey, openvdb::Vec3IMetadata({g.dims.x, g.dims.y, g.dims.z}));
  if (field.band > 0.0) grid->insertMeta(kBandKey, openvdb::DoubleMetadata(field.band));
  return grid;
}

/// OpenVDB marks each file with a random number; ours comes from the contents, so that equal fields make
/// equal files.
void replaceIdentifier(std::ostream& out, const NamedArray& array) {
  constexpr std::streamoff kIdentifierOffset = 21;  // After magic, versions and the mark for offsets.
  const auto end = out.tellp();
  if (end == std::ostream::pos_type(-1)) return;
  const auto* bytes = reinterpret_cast<const Bytef*>(array.bytes.data());
  const auto check = static_cast<unsigned>(crc32_z(0, bytes, array.bytes.size()));
  std::array<char, 37> text{};
  std::snprintf(text.data(), text.size(), "%08x-0000-4000-8000-%012zx", check, array.bytes.size());
  out.seekp(kIdentifierOffset).write(text.data(), 36).seekp(end);
}

[[noreturn]] void throwDamaged(const std::filesystem::path& path, const openvdb::Exception& e) {
  throwInvalid(path, "OpenVDB cannot read it: " + std::string(e.what()));
}

/// The first grid of floats, or else of whole numbers.
openvdb::GridBase::Ptr loadGrid(const std::filesystem::path& path) {
  openvdb::io::File file(path.string());
  file.setCopyMaxBytes(0);
  file.open(false);
  std::string name;
  bool isFloat = false;
  const openvdb::GridPtrVecPtr grids = file.readAllGridMetadata();
  for (const auto& grid : *grids) {
    const bool floats = grid->isType<openvdb::FloatGrid>();
    if ((floats && !isFloat) || (name.empty() && grid->isType<openvdb::Int32Grid>())) name = grid->getName();
    isFloat = isFloat || floats;
  }
  if (name.empty()) throwUnsupported(path, "it holds no grid of floats");
  return file.readGrid(name);
}

VdbContents contentsOf(const std::filesystem::path& path, const openvdb::GridBase& grid,
                       openvdb::CoordBBox& box) {
  const auto& transform = grid.transform();
  const openvdb::Vec3d size = transform.voxelSize();
  const openvdb::Vec3d zero = transform.indexToWorld(openvdb::Vec3d(0.0));
  constexpr double kTolerance = 1e-6;
  if (!transform.isLinear()) throwUnsupported(path, "its grid is not straight; resample it");
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d step(0.0);
    step[axis] = 1.0;
    openvdb::Vec3d world = transform.indexToWorld(step) - zero;
    world[axis] -= size[0];
    if (!(world.length() <= kTolerance * size[0] + 1e-12 * zero.length()))
      throwUnsupported(path, "its grid is turned, mirrored or not of cubes; resample it");
  }
  VdbContents contents;
  contents.spacing = size[0];
  if (const auto dims = grid.getMetadata<openvdb::Vec3IMetadata>(kDimsKey)) {
    box = {openvdb::Coord(0), openvdb::Coord(dims->value()) - openvdb::Coord(1)};
  } else {
    box = grid.evalActiveVoxelBoundingBox();
    if (grid.activeVoxelCount() == 0) throwInvalid(path, "its grid has no active voxel");
  }
  if (const auto band = grid.getMetadata<openvdb::DoubleMetadata>(kBandKey)) contents.band = band->value();
  const openvdb::Vec3d origin = transform.indexToWorld(box.min());
  for (int axis = 0; axis < 3; ++axis) {
    contents.dims[axis] = int64_t{box.max()[axis]} - box.min()[axis] + 1;
    contents.origin[axis] = origin[axis];
  }
  grid.getName().copy(contents.name.data(), contents.name.size() - 1);
  contents.type = grid.isType<openvdb::Int32Grid>() ? ElementType::Int32 : ElementType::Float32;
  return contents;
}

void writeAll(const std::filesystem::path& path, int descriptor, const void* data, size_t count) {
  const auto* bytes = static_cast<const char*>(data);
  while (count > 0) {
    const ssize_t written = ::write(descriptor, bytes, count);
    if (written <= 0) throw Error(ErrorCode::Memory, path.string() + ": no memory for its samples");
    bytes += written;
    count -= static_cast<size_t>(written);
  }
}

/// A few slices at a time: the whole is never in memory twice.
template <class GridType>
void copySamples(const std::filesystem::path& path, const openvdb::GridBase& base,
                 const openvdb::CoordBBox& box, int descriptor) {
  constexpr int kSlices = 8;  // A leaf's side.
  const auto& grid = static_cast<const GridType&>(base);
  for (int z = box.min().z(); z <= box.max().z(); z += kSlices) {
    openvdb::CoordBBox slab = box;
    slab.min().z() = z;
    slab.max().z() = std::min(z + kSlices - 1, box.max().z());
    openvdb::tools::Dense<typename GridType::ValueType, openvdb::tools::LayoutXYZ> dense(slab);
    openvdb::tools::copyToDense(grid, dense, /*serial=*/true);
    writeAll(path, descriptor, dense.data(), dense.valueCount() * sizeof(typename GridType::ValueType));
  }
}

}  // namespace

void initializeVdb() {
  openvdb::initialize();  // Locks, and does nothing the second time.
}

void writeVdb(std::ostream& out, const Field& field, const NamedArray& array) {
  initializeVdb();
  try {
    StreamArchive().writeTo(out, gridOf(field, array));
  } catch (const openvdb::Exception& e) {
    throw Error(ErrorCode::File, std::string("OpenVDB cannot write the field: ") + e.what());
  }
  replaceIdentifier(out, array);
}

void copyVdb(const std::filesystem::path& path, uint64_t limit, int descriptor) {
  try {
    const openvdb::GridBase::Ptr grid = loadGrid(path);
    openvdb::CoordBBox box;
    const VdbContents contents = contentsOf(path, *grid, box);
    checkedSampleCount(path, contents.dims, contents.type, limit);
    writeAll(path, descriptor, &contents, sizeof contents);
    if (contents.type == ElementType::Int32)
      copySamples<openvdb::Int32Grid>(path, *grid, box, descriptor);
    else
      copySamples<openvdb::FloatGrid>(path, *grid, box, descriptor);
  } catch (const openvdb::Exception& e) {
    throwDamaged(path, e);
  }
}

}  // namespace raymap
