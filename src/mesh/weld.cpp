#include "mesh/weld.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "base/sort_keys.h"
#include "mesh/position_bits.h"

namespace raymap {

namespace {

constexpr size_t kBlock = size_t{1} << 14;  // Vertices whose repetitions are found first, within the cache.
constexpr size_t kTable = 2 * kBlock;
constexpr uint32_t kFree = UINT32_MAX;

/// Sets `firstOf` of each vertex of a block to the first vertex of the block at its position. Appends the
/// first ones to `firsts`, and returns their number.
size_t findFirsts(std::span<const glm::vec3> vertices, size_t begin, size_t end, uint32_t* firstOf,
                  uint32_t* firsts) {
  std::vector<uint32_t> table(kTable, kFree);
  size_t count = 0;
  for (size_t v = begin; v < end; ++v) {
    const PositionBits bits = positionBits(vertices[v]);
    size_t slot = (hashOf(vertices[v]) >> 32) % kTable;
    while (table[slot] != kFree && positionBits(vertices[table[slot]]) != bits) slot = (slot + 1) % kTable;
    if (table[slot] == kFree) firsts[count++] = table[slot] = uint32_t(v);
    firstOf[v] = table[slot];
  }
  return count;
}

/// Removes the gaps between the blocks' first vertices. Turns their numbers into their starts, and adds the
/// end.
void joinBlocks(std::vector<size_t>& counts, Buffer<uint32_t>& firsts) {
  size_t sum = 0;
  for (size_t block = 0; block < counts.size(); ++block) {
    const uint32_t* from = firsts.data() + block * kBlock;
    std::copy(from, from + counts[block], firsts.data() + sum);
    sum += std::exchange(counts[block], sum);
  }
  counts.push_back(sum);
}

/// Copies the numbers of the block's first vertices to the other vertices, which have the first one's index.
void copyNumbers(std::span<const uint32_t> firsts, size_t begin, size_t end, Buffer<uint32_t>& ids) {
  auto first = firsts.begin();
  for (size_t v = begin; v < end; ++v)
    if (first != firsts.end() && *first == v)
      ++first;
    else
      ids[v] = ids[ids[v]];
}

bool isNewPosition(const Buffer<SortKey>& keys, size_t k) {
  return k == 0 || keys[k].high != keys[k - 1].high || keys[k].low >> 32 != keys[k - 1].low >> 32;
}

/// Writes the number of its position to each vertex that has a key. Returns the number of positions.
size_t numberPositions(const Buffer<SortKey>& keys, Buffer<uint32_t>& ids) {
  const size_t tasks = (keys.size() + kCheapGrain - 1) / kCheapGrain;
  std::vector<size_t> starts(tasks + 1, 0);
  const auto last = [&](size_t task) { return std::min((task + 1) * kCheapGrain, keys.size()); };
  parallelFor(tasks, 1, [&](size_t task, size_t) {
    for (size_t k = task * kCheapGrain; k < last(task); ++k) starts[task + 1] += isNewPosition(keys, k);
  });
  for (size_t task = 0; task < tasks; ++task) starts[task + 1] += starts[task];
  parallelFor(tasks, 1, [&](size_t task, size_t) {
    size_t next = starts[task];
    for (size_t k = task * kCheapGrain; k < last(task); ++k) {
      next += isNewPosition(keys, k);
      ids[uint32_t(keys[k].low)] = uint32_t(next - 1);
    }
  });
  return starts[tasks];
}

}  // namespace

Welding weldVertices(std::span<const glm::vec3> vertices, Buffer<SortKey>& keys) {
  const size_t blocks = (vertices.size() + kBlock - 1) / kBlock;
  const auto end = [&](size_t block) { return std::min((block + 1) * kBlock, vertices.size()); };
  Welding welding{Buffer<uint32_t>(vertices.size()), 0};
  Buffer<uint32_t> firsts(vertices.size());
  std::vector<size_t> starts(blocks);
  parallelFor(blocks, 1, [&](size_t block, size_t) {
    starts[block] =
        findFirsts(vertices, block * kBlock, end(block), welding.ids.data(), firsts.data() + block * kBlock);
  });
  joinBlocks(starts, firsts);
  const auto make = [&](size_t begin, size_t last, SortKey* to) {
    for (size_t k = begin; k < last; ++k) {
      const PositionBits bits = positionBits(vertices[firsts[k]]);
      *to++ = {uint64_t{bits[2]} << 32 | firsts[k], uint64_t{bits[0]} << 32 | bits[1]};
    }
  };
  sortKeys(starts.back(), make, keys);
  welding.count = numberPositions(keys, welding.ids);
  parallelFor(blocks, 1, [&](size_t block, size_t) {
    copyNumbers({firsts.data() + starts[block], firsts.data() + starts[block + 1]}, block * kBlock,
                end(block), welding.ids);
  });
  return welding;
}

Welding weldVertices(std::span<const glm::vec3> vertices) {
  Buffer<SortKey> keys;
  return weldVertices(vertices, keys);
}

std::vector<uint32_t> Welding::vertices() const {
  std::vector<uint32_t> last(count);
  for (uint32_t v = 0; v < ids.size(); ++v) last[ids[v]] = v;
  return last;
}

Welding unwelded(size_t vertices) {
  Welding welding{Buffer<uint32_t>(vertices), vertices};
  std::iota(welding.ids.begin(), welding.ids.end(), 0u);
  return welding;
}

}  // namespace raymap
