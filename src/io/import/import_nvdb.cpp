// Reads a .nvdb with NanoVDB, for `raymap-import`: as grids of OpenVDB, which then go the way of a .vdb.

#include <iostream>  // Which GridValidator.h lacks.

#include <nanovdb/util/GridValidator.h>
#include <nanovdb/util/IO.h>
#include <nanovdb/util/NanoToOpenVDB.h>
#include <openvdb/openvdb.h>
#include <raymap/error.h>
#include <tbb/global_control.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/text.h"
#include "io/field/nvdb.h"
#include "io/field/nvdb_nodes.h"
#include "io/import/import_grids.h"
#include "io/import/raymap_import.h"

namespace raymap {

namespace {

using nanovdb::GridType;

/// Magic number of newer files and of their grids; what comes after it is the same.
constexpr uint64_t kNewFileMagic = 0x324244566f6e614eUL, kNewGridMagic = 0x314244566f6e614eUL;

[[noreturn]] void throwDamaged(const std::string& what) {
  throw Error(ErrorCode::Input, "it is damaged: " + what);
}

/// A file, of which no more is read than it holds.
class Bytes {
 public:
  explicit Bytes(int file) : file_(file) {
    const off_t size = lseek(file, 0, SEEK_END);
    remaining_ = size > 0 ? uint64_t(size) : 0;
    lseek(file, 0, SEEK_SET);
  }

  uint64_t remaining() const { return remaining_; }
  void read(void* to, uint64_t bytes) {
    if (bytes > remaining_) throwDamaged("it ends early");
    remaining_ -= bytes;
    for (char* at = static_cast<char*>(to); bytes > 0;) {
      const ssize_t count = ::read(file_, at, bytes);
      if (count <= 0) throwDamaged("it ends early");
      at += count;
      bytes -= uint64_t(count);
    }
  }
  template <class Value>
  Value read() {
    Value value;
    read(&value, sizeof value);
    return value;
  }

 private:
  int file_;
  uint64_t remaining_ = 0;
};

/// A grid as it lies in the file.
struct NanoGrid {
  std::string name;
  nanovdb::HostBuffer bytes;

  nanovdb::GridData& data() const {
    return *reinterpret_cast<nanovdb::GridData*>(const_cast<uint8_t*>(bytes.data()));
  }
  GridType type() const { return data().mGridType; }
};

void checkVersion(const nanovdb::Version& version) {
  if (version.getMajor() != NANOVDB_MAJOR_VERSION_NUMBER)
    throw Error(ErrorCode::Unsupported, "it has version " + std::to_string(version.getMajor()) +
                                            " of NanoVDB's files, and " +
                                            std::to_string(NANOVDB_MAJOR_VERSION_NUMBER) + " is read");
}

/// Reads a grid of `size` bytes, of which the file holds `packed`.
nanovdb::HostBuffer readBytes(Bytes& file, nanovdb::io::Codec codec, uint64_t size, uint64_t packed) {
  constexpr uint64_t kMostDeflated = 1032;  // Zlib makes no more bytes of one.
  const bool isPlain = codec == nanovdb::io::Codec::NONE;
  if (packed > file.remaining()) throwDamaged("it ends early");
  if (isPlain ? packed != size : packed < size / kMostDeflated) throwDamaged("a grid has two sizes");
  auto bytes = nanovdb::HostBuffer::create(size);
  if (isPlain) {
    file.read(bytes.data(), size);
    return bytes;
  }
  const auto deflated =
      file.read<uint64_t>();  // `packed` counts this number in NanoVDB's files, not in Warp's.
  if (deflated > file.remaining()) throwDamaged("it ends early");
  std::vector<Bytef> source(deflated);
  file.read(source.data(), deflated);
  uLongf inflated = size;
  if (uncompress(bytes.data(), &inflated, source.data(), deflated) != Z_OK || inflated != size)
    throwDamaged("a grid does not decompress");
  return bytes;
}

/// Checks what the conversion of a grid trusts, except for the tree.
void checkGrid(NanoGrid& grid) {
  nanovdb::GridData& data = grid.data();
  if (data.mMagic != kNewGridMagic && data.mMagic != NANOVDB_MAGIC_NUMBER)
    throwDamaged("its grid " + excerpt(grid.name, kLongestName) + " does not begin as one");
  checkVersion(data.mVersion);
  if (data.mGridSize > grid.bytes.size())
    throwDamaged("its grid " + excerpt(grid.name, kLongestName) + " ends early");
  data.mMagic = NANOVDB_MAGIC_NUMBER;
  // Later versions compute other checksums.
  if (data.mVersion > nanovdb::Version()) data.mChecksum = nanovdb::GridChecksum::EMPTY;
}

/// Reads the grids of a segment. A file may have several.
void readSegment(Bytes& file, std::vector<NanoGrid>& grids) {
  using nanovdb::io::Codec;
  const auto header = file.read<nanovdb::io::Header>();
  if (header.magic != NANOVDB_MAGIC_NUMBER && header.magic != kNewFileMagic)
    throw Error(ErrorCode::Input, "it does not begin as a file of NanoVDB on a machine of this byte order");
  checkVersion(header.version);
  if (header.codec != Codec::NONE && header.codec != Codec::ZIP)
    throw Error(ErrorCode::Unsupported,
                "its grids are compressed by Blosc; write it without compression, or with zip");
  std::vector<nanovdb::io::MetaData> about;
  std::vector<std::string> names;
  for (int g = 0; g < header.gridCount; ++g) {
    about.push_back(file.read<nanovdb::io::MetaData>());
    if (about.back().nameSize > file.remaining()) throwDamaged("it ends early");
    names.emplace_back(about.back().nameSize, ' ');
    file.read(names.back().data(), names.back().size());
    names.back().resize(std::strlen(names.back().c_str()));  // It ends in zeros.
  }
  for (size_t g = 0; g < about.size(); ++g) {
    if (about[g].gridSize < sizeof(nanovdb::GridData) + sizeof(nanovdb::TreeData<>))
      throwDamaged("its grid " + excerpt(names[g], kLongestName) + " is too small");
    grids.push_back({names[g], readBytes(file, header.codec, about[g].gridSize, about[g].fileSize)});
    checkGrid(grids.back());
  }
}

/// Returns the metadata that `putNvdb` wrote behind a grid; nothing if there is none.
std::string_view metadataIn(const NanoGrid& grid) {
  using nanovdb::GridBlindMetaData;
  const auto* bytes = reinterpret_cast<const char*>(grid.bytes.data());
  const uint64_t size = grid.bytes.size(), at = uint64_t(grid.data().mBlindMetadataOffset);
  if (grid.data().mBlindMetadataCount == 0 || at > size || size - at < sizeof(GridBlindMetaData)) return {};
  const auto& about = *reinterpret_cast<const GridBlindMetaData*>(bytes + at);
  if (std::strncmp(about.mName, kNvdbMetadataName, GridBlindMetaData::MaxNameSize) != 0) return {};
  const uint64_t from = at + uint64_t(about.mByteOffset);
  if (from > size || size - from < about.mElementCount) throwDamaged("metadata ends early");
  return {bytes + from, about.mElementCount};
}

void describe(const NanoGrid& from, openvdb::GridBase& grid) {
  if (const std::string_view metadata = metadataIn(from); !metadata.empty()) {
    std::istringstream text{std::string(metadata)};
    grid.readMeta(text);
  }
  grid.setName(from.name);
  const bool isLevelSet = from.data().mGridClass == nanovdb::GridClass::LevelSet;
  grid.setGridClass(isLevelSet ? openvdb::GRID_LEVEL_SET : openvdb::GRID_UNKNOWN);
}

/// Places a grid of cubes that are not turned exactly as the file says. NanoVDB's conversion rounds.
void placeExactly(const nanovdb::Map& map, openvdb::GridBase& grid) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      if (map.mMatD[3 * row + column] != (row == column ? map.mMatD[0] : 0.0)) return;
  if (!(map.mMatD[0] > 0.0)) return;
  auto transform = openvdb::math::Transform::createLinearTransform(map.mMatD[0]);
  transform->postTranslate({map.mVecD[0], map.mVecD[1], map.mVecD[2]});
  grid.setTransform(transform);
}

bool isOfFloats(GridType type) {
  return type == GridType::Float || (type >= GridType::Fp4 && type <= GridType::FpN);
}

/// Returns a grid of its kind, without values.
openvdb::GridBase::Ptr emptyGridOf(const NanoGrid& grid) {
  const openvdb::Name type = isOfFloats(grid.type())          ? openvdb::FloatGrid::gridType()
                             : grid.type() == GridType::Int32 ? openvdb::Int32Grid::gridType()
                                                              : openvdb::BoolGrid::gridType();
  openvdb::GridBase::Ptr made = openvdb::GridBase::createGrid(type);
  describe(grid, *made);
  return made;
}

/// Gives values that are the background but for rounding the background itself. Quantized values are decoded
/// in single precision, and the background is the largest of most leaves.
template <class Build>
void restoreBackground(const nanovdb::NanoGrid<Build>& from, openvdb::FloatGrid& grid) {
  constexpr float kRounding = 1.0f / 64.0f;  // Steps; each is the range of a leaf divided by at most 65,535.
  const float background = grid.background();
  const auto accessor = from.getAccessor();
  for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf) {
    const openvdb::Coord at = leaf->origin();
    const float most = kRounding * accessor.probeLeaf({at.x(), at.y(), at.z()})->data()->mQuantum;
    for (openvdb::Index place = 0; place < leaf->SIZE; ++place)
      if (std::abs(leaf->getValue(place) - background) <= most) leaf->setValueOnly(place, background);
  }
}

template <class Build>
openvdb::GridBase::Ptr convertTo(const NanoGrid& grid) {
  auto& typed = *reinterpret_cast<nanovdb::NanoGrid<Build>*>(&grid.data());
  const std::string wrong = nanovdb::GridValidator<Build>::check(typed);
  if (!wrong.empty()) throwDamaged("its grid " + excerpt(grid.name, kLongestName) + ": " + wrong);
  placeEmptyNodes(typed);
  const auto made = nanovdb::nanoToOpenVDB(typed);
  constexpr bool kIsQuantized = !std::is_same_v<Build, typename nanovdb::BuildToValueMap<Build>::Type>;
  if constexpr (kIsQuantized) restoreBackground(typed, *made);
  return made;
}

openvdb::GridBase::Ptr convert(const NanoGrid& grid) {
  switch (grid.type()) {
    case GridType::Int32:
      return convertTo<int32_t>(grid);
    case GridType::Fp4:
      return convertTo<nanovdb::Fp4>(grid);
    case GridType::Fp8:
      return convertTo<nanovdb::Fp8>(grid);
    case GridType::Fp16:
      return convertTo<nanovdb::Fp16>(grid);
    case GridType::FpN:
      return convertTo<nanovdb::FpN>(grid);
    default:
      return convertTo<float>(grid);
  }
}

}  // namespace

void useOneThread() {
  static const tbb::global_control kOneThread(tbb::global_control::max_allowed_parallelism, 1);
}

void sendNvdb(int descriptor, const std::string& gridName, uint64_t mostDense) {
  openvdb::initialize();
  useOneThread();
  Bytes file(descriptor);
  std::vector<NanoGrid> grids;
  while (file.remaining() > 0) readSegment(file, grids);
  std::ranges::stable_sort(grids, {}, &NanoGrid::name);  // As those of a .vdb.
  openvdb::GridPtrVec about;
  for (const NanoGrid& grid : grids) about.push_back(emptyGridOf(grid));
  const auto read = [&](const std::string& name) {
    const NanoGrid& grid = *std::ranges::find(grids, name, &NanoGrid::name);
    openvdb::GridBase::Ptr made = convert(grid);
    describe(grid, *made);
    placeExactly(grid.data().mMap, *made);
    return made;
  };
  sendGrids(about, read, gridName, mostDense);
}

}  // namespace raymap
