#include <algorithm>

#include "base/parallel.h"
#include "cpu/backend.h"
#include "methods.h"

namespace raymap::bench {

void runRaymap(const Case& input, Buffer<float>& values) {
  Field field;
  Generator().generate(input.mesh, input.grid, {.band = input.band}, field, {.threads = input.threads});
  values = std::move(field.distance);
}

void runRaymapWinding(const Case& input, Buffer<float>& values) {
  const FieldOptions options{.winding = true};
  Progress progress;
  const Model model(input.mesh);
  Field field;
  withThreads(input.threads, [&] {
    cpu::Backend backend;
    backend.setJob({model, input.grid, options, progress, field});
    backend.begin();
    // Without distances every sample counts as close to the surface, so the dipoles settle more of them.
    std::fill(field.distance.begin(), field.distance.end(), 0.0f);
    backend.crossings();
    backend.rayMap();
    backend.winding(options.sign);
    orientFaces(backend);
    backend.windingDipoles();
  });
  values = std::move(field.winding);
}

void runRaymapBand(Case& input, Buffer<float>& values) {
  const MachineOptions machine{.threads = input.threads};
  const bool compact = isCompactBetter(input.grid, input.mesh.triangles.size());
  const Surface surface(std::move(input.mesh), {.compact = compact}, machine);
  values = surface.generateBand(input.grid, {.outside = input.band, .inside = input.band}, machine).distance;
}

}  // namespace raymap::bench
