#pragma once

#include <future>
#include <memory>

#include "state.h"

namespace raymap::view {

/// Answers what is at a point: for a mesh that does not move by the mesh itself, prepared by another thread;
/// for a field by its samples; for an animated mesh only where the point is.
class Probe {
 public:
  /// The content must outlive it.
  Probe(const Content& content, const MachineOptions& machine);

  Probed at(const glm::dvec3& point);

 private:
  const Content& content_;
  std::future<std::unique_ptr<Surface>> coming_;
  std::unique_ptr<Surface> surface_;
};

}  // namespace raymap::view
