#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "predicates/int128.h"

namespace raymap {

/// Random numbers that are the same bits on every machine: those of PCG64 (O'Neill 2014), seeded as NumPy
/// seeds it. Standard libraries promise the same of neither their distributions nor their logarithm.
class RandomNumbers {
 public:
  explicit RandomNumbers(uint64_t seed);

  /// Returns a multiple of 2^-53 in [0, 1).
  double uniform();
  std::vector<double> uniforms(size_t count);
  /// Returns points that lie evenly in the unit ball without its centre: N numbers each.
  template <int N>
  std::vector<glm::vec<N, double>> inBall(size_t count);
  /// Returns numbers of the standard normal distribution.
  std::vector<double> normals(size_t count);

 private:
  uint64_t next();
  void step();

  UInt128 state_ = 0, increment_ = 0;
};

/// Returns the natural logarithm of a positive number within 1e-15, by operations that IEEE 754 rounds alike
/// everywhere.
double portableLog(double x);

}  // namespace raymap
