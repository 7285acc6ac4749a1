#include "cpu/points/mark_rims.h"

#include <algorithm>

#include "base/parallel.h"

namespace raymap::cpu {

namespace {

constexpr size_t kRowsPerTask = 64;

/// Marks the cells along an edge. Each point of the edge is less than half a cell from a marked one.
void markEdge(const glm::vec3& a, const glm::vec3& b, const glm::ivec3& dims, Buffer<uint8_t>& marks) {
  const int steps = 1 + static_cast<int>(2.0f * glm::distance(a, b));
  for (int s = 0; s <= steps; ++s) {
    const glm::vec3 p = a + (b - a) * (static_cast<float>(s) / static_cast<float>(steps));
    const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(p)), glm::ivec3(0), dims - 1);
    marks[(size_t(cell.z) * dims.y + cell.y) * dims.x + cell.x] = 1;
  }
}

/// Marks the neighbours of all marked cells along one axis.
void widen(const glm::ivec3& dims, int axis, const Buffer<uint8_t>& from, Buffer<uint8_t>& to) {
  const size_t strides[] = {1, size_t(dims.x), size_t(dims.x) * dims.y};
  const size_t stride = strides[axis], rows = size_t(dims.y) * dims.z;
  parallelFor(rows, kRowsPerTask, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (int x = 0; x < dims.x; ++x) {
        const int places[] = {x, int(row % dims.y), int(row / dims.y)};
        const size_t i = row * dims.x + x;
        uint8_t mark = from[i];
        if (places[axis] > 0) mark |= from[i - stride];
        if (places[axis] + 1 < dims[axis]) mark |= from[i + stride];
        to[i] = mark;
      }
  });
}

}  // namespace

Buffer<uint8_t> markRims(const PackedMesh& mesh, const std::vector<RimEdge>& rims, const Grid& grid) {
  if (rims.empty()) return {};
  Buffer<uint8_t> marks(grid.sampleCount());
  std::fill(marks.begin(), marks.end(), uint8_t{0});
  const auto inCells = [&](uint32_t vertex) {
    return glm::vec3((mesh.position(vertex) - grid.origin) / grid.spacing);
  };
  for (const RimEdge& rim : rims) markEdge(inCells(rim.from), inCells(rim.to), grid.dims, marks);
  Buffer<uint8_t> wider(marks.size());
  for (int axis = 0; axis < 3; ++axis) {
    widen(grid.dims, axis, marks, wider);
    marks.swap(wider);
  }
  return marks;
}

}  // namespace raymap::cpu
