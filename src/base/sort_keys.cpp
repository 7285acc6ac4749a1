// Sample sort: the keys are distributed among buckets that fit the cache, then each bucket is sorted with
// SIMD.

#include "base/sort_keys.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

namespace raymap {

namespace {

static_assert(sizeof(SortKey) == sizeof(hwy::uint128_t));

constexpr size_t kKeysPerBucket = size_t{1} << 14;  // 256 KiB
constexpr size_t kMostBuckets = size_t{1} << 12;
constexpr size_t kSamplesPerBucket = 16;
constexpr size_t kBlocks = 64;  // Parts of the input that are distributed each by one thread.
constexpr size_t kChunk = 1024;

/// Numbers the buckets by 64-bit splitters, which lie in a complete binary tree.
class Splitters {
 public:
  Splitters(size_t buckets, std::vector<uint64_t> samples) : levels_(std::countr_zero(buckets)) {
    std::sort(samples.begin(), samples.end());
    tree_.resize(buckets);
    for (size_t node = 1; node < buckets; ++node) {  // The node's place in the order of all splitters.
      const auto level = size_t(std::bit_width(node)) - 1;
      const size_t rank = (2 * (node - (size_t{1} << level)) + 1) << (size_t(levels_) - 1 - level);
      tree_[node] = samples[rank * samples.size() / buckets];
    }
  }

  /// Writes the buckets of `count` keys. Several keys descend at a time, which hides the latency.
  void find(const SortKey* keys, size_t count, uint16_t* buckets) const {
    constexpr size_t kLanes = 8;
    size_t k = 0;
    for (; k + kLanes <= count; k += kLanes) {
      std::array<size_t, kLanes> nodes;
      nodes.fill(1);
      for (int level = 0; level < levels_; ++level)
        for (size_t lane = 0; lane < kLanes; ++lane)
          nodes[lane] = 2 * nodes[lane] + size_t(tree_[nodes[lane]] < keys[k + lane].high);
      for (size_t lane = 0; lane < kLanes; ++lane) buckets[k + lane] = uint16_t(nodes[lane] - tree_.size());
    }
    for (; k < count; ++k) {
      size_t node = 1;
      while (node < tree_.size()) node = 2 * node + size_t(tree_[node] < keys[k].high);
      buckets[k] = uint16_t(node - tree_.size());
    }
  }

 private:
  int levels_;
  std::vector<uint64_t> tree_;
};

using Make = FunctionView<size_t, size_t, SortKey*>;

std::vector<uint64_t> sample(size_t count, const Make& make, size_t samples) {
  std::vector<uint64_t> found(samples);
  parallelFor(samples, 256, [&](size_t begin, size_t end) {
    for (size_t s = begin; s < end; ++s) {
      const size_t k = s * 0x9e3779b97f4a7c15u % count;  // Spread evenly, but not in step with the mesh.
      SortKey key;
      make(k, k + 1, &key);
      found[s] = key.high;
    }
  });
  return found;
}

void sortBucket(SortKey* keys, size_t count) {
  hwy::Sorter()(reinterpret_cast<hwy::uint128_t*>(keys), count, hwy::SortAscending());
}

/// Calls `work(block, begin, end)` on chunks of keys, those of a block in order on one thread.
template <class Work>
void forEachChunk(size_t count, Work&& work) {
  parallelFor(kBlocks, 1, [&](size_t block, size_t) {
    const size_t last = count * (block + 1) / kBlocks;
    for (size_t begin = count * block / kBlocks; begin < last; begin += kChunk)
      work(block, begin, std::min(begin + kChunk, last));
  });
}

}  // namespace

void sortKeys(size_t count, Make make, Buffer<SortKey>& keys) {
  keys.resizeUninitialized(count);
  const size_t buckets = std::min(std::bit_floor(count / kKeysPerBucket), kMostBuckets);
  if (buckets < 2) {
    make(0, count, keys.data());
    return sortBucket(keys.data(), count);
  }
  const Splitters splitters(buckets, sample(count, make, buckets * kSamplesPerBucket));
  Buffer<uint16_t> bucketOf(count);
  std::vector<size_t> places(kBlocks * buckets);  // Next place of each block in each bucket.
  forEachChunk(count, [&](size_t block, size_t begin, size_t end) {
    std::array<SortKey, kChunk> chunk;
    make(begin, end, chunk.data());
    splitters.find(chunk.data(), end - begin, bucketOf.data() + begin);
    for (size_t k = begin; k < end; ++k) ++places[block * buckets + bucketOf[k]];
  });
  std::vector<size_t> ends(buckets);
  size_t sum = 0;
  for (size_t bucket = 0; bucket < buckets; ++bucket) {
    for (size_t block = 0; block < kBlocks; ++block)
      sum += std::exchange(places[block * buckets + bucket], sum);
    ends[bucket] = sum;
  }
  forEachChunk(count, [&](size_t block, size_t begin, size_t end) {
    std::array<SortKey, kChunk> chunk;
    make(begin, end, chunk.data());
    for (size_t k = begin; k < end; ++k) keys[places[block * buckets + bucketOf[k]]++] = chunk[k - begin];
  });
  parallelFor(buckets, 1, [&](size_t bucket, size_t) {
    const size_t first = bucket == 0 ? 0 : ends[bucket - 1];
    sortBucket(keys.data() + first, ends[bucket] - first);
  });
}

}  // namespace raymap
