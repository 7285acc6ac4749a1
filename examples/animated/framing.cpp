#include "framing.h"

#include <algorithm>

double secondsOf(int frame, int frames, const raymap::AnimatedMesh& mesh) {
  return mesh.seconds() * frame / frames;
}

raymap::Box reach(const raymap::AnimatedMesh& mesh, int frames) {
  // A mesh moves little between one of 64 poses and the next, and the grid has some room around them.
  const int poses = std::min(frames, 64);
  raymap::Box box;
  for (int pose = 0; pose < poses; ++pose) {
    const raymap::Box posed = bounds(raymap::posed(mesh, secondsOf(pose, poses, mesh)));
    box.min = glm::min(box.min, posed.min);
    box.max = glm::max(box.max, posed.max);
  }
  return box;
}

raymap::Grid gridOver(const raymap::AnimatedMesh& mesh, const raymap::Box& box, int resolution) {
  const glm::dvec3 size = box.size();
  const double padding = 0.1 * std::max({size.x, size.y, size.z});
  return fitGrid(mesh.rest,
                 {.resolution = resolution, .box = raymap::Box{box.min - padding, box.max + padding}});
}
