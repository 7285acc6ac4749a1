#pragma once

#include <raymap/export.h>
#include <raymap/mesh.h>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace raymap {

/// Distances between the elements of a view, in bytes; 0 = tightly packed.
struct MeshStrides {
  size_t vertex = 0;
  size_t triangle = 0;
};

/// A triangle mesh in the caller's memory. Functions that read a mesh take a view; `Mesh` converts to it.
///
/// Position of vertex v: `origin` plus three numbers at `vertices` + v * `vertexStride` bytes, in the mesh's
/// own units. Triangle t: three vertex numbers at `triangles` + t * `triangleStride` bytes, counter-clockwise
/// seen from outside. The memory must stay valid and unchanged during each call that is given the view.
///
/// A view with floats, 32-bit indices and no gaps is read in place. Any other is converted once per call into
/// memory that the `Generator` keeps. Double positions are rounded to single precision about an origin, as by
/// `makeMesh`; their field is the same, bit for bit.
struct MeshView {
  enum class Index : uint8_t { UInt32, UInt64 };

  const void* vertices = nullptr;
  size_t vertexCount = 0;
  size_t vertexStride = sizeof(glm::vec3);  ///< Bytes from one vertex to the next.
  const void* triangles = nullptr;
  size_t triangleCount = 0;
  size_t triangleStride = sizeof(glm::uvec3);  ///< Bytes from one triangle to the next.
  Scalar scalar = Scalar::Float;
  Index index = Index::UInt32;
  glm::dvec3 origin{0.0};  ///< Added to every position, in double precision.

  MeshView() = default;
  MeshView(const Mesh& mesh) : MeshView(mesh.vertices, mesh.triangles, mesh.origin) {}

  /// Views packed arrays of glm's types: `vec3` or `dvec3`, `uvec3` or `u64vec3`.
  template <std::floating_point S, std::unsigned_integral I>
  MeshView(std::span<const glm::vec<3, S>> positions, std::span<const glm::vec<3, I>> faces,
           const glm::dvec3& about = glm::dvec3(0.0))
      : MeshView(reinterpret_cast<const S*>(positions.data()), positions.size(),
                 reinterpret_cast<const I*>(faces.data()), faces.size(), {}, about) {}
  template <class Positions, class Faces>
  requires requires(const Positions& p, const Faces& f) {
    std::span(p);
    std::span(f);
  }
  MeshView(const Positions& positions, const Faces& faces, const glm::dvec3& about = glm::dvec3(0.0))
      : MeshView(asConst(std::span(positions)), asConst(std::span(faces)), about) {}

  /// Views arrays of `float` or `double`, and of 32-bit or 64-bit unsigned integers.
  template <std::floating_point S, std::unsigned_integral I>
  requires(sizeof(S) <= sizeof(double) && (sizeof(I) == 4 || sizeof(I) == 8))
      MeshView(const S* positions, size_t positionCount, const I* indices, size_t faceCount,
               MeshStrides strides = {}, const glm::dvec3& about = glm::dvec3(0.0))
      : vertices(positions),
        vertexCount(positionCount),
        vertexStride(strides.vertex > 0 ? strides.vertex : 3 * sizeof(S)),
        triangles(indices),
        triangleCount(faceCount),
        triangleStride(strides.triangle > 0 ? strides.triangle : 3 * sizeof(I)),
        scalar(sizeof(S) == sizeof(float) ? Scalar::Float : Scalar::Double),
        index(sizeof(I) == sizeof(uint32_t) ? Index::UInt32 : Index::UInt64),
        origin(about) {}

 private:
  template <class T, size_t N>
  static std::span<const T> asConst(std::span<T, N> span) {
    return span;
  }
};

/// Returns the bounds of the vertices that triangles use, in the mesh's units. Ignores indices out of range.
RAYMAP_API Box bounds(const MeshView& mesh);

/// Throws `Error(Input)` that names the element and the value if the mesh has no triangle, an index out of
/// range or a vertex that is not finite.
RAYMAP_API void validate(const MeshView& mesh);

}  // namespace raymap
