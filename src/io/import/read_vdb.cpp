// Reads .vdb and .nvdb files in a child process (see Importer). OpenVDB and NanoVDB trust their files, so a
// damaged one may crash it or request any amount of memory.

#include <sstream>

#include "base/memory.h"
#include "io/field/field_formats.h"
#include "io/import/import_stream.h"
#include "io/import/importer.h"

namespace raymap {

namespace {

/// Returns the most bytes of samples that a file may have: enough for a thin band in a large box, with a
/// margin.
uint64_t mostBytes(uint64_t fileBytes) {
  constexpr uint64_t kMostGrowth = 2000;
  constexpr uint64_t kAlways = uint64_t{64} << 20;
  return kAlways + kMostGrowth * fileBytes;
}

/// Reads the grids of a file, as fields of all samples or as a narrow band.
class GridReader {
 public:
  GridReader(const SourceFile& source, std::string_view format, uint64_t fileBytes, const GridChoice& grid)
      : path_(source.path()), most_(mostBytes(fileBytes)), importer_(source, format, fileBytes, grid) {}

  Field read(LeftOut& leftOut) {
    std::istringstream names(importer_.warning());
    for (std::string name; std::getline(names, name);) leftOut.push_back(name);
    next();
    if (header_.isBand != 0) return readBand();
    Field field;
    for (readGrid(field); header_.gridsAfter > 0; readGrid(field)) next();
    return field;
  }

 private:
  /// Reads the next grid's header.
  void next() {
    importer_.receive(&header_, sizeof header_);
    header_.name.back() = '\0';
    name_ = header_.name.data();
    type_ = header_.isWhole != 0 ? ElementType::Int32 : ElementType::Float32;
  }

  /// Returns a field without samples where the grid lies.
  Field placed() const {
    Field field;
    setDims(field.grid, header_.dims);
    field.grid.origin = {header_.origin[0], header_.origin[1], header_.origin[2]};
    field.grid.spacing = header_.spacing;
    field.clampDistance = header_.clampDistance;
    if (header_.hasSurface != 0) setSurfaceBounds(path_, header_.surface, field);
    checkPlacement(path_, field);
    return field;
  }

  /// Reads one grid. The first one gives the field its lattice, and the others must have the same.
  void readGrid(Field& field) {
    checkedSampleCount(path_, header_.dims, type_, {most_});
    Field about = placed();
    if (field.grid.dims == glm::ivec3(0)) {
      field.grid = about.grid;
      field.clampDistance = about.clampDistance;
      field.surfaceBounds = about.surfaceBounds;
    }
    checkPlace(about, field.grid);
    const bool isOurs = name_ != "triangle" || type_ == ElementType::Int32;
    readArray(path_, field, isOurs ? name_ : "distance", {type_},
              [&](void* to, size_t count) { importer_.receive(to, count); });
  }

  void checkPlace(const Field& about, const Grid& first) const {
    if (about.grid != first) throwInvalid(path_, "its grid '" + name_ + "' lies elsewhere than the others");
  }

  Field readBand() {
    Field about = placed();
    Field band{.grid = about.grid,
               .surfaceBounds = about.surfaceBounds,
               .narrow = NarrowBand{.outside = header_.outside, .inside = header_.inside}};
    checkBytes();
    receive(band.narrow->leaves, header_.leaves);
    band.narrow->tiles.resize(header_.tiles);
    importer_.receive(band.narrow->tiles.data(), band.narrow->tiles.size() * sizeof(NarrowBand::Tile));
    receiveValues(band, band.distance);
    while (header_.gridsAfter > 0) {
      next();
      checkPlace(placed(), band.grid);
      if (name_ == "triangle" && type_ == ElementType::Int32)
        receiveValues(band, band.triangle);
      else if (name_ == "winding" && type_ == ElementType::Float32)
        receiveValues(band, band.winding);
      else if (name_ == "confidence" && type_ == ElementType::Float32)
        receiveValues(band, band.confidence);
      else
        throwInvalid(path_, "its grid '" + name_ + "' is no array of a narrow band");
    }
    try {
      validate(band);
    } catch (const Error& error) {
      throwInvalid(path_, error.what());
    }
    return band;
  }

  /// Throws unless the leaves of the band may be in the file, and fit into memory with all arrays.
  void checkBytes() const {
    constexpr uint64_t kLeafBytes = NarrowBand::kLeafSamples * sizeof(float);
    const uint64_t leaves = header_.leaves, tiles = header_.tiles;
    if (leaves > most_ / kLeafBytes || tiles > most_ / sizeof(NarrowBand::Tile))
      throwInvalid(path_, "declares " + std::to_string(leaves) + " leaves and " + std::to_string(tiles) +
                              " tiles, more than its bytes can hold");
    checkFieldMemory(leaves * (sizeof(glm::ivec3) + kLeafBytes * (1 + header_.gridsAfter)) +
                         tiles * sizeof(NarrowBand::Tile),
                     memoryLeft());
  }

  template <class Element>
  void receive(Buffer<Element>& array, size_t count) {
    array.resizeUninitialized(count);
    importer_.receive(array.data(), count * sizeof(Element));
  }

  template <class Element>
  void receiveValues(const Field& band, Buffer<Element>& array) {
    receive(array, band.narrow->leaves.size() * NarrowBand::kLeafSamples);
  }

  const std::filesystem::path& path_;
  uint64_t most_;
  Importer importer_;
  VdbHeader header_;
  std::string name_;
  ElementType type_ = ElementType::Float32;
};

Field readGrids(const SourceFile& source, std::string_view format, std::string_view magic, LeftOut& leftOut,
                const GridChoice& grid) {
  InputFile file(source);
  const uint64_t fileBytes = file.remaining();
  std::string begin(magic.size(), ' ');
  file.read(begin.data(), begin.size());
  if (begin != magic) throwInvalid(source.path(), "does not begin as a " + std::string(format));
  return GridReader(source, format, fileBytes, grid).read(leftOut);
}

}  // namespace

Field readVdb(const SourceFile& source, LeftOut& leftOut, const GridChoice& grid) {
  return readGrids(source, ".vdb", " BDV", leftOut, grid);
}

Field readNvdb(const SourceFile& source, LeftOut& leftOut, const GridChoice& grid) {
  return readGrids(source, ".nvdb", "NanoVDB", leftOut, grid);
}

}  // namespace raymap
