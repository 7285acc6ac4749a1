#pragma once

#include <raymap/mesh_view.h>

#include <cstddef>
#include <cstring>
#include <type_traits>

namespace raymap {

/// Reads the elements of a view whose types are known at compile time.
template <class Scalar, class Index>
class StridedMesh {
 public:
  using Position = glm::vec<3, Scalar>;
  using Triangle = glm::vec<3, Index>;

  explicit StridedMesh(const MeshView& view) : view_(view) {}

  size_t vertexCount() const { return view_.vertexCount; }
  size_t triangleCount() const { return view_.triangleCount; }
  Position position(size_t vertex) const {
    return read<Position>(view_.vertices, vertex * view_.vertexStride);
  }
  Triangle triangle(size_t index) const {
    return read<Triangle>(view_.triangles, index * view_.triangleStride);
  }

 private:
  /// Copies: the caller's memory need not be aligned.
  template <class T>
  static T read(const void* base, size_t offset) {
    T value;
    std::memcpy(&value, static_cast<const std::byte*>(base) + offset, sizeof(T));
    return value;
  }

  const MeshView& view_;
};

/// Calls `visit` with the view as a `StridedMesh` of its types.
template <class Visit>
auto visitTypes(const MeshView& view, Visit&& visit) {
  const bool isFloat = view.scalar == Scalar::Float, isShort = view.index == MeshView::Index::UInt32;
  if (isFloat && isShort) return visit(StridedMesh<float, uint32_t>(view));
  if (isFloat) return visit(StridedMesh<float, uint64_t>(view));
  if (isShort) return visit(StridedMesh<double, uint32_t>(view));
  return visit(StridedMesh<double, uint64_t>(view));
}

}  // namespace raymap
