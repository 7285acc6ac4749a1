#pragma once

// A case of the comparison, and every method that can run it.

#include <raymap/raymap.h>

namespace raymap::bench {

/// A mesh on a grid. Every method fills the same samples.
struct Case {
  Mesh mesh;
  Grid grid;
  int threads = 0;
  double band = 0.0;  ///< In samples; 0 = the whole box.
};

/// Ours: signed distance with the defaults, and the harmonic winding number alone.
void runRaymap(const Case& input, Buffer<float>& values);
void runRaymapWinding(const Case& input, Buffer<float>& values);

/// Embree point queries, each started from the triangle of the sample before; sign from angle-weighted
/// pseudo-normals (Bærentzen & Aanæs 2005).
void runEmbree(const Case& input, Buffer<float>& values);

/// OpenVDB's meshToVolume, copied to a dense array.
void runOpenvdb(const Case& input, Buffer<float>& values);

/// Narrow bands. Ours takes the mesh and gives the values of its leaves, OpenVDB's gives nothing.
void runRaymapBand(Case& input, Buffer<float>& values);
void runOpenvdbBand(const Case& input, Buffer<float>& values);

}  // namespace raymap::bench
