// Ours: whether a ball is free of the surface, for the local thickness of a mesh.

#include "cpu/points/near_surface.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/points/near_surface.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include <vector>

#include "cpu/distance/surface_shapes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {
namespace {

/// Nodes of a packet that a ball meets, and whether one of them lies in it as a whole.
struct Met {
  uint32_t nodes = 0;
  bool isWhole = false;
};

HWY_INLINE Met meet(const DiscPacket& discs, const glm::vec3& p, float radius) {
  const Tag d;
  const Float x = hn::Set(d, p.x), y = hn::Set(d, p.y), z = hn::Set(d, p.z), r = hn::Set(d, radius);
  Met met;
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const Disc<Each> disc{discs, {i}};
    met.nodes |= bits(hn::Le(squaredDistance(disc, x, y, z), hn::Mul(r, r))) << i;
    const Float dx = hn::Sub(x, disc.read(discs.cx)), dy = hn::Sub(y, disc.read(discs.cy)),
                dz = hn::Sub(z, disc.read(discs.cz));
    const Float centre = hn::Sqrt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
    const Float farthest = hn::Add(centre, hn::Add(disc.read(discs.radius), disc.read(discs.halfThickness)));
    met.isWhole |= bits(hn::Le(farthest, r)) != 0;
  }
  return met;
}

/// Triangles that fill up a packet repeat another.
HWY_INLINE bool isAnyWithin(const TrianglePacket& packet, const glm::vec3& p, float radius) {
  const Tag d;
  const Float x = hn::Set(d, p.x), y = hn::Set(d, p.y), z = hn::Set(d, p.z);
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const Triangle<Each> t{packet, {i}};
    if (bits(hn::Le(squaredDistance(t, x, y, z), hn::Set(d, radius * radius)))) return true;
  }
  return false;
}

bool isNear(const SurfaceTree& tree, const glm::vec3& p, float radius) {
  thread_local std::vector<uint32_t> stack;
  stack.assign(1, tree.root() / kPacket);
  while (!stack.empty()) {
    const uint32_t packet = stack.back();
    stack.pop_back();
    const Met met = meet(tree.discs(packet), p, radius);
    if (met.isWhole) return true;
    bool isFound = false;
    forEachLane(met.nodes, [&](size_t lane) {
      const uint32_t node = packet * kPacket + static_cast<uint32_t>(lane), child = tree.childPacket(node);
      if (!tree.isLeaf(node))
        stack.push_back(child);
      else if (!isFound)
        isFound = isAnyWithin(tree.triangles(child), p, radius);
    });
    if (isFound) return true;
  }
  return false;
}

}  // namespace
}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(isNear);

bool isNearSurface(const SurfaceTree& tree, const glm::vec3& p, float radius) {
  return HWY_DYNAMIC_DISPATCH(isNear)(tree, p, radius);
}

}  // namespace raymap::cpu
#endif
