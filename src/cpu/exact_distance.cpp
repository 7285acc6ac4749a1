// Ours (Krayer & Müller 2019 keep the nearest cell's triangles, §3.3): the true closest triangle of every
// sample.
//
// Blocks of samples are halved again and again, each with the list of triangles and tree nodes that may hold
// the closest triangle of some sample in it. The eight halves lie in SIMD lanes. Let t be the triangle
// closest to a half's centre. The distance to a candidate is convex, so its tangent plane at the centre
// bounds it from below over the whole half; the distance to t is convex too, so where it stays below that
// plane at the eight corners, it does so everywhere between, and the candidate cannot matter. Lists shrink to
// a handful before single samples look at them.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/exact_distance.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "cpu/exact_distance.h"
#include "cpu/parallel.h"
#include "cpu/surface_tree.h"

#ifndef RAYMAP_EXACT_DISTANCE_COMMON
#define RAYMAP_EXACT_DISTANCE_COMMON
namespace raymap {

/// What a run reads and writes, the same for every block.
struct ExactDistanceJob {
  const SurfaceTree& tree;
  glm::ivec3 dims;
  float band;       // cells; 0 = none
  float tolerance;  // cells: candidates that cannot win by more are dropped
  float* distance;
  uint32_t* triangle;  // may be null
};

constexpr int kTopSide = 16;

}  // namespace raymap
#endif

HWY_BEFORE_NAMESPACE();
namespace raymap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 8>;
using Float = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

constexpr size_t kLanes = 8;
/// A node may stay whole in the list of a block this many times as wide as its radius.
constexpr float kNodeShare = 1.0f;

/// One value per lane, whatever the width of the machine's vectors.
struct Lanes {
  alignas(64) float v[kLanes];
  HWY_INLINE Float load(size_t i) const { return hn::Load(Tag(), v + i); }
  HWY_INLINE void store(size_t i, Float x) { hn::Store(x, Tag(), v + i); }
};

HWY_INLINE uint32_t bits(Mask mask) {
  uint8_t out[8] = {};
  hn::StoreMaskBits(Tag(), mask, out);
  return out[0];
}

/// A triangle read for all lanes at once: every lane the same, or each its own.
struct SameTriangle {
  const FramedTriangle& t;
#define RAYMAP_FIELD(name, member)   \
  HWY_INLINE Float name() const {    \
    return hn::Set(Tag(), t.member); \
  }
  RAYMAP_FIELD(ax, a.x)
  RAYMAP_FIELD(ay, a.y) RAYMAP_FIELD(az, a.z) RAYMAP_FIELD(xx, x.x) RAYMAP_FIELD(xy, x.y)
      RAYMAP_FIELD(xz, x.z) RAYMAP_FIELD(yx, y.x) RAYMAP_FIELD(yy, y.y) RAYMAP_FIELD(yz, y.z)
          RAYMAP_FIELD(zx, z.x) RAYMAP_FIELD(zy, z.y) RAYMAP_FIELD(zz, z.z) RAYMAP_FIELD(bx, bx)
              RAYMAP_FIELD(cx, cx) RAYMAP_FIELD(cy, cy) RAYMAP_FIELD(ibc, inverseBc2)
                  RAYMAP_FIELD(ica, inverseCa2)
#undef RAYMAP_FIELD
};

/// A point, or an offset, in a triangle's frame.
struct Local {
  Float u, v, w;
};

template <class T>
HWY_INLINE Local rotate(const T& t, Float x, Float y, Float z) {
  return {hn::MulAdd(x, t.xx(), hn::MulAdd(y, t.xy(), hn::Mul(z, t.xz()))),
          hn::MulAdd(x, t.yx(), hn::MulAdd(y, t.yy(), hn::Mul(z, t.yz()))),
          hn::MulAdd(x, t.zx(), hn::MulAdd(y, t.zy(), hn::Mul(z, t.zz())))};
}

template <class T>
HWY_INLINE Local toLocal(const T& t, Float px, Float py, Float pz) {
  return rotate(t, hn::Sub(px, t.ax()), hn::Sub(py, t.ay()), hn::Sub(pz, t.az()));
}

/// The least of the three edge functions: positive where (u, v) lies inside the triangle, never so if
/// it has no area.
template <class T>
HWY_INLINE Float insideness(const T& t, Float u, Float v, Float ub, Float ex) {
  return hn::Min(v,
                 hn::Min(hn::MulSub(ex, v, hn::Mul(t.cy(), ub)), hn::MulSub(t.cy(), u, hn::Mul(t.cx(), v))));
}

/// The offset to a point from the closest point of the triangle.
template <class T>
HWY_INLINE Local offsetFrom(const T& t, const Local& p) {
  const Tag d;
  const Float u = p.u, v = p.v;
  const Float zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Float bx = t.bx(), cx = t.cx(), cy = t.cy();
  const Float ex = hn::Sub(cx, bx), ub = hn::Sub(u, bx);
  // Offsets from the closest points of the three edges.
  const Float abU = hn::Sub(u, hn::Min(hn::Max(u, zero), bx));
  const Float ab2 = hn::MulAdd(abU, abU, hn::Mul(v, v));
  const Float s = hn::Min(hn::Max(hn::Mul(hn::MulAdd(ub, ex, hn::Mul(v, cy)), t.ibc()), zero), one);
  const Float bcU = hn::NegMulAdd(s, ex, ub), bcV = hn::NegMulAdd(s, cy, v);
  const Float bc2 = hn::MulAdd(bcU, bcU, hn::Mul(bcV, bcV));
  const Float r = hn::Min(hn::Max(hn::Mul(hn::MulAdd(u, cx, hn::Mul(v, cy)), t.ica()), zero), one);
  const Float caU = hn::NegMulAdd(r, cx, u), caV = hn::NegMulAdd(r, cy, v);
  const Float ca2 = hn::MulAdd(caU, caU, hn::Mul(caV, caV));
  const Mask bcCloser = hn::Lt(bc2, ab2);
  const Float near2 = hn::Min(bc2, ab2);
  const Mask caCloser = hn::Lt(ca2, near2);
  const Float edgeU = hn::IfThenElse(caCloser, caU, hn::IfThenElse(bcCloser, bcU, abU));
  const Float edgeV = hn::IfThenElse(caCloser, caV, hn::IfThenElse(bcCloser, bcV, v));
  // Over the face there is no offset in the plane: all three edge functions are positive.
  const Mask outside = hn::Le(insideness(t, u, v, ub, ex), zero);
  return {hn::IfThenElseZero(outside, edgeU), hn::IfThenElseZero(outside, edgeV), p.w};
}

HWY_INLINE Float squared(const Local& o) {
  return hn::MulAdd(o.u, o.u, hn::MulAdd(o.v, o.v, hn::Mul(o.w, o.w)));
}

/// The squared distance alone: no need to know which edge is closest.
template <class T>
HWY_INLINE Float squaredDistance(const T& t, const Local& p) {
  const Tag d;
  const Float u = p.u, v = p.v;
  const Float zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Float bx = t.bx(), cx = t.cx(), cy = t.cy();
  const Float ex = hn::Sub(cx, bx), ub = hn::Sub(u, bx);
  const Float abU = hn::Sub(u, hn::Min(hn::Max(u, zero), bx));
  const Float ab2 = hn::MulAdd(abU, abU, hn::Mul(v, v));
  const Float s = hn::Min(hn::Max(hn::Mul(hn::MulAdd(ub, ex, hn::Mul(v, cy)), t.ibc()), zero), one);
  const Float bcU = hn::NegMulAdd(s, ex, ub), bcV = hn::NegMulAdd(s, cy, v);
  const Float bc2 = hn::MulAdd(bcU, bcU, hn::Mul(bcV, bcV));
  const Float r = hn::Min(hn::Max(hn::Mul(hn::MulAdd(u, cx, hn::Mul(v, cy)), t.ica()), zero), one);
  const Float caU = hn::NegMulAdd(r, cx, u), caV = hn::NegMulAdd(r, cy, v);
  const Float ca2 = hn::MulAdd(caU, caU, hn::Mul(caV, caV));
  const Mask outside = hn::Le(insideness(t, u, v, ub, ex), zero);
  return hn::MulAdd(p.w, p.w, hn::IfThenElseZero(outside, hn::Min(hn::Min(ab2, bc2), ca2)));
}

template <class T>
HWY_INLINE Float squaredDistance(const T& t, Float px, Float py, Float pz) {
  return squaredDistance(t, toLocal(t, px, py, pz));
}

/// Distance and its gradient at the lanes' centres: the tangent plane.
struct Tangent {
  Float d, gx, gy, gz;
};

HWY_INLINE Tangent tangent(const FramedTriangle& triangle, Float px, Float py, Float pz) {
  const Tag tag;
  const SameTriangle t{triangle};
  const Local o = offsetFrom(t, toLocal(t, px, py, pz));
  const Float d = hn::Sqrt(squared(o));
  const Float inverse = hn::Div(hn::Set(tag, 1.0f), hn::Max(d, hn::Set(tag, 1e-20f)));
  const Float u = hn::Mul(o.u, inverse), v = hn::Mul(o.v, inverse), w = hn::Mul(o.w, inverse);
  return {d, hn::MulAdd(u, t.xx(), hn::MulAdd(v, t.yx(), hn::Mul(w, t.zx()))),
          hn::MulAdd(u, t.xy(), hn::MulAdd(v, t.yy(), hn::Mul(w, t.zy()))),
          hn::MulAdd(u, t.xz(), hn::MulAdd(v, t.yz(), hn::Mul(w, t.zz())))};
}

/// The tangent plane of the distance to a disc with thickness; zero inside it.
HWY_INLINE Tangent tangent(const Disc& disc, Float px, Float py, Float pz) {
  const Tag tag;
  const Float nx = hn::Set(tag, disc.normal.x), ny = hn::Set(tag, disc.normal.y),
              nz = hn::Set(tag, disc.normal.z);
  const Float qx = hn::Sub(px, hn::Set(tag, disc.centre.x)), qy = hn::Sub(py, hn::Set(tag, disc.centre.y)),
              qz = hn::Sub(pz, hn::Set(tag, disc.centre.z));
  const Float height = hn::MulAdd(qx, nx, hn::MulAdd(qy, ny, hn::Mul(qz, nz)));
  const Float q2 = hn::MulAdd(qx, qx, hn::MulAdd(qy, qy, hn::Mul(qz, qz)));
  const Float tiny = hn::Set(tag, 1e-20f), zero = hn::Zero(tag);
  const Float rho = hn::Sqrt(hn::Max(hn::NegMulAdd(height, height, q2), tiny));
  const Float beside = hn::Max(hn::Sub(rho, hn::Set(tag, disc.radius)), zero);
  const Float above = hn::Max(hn::Sub(hn::Abs(height), hn::Set(tag, disc.halfThickness)), zero);
  const Float d = hn::Sqrt(hn::MulAdd(beside, beside, hn::Mul(above, above)));
  const Float inverse = hn::Div(hn::Set(tag, 1.0f), hn::Max(d, tiny));
  const Float radial = hn::Div(hn::Mul(beside, inverse), rho);
  const Float axial = hn::NegMulAdd(radial, height, hn::CopySign(hn::Mul(above, inverse), height));
  return {d, hn::MulAdd(axial, nx, hn::Mul(radial, qx)), hn::MulAdd(axial, ny, hn::Mul(radial, qy)),
          hn::MulAdd(axial, nz, hn::Mul(radial, qz))};
}

/// The squared distance to a disc with thickness.
HWY_INLINE Float squaredDistance(const Disc& disc, Float px, Float py, Float pz) {
  const Tag tag;
  const Float qx = hn::Sub(px, hn::Set(tag, disc.centre.x)), qy = hn::Sub(py, hn::Set(tag, disc.centre.y)),
              qz = hn::Sub(pz, hn::Set(tag, disc.centre.z));
  const Float height =
      hn::MulAdd(qx, hn::Set(tag, disc.normal.x),
                 hn::MulAdd(qy, hn::Set(tag, disc.normal.y), hn::Mul(qz, hn::Set(tag, disc.normal.z))));
  const Float q2 = hn::MulAdd(qx, qx, hn::MulAdd(qy, qy, hn::Mul(qz, qz)));
  const Float zero = hn::Zero(tag);
  const Float rho = hn::Sqrt(hn::Max(hn::NegMulAdd(height, height, q2), zero));
  const Float beside = hn::Max(hn::Sub(rho, hn::Set(tag, disc.radius)), zero);
  const Float above = hn::Max(hn::Sub(hn::Abs(height), hn::Set(tag, disc.halfThickness)), zero);
  return hn::MulAdd(beside, beside, hn::Mul(above, above));
}

/// What may hold the closest triangle of some sample of a block.
struct Candidates {
  std::vector<uint32_t> nodes, triangles;
  uint32_t closest = 0;  // the triangle closest to the middle of the block that this one is a half of

  void reset(uint32_t newClosest) {
    nodes.clear();
    triangles.clear();
    closest = newClosest;
  }
};

struct StoredTangent {
  Lanes d, gx, gy, gz;
  HWY_INLINE Tangent load(size_t i) const { return {d.load(i), gx.load(i), gy.load(i), gz.load(i)}; }
  HWY_INLINE void store(size_t i, const Tangent& t) {
    d.store(i, t.d), gx.store(i, t.gx), gy.store(i, t.gy), gz.store(i, t.gz);
  }
};

/// Calls `visit` with each lane in the set.
template <class Visit>
HWY_INLINE void forEachLane(uint32_t lanes, Visit&& visit) {
  for (; lanes; lanes &= lanes - 1) visit(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
}

HWY_INLINE glm::ivec3 octant(size_t lane) {
  return {lane & 1, lane >> 1 & 1, lane >> 2};
}

#ifdef RAYMAP_COUNT
struct Counters {
  std::atomic<long> tri{0}, node{0}, exTri{0}, exNode{0}, near{0}, finTri{0}, finEval{0}, finNode{0},
      calls[8]{}, listTri[8]{}, listNode[8]{};
  ~Counters() {
    if (!tri) return;
    printf("tri %ld node %ld exTri %ld exNode %ld near %ld| finTri %ld evals %ld node %ld\n", tri.load(),
           node.load(), exTri.load(), exNode.load(), near.load(), finTri.load(), finEval.load(),
           finNode.load());
    for (int i = 0; i < 8; i++)
      if (calls[i])
        printf(" lvl %d calls %ld tris/call %.1f nodes/call %.1f\n", i, calls[i].load(),
               double(listTri[i]) / calls[i], double(listNode[i]) / calls[i]);
  }
};
inline Counters gC;
#define COUNT(x, n) gC.x += (n)
#else
#define COUNT(x, n)
#endif

/// Halves one block after another; each thread has its own.
class BlockRefiner {
 public:
  explicit BlockRefiner(const ExactDistanceJob& job) : job_(job), tree_(job.tree) {
    for (size_t c = 0; c < kLanes; ++c) {
      const glm::vec3 sign = 2.0f * glm::vec3(octant(c)) - 1.0f;
      signX_.v[c] = sign.x, signY_.v[c] = sign.y, signZ_.v[c] = sign.z;
    }
  }

  void run(glm::ivec3 low) {
    Candidates all;
    all.nodes.push_back(tree_.root());
    all.closest = tree_.representative(tree_.root());
    refine(low, kTopSide, all, 0);
  }

 private:
  /// The eight halves of a block.
  struct Level {
    Candidates candidates[kLanes];
    Lanes x, y, z;             // their centres
    Lanes distance;            // of the closest triangle to the centres
    uint32_t closest[kLanes];  // that triangle
    Lanes corners[8];          // its distance at the corners, minus the tolerance
    std::vector<StoredTangent> triangles, nodes;
  };

  /// Fills the eight halves of a block of `side` samples.
  void refine(glm::ivec3 low, int side, const Candidates& candidates, int depth) {
    Level& level = levels_[depth];
    const int half = side / 2;
    const float reach = 0.5f * static_cast<float>(half - 1);
    uint32_t active = placeHalves(low, half, reach, level);
    COUNT(calls[depth], 1);
    COUNT(listTri[depth], candidates.triangles.size());
    COUNT(listNode[depth], candidates.nodes.size());
    measure(candidates, level);
    if (job_.band > 0.0f) active = skipFar(low, half, reach, active, level);
    if (!active) return;
    if (half == 2) {
      finish(low, candidates, active, level);
      return;
    }
    for (size_t lane = 0; lane < kLanes; ++lane) {
      measureCorners(lane, reach, level);
      level.candidates[lane].reset(level.closest[lane]);
    }
    prune(
        candidates, reach, active, level,
        [&](uint32_t t, uint32_t lanes) {
          forEachLane(lanes, [&](size_t lane) { level.candidates[lane].triangles.push_back(t); });
        },
        [&](uint32_t n, uint32_t lanes) {
          forEachLane(lanes, [&](size_t lane) { level.candidates[lane].nodes.push_back(n); });
        });
    forEachLane(active, [&](size_t lane) {
      refine(low + half * octant(lane), half, level.candidates[lane], depth + 1);
    });
  }

  /// Places the centres of the halves; returns the lanes that hold samples of the grid.
  uint32_t placeHalves(glm::ivec3 low, int half, float reach, Level& level) const {
    uint32_t active = 0;
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const glm::ivec3 p = low + half * octant(lane);
      level.x.v[lane] = static_cast<float>(p.x) + reach;
      level.y.v[lane] = static_cast<float>(p.y) + reach;
      level.z.v[lane] = static_cast<float>(p.z) + reach;
      if (p.x < job_.dims.x && p.y < job_.dims.y && p.z < job_.dims.z) active |= 1u << lane;
    }
    return active;
  }

  /// Stores the tangents of all candidates, and finds the closest triangle to each centre.
  HWY_NOINLINE void measure(const Candidates& candidates, Level& level) {
    level.triangles.resize(candidates.triangles.size());
    level.nodes.resize(candidates.nodes.size());
    COUNT(tri, candidates.triangles.size());
    COUNT(node, candidates.nodes.size());
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) {
      const Float x = level.x.load(i), y = level.y.load(i), z = level.z.load(i);
      Nearest nearest(candidates.closest,
                      hn::Sqrt(squaredDistance(SameTriangle{tree_.triangle(candidates.closest)}, x, y, z)));
      for (size_t k = 0; k < candidates.triangles.size(); ++k) {
        const Tangent t = tangent(tree_.triangle(candidates.triangles[k]), x, y, z);
        level.triangles[k].store(i, t);
        nearest.take(candidates.triangles[k], t.d);
      }
      nearest.store(i, level.distance, level.closest);
      for (size_t k = 0; k < candidates.nodes.size(); ++k)
        level.nodes[k].store(i, tangent(tree_.disc(candidates.nodes[k]), x, y, z));
    }
    if (!candidates.nodes.empty()) searchNodes(candidates, level);
  }

  /// The smallest value so far in each lane, and whose it is.
  struct Nearest {
    using IntTag = hn::Rebind<int32_t, Tag>;
    Float distance;
    hn::Vec<IntTag> id;
    HWY_INLINE Nearest(uint32_t firstId, Float first)
        : distance(first), id(hn::Set(IntTag(), static_cast<int32_t>(firstId))) {}
    HWY_INLINE Nearest(size_t i, const Lanes& distances, const uint32_t* ids)
        : distance(distances.load(i)), id(hn::Load(IntTag(), reinterpret_cast<const int32_t*>(ids) + i)) {}
    HWY_INLINE void take(uint32_t newId, Float value) {
      id = hn::IfThenElse(hn::RebindMask(IntTag(), hn::Lt(value, distance)),
                          hn::Set(IntTag(), static_cast<int32_t>(newId)), id);
      distance = hn::Min(distance, value);
    }
    HWY_INLINE void store(size_t i, Lanes& distances, uint32_t* ids) const {
      distances.store(i, distance);
      hn::Store(id, IntTag(), reinterpret_cast<int32_t*>(ids) + i);
    }
  };

  /// Looks for triangles below the candidate nodes that are closer to the centres.
  void searchNodes(const Candidates& candidates, Level& level) {
    // Start from a good leaf in every direction: the node closest to each centre holds one.
    uint32_t last = kNoTriangle;
    for (size_t lane = 0; lane < kLanes; ++lane) {
      size_t best = 0;
      for (size_t k = 1; k < candidates.nodes.size(); ++k)
        if (level.nodes[k].d.v[lane] < level.nodes[best].d.v[lane]) best = k;
      if (level.nodes[best].d.v[lane] >= level.distance.v[lane] || candidates.nodes[best] == last) continue;
      last = candidates.nodes[best];
      descend(last, lane, level);
    }
    for (size_t k = 0; k < candidates.nodes.size(); ++k) {
      uint32_t open = 0;
      for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag()))
        open |= bits(hn::Lt(level.nodes[k].d.load(i), level.distance.load(i)));
      if (open) stack_.emplace_back(candidates.nodes[k], 0);
    }
    while (!stack_.empty()) {
      const uint32_t node = stack_.back().first;
      stack_.pop_back();
      const SurfaceTree::Range children = tree_.children(node);
      if (tree_.isLeaf(node)) {
        COUNT(near, children.end - children.begin);
        approach(children, level);
        continue;
      }
      COUNT(near, children.end - children.begin);
      for (uint32_t n = children.begin; n < children.end; ++n) {
        uint32_t open = 0;
        for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) {
          const Float best = level.distance.load(i);
          open |=
              bits(hn::Lt(squaredDistance(tree_.disc(n), level.x.load(i), level.y.load(i), level.z.load(i)),
                          hn::Mul(best, best)));
        }
        if (open) stack_.emplace_back(n, 0);
      }
    }
  }

  /// Follows the children closest to the lane's centre down to a leaf, and takes its triangles where they are
  /// closest.
  void descend(uint32_t node, size_t lane, Level& level) const {
    const glm::vec3 p(level.x.v[lane], level.y.v[lane], level.z.v[lane]);
    SurfaceTree::Range children = tree_.children(node);
    while (!tree_.isLeaf(node)) {
      float best = INFINITY;
      for (uint32_t n = children.begin; n < children.end; ++n) {
        const glm::vec3 q = p - tree_.disc(n).centre;
        const float d = glm::dot(q, q);
        if (d < best) best = d, node = n;
      }
      children = tree_.children(node);
    }
    approach(children, level);
  }

  /// Takes these triangles as the closest where they are.
  void approach(SurfaceTree::Range triangles, Level& level) const {
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) {
      Nearest nearest(i, level.distance, level.closest);
      for (uint32_t t = triangles.begin; t < triangles.end; ++t)
        nearest.take(t, hn::Sqrt(squaredDistance(SameTriangle{tree_.triangle(t)}, level.x.load(i),
                                                 level.y.load(i), level.z.load(i))));
      nearest.store(i, level.distance, level.closest);
    }
  }

  /// Fills the halves that the band does not reach; returns the rest.
  uint32_t skipFar(glm::ivec3 low, int half, float reach, uint32_t active, const Level& level) const {
    uint32_t rest = active;
    forEachLane(active, [&](size_t lane) {
      if (level.distance.v[lane] - reach * std::sqrt(3.0f) <= job_.band) return;
      rest &= ~(1u << lane);
      const glm::ivec3 begin = low + half * octant(lane);
      const glm::ivec3 end = glm::min(begin + half, job_.dims);
      for (int z = begin.z; z < end.z; ++z)
        for (int y = begin.y; y < end.y; ++y) {
          const size_t row = (size_t(z) * job_.dims.y + y) * job_.dims.x;
          std::fill(job_.distance + row + begin.x, job_.distance + row + end.x, job_.band);
          if (job_.triangle)
            std::fill(job_.triangle + row + begin.x, job_.triangle + row + end.x, kNoTriangle);
        }
    });
    return rest;
  }

  /// Distances of the lane's closest triangle at the corners of its half; returns their squares.
  void measureCorners(size_t lane, float reach, Level& level, Lanes* squares = nullptr) const {
    const Tag tag;
    const SameTriangle t{tree_.triangle(level.closest[lane])};
    const Float r = hn::Set(tag, reach);
    Lanes d;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
      const Float square = squaredDistance(t, hn::MulAdd(signX_.load(i), r, hn::Set(tag, level.x.v[lane])),
                                           hn::MulAdd(signY_.load(i), r, hn::Set(tag, level.y.v[lane])),
                                           hn::MulAdd(signZ_.load(i), r, hn::Set(tag, level.z.v[lane])));
      if (squares) squares->store(i, square);
      d.store(i, hn::Sub(hn::Sqrt(square), hn::Set(tag, job_.tolerance)));
    }
    for (size_t c = 0; c < 8; ++c) level.corners[c].v[lane] = d.v[c];
  }

  /// Lanes whose half may hold a sample to which this candidate is closest: its tangent plane lies below the
  /// closest triangle's distance at some corner.
  HWY_INLINE uint32_t survivors(const Tangent& t, size_t i, Float reach, const Level& level) const {
    const Float x = hn::Mul(t.gx, reach), y = hn::Mul(t.gy, reach), z = hn::Mul(t.gz, reach);
    const Float low = hn::Sub(t.d, z), high = hn::Add(t.d, z);
    const Float sum = hn::Add(x, y), difference = hn::Sub(x, y);
    const auto gap = [&](Float value, size_t c) { return hn::Sub(value, level.corners[c].load(i)); };
    const Float a = hn::Min(gap(hn::Sub(low, sum), 0), gap(hn::Add(low, difference), 1));
    const Float b = hn::Min(gap(hn::Sub(low, difference), 2), gap(hn::Add(low, sum), 3));
    const Float c = hn::Min(gap(hn::Sub(high, sum), 4), gap(hn::Add(high, difference), 5));
    const Float d = hn::Min(gap(hn::Sub(high, difference), 6), gap(hn::Add(high, sum), 7));
    return bits(hn::Lt(hn::Min(hn::Min(a, b), hn::Min(c, d)), hn::Zero(Tag()))) << i;
  }

  HWY_INLINE uint32_t survivors(const StoredTangent& t, Float reach, const Level& level) const {
    uint32_t lanes = 0;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) lanes |= survivors(t.load(i), i, reach, level);
    return lanes;
  }

  template <class Shape>
  HWY_INLINE uint32_t survivors(const Shape& shape, Float reach, const Level& level) const {
    uint32_t lanes = 0;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag()))
      lanes |= survivors(tangent(shape, level.x.load(i), level.y.load(i), level.z.load(i)), i, reach, level);
    return lanes;
  }

  /// Hands on the triangles and nodes that may matter, and to which halves. Nodes too wide for the halves are
  /// opened.
  template <class KeepTriangle, class KeepNode>
  HWY_INLINE void prune(const Candidates& candidates, float reach, uint32_t active, const Level& level,
                        KeepTriangle&& keepTriangle, KeepNode&& keepNode) {
    const Float reachLanes = hn::Set(Tag(), reach);
    // Each half already has its closest triangle.
    const auto offer = [&](uint32_t t, uint32_t lanes) {
      if (lanes) keepTriangle(t, lanes);
    };
    for (size_t k = 0; k < candidates.triangles.size(); ++k)
      offer(candidates.triangles[k], active & survivors(level.triangles[k], reachLanes, level));
    offer(candidates.closest, active & survivors(tree_.triangle(candidates.closest), reachLanes, level));
    for (size_t k = 0; k < candidates.nodes.size(); ++k)
      if (const uint32_t lanes = active & survivors(level.nodes[k], reachLanes, level))
        stack_.emplace_back(candidates.nodes[k], lanes);
    const float wide = kNodeShare * (reach + 0.5f);
    while (!stack_.empty()) {
      const auto [node, lanes] = stack_.back();
      stack_.pop_back();
      if (tree_.disc(node).radius <= wide) {
        keepNode(node, lanes);
        continue;
      }
      const SurfaceTree::Range children = tree_.children(node);
      if (tree_.isLeaf(node)) {
        COUNT(exTri, children.end - children.begin);
        for (uint32_t t = children.begin; t < children.end; ++t)
          offer(t, lanes & survivors(tree_.triangle(t), reachLanes, level));
      } else {
        COUNT(exNode, children.end - children.begin);
        for (uint32_t n = children.begin; n < children.end; ++n)
          if (const uint32_t kept = lanes & survivors(tree_.disc(n), reachLanes, level))
            stack_.emplace_back(n, kept);
      }
    }
  }

  /// The closest triangles of the samples of eight halves, 2x2x2 samples each.
  struct Samples {
    Lanes squared[kLanes];  // by half, then by sample
    alignas(64) uint32_t closest[kLanes][kLanes];
  };

  /// Fills a block of 4x4x4 samples.
  HWY_NOINLINE void finish(glm::ivec3 low, const Candidates& candidates, uint32_t active, Level& level) {
    constexpr float kReach = 0.5f;
    for (size_t half = 0; half < kLanes; ++half) {
      measureCorners(half, kReach, level, &samples_.squared[half]);
      std::fill_n(samples_.closest[half], kLanes, level.closest[half]);
    }
    prune(
        candidates, kReach, active, level,
        [&](uint32_t t, uint32_t halves) {
          finishTriangles({t, t + 1}, halves, level);
        },
        [&](uint32_t n, uint32_t halves) { finishNode(n, halves, level); });
    forEachLane(active, [&](size_t half) { write(low + 2 * octant(half), half); });
  }

  void finishNode(uint32_t node, uint32_t halves, const Level& level) {
    const Tag tag;
    const Float reach = hn::Set(tag, 0.5f);
    COUNT(finNode, 1);
    uint32_t open = 0;
    forEachLane(halves, [&](size_t half) {
      for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
        const Float d = squaredDistance(tree_.disc(node),
                                        hn::MulAdd(signX_.load(i), reach, hn::Set(tag, level.x.v[half])),
                                        hn::MulAdd(signY_.load(i), reach, hn::Set(tag, level.y.v[half])),
                                        hn::MulAdd(signZ_.load(i), reach, hn::Set(tag, level.z.v[half])));
        if (!hn::AllFalse(tag, hn::Lt(d, samples_.squared[half].load(i)))) open |= 1u << half;
      }
    });
    if (!open) return;
    const SurfaceTree::Range children = tree_.children(node);
    if (tree_.isLeaf(node)) {
      finishTriangles(children, open, level);
    } else {
      for (uint32_t n = children.begin; n < children.end; ++n) finishNode(n, open, level);
    }
  }

  /// Takes these triangles as the closest of the samples where they are.
  HWY_INLINE void finishTriangles(SurfaceTree::Range triangles, uint32_t halves, const Level& level) {
    const Tag tag;
    for (uint32_t id = triangles.begin; id < triangles.end; ++id) {
      COUNT(finTri, 1);
      const SameTriangle t{tree_.triangle(id)};
      // The samples of a half lie at the same offsets from its centre in every half.
      Lanes u, v, w;
      for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
        const Local centre = toLocal(t, level.x.load(i), level.y.load(i), level.z.load(i));
        u.store(i, centre.u), v.store(i, centre.v), w.store(i, centre.w);
      }
      const Float reach = hn::Set(tag, 0.5f);
      for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
        const Local offset = rotate(t, hn::Mul(signX_.load(i), reach), hn::Mul(signY_.load(i), reach),
                                    hn::Mul(signZ_.load(i), reach));
        forEachLane(halves, [&](size_t half) {
          COUNT(finEval, 1);
          const Local p{hn::Add(hn::Set(tag, u.v[half]), offset.u),
                        hn::Add(hn::Set(tag, v.v[half]), offset.v),
                        hn::Add(hn::Set(tag, w.v[half]), offset.w)};
          Nearest nearest(i, samples_.squared[half], samples_.closest[half]);
          nearest.take(id, squaredDistance(t, p));
          nearest.store(i, samples_.squared[half], samples_.closest[half]);
        });
      }
    }
  }

  void write(glm::ivec3 low, size_t half) const {
    Lanes distance;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag()))
      distance.store(i, hn::Sqrt(samples_.squared[half].load(i)));
    for (size_t s = 0; s < kLanes; ++s) {
      const glm::ivec3 p = low + octant(s);
      if (p.x >= job_.dims.x || p.y >= job_.dims.y || p.z >= job_.dims.z) continue;
      const size_t index = (size_t(p.z) * job_.dims.y + p.y) * job_.dims.x + p.x;
      const bool beyond = job_.band > 0.0f && distance.v[s] > job_.band;
      job_.distance[index] = beyond ? job_.band : distance.v[s];
      if (job_.triangle)
        job_.triangle[index] = beyond ? kNoTriangle : tree_.triangle(samples_.closest[half][s]).id;
    }
  }

  const ExactDistanceJob& job_;
  const SurfaceTree& tree_;
  Lanes signX_, signY_, signZ_;  // of the eight corners of a half
  Level levels_[4];
  Samples samples_;
  std::vector<std::pair<uint32_t, uint32_t>> stack_;  // node, lanes
};

void refineBlocks(const ExactDistanceJob& job, Progress& progress) {
  const glm::ivec3 blocks = (job.dims + kTopSide - 1) / kTopSide;
  const size_t count = size_t(blocks.x) * blocks.y * blocks.z;
  std::atomic<size_t> done{0};
  parallelFor(count, 8, [&](size_t begin, size_t end) {
    BlockRefiner refiner(job);
    for (size_t b = begin; b < end; ++b)
      refiner.run(kTopSide * glm::ivec3(b % blocks.x, b / blocks.x % blocks.y, b / blocks.x / blocks.y));
    progress.report(double(done += end - begin) / double(count));
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace raymap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap {

HWY_EXPORT(refineBlocks);

struct ExactDistance::Impl {
  SurfaceTree tree;
};

ExactDistance::ExactDistance() : impl_(std::make_unique<Impl>()) {}
ExactDistance::~ExactDistance() = default;

size_t ExactDistance::bytes() const {
  return impl_->tree.bytes();
}

void ExactDistance::compute(const CellMesh& mesh, double band, Progress& progress, Buffer<float>& distance,
                            Buffer<uint32_t>* triangle) {
  impl_->tree.build(mesh);
  const glm::vec3 dims(mesh.dims);
  const ExactDistanceJob job{impl_->tree,
                             mesh.dims,
                             static_cast<float>(band),
                             1e-7f * glm::length(dims),
                             distance.data(),
                             triangle ? triangle->data() : nullptr};
  HWY_DYNAMIC_DISPATCH(refineBlocks)(job, progress);
}

}  // namespace raymap
#endif
