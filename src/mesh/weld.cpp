#include "mesh/weld.h"

#include <array>
#include <bit>

#include "base/parallel_sort.h"

namespace raymap {

namespace {

/// Position as sortable bits, equal exactly where the coordinates are: -0 equals 0, and even NaN is ordered.
struct WeldKey {
  std::array<uint32_t, 3> bits;
  uint32_t vertex;
  bool operator<(const WeldKey& other) const { return bits < other.bits; }
};

}  // namespace

Welding weldVertices(std::span<const glm::vec3> vertices) {
  std::vector<WeldKey> keys(vertices.size());
  for (uint32_t v = 0; v < keys.size(); ++v) {
    const glm::vec3 p = vertices[v] + 0.0f;  // Turns -0 into 0.
    keys[v] = {{std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y), std::bit_cast<uint32_t>(p.z)}, v};
  }
  parallelSort(keys.begin(), keys.end());
  Welding welding{std::vector<uint32_t>(keys.size()), 0};
  for (size_t k = 0; k < keys.size(); ++k) {
    if (k == 0 || keys[k].bits != keys[k - 1].bits) ++welding.count;
    welding.ids[keys[k].vertex] = static_cast<uint32_t>(welding.count - 1);
  }
  return welding;
}

}  // namespace raymap
