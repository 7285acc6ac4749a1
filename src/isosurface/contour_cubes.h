#pragma once

#include <raymap/field.h>

#include <array>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "base/progress.h"
#include "isosurface/cube_cycles.h"

namespace raymap {

/// Returns a unit step along an axis; axes count modulo 3.
inline glm::ivec3 along(int axis) {
  glm::ivec3 step(0);
  step[axis % 3] = 1;
  return step;
}

inline glm::ivec3 cornerOffset(int corner) {
  return {corner & 1, corner >> 1 & 1, corner >> 2};
}

/// A cube between eight samples that the surface passes. Its lowest corner is sample (x - 1, y - 1, z - 1);
/// its row gives y and z.
struct ContourCube {
  int32_t x;
  uint8_t corners;    // Bits of the corners that are inside.
  uint8_t ambiguous;  // Bits of the ambiguous faces.
  uint8_t joined;     // Bits of the ambiguous faces whose inside corners are joined.
  CubeCycles cycles;
  uint32_t firstVertex;  // First of its vertices, one per sheet.
  uint32_t firstQuad;    // First of its quads, one per own edge that the surface crosses.

  /// Returns whether the surface crosses the cube's own edge along an axis. A cube owns the lattice edges
  /// that start at its lowest corner.
  bool isCrossed(int axis) const { return ((corners ^ corners >> (1 << axis)) & 1) != 0; }
  bool startsInside() const { return (corners & 1) != 0; }
};

/// All cubes that the surface passes, in rows along x. Everything beyond the grid is outside.
class ContourCubes {
 public:
  /// Finds the cubes and reports to `progress`, as `forEach` does.
  ContourCubes(const Field& field, double iso, Progress& progress);

  size_t vertexCount() const { return vertexCount_; }
  size_t quadCount() const { return quadCount_; }

  /// Calls `work(cube, place)` for each cube, on any thread.
  template <class Work>
  void forEach(Work&& work) const {
    forEachRow([&](size_t row, int y, int z) {
      for (size_t c = rowBegin_[row]; c < rowBegin_[row + 1]; ++c)
        work(cubes_[c], glm::ivec3(cubes_[c].x, y, z));
    });
  }

  const ContourCube& at(const glm::ivec3& place) const { return cubes_[find(place)]; }

  struct Found {
    const ContourCube& cube;
    glm::ivec3 place;
  };
  Found ofVertex(uint32_t vertex) const { return last(&ContourCube::firstVertex, vertex); }
  Found ofQuad(uint32_t quad) const { return last(&ContourCube::firstQuad, quad); }

 private:
  static constexpr size_t kRowsPerTask = 64;

  template <class Work>
  void forEachRow(Work&& work) const {
    parallelFor(rowBegin_.size() - 1, kRowsPerTask, [&](size_t begin, size_t end) {
      progress_.report(double(begin) / double(rowBegin_.size()));
      for (size_t row = begin; row < end; ++row) work(row, int(row % dims_.y), int(row / dims_.y));
    });
  }

  double value(const glm::ivec3& sample) const;
  template <class Visit>
  void scanRow(int y, int z, Visit&& visit) const;
  void findCubes();
  ContourCube makeCube(const glm::ivec3& place, unsigned corners) const;
  bool isJoined(const glm::ivec3& place, unsigned corners, const CubeFace& face) const;
  size_t find(const glm::ivec3& place) const;
  Found last(uint32_t ContourCube::*first, uint32_t number) const;
  void splitDoubledEdges();
  void splitDoubledEdges(ContourCube& cube, const glm::ivec3& place);
  void numberAll();

  const Field& field_;
  double iso_;
  Progress& progress_;
  glm::ivec3 dims_;  // Number of cubes per axis, one more than samples.
  std::vector<size_t> rowBegin_;
  std::vector<ContourCube> cubes_;
  size_t vertexCount_ = 0, quadCount_ = 0;
};

}  // namespace raymap
