#include "content.h"

#include <raymap/error.h>

#include <algorithm>

namespace raymap::view {

namespace {

/// A mesh moves little between one of these poses and the next, and a grid has some room around them.
constexpr int kPoses = 64;

void add(Box& all, const Box& box) {
  all.min = glm::min(all.min, box.min);
  all.max = glm::max(all.max, box.max);
}

/// Returns the bounds of a pose. The numbers of an animation are finite, but their product may not be.
Box boundsAt(const AnimatedMesh& mesh, double seconds) {
  const Mesh pose = posed(mesh, seconds);
  try {
    validate(pose);
  } catch (const Error& error) {
    throw Error(error.code(), "at " + std::to_string(seconds) + " s: " + error.what());
  }
  return bounds(pose);
}

/// Returns the bounds of a field's surface, or of its grid if they are not known.
Box boundsOf(const Field& field) {
  if (!field.surfaceBounds.isEmpty()) return field.surfaceBounds;
  return {field.grid.origin, field.grid.position(glm::dvec3(field.grid.dims - 1))};
}

}  // namespace

Content contentOf(Mesh mesh) {
  validate(mesh);
  if (mesh.triangles.empty()) throw Error(ErrorCode::Input, "the mesh has no face to show");
  Content content;
  content.bounds = bounds(mesh);
  content.mesh = std::move(mesh);
  return content;
}

Content contentOf(Field field) {
  Content content;
  content.bounds = boundsOf(field);
  content.field = std::move(field);
  return content;
}

Content contentOf(AnimatedMesh mesh) {
  validate(mesh);
  if (mesh.rest.triangles.empty()) throw Error(ErrorCode::Input, "the mesh has no face to show");
  Content content;
  for (int pose = 0; pose < kPoses; ++pose)
    add(content.bounds, boundsAt(mesh, mesh.seconds() * pose / (kPoses - 1)));
  content.mesh = mesh.rest;
  content.clips = mesh.clips;
  content.animated = std::move(mesh);
  return content;
}

}  // namespace raymap::view
