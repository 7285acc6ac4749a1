#include "probe.h"

#include <raymap/error.h>
#include <raymap/sample.h>

#include <array>
#include <chrono>

namespace raymap::view {

Probe::Probe(const Content& content, const MachineOptions& machine) : content_(content) {
  if (content.isField() || content.animated) return;
  coming_ =
      std::async(std::launch::async, [&content, threads = machine.threads]() -> std::unique_ptr<Surface> {
        try {
          return std::make_unique<Surface>(content.mesh, SurfaceOptions{},
                                           MachineOptions{.threads = threads});
        } catch (const Error&) {
          return nullptr;  // The field says why.
        }
      });
}

Probed Probe::at(const glm::dvec3& point) {
  Probed probed{.position = point};
  if (content_.isField()) {
    const double distance = distanceAt(*content_.field, point, Outside::NaN);
    if (distance == distance) probed.distance = distance;
    return probed;
  }
  if (coming_.valid() && coming_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    surface_ = coming_.get();
  if (!surface_) return probed;
  const std::array points{point};
  const bool isSigned = surface_->isSigned();
  const QueryResult found = surface_->query(
      points, {.triangle = true, .winding = isSigned, .confidence = isSigned}, {.threads = 1});
  probed.distance = found.distance[0];
  probed.triangle = found.triangle[0];
  if (isSigned) probed.winding = found.winding[0];
  if (isSigned) probed.confidence = found.confidence[0];
  return probed;
}

}  // namespace raymap::view
