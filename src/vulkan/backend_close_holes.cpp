// Krayer & Müller 2019, §4, end. The device finds where surface is missing and measures distances to it; the
// host lays it, as for the CPU, from the short list that it reads back.

#include <algorithm>

#include "backend.h"
#include "memory.h"

namespace raymap::vulkan {

void Backend::closeHoles() {
  // Where the six rays agree, triangles account for every change of the winding number.
  if (readDoubtfulShare("close_holes") == 0.0) return;
  do run("close_holes", [&] { recordMissingEdges(); });
  while (closeHolesOf().growIfFull());
  const std::vector<MissingEdge> edges = closeHolesOf().edges();
  if (edges.empty()) return;
  const size_t held = device_->heldMemory();
  const size_t left = options().memoryLimit ? options().memoryLimit - std::min(options().memoryLimit, held)
                                            : availableMemory();
  requirePatch(edges.size(), kBytesPerTriangle, left);
  raymap::CellMesh mesh;
  toCellUnits(*inputMesh_, grid(), mesh);
  const auto windingAt = [this](std::span<const glm::vec3> points) {
    run("close_holes", [&] { recordNumbersAt(points); });
    return closeHolesOf().numbers();
  };
  makePatch(mesh, edges, options().threshold, windingAt, *progress_, patch_);
  stage("close_holes", [&] { recordPatch(patch_); });
}

}  // namespace raymap::vulkan
