#include <raymap/error.h>
#include <raymap/mesh_view.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/text.h"
#include "mesh/area_bounds.h"
#include "mesh/model.h"
#include "mesh/single_origin.h"
#include "mesh/strided_mesh.h"

namespace raymap {

namespace {

template <class Scalar>
bool isFinite(const glm::vec<3, Scalar>& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <class Scalar>
std::string text(const glm::vec<3, Scalar>& v) {
  return "(" + numberText(v.x) + ", " + numberText(v.y) + ", " + numberText(v.z) + ")";
}

[[noreturn]] void failIndex(size_t triangle, uint64_t vertex, size_t vertexCount) {
  throw Error(ErrorCode::Input, "triangle " + std::to_string(triangle) + " uses vertex " +
                                    std::to_string(vertex) + ", but there are only " +
                                    std::to_string(vertexCount));
}

template <class Scalar>
struct Extent {
  glm::vec<3, Scalar> low{INFINITY}, high{-INFINITY};

  void add(const glm::vec<3, Scalar>& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

constexpr size_t kTrianglesPerTask = size_t{1} << 15;

/// Returns the extent that `add(triangle, extent)` makes of all triangles.
template <class Scalar, class Mesh, class Add>
Extent<Scalar> extentOfTriangles(const Mesh& mesh, Add&& add) {
  std::vector<Extent<Scalar>> extents((mesh.triangleCount() + kTrianglesPerTask - 1) / kTrianglesPerTask);
  parallelFor(extents.size(), 1, [&](size_t task, size_t) {
    Extent<Scalar> extent;
    const size_t begin = task * kTrianglesPerTask;
    for (size_t t = begin; t < std::min(begin + kTrianglesPerTask, mesh.triangleCount()); ++t)
      add(mesh.triangle(t), extent);
    extents[task] = extent;
  });
  Extent<Scalar> all;
  for (const Extent<Scalar>& extent : extents) {  // In order: of 0 and -0, the first one is taken.
    all.low = glm::min(all.low, extent.low);
    all.high = glm::max(all.high, extent.high);
  }
  return all;
}

/// Finds the extent of the vertices that triangles use, without the view's origin.
template <class Scalar, class Index>
Extent<Scalar> extentOf(const StridedMesh<Scalar, Index>& mesh) {
  return extentOfTriangles<Scalar>(mesh, [&](const glm::vec<3, Index>& triangle, Extent<Scalar>& extent) {
    for (int c = 0; c < 3; ++c)
      if (triangle[c] < mesh.vertexCount()) extent.add(mesh.position(triangle[c]));
  });
}

/// Returns the position of a vertex as its owner knows it: a packed mesh holds it about the origin.
template <class Scalar>
std::string positionText(const glm::vec<3, Scalar>& p, const glm::dvec3& origin) {
  return origin == glm::dvec3(0.0) ? text(p) : text(origin + glm::dvec3(p));
}

/// Throws if the triangle has an index out of range or a vertex that is not finite.
template <class Scalar, class Index>
void checkTriangle(const StridedMesh<Scalar, Index>& mesh, const glm::dvec3& origin, size_t t) {
  const glm::vec<3, Index> triangle = mesh.triangle(t);
  for (int c = 0; c < 3; ++c) {
    if (triangle[c] >= mesh.vertexCount()) failIndex(t, triangle[c], mesh.vertexCount());
    if (const auto p = mesh.position(triangle[c]); !isFinite(p))
      throw Error(ErrorCode::Input, "vertex " + std::to_string(triangle[c]) + " of triangle " +
                                        std::to_string(t) + " is not finite: " + positionText(p, origin));
  }
}

/// Returns whether `test(i)` holds for all i below `count`.
template <class Test>
bool allOf(size_t count, Test&& test) {
  std::atomic<bool> all{true};
  parallelFor(count, kTrianglesPerTask, [&](size_t begin, size_t end) {
    bool holds = true;
    for (size_t i = begin; i < end; ++i) holds &= test(i);  // Without branches, so that it is vectorized.
    if (!holds) all = false;
  });
  return all;
}

/// Returns whether every index is in range and every vertex finite, used or not.
template <class Scalar, class Index>
bool isValid(const StridedMesh<Scalar, Index>& mesh) {
  const auto isInRange = [&](size_t t) {
    const glm::vec<3, Index> triangle = mesh.triangle(t);
    return glm::max(glm::max(triangle.x, triangle.y), triangle.z) < mesh.vertexCount();
  };
  const auto isFiniteVertex = [&](size_t v) {
    const glm::vec<3, Scalar> p = mesh.position(v), zero = p * Scalar(0);  // NaN if p is not finite.
    return zero.x + zero.y + zero.z == Scalar(0);
  };
  return allOf(mesh.triangleCount(), isInRange) && allOf(mesh.vertexCount(), isFiniteVertex);
}

/// Returns the origin about which double positions are rounded.
template <class Index>
glm::dvec3 originOf(const StridedMesh<double, Index>& mesh, const Extent<double>& extent) {
  return singleOrigin({extent.low, extent.high}, mesh.vertexCount(),
                      [&](size_t v) { return mesh.position(v); });
}

/// Returns zero: floats are rounded already.
template <class Index>
glm::dvec3 originOf(const StridedMesh<float, Index>&, const Extent<float>&) {
  return glm::dvec3(0.0);
}

bool isPacked(const MeshView& view) {
  const auto isAligned = [](const void* memory) { return reinterpret_cast<uintptr_t>(memory) % 4 == 0; };
  return view.scalar == Scalar::Float && view.index == MeshView::Index::UInt32 &&
         view.vertexStride == sizeof(glm::vec3) && view.triangleStride == sizeof(glm::uvec3) &&
         isAligned(view.vertices) && isAligned(view.triangles);
}

template <class Scalar, class Index>
void copyTriangles(const StridedMesh<Scalar, Index>& mesh, Buffer<glm::uvec3>& triangles) {
  triangles.resizeUninitialized(mesh.triangleCount());
  for (size_t t = 0; t < mesh.triangleCount(); ++t) {
    const glm::vec<3, Index> triangle = mesh.triangle(t);
    for (int c = 0; c < 3; ++c)
      if (sizeof(Index) > sizeof(uint32_t) && triangle[c] >= mesh.vertexCount())
        failIndex(t, triangle[c], mesh.vertexCount());
    triangles[t] = glm::uvec3(triangle);
  }
}

}  // namespace

Box bounds(const MeshView& view) {
  return visitTypes(view, [&](const auto& mesh) -> Box {
    const auto extent = extentOf(mesh);
    // Double positions are rounded as the packed mesh has them, so that both have the same grid.
    const glm::dvec3 about = originOf(mesh, extent), origin = view.origin + about;
    const auto round = [&](const auto& p) {
      return origin + glm::dvec3(roundedToSingle(glm::dvec3(p) - about));
    };
    return {round(extent.low), round(extent.high)};
  });
}

Box areaBounds(const MeshView& view) {
  return visitTypes(view, [&](const auto& mesh) -> Box {
    const glm::dvec3 about = originOf(mesh, extentOf(mesh));
    const auto at = [&](auto vertex) -> glm::vec3 {
      const auto p = mesh.position(vertex);
      if constexpr (std::is_same_v<decltype(p), const glm::vec3>)
        return p;
      else
        return roundedToSingle(p - about);
    };
    const auto all = extentOfTriangles<float>(mesh, [&](const auto& triangle, Extent<float>& extent) {
      if (glm::max(glm::max(triangle.x, triangle.y), triangle.z) >= mesh.vertexCount()) return;
      const glm::vec3 a = at(triangle.x), b = at(triangle.y), c = at(triangle.z);
      const glm::dvec3 u = glm::dvec3(b) - glm::dvec3(a), v = glm::dvec3(c) - glm::dvec3(a);
      if (glm::cross(u, v) == glm::dvec3(0.0)) return;
      for (const glm::vec3& p : {a, b, c}) extent.add(p);
    });
    const glm::dvec3 origin = view.origin + about;
    return {origin + glm::dvec3(all.low), origin + glm::dvec3(all.high)};
  });
}

void validate(const MeshView& view) {
  if (view.triangleCount == 0) throw Error(ErrorCode::Input, "the mesh has no triangles");
  if (!isFinite(view.origin))
    throw Error(ErrorCode::Input, "the mesh's origin is not finite: " + text(view.origin));
  visitTypes(view, [&](const auto& mesh) {
    if (isValid(mesh)) return;
    for (size_t t = 0; t < mesh.triangleCount(); ++t) checkTriangle(mesh, view.origin, t);
  });
}

size_t Model::bytesNeeded(const MeshView& view) {
  return isPacked(view) ? 0 : view.vertexCount * sizeof(glm::vec3) + view.triangleCount * sizeof(glm::uvec3);
}

void Model::pack(const MeshView& view) {
  forget();
  if (isPacked(view)) {
    PackedMesh::operator=({{static_cast<const glm::vec3*>(view.vertices), view.vertexCount},
                           {static_cast<const glm::uvec3*>(view.triangles), view.triangleCount},
                           view.origin});
    return;
  }
  if (view.vertexCount > UINT32_MAX)
    throw Error(ErrorCode::Unsupported, "the mesh has " + std::to_string(view.vertexCount) +
                                            " vertices; at most 4294967295 can be numbered");
  visitTypes(view, [&](const auto& mesh) {
    copyTriangles(mesh, convertedTriangles_);
    const glm::dvec3 about = originOf(mesh, extentOf(mesh));
    convertedVertices_.resizeUninitialized(mesh.vertexCount());
    for (size_t v = 0; v < mesh.vertexCount(); ++v)
      convertedVertices_[v] = roundedToSingle(glm::dvec3(mesh.position(v)) - about);
    PackedMesh::operator=({convertedVertices_, convertedTriangles_, view.origin + about});
  });
}

void Model::keep(const MeshView& view) {
  pack(view);
  if (isPacked(view))
    keep(Mesh{{vertices.begin(), vertices.end()}, {triangles.begin(), triangles.end()}, origin});
}

void Model::keep(Mesh&& mesh) {
  kept_ = std::move(mesh);
  pack(kept_);
}

size_t Model::bytes() const {
  return convertedVertices_.capacityBytes() + convertedTriangles_.capacityBytes() +
         kept_.vertices.capacity() * sizeof(glm::vec3) + kept_.triangles.capacity() * sizeof(glm::uvec3);
}

}  // namespace raymap
