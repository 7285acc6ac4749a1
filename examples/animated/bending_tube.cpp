#include "bending_tube.h"

#include <algorithm>
#include <cmath>
#include <numbers>

using raymap::AnimatedMesh;

namespace {

constexpr int kJoints = 5, kRings = 41, kSides = 24;
constexpr double kLength = 4.0, kRadius = 0.4, kJointLength = kLength / kJoints;
constexpr double kBend = 0.35;  // Radians at each joint.

/// Rings from the lower end to the upper, of a radius that closes both.
void addVertices(AnimatedMesh& tube) {
  for (int ring = 0; ring < kRings; ++ring) {
    const double along = double(ring) / (kRings - 1);
    const double y = kLength * along;
    const double radius = kRadius * std::pow(1.0 - std::pow(2.0 * along - 1.0, 8.0), 0.5);
    // Between the middles of two joints, both move a vertex.
    const double place = std::clamp(y / kJointLength - 0.5, 0.0, kJoints - 1.0);
    const int lower = std::min(int(place), kJoints - 2);
    const auto upperWeight = float(place - lower);
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2.0 * std::numbers::pi * side / kSides;
      tube.rest.vertices.emplace_back(radius * std::cos(angle), y, radius * std::sin(angle));
      tube.joints.emplace_back(lower, lower + 1, 0, 0);
      tube.weights.emplace_back(1.0F - upperWeight, upperWeight, 0.0F, 0.0F);
    }
  }
}

void addTriangles(AnimatedMesh& tube) {
  const auto vertex = [](int ring, int side) { return uint32_t(ring * kSides + side % kSides); };
  for (int ring = 0; ring + 1 < kRings; ++ring)
    for (int side = 0; side < kSides; ++side) {
      const uint32_t a = vertex(ring, side), b = vertex(ring, side + 1), c = vertex(ring + 1, side + 1),
                     d = vertex(ring + 1, side);
      tube.rest.triangles.emplace_back(a, c, b);
      tube.rest.triangles.emplace_back(a, d, c);
    }
}

/// Each joint hangs on the one below and turns it a little further.
void addJoints(AnimatedMesh& tube) {
  using Track = AnimatedMesh::Track;
  for (int j = 0; j < kJoints; ++j) {
    tube.nodes.push_back({.parent = j - 1, .translation = {0.0, j == 0 ? 0.0 : kJointLength, 0.0}});
    AnimatedMesh::Joint& joint = tube.skeleton.emplace_back();
    joint.node = uint32_t(j);
    joint.inverseBind[3] = {0.0, -j * kJointLength, 0.0, 1.0};
    Track track{.node = uint32_t(j),
                .target = Track::Target::Rotation,
                .interpolation = Track::Interpolation::CubicSpline};
    for (int second = 0; second <= 4; ++second) {
      const double phase = 0.5 * std::numbers::pi * second;
      const double half = 0.5 * kBend * std::sin(phase),
                   speed = 0.25 * std::numbers::pi * kBend * std::cos(phase);
      const glm::dvec4 tangent(0.0, 0.0, speed, 0.0);
      track.times.push_back(second);
      track.values.insert(track.values.end(), {tangent, {0.0, 0.0, std::sin(half), std::cos(half)}, tangent});
    }
    tube.tracks.push_back(std::move(track));
  }
}

}  // namespace

AnimatedMesh bendingTube() {
  AnimatedMesh tube;
  addVertices(tube);
  addTriangles(tube);
  addJoints(tube);
  return tube;
}
