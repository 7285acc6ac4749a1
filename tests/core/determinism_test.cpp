// The field is the same on 1, 2 and 8 threads. The example mesh, closed and torn, is fine enough for every
// parallel loop to have several blocks.

#include "any_threads.h"
#include "example_mesh.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr DistanceMode kDistances[] = {DistanceMode::Exact, DistanceMode::Neighbours, DistanceMode::Cell,
                                       DistanceMode::Raster};
constexpr SignMode kSigns[] = {SignMode::Harmonic,  SignMode::Exact, SignMode::Paths,
                               SignMode::Evolution, SignMode::Rays,  SignMode::Ray};

void expectSame(const Mesh& mesh, int resolution, const FieldOptions& options) {
  expectSameForAnyThreads(mesh, fitGrid(mesh, {.resolution = resolution}), options, {2, 8});
}

TEST(Determinism, OfASoupInEveryMode) {
  const Mesh mesh = shapes::soup(300, 5);
  for (const DistanceMode distance : kDistances)
    for (const SignMode sign : kSigns) expectSame(mesh, 40, {.distance = distance, .sign = sign});
}

TEST(Determinism, OfDistances) {
  const Mesh mesh = makeExampleMesh(false);
  for (const DistanceMode distance : kDistances)
    expectSame(mesh, 96, {.distance = distance, .sign = SignMode::Rays});
}

TEST(Determinism, OfSignsWhereTheRaysAgree) {
  const Mesh mesh = makeExampleMesh(false);
  for (const SignMode sign : kSigns) expectSame(mesh, 96, {.sign = sign, .band = 3.0});
}

TEST(Determinism, OfSignsAroundHoles) {
  const Mesh mesh = makeExampleMesh(true);
  for (const SignMode sign : kSigns) expectSame(mesh, 96, {.sign = sign, .band = 3.0});
  expectSame(mesh, 96, {});
}

}  // namespace
}  // namespace raymap
