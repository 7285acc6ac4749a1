#pragma once

// A case of the comparison at points, and every method that can run it.

#include <raymap/raymap.h>

#include <functional>
#include <vector>

namespace raymap::bench {

/// A mesh and points in its units. Every method fills the signed distances of the points.
struct PointCase {
  Mesh mesh;
  std::vector<glm::vec3> points;
  int threads = 0;
};

/// Embree point queries, each started from the triangle of the point before. So the points should be sorted.
/// Calls `prepared` between preparation and query.
void runEmbreePoints(const PointCase& input, const std::function<void()>& prepared, Buffer<double>& values);

}  // namespace raymap::bench
