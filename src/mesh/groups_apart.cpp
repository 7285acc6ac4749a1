#include "mesh/groups_apart.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace raymap {

namespace {

using Groups = std::vector<std::vector<uint32_t>>;

constexpr double kSlabsPerGap = 8.0;
constexpr double kMostSlabs = 1 << 20;

/// Slabs across an axis, of which so many in a row make a gap.
class Slabs {
 public:
  Slabs(const PackedMesh& mesh, int axis, double gap, const std::vector<uint32_t>& faces)
      : mesh_(mesh), axis_(axis) {
    for (const uint32_t face : faces)
      low_ = std::min(low_, lowOf(face)), high_ = std::max(high_, highOf(face));
    if (faces.empty()) return;
    width_ = std::max(gap / kSlabsPerGap, (double(high_) - low_) / kMostSlabs);
    changes_.resize(slabOf(high_) + 2);
    for (const uint32_t face : faces) ++changes_[slabOf(lowOf(face))], --changes_[slabOf(highOf(face)) + 1];
  }

  /// Appends the faces between gaps. `faces` are those of the constructor.
  void divide(const std::vector<uint32_t>& faces, Groups& groups) const {
    const auto most = size_t(kSlabsPerGap);
    const size_t first = groups.size();
    std::vector<size_t> groupOf(changes_.size());
    int covering = 0;
    size_t empty = 0, group = 0;
    for (size_t slab = 0; slab < changes_.size(); ++slab) {
      covering += changes_[slab];
      if (covering > 0 && empty > most) ++group;
      empty = covering > 0 ? 0 : empty + 1;
      groupOf[slab] = group;
    }
    groups.resize(first + group + 1);
    for (const uint32_t face : faces) groups[first + groupOf[slabOf(lowOf(face))]].push_back(face);
  }

 private:
  float at(uint32_t face, int corner) const { return mesh_.vertices[mesh_.triangles[face][corner]][axis_]; }
  float lowOf(uint32_t face) const { return std::min({at(face, 0), at(face, 1), at(face, 2)}); }
  float highOf(uint32_t face) const { return std::max({at(face, 0), at(face, 1), at(face, 2)}); }
  size_t slabOf(float value) const { return width_ > 0.0 ? size_t((double(value) - low_) / width_) : 0; }

  const PackedMesh& mesh_;
  int axis_;
  float low_ = INFINITY, high_ = -INFINITY;
  double width_ = 0.0;
  std::vector<int> changes_;  // Of the number of faces that reach into a slab.
};

}  // namespace

Groups groupsApart(const PackedMesh& mesh, double gap) {
  constexpr int kMostRounds = 48;  // Each passes over all faces.
  Groups groups(1, std::vector<uint32_t>(mesh.triangles.size()));
  std::iota(groups[0].begin(), groups[0].end(), 0U);
  for (int round = 0, whole = 0; round < kMostRounds && whole < 3; ++round) {
    Groups finer;
    for (const std::vector<uint32_t>& group : groups) Slabs(mesh, round % 3, gap, group).divide(group, finer);
    whole = finer.size() == groups.size() ? whole + 1 : 0;
    groups = std::move(finer);
  }
  std::ranges::sort(groups, {}, [](const std::vector<uint32_t>& group) { return group.front(); });
  return groups;
}

Mesh partOf(const PackedMesh& mesh, const std::vector<uint32_t>& faces) {
  if (faces.size() == mesh.triangles.size())
    return {.vertices = {mesh.vertices.begin(), mesh.vertices.end()},
            .triangles = {mesh.triangles.begin(), mesh.triangles.end()},
            .origin = mesh.origin};
  std::vector<uint32_t> used;
  for (const uint32_t face : faces)
    for (int c = 0; c < 3; ++c) used.push_back(mesh.triangles[face][c]);
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  Mesh part{.origin = mesh.origin};
  for (const uint32_t v : used) part.vertices.push_back(mesh.vertices[v]);
  const auto number = [&](uint32_t v) { return uint32_t(std::ranges::lower_bound(used, v) - used.begin()); };
  for (const uint32_t face : faces) {
    const glm::uvec3& t = mesh.triangles[face];
    part.triangles.emplace_back(number(t.x), number(t.y), number(t.z));
  }
  return part;
}

}  // namespace raymap
