#pragma once

// A case of the comparison, and every method that can run it.

#include <raymap/raymap.h>

#include <functional>
#include <vector>

namespace raymap::bench {

/// A mesh with a grid, or with points in its units. Every method fills the same samples or points.
struct Case {
  Mesh mesh;
  Grid grid;
  int threads = 0;
  double band = 0.0;  ///< In samples; 0 = the whole box.
  std::vector<glm::vec3> points;
  std::function<void()> prepared;  ///< Called between the preparation and the query of points.
};

/// Ours: signed distance with the defaults, and the harmonic winding number alone.
void runRaymap(const Case& input, Buffer<float>& values);
void runRaymapWinding(const Case& input, Buffer<float>& values);

/// Embree point queries, each started from the triangle of the sample before; sign from angle-weighted
/// pseudo-normals (Bærentzen & Aanæs 2005).
void runEmbree(const Case& input, Buffer<float>& values);
/// The same at points, which should be sorted.
void runEmbreePoints(const Case& input, Buffer<float>& values);

/// OpenVDB's meshToVolume, copied to a dense array.
void runOpenvdb(const Case& input, Buffer<float>& values);

/// Narrow bands. Ours takes the mesh and gives the values of its leaves, OpenVDB's gives nothing.
void runRaymapBand(Case& input, Buffer<float>& values);
void runOpenvdbBand(const Case& input, Buffer<float>& values);

}  // namespace raymap::bench
