// Crossings of short segments: they carry the winding number from a lattice's sample to a point.

#include "cpu/points/segment_crossings.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/points/segment_crossings.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "cpu/distance/surface_shapes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {
namespace {

/// Capsule: all points within `radius` of a segment.
struct Capsule {
  glm::vec3 from, along;
  float radius;
};

/// Returns the nodes of a packet whose discs the capsule may meet: the part of its axis that is near the
/// plane of the disc comes close to the centre. Discs that fill up the packet never do.
HWY_INLINE uint32_t nodesAt(const DiscPacket& discs, const Capsule& capsule) {
  const Tag d;
  const auto set = [&](float v) { return hn::Set(d, v); };
  const auto dot = [](Float ax, Float ay, Float az, Float bx, Float by, Float bz) {
    return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
  };
  const float length2 = glm::dot(capsule.along, capsule.along);
  const Float inverse = set(length2 > 0.0f ? 1.0f / length2 : 0.0f), radius = set(capsule.radius);
  const Float ux = set(capsule.along.x), uy = set(capsule.along.y), uz = set(capsule.along.z);
  uint32_t nodes = 0;
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const Each read{i};
    const Float x = hn::Sub(read(discs.cx), set(capsule.from.x)),
                y = hn::Sub(read(discs.cy), set(capsule.from.y)),
                z = hn::Sub(read(discs.cz), set(capsule.from.z));
    const Float nx = read(discs.nx), ny = read(discs.ny), nz = read(discs.nz);
    const Float half = hn::Add(read(discs.halfThickness), radius);
    // Parameters at which the axis enters and leaves the slab of the disc, 0 at its start and 1 at its end.
    // Along the slab the axis is in it everywhere or nowhere.
    const Float height = dot(x, y, z, nx, ny, nz), rise = dot(ux, uy, uz, nx, ny, nz);
    const Float steep = hn::CopySign(hn::Max(hn::Abs(rise), set(1e-20f)), rise);
    const Float s = hn::Div(hn::Sub(height, half), steep), e = hn::Div(hn::Add(height, half), steep);
    const Float low = hn::Max(hn::Min(s, e), hn::Zero(d)), high = hn::Min(hn::Max(s, e), set(1.0f));
    const Float closest = hn::Mul(dot(x, y, z, ux, uy, uz), inverse);
    const Float t = hn::Min(hn::Max(closest, low), high);
    const Float dx = hn::NegMulAdd(t, ux, x), dy = hn::NegMulAdd(t, uy, y), dz = hn::NegMulAdd(t, uz, z);
    const Float reach = hn::Add(read(discs.radius), half);
    const Mask isNear = hn::Le(dot(dx, dy, dz, dx, dy, dz), hn::Mul(reach, reach));
    nodes |= bits(hn::And(hn::Le(low, high), isNear)) << i;
  }
  return nodes;
}

/// Visits the leaves that the capsule meets.
template <class Visit>
HWY_INLINE void forEachLeaf(const SurfaceTree& tree, const Capsule& capsule, std::vector<uint32_t>& stack,
                            Visit&& visit) {
  stack.push_back(tree.root() / kPacket);
  while (!stack.empty()) {
    const uint32_t packet = stack.back();
    stack.pop_back();
    forEachLane(nodesAt(tree.discs(packet), capsule), [&](size_t lane) {
      const uint32_t node = packet * kPacket + static_cast<uint32_t>(lane);
      if (tree.isLeaf(node))
        visit(node);
      else
        stack.push_back(tree.childPacket(node));
    });
  }
}

/// Exceeds the rounding errors of lengths in the frame of a triangle, relative to the farthest point.
constexpr float kLocalRounding = 4e-6f;

/// Triangles of a packet that a segment may cross, those that it crosses for sure, and those whose front it
/// begins at.
struct PacketCrossings {
  uint32_t possible = 0, sure = 0, fromFront = 0;
};

HWY_INLINE PacketCrossings crossingsOf(const TrianglePacket& packet, const glm::vec3& from,
                                       const glm::vec3& to, float slack) {
  const Tag d;
  const auto set = [&](float v) { return hn::Set(d, v); };
  const float length = glm::distance(from, to);
  PacketCrossings crossings;
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const Triangle<Each> t{packet, {i}};
    const Local a = toLocal(t, set(from.x), set(from.y), set(from.z)),
                b = toLocal(t, set(to.x), set(to.y), set(to.z));
    const Float near = set(slack), zero = hn::Zero(d);
    // Both ends surely on the same side of the plane: no crossing.
    const Mask meetsPlane =
        hn::And(hn::Lt(hn::Min(a.w, b.w), near), hn::Gt(hn::Max(a.w, b.w), hn::Neg(near)));
    const Float fall = hn::Max(hn::Abs(hn::Sub(a.w, b.w)), near);
    const Float s = hn::Min(hn::Div(hn::Abs(a.w), fall), set(1.0f));
    const Float u = hn::MulAdd(s, hn::Sub(b.u, a.u), a.u), v = hn::MulAdd(s, hn::Sub(b.v, a.v), a.v);
    const Float bx = t.read(packet.bx), ub = hn::Sub(u, bx), ex = hn::Sub(t.read(packet.cx), bx);
    const Float inside = hn::Min(hn::Mul(bx, v), insidenessAtC(t, u, v, ub, ex));
    const Mask passesPlane =
        hn::And(hn::Lt(hn::Min(a.w, b.w), hn::Neg(near)), hn::Gt(hn::Max(a.w, b.w), near));
    // Edge functions are distances times lengths of edges, and ab is the longest. The place of the crossing
    // is exact but for rounding, unless the segment ends at the plane. Its error grows as the segment runs
    // along the plane.
    const Float rounding = hn::Mul(set(kLocalRounding), hn::MulAdd(set(2.0f), bx, set(length)));
    const Float place = hn::IfThenElse(passesPlane, hn::Min(rounding, near), near);
    const Float error = hn::Mul(hn::Mul(bx, place), hn::Add(set(2.0f), hn::Div(set(2.0f * length), fall)));
    crossings.possible |= bits(hn::And(meetsPlane, hn::Gt(inside, hn::Neg(error)))) << i;
    crossings.sure |= bits(hn::And(passesPlane, hn::Gt(inside, error))) << i;
    crossings.fromFront |= bits(hn::Gt(a.w, zero)) << i;
  }
  return crossings;
}

/// Returns the lanes of a leaf's packet that are not filled up with a repeated triangle.
HWY_INLINE uint32_t lanesOf(const SurfaceTree& tree, uint32_t leaf) {
  const uint32_t left = tree.triangleCount() - leaf * kPacket;
  return left >= kPacket ? 0xffu : (1u << left) - 1;
}

/// Bounds of points.
struct Extent {
  glm::vec3 low = glm::vec3(INFINITY), high = glm::vec3(-INFINITY);

  void add(const glm::vec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  float radius() const { return 0.5f * glm::length(high - low); }
  /// Returns a ball that holds them, widened by `slack`.
  Capsule ball(float slack) const { return {0.5f * (low + high), glm::vec3(0.0f), radius() + slack}; }
};

/// Leaves of a tree, with their discs packed together.
struct Leaves {
  std::vector<uint32_t> leaves;
  std::vector<DiscPacket> discs;

  void collect(const SurfaceTree& tree, const Capsule& capsule, std::vector<uint32_t>& stack) {
    leaves.clear();
    forEachLeaf(tree, capsule, stack, [&](uint32_t leaf) { leaves.push_back(leaf); });
    discs.resize((leaves.size() + kPacket - 1) / kPacket);
    for (size_t k = 0; k < discs.size() * kPacket; ++k) {
      const uint32_t leaf = leaves[std::min(k, leaves.size() - 1)];
      const DiscPacket& from = tree.discs(leaf / kPacket);
      DiscPacket& to = discs[k / kPacket];
      const size_t i = leaf % kPacket, j = k % kPacket;
      to.cx[j] = from.cx[i], to.cy[j] = from.cy[i], to.cz[j] = from.cz[i];
      to.nx[j] = from.nx[i], to.ny[j] = from.ny[i], to.nz[j] = from.nz[i];
      to.radius[j] = from.radius[i], to.halfThickness[j] = from.halfThickness[i];
    }
  }

  /// Visits the leaves that the capsule meets.
  template <class Visit>
  HWY_INLINE void forEachAt(const Capsule& capsule, Visit&& visit) const {
    for (size_t packet = 0; packet < discs.size(); ++packet)
      forEachLane(nodesAt(discs[packet], capsule), [&](size_t lane) {
        if (const size_t k = packet * kPacket + lane; k < leaves.size()) visit(leaves[k]);
      });
  }
};

void countAll(const SurfaceTree& tree, const glm::vec3& from, std::span<const glm::vec3> to, float slack,
              std::span<int32_t> change) {
  Extent extent;
  extent.add(from);
  for (const glm::vec3& p : to) extent.add(p);
  thread_local std::vector<uint32_t> stack;
  thread_local Leaves leaves;
  leaves.collect(tree, extent.ball(slack), stack);
  for (size_t i = 0; i < to.size(); ++i) {
    bool isSure = true;
    change[i] = 0;
    leaves.forEachAt({from, to[i] - from, slack}, [&](uint32_t leaf) {
      const PacketCrossings found = crossingsOf(tree.triangles(leaf), from, to[i], slack);
      const uint32_t possible = found.possible & lanesOf(tree, leaf);
      if (possible & ~found.sure) isSure = false;
      change[i] += hwy::PopCount(possible & found.fromFront) - hwy::PopCount(possible & ~found.fromFront);
    });
    if (!isSure) change[i] = kUnsure;
  }
}

/// Appends the triangles of a leaf that a segment may cross.
void addPossible(const SurfaceTree& tree, uint32_t leaf, const glm::vec3& from, const glm::vec3& to,
                 float slack, std::vector<uint32_t>& triangles) {
  const uint32_t possible = crossingsOf(tree.triangles(leaf), from, to, slack).possible & lanesOf(tree, leaf);
  forEachLane(possible,
              [&](size_t lane) { triangles.push_back(leaf * kPacket + static_cast<uint32_t>(lane)); });
}

void findAlong(const SurfaceTree& tree, const glm::vec3& from, const glm::vec3& to, float slack,
               std::vector<uint32_t>& triangles) {
  triangles.clear();
  thread_local std::vector<uint32_t> stack;
  forEachLeaf(tree, {from, to - from, slack}, stack,
              [&](uint32_t leaf) { addPossible(tree, leaf, from, to, slack, triangles); });
}

/// Returns the end of the segments from `begin` on that share one search.
size_t endOfGroup(std::span<const glm::vec3> from, std::span<const glm::vec3> to, size_t begin,
                  Extent& extent) {
  constexpr float kWide = 1.5f, kLeast = 0.5f;  // Most radius in lengths of the first segment, or in cells.
  constexpr size_t kMost = 64;
  const float most = std::max(kWide * glm::distance(from[begin], to[begin]), kLeast);
  size_t end = begin;
  for (; end < std::min(from.size(), begin + kMost); ++end) {
    Extent with = extent;
    with.add(from[end]);
    with.add(to[end]);
    if (end > begin && with.radius() > most) break;
    extent = with;
  }
  return end;
}

void findAlongEach(const SurfaceTree& tree, std::span<const glm::vec3> from, std::span<const glm::vec3> to,
                   float slack, TrianglesAlong& found) {
  found.triangles.clear();
  found.begins.assign(1, 0);
  thread_local std::vector<uint32_t> stack;
  thread_local Leaves leaves;
  for (size_t begin = 0, end = 0; begin < from.size(); begin = end) {
    Extent extent;
    end = endOfGroup(from, to, begin, extent);
    leaves.collect(tree, extent.ball(slack), stack);
    for (size_t i = begin; i < end; ++i) {
      leaves.forEachAt({from[i], to[i] - from[i], slack}, [&](uint32_t leaf) {
        addPossible(tree, leaf, from[i], to[i], slack, found.triangles);
      });
      found.begins.push_back(found.triangles.size());
    }
  }
}

}  // namespace
}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(countAll);
HWY_EXPORT(findAlong);
HWY_EXPORT(findAlongEach);

float slackOf(const SurfaceTree& tree, const glm::ivec3& dims) {
  constexpr float kRounding = 2e-6f;
  const DiscPacket& root = tree.discs(tree.root() / kPacket);
  const float reach = root.radius[0] + root.halfThickness[0];
  return kRounding * std::max({std::abs(root.cx[0]) + reach, std::abs(root.cy[0]) + reach,
                               std::abs(root.cz[0]) + reach, float(dims.x), float(dims.y), float(dims.z)});
}

void countCrossings(const SurfaceTree& tree, const glm::vec3& from, std::span<const glm::vec3> to,
                    float slack, std::span<int32_t> change) {
  HWY_DYNAMIC_DISPATCH(countAll)(tree, from, to, slack, change);
}

void findTrianglesAlong(const SurfaceTree& tree, const glm::vec3& from, const glm::vec3& to, float slack,
                        std::vector<uint32_t>& triangles) {
  HWY_DYNAMIC_DISPATCH(findAlong)(tree, from, to, slack, triangles);
}

void findTrianglesAlong(const SurfaceTree& tree, std::span<const glm::vec3> from,
                        std::span<const glm::vec3> to, float slack, TrianglesAlong& found) {
  HWY_DYNAMIC_DISPATCH(findAlongEach)(tree, from, to, slack, found);
}

}  // namespace raymap::cpu
#endif
