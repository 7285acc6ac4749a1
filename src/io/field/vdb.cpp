// Writes fields as OpenVDB level sets; import/read_vdb.cpp and import/import_vdb.cpp read them.

#include "io/field/vdb.h"

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Activate.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Prune.h>
#include <zlib.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "base/parallel.h"
#include "io/field/field_formats.h"

namespace raymap {

namespace {

/// Archive that writes to a stream. OpenVDB's own file class neither does so nor notices a full disk.
class StreamArchive : public openvdb::io::Archive {
 public:
  void writeTo(std::ostream& out, const openvdb::GridPtrVec& grids) const {
    Archive::write(out, grids, out.tellp() != std::ostream::pos_type(-1), openvdb::MetaMap());
  }
};

openvdb::CoordBBox boxOf(const Grid& grid) {
  return {openvdb::Coord(0), openvdb::Coord(grid.dims.x - 1, grid.dims.y - 1, grid.dims.z - 1)};
}

/// Returns a tree with the value of every sample. Background values are inactive; with `mirrored`, so are
/// values of the negated background. Where either fills a block, the block takes no memory.
template <class GridType>
openvdb::GridBase::Ptr makeGrid(const Field& field, const NamedArray& array,
                                typename GridType::ValueType background, bool mirrored) {
  using Value = typename GridType::ValueType;
  const auto* values = reinterpret_cast<const Value*>(array.bytes.data());
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

float largestMagnitude(std::span<const float> values) {
  float largest = 0.0F;
  for (const float value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Value outside of the stored samples, and what it means.
struct Background {
  float value;
  const char* meaning;
};

/// Returns the band of clamped distances. Without one, returns a value above all distances, so that every
/// sample is active.
Background backgroundOf(const Field& field) {
  constexpr double kRounding = 1e-5;
  const float largest = largestMagnitude(field.distance);
  if (field.clampDistance > 0.0 && largest <= field.clampDistance * (1.0 + kRounding))
    return {largest < field.clampDistance * (1.0 - kRounding) ? float(field.clampDistance) : largest,
            "band: distances are clamped to this magnitude"};
  const float above =
      largest > 0.0F ? std::min(std::nextafter(largest, INFINITY), FLT_MAX) : float(field.grid.spacing);
  return {above, "no band: more than every distance in the grid; outside of the grid nothing is known"};
}

openvdb::GridBase::Ptr gridOf(const Field& field, const NamedArray& array) {
  openvdb::GridBase::Ptr grid;
  const char* meaning = "outside of the grid nothing is known";
  if (array.type == ElementType::UInt32) {
    grid = makeGrid<openvdb::Int32Grid>(field, array, -1, false);  // kNoTriangle in 32 signed bits.
  } else if (array.name == "distance") {
    const Background background = backgroundOf(field);
    meaning = background.meaning;
    grid = makeGrid<openvdb::FloatGrid>(field, array, background.value, true);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
  } else {
    grid = makeGrid<openvdb::FloatGrid>(field, array, 0.0F, false);
  }
  grid->insertMeta(kVdbBackgroundKey, openvdb::StringMetadata(meaning));
  const Grid& g = field.grid;
  auto transform = openvdb::math::Transform::createLinearTransform(g.spacing);
  transform->postTranslate({g.origin.x, g.origin.y, g.origin.z});
  grid->setTransform(transform);
  grid->setName(std::string(array.name));
  grid->setCreator("raymap");
  grid->insertMeta(kVdbDimsKey, openvdb::Vec3IMetadata({g.dims.x, g.dims.y, g.dims.z}));
  if (field.clampDistance > 0.0) grid->insertMeta(kVdbClampKey, openvdb::DoubleMetadata(field.clampDistance));
  if (const auto& [low, high] = field.surfaceBounds; !field.surfaceBounds.isEmpty()) {
    grid->insertMeta(kVdbSurfaceMinKey, openvdb::Vec3DMetadata({low.x, low.y, low.z}));
    grid->insertMeta(kVdbSurfaceMaxKey, openvdb::Vec3DMetadata({high.x, high.y, high.z}));
  }
  return grid;
}

/// Replaces the random identifier that OpenVDB gives each file by one computed from the contents. Equal
/// fields then make equal files.
void replaceIdentifier(std::ostream& out, const std::vector<NamedArray>& arrays) {
  // The magic number, the versions and the offsets flag come first.
  constexpr std::streamoff kIdentifierOffset = 21;
  const auto end = out.tellp();
  if (end == std::ostream::pos_type(-1)) return;
  uLong check = 0;
  size_t count = 0;
  for (const NamedArray& array : arrays) {
    check = crc32_z(check, reinterpret_cast<const Bytef*>(array.bytes.data()), array.bytes.size());
    count += array.bytes.size();
  }
  std::array<char, 37> text{};
  std::snprintf(text.data(), text.size(), "%08x-0000-4000-8000-%012zx", static_cast<unsigned>(check), count);
  out.seekp(kIdentifierOffset).write(text.data(), 36).seekp(end);
}

}  // namespace

void writeVdb(std::ostream& out, const Field& field, const NamedArray& array) {
  openvdb::initialize();  // Thread-safe; later calls do nothing.
  const std::vector<NamedArray> arrays = arraysWith(field, array);
  try {
    withCallersThreads([&] {
      openvdb::GridPtrVec grids;
      for (const NamedArray& each : arrays) grids.push_back(gridOf(field, each));
      StreamArchive().writeTo(out, grids);
    });
  } catch (const openvdb::Exception& e) {
    throw Error(ErrorCode::File, std::string("OpenVDB cannot write the field: ") + e.what());
  }
  replaceIdentifier(out, arrays);
}

}  // namespace raymap
