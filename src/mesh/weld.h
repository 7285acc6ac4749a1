#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

/// Which distinct position each vertex has.
struct Welding {
  std::vector<uint32_t> ids;
  size_t count = 0;
};

/// Positions are the same where their coordinates are exactly equal.
Welding weldVertices(std::span<const glm::vec3> vertices);

}  // namespace raymap
