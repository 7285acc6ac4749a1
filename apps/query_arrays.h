#pragma once

#include <raymap/query.h>

#include <array>

namespace raymap {

/// An array that may be asked for: its name and its member of the options.
struct AskedArray {
  const char* name;
  bool QueryOptions::*isAsked;
  size_t bytes;  ///< Size of a point's value.
};

inline constexpr std::array kQueryArrays{
    AskedArray{"distance", &QueryOptions::distance, sizeof(double)},
    AskedArray{"closest", &QueryOptions::closest, sizeof(glm::dvec3)},
    AskedArray{"triangle", &QueryOptions::triangle, sizeof(uint32_t)},
    AskedArray{"barycentric", &QueryOptions::barycentric, sizeof(glm::dvec3)},
    AskedArray{"direction", &QueryOptions::direction, sizeof(glm::dvec3)},
    AskedArray{"winding", &QueryOptions::winding, sizeof(float)},
    AskedArray{"confidence", &QueryOptions::confidence, sizeof(float)}};

}  // namespace raymap
