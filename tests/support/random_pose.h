#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

namespace raymap {

/// Returns a random rotation about a random axis, and a translation of up to `reach` along each.
inline glm::dmat4 randomPose(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&] {
    const double x = unit(random), y = unit(random), z = unit(random);
    return glm::dvec3(x, y, z);
  };
  const glm::dmat4 translation = glm::translate(glm::dmat4(1.0), reach * vector());
  return glm::rotate(translation, 3.0 * unit(random), glm::normalize(vector()));
}

}  // namespace raymap
