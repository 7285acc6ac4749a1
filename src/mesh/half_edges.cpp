#include "mesh/half_edges.h"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "base/parallel.h"

namespace raymap {

namespace {

constexpr size_t kKeysPerBucket = size_t{1} << 14;  // 256 KiB
constexpr size_t kMostBuckets = size_t{1} << 12;
constexpr size_t kBlocks = 64;  // Parts of the faces that are distributed each by one thread.

/// Calls `work(key)` for the three half edges of a face.
template <class Work>
void forEachHalfEdge(const glm::uvec3& corners, uint32_t face, Work&& work) {
  const auto add = [&](uint32_t a, uint32_t b, uint32_t third) {
    work(halfEdgeKey({std::min(a, b), std::max(a, b), face, third, a < b}));
  };
  add(corners.x, corners.y, corners.z);
  add(corners.y, corners.z, corners.x);
  add(corners.z, corners.x, corners.y);
}

uint32_t lowOf(const SortKey& key) {
  return uint32_t(key.high >> 32);
}

/// Sorts the keys of `positions` low ends, from `first` on: by these ends with counts, as few keys share one.
void sortBucket(std::span<SortKey> keys, size_t first, size_t positions) {
  std::vector<uint32_t> ends(positions + 1, 0);
  for (const SortKey& key : keys) ++ends[lowOf(key) - first + 1];
  for (size_t p = 0; p < positions; ++p) ends[p + 1] += ends[p];
  Buffer<SortKey> byLow(keys.size());
  for (const SortKey& key : keys) byLow[ends[lowOf(key) - first]++] = key;
  const auto isLess = [](const SortKey& a, const SortKey& b) {
    return a.high != b.high ? a.high < b.high : a.low < b.low;
  };
  for (size_t p = 0, begin = 0; p < positions; begin = ends[p++])
    std::sort(byLow.data() + begin, byLow.data() + ends[p], isLess);
  std::copy(byLow.begin(), byLow.end(), keys.begin());
}

}  // namespace

std::span<const SortKey> sortHalfEdges(const PackedMesh& mesh, const Welding& welding,
                                       Buffer<SortKey>& keys) {
  const auto cornersOf = [&](uint32_t face) { return weldedFace(mesh, welding, face); };
  const std::vector<uint32_t> faces = parallelSelect(mesh.triangles.size(), [&](uint32_t face) {
    const glm::uvec3 c = cornersOf(face);
    return c.x != c.y && c.y != c.z && c.z != c.x;
  });
  keys.resizeUninitialized(3 * faces.size());
  // A bucket has 2^shift positions. Half edges are distributed by their low ends.
  const size_t most = std::clamp(keys.size() / kKeysPerBucket, size_t{1}, kMostBuckets);
  const int shift = std::bit_width(welding.count / most);
  const size_t buckets = (welding.count >> shift) + 1;
  std::vector<size_t> places(kBlocks * buckets);  // Next place of each block in each bucket.
  const auto forEachKey = [&](auto&& work) {
    parallelFor(kBlocks, 1, [&](size_t block, size_t) {
      size_t* const placesOfBlock = places.data() + block * buckets;
      for (size_t f = faces.size() * block / kBlocks; f < faces.size() * (block + 1) / kBlocks; ++f)
        forEachHalfEdge(cornersOf(faces[f]), faces[f],
                        [&](const SortKey& key) { work(key, placesOfBlock[lowOf(key) >> shift]); });
    });
  };
  forEachKey([](const SortKey&, size_t& place) { ++place; });
  std::vector<size_t> starts;
  size_t sum = 0;
  for (size_t bucket = 0; bucket < buckets; ++bucket) {
    starts.push_back(sum);
    for (size_t block = 0; block < kBlocks; ++block)
      sum += std::exchange(places[block * buckets + bucket], sum);
  }
  starts.push_back(sum);
  forEachKey([&](const SortKey& key, size_t& place) { keys[place++] = key; });
  parallelFor(buckets, 1, [&](size_t b, size_t) {
    sortBucket({keys.data() + starts[b], keys.data() + starts[b + 1]}, b << shift, size_t{1} << shift);
  });
  return {keys.data(), keys.size()};
}

}  // namespace raymap
