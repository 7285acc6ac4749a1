#pragma once

#include <raymap/query.h>

#include <cstddef>
#include <cstring>

namespace raymap {

inline const std::byte* bytesAt(const PointsView& view, size_t i) {
  return static_cast<const std::byte*>(view.data) + i * view.stride;
}

/// Returns a point of a view in double precision.
inline glm::dvec3 pointAt(const PointsView& view, size_t i) {
  const std::byte* bytes = bytesAt(view, i);
  const auto read = [&]<class S>(S) {
    S p[3];
    std::memcpy(p, bytes, sizeof(p));
    return glm::dvec3(p[0], p[1], p[2]);
  };
  return view.scalar == Scalar::Float ? read(float{}) : read(double{});
}

}  // namespace raymap
