// The whole generator on several threads, small enough for ThreadSanitizer.

#include "any_threads.h"
#include "shapes.h"

namespace raymap {
namespace {

void expectSame(const FieldOptions& options) {
  // Closed, torn and loose parts, so that the rays disagree at some samples and every stage has work.
  Mesh torn = shapes::torus(1.0, 0.4, 16, 8);
  torn.triangles.resize(torn.triangles.size() - 20);
  const Mesh mesh = shapes::joined(torn, shapes::soup(20, 5));
  expectSameForAnyThreads(mesh, fitGrid(mesh, {.resolution = 24}), options, {4});
}

TEST(GeneratorThreads, ExactAndHarmonic) {
  expectSame({});
}

TEST(GeneratorThreads, BandAndPaths) {
  expectSame({.sign = SignMode::Paths, .passes = 2, .band = 2.0});
}

TEST(GeneratorThreads, NeighboursAndEvolution) {
  expectSame({.distance = DistanceMode::Neighbours, .sign = SignMode::Evolution, .passes = 2});
}

TEST(GeneratorThreads, RasterAndRays) {
  expectSame({.distance = DistanceMode::Raster, .sign = SignMode::Rays});
}

}  // namespace
}  // namespace raymap
