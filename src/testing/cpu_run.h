#pragma once

// Whole runs on the CPU and how they compare.

#include <raymap/generate.h>

#include <cmath>
#include <cstddef>
#include <cstring>

namespace raymap {

/// Makes a field on the CPU, with its winding numbers.
inline Generated runOf(const Mesh& mesh, const Grid& grid, FieldOptions options,
                       MachineOptions machine = {}) {
  options.winding = true;
  machine.device = "cpu";
  return generate(mesh, grid, options, machine);
}

inline Generated runOf(const Mesh& mesh, const Grid& grid, Orientation orientation,
                       SignMode sign = SignMode::Harmonic) {
  return runOf(mesh, grid, {.sign = sign, .orientation = orientation});
}

/// Returns the number of samples whose signs differ.
inline size_t countUnlike(const Generated& a, const Generated& b) {
  size_t unlike = 0;
  for (size_t s = 0; s < a.field.distance.size(); ++s)
    unlike += std::signbit(a.field.distance[s]) != std::signbit(b.field.distance[s]);
  return unlike;
}

inline bool areSame(const Generated& a, const Generated& b) {
  const auto bytes = [](const Generated& run) { return run.field.winding.size() * sizeof(float); };
  return bytes(a) == bytes(b) && a.stats.turnedFaces == b.stats.turnedFaces &&
         std::memcmp(a.field.winding.data(), b.field.winding.data(), bytes(a)) == 0 &&
         std::memcmp(a.field.distance.data(), b.field.distance.data(), bytes(a)) == 0;
}

}  // namespace raymap
