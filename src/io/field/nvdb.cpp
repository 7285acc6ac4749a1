// Writes OpenVDB's grids as files of NanoVDB. By itself, for the converter takes long to compile.

#include "io/field/nvdb.h"

#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/tools/Prune.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "io/field/nvdb_nodes.h"
#include "io/field/vdb_module.h"

namespace raymap {

namespace {

constexpr size_t kAlignment = NANOVDB_DATA_ALIGNMENT;

/// Memory of a grid, for NanoVDB's classes. Begins as zeros, since grids have gaps that they leave as they
/// are. An allocator is a buffer without memory, which tells how many bytes to add at the end.
class ZeroedBuffer {
 public:
  explicit ZeroedBuffer(uint64_t added = 0) : added_(added) {}

  static ZeroedBuffer create(uint64_t bytes, const ZeroedBuffer* allocator) {
    ZeroedBuffer made;
    made.bytes_ = bytes + allocator->added_;
    vdbHost().checkFormatMemory(made.bytes_);
    made.data_.reset(static_cast<uint8_t*>(::operator new(made.bytes_, std::align_val_t(kAlignment))));
    std::memset(made.data_.get(), 0, made.bytes_);
    return made;
  }
  uint8_t* data() { return data_.get(); }
  const uint8_t* data() const { return data_.get(); }
  uint64_t size() const { return bytes_; }
  void clear() { *this = ZeroedBuffer(); }

 private:
  struct Delete {
    void operator()(uint8_t* data) const { ::operator delete(data, std::align_val_t(kAlignment)); }
  };
  std::unique_ptr<uint8_t, Delete> data_;
  uint64_t bytes_ = 0, added_ = 0;
};

using Handle = nanovdb::GridHandle<ZeroedBuffer>;

std::string metadataOf(const openvdb::GridBase& grid) {
  std::ostringstream text;
  grid.writeMeta(text);
  return text.str();
}

/// Writes metadata behind a grid, as its blind data.
void append(const std::string& metadata, uint64_t room, nanovdb::GridData& grid) {
  auto* about = nanovdb::PtrAdd<nanovdb::GridBlindMetaData>(&grid, int64_t(grid.mGridSize));
  grid.mBlindMetadataOffset = int64_t(grid.mGridSize);
  grid.mBlindMetadataCount = 1;
  grid.mGridSize += room;
  about->setBlindData(about + 1);
  about->mElementCount = metadata.size();
  about->mFlags = 1;  // Later versions take it for the size of an element.
  about->mSemantic = nanovdb::GridBlindDataSemantic::Unknown;
  about->mDataClass = nanovdb::GridBlindDataClass::Unknown;
  about->mDataType = nanovdb::GridType::Unknown;
  std::strcpy(about->mName, kNvdbMetadataName);
  std::memcpy(about + 1, metadata.data(), metadata.size());
}

/// Converts a grid. `Build` is the type of its values in the file.
template <class GridType, class Build>
Handle convert(openvdb::GridBase& base) {
  using Value = typename GridType::ValueType;
  auto& grid = static_cast<GridType&>(base);
  // The range of a leaf with one value has no steps. As a tile, it needs none.
  if constexpr (!std::is_same_v<Build, Value>) openvdb::tools::prune(grid.tree());
  const std::string metadata = metadataOf(grid);
  const uint64_t room =
      (sizeof(nanovdb::GridBlindMetaData) + metadata.size() + kAlignment - 1) / kAlignment * kAlignment;
  nanovdb::OpenToNanoVDB<Value, Build, nanovdb::AbsDiff, ZeroedBuffer> converter;
  converter.setChecksum(nanovdb::ChecksumMode::Disable);
  converter.setStats(nanovdb::StatsMode::Disable);
  Handle handle = converter(grid, ZeroedBuffer(room));
  auto* made = handle.template grid<Build>();
  // Several threads would add up means in an order of their own each time. Without active values there is
  // nothing to tell, which the statistics warn of.
  if (grid.activeVoxelCount() > 0)
    tbb::task_arena(1).execute([&] { nanovdb::gridStats(*made, nanovdb::StatsMode::Default); });
  placeEmptyNodes(*made);
  append(metadata, room, *made->data());
  nanovdb::updateChecksum(*made, nanovdb::ChecksumMode::Full);
  return handle;
}

Handle convert(openvdb::GridBase& grid) {
  if (!grid.isType<openvdb::FloatGrid>()) return convert<openvdb::Int32Grid, int32_t>(grid);
  return grid.saveFloatAsHalf() ? convert<openvdb::FloatGrid, nanovdb::Fp16>(grid)
                                : convert<openvdb::FloatGrid, float>(grid);
}

}  // namespace

void putNvdb(std::ostream& out, openvdb::GridPtrVec& grids) {
  std::vector<Handle> handles;
  nanovdb::io::Segment about;
  for (openvdb::GridBase::Ptr& grid : grids) {
    handles.push_back(convert(*grid));
    grid.reset();
    about.add(handles.back());
    about.meta.back().fileSize = handles.back().size();
  }
  about.write(out);
  for (const Handle& handle : handles)
    out.write(reinterpret_cast<const char*>(handle.data()), std::streamsize(handle.size()));
}

}  // namespace raymap
