#include "cpu/cells/closest_triangles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/cells/closest_triangles.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToUnsigned<Tag>;
using Float = hn::Vec<Tag>;

struct Vector {
  Float x, y, z;

  HWY_INLINE Float dot(const glm::vec3& v) const {
    return hn::MulAdd(x, all(v.x), hn::MulAdd(y, all(v.y), hn::Mul(z, all(v.z))));
  }
  HWY_INLINE Vector plus(Float factor, const glm::vec3& v) const {
    return {hn::MulAdd(factor, all(v.x), x), hn::MulAdd(factor, all(v.y), y),
            hn::MulAdd(factor, all(v.z), z)};
  }
  HWY_INLINE Float squaredLength() const { return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))); }

  static HWY_INLINE Float all(float value) { return hn::Set(Tag(), value); }
};

/// Edge with 1 / length^2, or 0 if it is a point.
struct Edge {
  explicit Edge(const glm::vec3& v) : vector(v) {
    const float length2 = glm::dot(v, v);
    inverse = length2 > 0.0f ? 1.0f / length2 : 0.0f;
  }
  /// Returns the squared distance from the origin to the edge that starts at `start`.
  HWY_INLINE Float squaredDistance(const Vector& start) const {
    const Float along = hn::Mul(start.dot(vector), Vector::all(-inverse));
    const Float clamped = hn::Min(hn::Max(along, hn::Zero(Tag())), Vector::all(1.0f));
    return start.plus(clamped, vector).squaredLength();
  }

  glm::vec3 vector;
  float inverse;
};

/// Triangle prepared for measuring its distance from many points.
struct MeasuredTriangle {
  MeasuredTriangle(const glm::vec3& corner, const glm::vec3& b, const glm::vec3& c)
      : a(corner), ab(b - corner), ac(c - corner), bc(c - b) {
    const glm::vec3 normal = glm::cross(ab.vector, ac.vector);
    const float area2 = glm::dot(normal, normal);
    const float inverse = area2 > 0.0f ? 1.0f / area2 : 0.0f;
    alongAb = glm::cross(normal, ac.vector) * inverse;
    alongAc = glm::cross(ab.vector, normal) * inverse;
  }

  HWY_INLINE Float squaredDistance(Float px, Float py, Float pz) const {
    const Vector pa{hn::Sub(Vector::all(a.x), px), hn::Sub(Vector::all(a.y), py),
                    hn::Sub(Vector::all(a.z), pz)};
    const Vector pb = pa.plus(Vector::all(1.0f), ab.vector);
    const Float edges =
        hn::Min(hn::Min(ab.squaredDistance(pa), ac.squaredDistance(pa)), bc.squaredDistance(pb));
    // Barycentric coordinates of the projection; with an area of 0 they are 0, which is corner a.
    const Float v = pa.dot(alongAb), w = pa.dot(alongAc), zero = hn::Zero(Tag());
    const auto isInside =
        hn::And(hn::And(hn::Ge(v, zero), hn::Ge(w, zero)), hn::Le(hn::Add(v, w), Vector::all(1.0f)));
    const Float inside = pa.plus(v, ab.vector).plus(w, ac.vector).squaredLength();
    return hn::IfThenElse(isInside, hn::Min(inside, edges), edges);
  }

  glm::vec3 a;
  Edge ab, ac, bc;
  glm::vec3 alongAb, alongAc;
};

void findClosest(const CellMesh& mesh, std::span<const uint32_t> triangles, PointBatch& batch) {
  const Tag tag;
  const IntTag intTag;
  for (const uint32_t t : triangles) {
    const MeasuredTriangle triangle(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    for (size_t i = 0; i < batch.count; i += hn::Lanes(tag)) {
      const Float squared = triangle.squaredDistance(hn::Load(tag, &batch.x[i]), hn::Load(tag, &batch.y[i]),
                                                     hn::Load(tag, &batch.z[i]));
      const Float best = hn::Load(tag, &batch.squared[i]);
      const auto isCloser = hn::Lt(squared, best);
      hn::Store(hn::IfThenElse(isCloser, squared, best), tag, &batch.squared[i]);
      hn::Store(hn::IfThenElse(hn::RebindMask(intTag, isCloser), hn::Set(intTag, t),
                               hn::Load(intTag, &batch.triangle[i])),
                intTag, &batch.triangle[i]);
    }
  }
}

}  // namespace
}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(findClosest);

void findClosestTriangles(const CellMesh& mesh, std::span<const uint32_t> triangles, PointBatch& batch) {
  HWY_DYNAMIC_DISPATCH(findClosest)(mesh, triangles, batch);
}

}  // namespace raymap::cpu
#endif
