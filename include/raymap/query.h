#pragma once

#include <raymap/buffer.h>
#include <raymap/mesh.h>
#include <raymap/options.h>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

namespace raymap {

/// How to prepare a mesh.
struct SurfaceOptions {
  /// Sign: `harmonic`, or `none`. Queries then do not tell inside from outside, and the surface takes less
  /// time and memory.
  SignMode sign = SignMode::Harmonic;
  /// Whether faces that point the wrong way are reversed: `auto`, if the mesh then fits clearly better;
  /// `keep`, never; `repair`, whenever it fits no worse.
  Orientation orientation = Orientation::Auto;
  double threshold = 0.5;  ///< A point is inside if |winding number| exceeds this.
  /// Whether to take 68 to 74 bytes per triangle less. The results are the same. Scattered points then take
  /// up to half more time, and narrow bands up to a tenth.
  bool compact = false;
};

/// Points in the caller's memory. Point i: three numbers at `data` + i * `stride` bytes, in the mesh's units.
struct PointsView {
  const void* data = nullptr;
  size_t count = 0;
  size_t stride = sizeof(glm::vec3);  ///< Bytes from one point to the next.
  Scalar scalar = Scalar::Float;

  PointsView() = default;
  /// Views points of three `float` or `double` each; `bytes` is the stride, 0 = tightly packed.
  template <std::floating_point S>
  requires(sizeof(S) <= sizeof(double)) PointsView(const S* points, size_t pointCount, size_t bytes = 0)
      : data(points),
        count(pointCount),
        stride(bytes > 0 ? bytes : 3 * sizeof(S)),
        scalar(sizeof(S) == sizeof(float) ? Scalar::Float : Scalar::Double) {}
  /// Views an array of `vec3` or `dvec3`.
  template <class Points>
  requires requires(const Points& p) {
    std::span(p);
    &std::span(p).data()->x;
  }
  PointsView(const Points& points)
      : PointsView(std::span(points).empty() ? nullptr : &std::span(points).data()->x,
                   std::span(points).size()) {}
};

/// Options of a query: arrays to fill, and limits. Arrays that are not asked for take no memory.
struct QueryOptions {
  bool distance = true;      ///< Whether to fill `QueryResult::distance`.
  bool closest = false;      ///< Whether to fill `QueryResult::closest`.
  bool triangle = false;     ///< Whether to fill `QueryResult::triangle`.
  bool barycentric = false;  ///< Whether to fill `QueryResult::barycentric`.
  bool direction = false;    ///< Whether to fill `QueryResult::direction`.
  bool winding = false;      ///< Whether to fill `QueryResult::winding`. Needs a sign.
  bool confidence = false;   ///< Whether to fill `QueryResult::confidence`. Needs a sign.
  /// Farther points get this distance, with their sign, and no closest point, triangle or direction.
  double maxDistance = std::numeric_limits<double>::infinity();
};

/// One value per point, in the order of the points. Arrays that were not asked for are empty.
///
/// A point with a coordinate that is not finite gets NaN and `kNoTriangle`. So do points beyond
/// `QueryOptions::maxDistance`, except for `distance`, `winding` and `confidence`. A
/// distance beyond the largest double is infinite.
struct QueryResult {
  Buffer<double> distance = {};     ///< In the mesh's units, negative inside; not negative without a sign.
  Buffer<glm::dvec3> closest = {};  ///< Closest point of the surface, in the mesh's units.
  Buffer<uint32_t> triangle = {};   ///< Index of a triangle that holds it, or `kNoTriangle`.
  Buffer<glm::dvec3> barycentric = {};  ///< Weights of the triangle's corners at it, 0 to 1; their sum is 1.
  Buffer<glm::dvec3> direction = {};    ///< Unit vector from the point to the closest one; 0 on the surface.
  Buffer<float> winding = {};           ///< Winding number, +1 inside a closed surface that faces outwards.
  Buffer<float> confidence = {};        ///< Confidence in the sign, 0 to 1.
};

}  // namespace raymap
