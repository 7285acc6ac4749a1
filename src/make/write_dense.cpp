#include <raymap/field_slabs.h>
#include <raymap/generate_file.h>

#include <algorithm>

#include "io/file_format.h"

namespace raymap {

void writeDense(const std::filesystem::path& path, const Field& band, const FieldWriteOptions& options) {
  constexpr size_t kManySamples = size_t{1} << 24;
  const std::string format = formatOf(path, options.format, fieldExtensions());
  if (!contains(slabExtensions(), format) || options.half || !options.gridName.empty())
    return writeField(path, toDense(band), options);
  const glm::ivec3 dims = band.grid.dims;
  SlabFile file{.path = path, .arrays = {options.array}};
  if (format == ".vti" && options.array == FieldArray::Distance)
    for (const FieldArray array : {FieldArray::Triangle, FieldArray::Winding, FieldArray::Confidence})
      if (band.has(array)) file.arrays.push_back(array);
  const Field about{.grid = band.grid, .clampDistance = band.clamp(), .surfaceBounds = band.surfaceBounds};
  const auto slab = [&](int begin, int end) {
    return toDense(band, {{0, 0, begin}, {dims.x, dims.y, end - begin}});
  };
  const size_t planes = kManySamples / (size_t(dims.x) * size_t(dims.y));
  writeFieldInSlabs({file}, about, slab,
                    {.planes = int(std::clamp<size_t>(planes, 1, size_t(dims.z))), .format = options.format});
}

}  // namespace raymap
