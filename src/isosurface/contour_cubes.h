#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/parallel.h"
#include "base/progress.h"
#include "isosurface/contour_rows.h"

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

/// All cubes that the surface passes, in rows along x.
class ContourCubes {
 public:
  /// Returns the distance of a sample on the grid, less that of the surface.
  using SampleValue = std::function<double(const glm::ivec3& sample)>;

  /// Completes the cubes that `findCubes` has found, and reports to `progress`, as `forEach` does.
  ContourCubes(ContourRows found, const SampleValue& value, Progress& progress);

  size_t vertexCount() const { return vertexCount_; }
  size_t quadCount() const { return quadCount_; }

  /// Calls `work(cube, place)` for each cube, on any thread.
  template <class Work>
  void forEach(Work&& work) const {
    const std::vector<size_t>& begin = found_.begin;
    parallelFor(found_.rows.size(), kRowsPerTask, [&](size_t first, size_t end) {
      progress_.report(double(first) / double(found_.rows.size()));
      for (size_t row = first; row < end; ++row)
        for (size_t c = begin[row]; c < begin[row + 1]; ++c) work(found_.cubes[c], placeOf(row, c));
    });
  }

  const ContourCube& at(const glm::ivec3& place) const { return found_.cubes[find(place)]; }

  struct Found {
    const ContourCube& cube;
    glm::ivec3 place;
  };
  Found ofVertex(uint32_t vertex) const { return last(&ContourCube::firstVertex, vertex); }
  Found ofQuad(uint32_t quad) const { return last(&ContourCube::firstQuad, quad); }

 private:
  static constexpr size_t kRowsPerTask = 64;

  glm::ivec3 placeOf(size_t row, size_t cube) const {
    return {found_.cubes[cube].x, found_.rows[row].y, found_.rows[row].z};
  }
  void joinCorners(const SampleValue& value);
  size_t find(const glm::ivec3& place) const;
  Found last(uint32_t ContourCube::*first, uint32_t number) const;
  void splitDoubledEdges();
  void splitDoubledEdges(ContourCube& cube, const glm::ivec3& place);
  void numberAll();

  ContourRows found_;
  Progress& progress_;
  size_t vertexCount_ = 0, quadCount_ = 0;
};

}  // namespace raymap
