// Reads .vdb files in a child process (see Importer). OpenVDB trusts its files, so a damaged one may crash it
// or request any amount of memory.

#include <sstream>

#include "io/field/field_formats.h"
#include "io/import/import_stream.h"
#include "io/import/importer.h"

namespace raymap {

namespace {

/// Reads one grid. The first one gives the field its lattice, and the others must have the same.
/// Returns the number of grids that follow.
uint64_t readGrid(Importer& importer, const std::filesystem::path& path, uint64_t fileBytes, Field& field) {
  VdbHeader header;
  importer.receive(&header, sizeof header);
  // Bytes of samples per byte of the file: enough for a thin clampDistance in a large box, with a margin.
  constexpr uint64_t kMostGrowth = 2000;
  constexpr uint64_t kAlways = uint64_t{64} << 20;
  const ElementType type = header.isWhole != 0 ? ElementType::Int32 : ElementType::Float32;
  checkedSampleCount(path, header.dims, type, kAlways + kMostGrowth * fileBytes);
  Field placed;
  setDims(placed.grid, header.dims);
  placed.grid.origin = {header.origin[0], header.origin[1], header.origin[2]};
  placed.grid.spacing = header.spacing;
  placed.clampDistance = header.clampDistance;
  if (header.hasSurface != 0) setSurfaceBounds(path, header.surface, placed);
  checkPlacement(path, placed);
  const bool isFirst = field.grid.dims == glm::ivec3(0);
  if (isFirst) {
    field.grid = placed.grid;
    field.clampDistance = placed.clampDistance;
    field.surfaceBounds = placed.surfaceBounds;
  }
  header.name.back() = '\0';
  const std::string name = header.name.data();
  if (placed.grid != field.grid) throwInvalid(path, "its grid '" + name + "' lies elsewhere than the others");
  const bool isOurs = name != "triangle" || type == ElementType::Int32;
  readArray(path, field, isOurs ? name : "distance", {type},
            [&](void* to, size_t count) { importer.receive(to, count); });
  return header.gridsAfter;
}

}  // namespace

Field readVdb(const SourceFile& source, LeftOut& leftOut) {
  const std::filesystem::path& path = source.path();
  constexpr std::array<char, 4> kMagic{' ', 'B', 'D', 'V'};
  InputFile file(source);
  const uint64_t fileBytes = file.remaining();
  std::array<char, kMagic.size()> magic{};
  file.read(magic.data(), magic.size());
  if (magic != kMagic) throwInvalid(path, "does not begin as a VDB");

  Importer importer(source, ".vdb", fileBytes);
  std::istringstream names(importer.warning());
  for (std::string name; std::getline(names, name);) leftOut.push_back(name);
  Field field;
  while (readGrid(importer, path, fileBytes, field) > 0) {
  }
  return field;
}

}  // namespace raymap
