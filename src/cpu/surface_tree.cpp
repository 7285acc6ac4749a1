// Ours (the paper's future work names a hierarchy): the tree behind exact_distance.

#include "surface_tree.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <cmath>

#include "parallel.h"

namespace raymap {

namespace {

constexpr int kCurveBits = 10;
constexpr size_t kGrain = 2048;

/// Position along the Hilbert curve of a point on a 2^10 lattice (Skilling 2004).
uint32_t hilbertIndex(glm::uvec3 p) {
  for (uint32_t q = 1u << (kCurveBits - 1); q > 1; q >>= 1) {
    const uint32_t mask = q - 1;
    for (int a = 0; a < 3; ++a) {
      if (p[a] & q) {
        p.x ^= mask;
      } else {
        const uint32_t t = (p.x ^ p[a]) & mask;
        p.x ^= t;
        p[a] ^= t;
      }
    }
  }
  p.y ^= p.x;
  p.z ^= p.y;
  uint32_t t = 0;
  for (uint32_t q = 1u << (kCurveBits - 1); q > 1; q >>= 1)
    if (p.z & q) t ^= q - 1;
  p ^= t;
  const auto spread = [](uint32_t v) {
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
  };
  return spread(p.x) << 2 | spread(p.y) << 1 | spread(p.z);
}

glm::dvec3 anyPerpendicular(const glm::dvec3& x) {
  const glm::dvec3 axis = std::abs(x.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(x, axis));
}

/// `v` with unit length, or a fallback if it has none.
glm::dvec3 direction(const glm::dvec3& v, const glm::dvec3& fallback) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : fallback;
}

float inverseSquare(const glm::dvec2& v) {
  const double length2 = glm::dot(v, v);
  return length2 > 1e-30 ? static_cast<float>(1.0 / length2) : 0.0f;
}

/// The longest edge becomes ab, so that c lies over it and slivers keep a sound frame.
FramedTriangle frameTriangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, uint32_t id) {
  const double ab = glm::distance(a, b), bc = glm::distance(b, c), ca = glm::distance(c, a);
  if (bc >= ab && bc >= ca) {
    std::swap(a, b);
    std::swap(b, c);
  } else if (ca >= ab) {
    std::swap(a, c);
    std::swap(b, c);
  }
  const glm::dvec3 x = direction(b - a, {1, 0, 0});
  const glm::dvec3 z = direction(glm::cross(x, c - a), anyPerpendicular(x));
  const glm::dvec3 y = glm::cross(z, x);
  const glm::dvec2 b2(glm::distance(a, b), 0.0);
  const glm::dvec2 c2(glm::dot(c - a, x), glm::dot(c - a, y));
  return {a, x, y, z, float(b2.x), float(c2.x), float(c2.y), inverseSquare(c2 - b2), inverseSquare(c2), id};
}

}  // namespace

void SurfaceTree::build(const CellMesh& mesh) {
  sortTriangles(mesh);
  buildDiscs(mesh);
}

void SurfaceTree::sortTriangles(const CellMesh& mesh) {
  const size_t count = mesh.triangles.size();
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (size_t t = 0; t < count; ++t) {
    const glm::vec3 sum = mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2);
    low = glm::min(low, sum);
    high = glm::max(high, sum);
  }
  const glm::vec3 size = high - low;
  const float scale = ((1 << kCurveBits) - 1) / std::max({size.x, size.y, size.z, 1e-20f});
  keys_.resize(count);
  parallelFor(count, kGrain, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) {
      const glm::vec3 sum = mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2);
      keys_[t] = uint64_t(hilbertIndex(glm::uvec3((sum - low) * scale))) << 32 | t;
    }
  });
  hwy::Sorter()(keys_.data(), count, hwy::SortAscending());
  triangles_.resize(count);
  parallelFor(count, kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto t = static_cast<uint32_t>(keys_[i]);
      triangles_[i] = frameTriangle(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2), t);
    }
  });
}

namespace {

/// The disc around corners of sorted triangles [begin, end).
Disc boundTriangles(const CellMesh& mesh, const Buffer<FramedTriangle>& triangles, uint32_t begin,
                    uint32_t end) {
  glm::vec3 normal(0.0f), low(INFINITY), high(-INFINITY);
  const auto forEachCorner = [&](auto&& visit) {
    for (uint32_t t = begin; t < end; ++t)
      for (int c = 0; c < 3; ++c) visit(mesh.corner(triangles[t].id, c));
  };
  for (uint32_t t = begin; t < end; ++t) {
    const FramedTriangle& f = triangles[t];
    normal += f.z * (f.bx * f.cy);
  }
  forEachCorner([&](const glm::vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  });
  const float length = glm::length(normal);
  normal = length > 1e-12f ? normal / length : glm::vec3(triangles[begin].z);
  glm::vec3 centre = 0.5f * (low + high);
  float front = -INFINITY, back = INFINITY, radius2 = 0.0f;
  forEachCorner([&](const glm::vec3& p) {
    const glm::vec3 q = p - centre;
    const float height = glm::dot(q, normal);
    front = std::max(front, height);
    back = std::min(back, height);
    radius2 = std::max(radius2, glm::dot(q, q) - height * height);
  });
  centre += 0.5f * (front + back) * normal;
  return {centre, normal, std::sqrt(std::max(radius2, 0.0f)), 0.5f * (front - back)};
}

}  // namespace

void SurfaceTree::buildDiscs(const CellMesh& mesh) {
  const auto count = static_cast<uint32_t>(triangles_.size());
  levelStarts_ = {0};
  uint32_t nodes = (count + kLeafSize - 1) / kLeafSize;
  for (;; nodes = (nodes + kArity - 1) / kArity) {
    levelStarts_.push_back(levelStarts_.back() + nodes);
    if (nodes == 1) break;
  }
  discs_.resize(levelStarts_.back());
  uint64_t span = kLeafSize;
  for (size_t l = 0; l + 1 < levelStarts_.size(); ++l, span *= kArity) {
    const uint32_t first = levelStarts_[l];
    parallelFor(levelStarts_[l + 1] - first, std::max<size_t>(1, kGrain / span),
                [&](size_t begin, size_t end) {
                  for (size_t n = begin; n < end; ++n)
                    discs_[first + n] =
                        boundTriangles(mesh, triangles_, static_cast<uint32_t>(n * span),
                                       static_cast<uint32_t>(std::min<uint64_t>(count, (n + 1) * span)));
                });
  }
}

uint32_t SurfaceTree::level(uint32_t node) const {
  uint32_t l = 0;
  while (node >= levelStarts_[l + 1]) ++l;
  return l;
}

SurfaceTree::Range SurfaceTree::children(uint32_t node) const {
  const uint32_t l = level(node);
  if (l == 0)
    return {node * kLeafSize, std::min((node + 1) * kLeafSize, static_cast<uint32_t>(triangles_.size()))};
  const uint32_t begin = levelStarts_[l - 1] + (node - levelStarts_[l]) * kArity;
  return {begin, std::min(begin + kArity, levelStarts_[l])};
}

uint32_t SurfaceTree::representative(uint32_t node) const {
  const uint32_t l = level(node);
  uint64_t span = kLeafSize;
  for (uint32_t i = 0; i < l; ++i) span *= kArity;
  const uint64_t begin = (node - levelStarts_[l]) * span;
  const uint64_t end = std::min<uint64_t>(begin + span, triangles_.size());
  return static_cast<uint32_t>((begin + end) / 2);
}

size_t SurfaceTree::bytes() const {
  return keys_.capacityBytes() + triangles_.capacityBytes() + discs_.capacityBytes();
}

}  // namespace raymap
