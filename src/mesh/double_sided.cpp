#include "mesh/double_sided.h"

#include <hwy/cache_control.h>
#include <hwy/contrib/sort/vqsort.h>
#include <raymap/buffer.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "base/parallel.h"
#include "mesh/position_bits.h"
#include "mesh/surplus_faces.h"

namespace raymap {

namespace {

/// Returns a hash of a face's corners that does not depend on their order.
uint32_t faceHash(const PackedMesh& mesh, const glm::uvec3& t) {
  const PositionBits a = positionBits(mesh.vertices[t.x]), b = positionBits(mesh.vertices[t.y]),
                     c = positionBits(mesh.vertices[t.z]);
  const auto sum = [&](size_t axis) { return uint64_t{a[axis]} + b[axis] + c[axis]; };
  return uint32_t(hashOf(sum(0), sum(1), sum(2)) >> 32);
}

/// Counts hashes up to two.
class HashCounter {
 public:
  explicit HashCounter(size_t slots) : once_(slots / 64), twice_(slots / 64) {}

  void add(size_t slot) {
    const uint64_t bit = uint64_t{1} << slot % 64, once = once_[slot / 64];
    if (once & bit) twice_[slot / 64] |= bit;
    once_[slot / 64] = once | bit;
  }
  bool hasTwo(size_t slot) const { return (twice_[slot / 64] >> slot % 64 & 1) != 0; }

 private:
  std::vector<uint64_t> once_, twice_;
};

/// Two numbers that sort by the first one.
uint64_t paired(uint32_t first, uint32_t second) {
  return uint64_t{first} << 32 | second;
}

/// Calls `work(run)` with each run of numbers that were paired with the same first one.
template <class Work>
void forEachRun(std::span<const uint64_t> pairs, Work&& work) {
  for (size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
    while (end < pairs.size() && pairs[end] >> 32 == pairs[begin] >> 32) ++end;
    work(pairs.subspan(begin, end - begin));
  }
}

/// Returns the number of slots, a power of two, to count the hashes of faces in. There are 16 or more for
/// each face, so few faces share a slot by accident.
uint64_t slotCount(size_t faces) {
  return std::min(std::bit_ceil(std::max<uint64_t>(16 * uint64_t{faces}, 64)), uint64_t{1} << 32);
}

/// Calls `work(face)` for each face whose hash begins with the bits `part`, of which there are `32 - shift`.
template <class Work>
void forEachFaceOf(uint64_t part, int shift, std::span<const uint32_t> hashes, Work&& work) {
  std::array<uint32_t, 1024> faces;  // Chosen without branches, which no processor could predict.
  for (size_t begin = 0; begin < hashes.size(); begin += faces.size()) {
    size_t chosen = 0;
    for (size_t f = begin; f < std::min(begin + faces.size(), hashes.size()); ++f) {
      faces[chosen] = uint32_t(f);
      chosen += uint64_t{hashes[f]} >> shift == part ? 1 : 0;
    }
    for (size_t k = 0; k < chosen; ++k) work(faces[k]);
  }
}

/// Returns the faces whose hash is that of another face too, and a few more, each paired with its hash.
/// Each part counts the hashes that begin with its bits, so that its counter stays in a processor's cache.
std::vector<uint64_t> findCandidates(const PackedMesh& mesh) {
  constexpr size_t kGrain = size_t{1} << 13;
  const size_t count = mesh.triangles.size();
  Buffer<uint32_t> hashes(count);
  parallelFor(count, kGrain, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) hashes[f] = faceHash(mesh, mesh.triangles[f]);
  });
  const uint64_t parts = std::bit_ceil(std::min<uint64_t>(parallelThreads(), count / kGrain + 1));
  const uint64_t slotsEach = std::max<uint64_t>(slotCount(count) / parts, 64);
  const int partShift = 32 - std::countr_zero(parts), slotShift = partShift - std::countr_zero(slotsEach);
  const auto slotOf = [&](size_t f) { return hashes[f] >> slotShift & (slotsEach - 1); };
  std::vector<std::vector<uint64_t>> found(parts);
  parallelFor(parts, 1, [&](size_t part, size_t) {
    HashCounter counter(slotsEach);
    forEachFaceOf(part, partShift, hashes, [&](uint32_t f) { counter.add(slotOf(f)); });
    forEachFaceOf(part, partShift, hashes, [&](uint32_t f) {
      if (counter.hasTwo(slotOf(f))) found[part].push_back(paired(hashes[f], f));
    });
  });
  std::vector<uint64_t> candidates;
  for (const std::vector<uint64_t>& part : found)
    candidates.insert(candidates.end(), part.begin(), part.end());
  return candidates;
}

/// Returns every candidate whose hash another one has, paired with the lowest face of that hash. Near faces
/// of the mesh are near in this order.
std::vector<uint64_t> pairWithFirst(std::vector<uint64_t> candidates) {
  hwy::Sorter()(candidates.data(), candidates.size(), hwy::SortAscending());
  std::vector<uint64_t> pairs;
  forEachRun(candidates, [&](std::span<const uint64_t> run) {
    if (run.size() < 2) return;
    for (const uint64_t candidate : run) pairs.push_back(paired(uint32_t(run[0]), uint32_t(candidate)));
  });
  hwy::Sorter()(pairs.data(), pairs.size(), hwy::SortAscending());
  return pairs;
}

/// A face by its positions. Faces with the same corners are ordered by their index.
struct CornersOfFace {
  std::array<PositionBits, 3> corners;  ///< Ascending.
  uint32_t face;
  bool isEven;  ///< Whether an even number of swaps sorts the corners.

  bool operator<(const CornersOfFace& other) const {
    return corners != other.corners ? corners < other.corners : face < other.face;
  }
  bool isDegenerate() const { return corners[0] == corners[1] || corners[1] == corners[2]; }
};

CornersOfFace cornersOf(const PackedMesh& mesh, uint32_t face) {
  const glm::uvec3& t = mesh.triangles[face];
  const auto at = [&](uint32_t vertex) { return positionBits(mesh.vertices[vertex]); };
  CornersOfFace c{{at(t.x), at(t.y), at(t.z)}, face, true};
  for (const auto& [low, high] : {std::pair(0u, 1u), std::pair(1u, 2u), std::pair(0u, 1u)})
    if (c.corners[high] < c.corners[low]) {
      std::swap(c.corners[low], c.corners[high]);
      c.isEven = !c.isEven;
    }
  return c;
}

/// Faces that lie on others, as they are found.
struct FoundFaces {
  std::vector<uint64_t> others;  ///< All faces of double-sided groups but the first, paired with the first.
  std::vector<uint32_t> repeated;
};

/// Adds the repeated faces of a group on the same corners, `even` of which are even.
void addRepeated(std::span<const CornersOfFace> group, size_t even, std::vector<uint32_t>& repeated) {
  const bool isEven = 2 * even > group.size();
  bool isFirst = true;
  for (const CornersOfFace& face : group)
    if (face.isEven != isEven || !std::exchange(isFirst, false)) repeated.push_back(face.face);
}

/// Adds the groups among faces that may lie on the same positions.
void addGroups(const PackedMesh& mesh, std::span<const uint64_t> candidates,
               std::vector<CornersOfFace>& faces, FoundFaces& found) {
  faces.clear();
  for (const uint64_t candidate : candidates) {
    const CornersOfFace face = cornersOf(mesh, uint32_t(candidate));
    if (!face.isDegenerate()) faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  for (size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
    size_t even = 0;
    for (; end < faces.size() && faces[end].corners == faces[begin].corners; ++end)
      even += faces[end].isEven ? 1 : 0;
    if (2 * even != end - begin) {
      addRepeated(std::span(faces).subspan(begin, end - begin), even, found.repeated);
      continue;
    }
    for (size_t f = begin + 1; f < end; ++f) found.others.push_back(paired(faces[begin].face, faces[f].face));
  }
}

/// Adds two faces that may lie on the same positions. Almost all groups are such pairs, and most of them
/// share their vertices.
void addPair(const PackedMesh& mesh, uint32_t a, uint32_t b, FoundFaces& found) {
  const glm::uvec3 s = mesh.triangles[a], t = mesh.triangles[b];
  const auto at = [&](uint32_t vertex) { return mesh.vertices[vertex]; };
  const auto areSame = [&](uint32_t u, uint32_t v) { return u == v || at(u) == at(v); };
  if (at(s.x) == at(s.y) || at(s.y) == at(s.z) || at(s.z) == at(s.x)) return;
  const int first = areSame(t.x, s.x) ? 0 : areSame(t.y, s.x) ? 1 : 2;
  const auto matches = [&](uint32_t second, uint32_t third) {
    return areSame(t[first], s.x) && areSame(t[(first + 1) % 3], second) &&
           areSame(t[(first + 2) % 3], third);
  };
  if (matches(s.z, s.y)) found.others.push_back(paired(a, b));
  if (matches(s.y, s.z)) found.repeated.push_back(b);
}

/// Returns the faces of all groups. Each list is ascending.
FoundFaces findGroups(const PackedMesh& mesh, std::span<const uint64_t> candidates) {
  constexpr size_t kPart = size_t{1} << 16;
  constexpr size_t kAhead = 24;  // Faces are fetched early: they lie anywhere in memory.
  std::vector<FoundFaces> found((candidates.size() + kPart - 1) / kPart);
  const auto runStart = [&](size_t c) {  // The first run that starts at c or later.
    while (c > 0 && c < candidates.size() && candidates[c] >> 32 == candidates[c - 1] >> 32) ++c;
    return c;
  };
  parallelFor(found.size(), 1, [&](size_t part, size_t) {
    const size_t begin = runStart(part * kPart),
                 end = runStart(std::min((part + 1) * kPart, candidates.size()));
    std::vector<CornersOfFace> faces;
    size_t fetched = begin;
    forEachRun(candidates.subspan(begin, end - begin), [&](std::span<const uint64_t> run) {
      for (const size_t next = size_t(run.data() - candidates.data()) + kAhead;
           fetched < std::min(next, candidates.size()); ++fetched)
        hwy::Prefetch(&mesh.triangles[uint32_t(candidates[fetched])]);
      if (run.size() > 2) return addGroups(mesh, run, faces, found[part]);
      if (run.size() < 2) return;
      const auto [low, high] = std::minmax({uint32_t(run[0]), uint32_t(run[1])});
      addPair(mesh, low, high, found[part]);
    });
  });
  FoundFaces all;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (const FoundFaces& part : found) {
    append(all.others, part.others);
    append(all.repeated, part.repeated);
  }
  hwy::Sorter()(all.others.data(), all.others.size(), hwy::SortAscending());
  hwy::Sorter()(all.repeated.data(), all.repeated.size(), hwy::SortAscending());
  return all;
}

}  // namespace

DoubleSidedFaces findDoubleSidedFaces(const PackedMesh& mesh) {
  return findDoubleSidedFaces(mesh, pairWithFirst(findCandidates(mesh)));
}

DoubleSidedFaces findDoubleSidedFaces(const PackedMesh& mesh, std::span<const uint32_t> faces) {
  std::vector<uint64_t> candidates(faces.size());
  std::ranges::transform(faces, candidates.begin(),
                         [&](uint32_t f) { return paired(faceHash(mesh, mesh.triangles[f]), f); });
  return findDoubleSidedFaces(mesh, pairWithFirst(std::move(candidates)));
}

DoubleSidedFaces findDoubleSidedFaces(const PackedMesh& mesh, std::span<const uint64_t> candidates) {
  FoundFaces groups = findGroups(mesh, candidates);
  DoubleSidedFaces found;
  found.repeated = surplusFaces(mesh, std::move(groups.repeated));
  forEachRun(groups.others, [&](std::span<const uint64_t> run) {
    for (const uint64_t other : run) {
      found.others.push_back(uint32_t(other));
      found.groupOf.push_back(uint32_t(found.firsts.size()));
    }
    found.firsts.push_back(uint32_t(run[0] >> 32));
  });
  return found;
}

}  // namespace raymap
