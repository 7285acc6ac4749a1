#include "mesh/polygons.h"

#include <raymap/error.h>
#include <raymap/polygons.h>

#include <algorithm>
#include <string>

#include "base/parallel.h"
#include "mesh/polygon.h"

namespace raymap {

/// Triangles of some fans' polygons.
struct Polygons::Cuts {
  std::vector<uint32_t> fans;
  std::vector<size_t> ends;  ///< Where the triangles of each end.
  std::vector<glm::uvec3> triangles, corners;
  size_t uncut = 0;
};

namespace {

/// Returns the vertex at a corner of the fan that begins at `fan`.
uint32_t vertexOf(const glm::uvec3* fan, uint32_t corner) {
  return corner < 2 ? (*fan)[static_cast<int>(corner)] : fan[corner - 2].z;
}

}  // namespace

void Polygons::add(std::span<const uint32_t> corners) {
  if (corners.size() < 3) ++dropped_;
  // Meshes with more triangles than that are refused later.
  if (corners.size() > 3 && triangles.size() + corners.size() < UINT32_MAX)
    fans_.push_back({static_cast<uint32_t>(triangles.size()), static_cast<uint32_t>(corners.size())});
  for (size_t c = 2; c < corners.size(); ++c) triangles.emplace_back(corners[0], corners[c - 1], corners[c]);
  const auto first = static_cast<uint32_t>(cornerCount_), count = static_cast<uint32_t>(corners.size());
  for (uint32_t c = 2; isTracking_ && c < count; ++c)
    cornerNumbers.emplace_back(first, first + c - 1, first + c);
  cornerCount_ += corners.size();
}

template <class Vec>
void Polygons::cutFan(size_t fan, const std::vector<Vec>& positions, Cuts& cuts) const {
  const glm::uvec3* first = &triangles[fans_[fan].first];
  std::vector<glm::dvec3> corners;
  corners.reserve(fans_[fan].corners);
  for (uint32_t c = 0; c < fans_[fan].corners; ++c) corners.emplace_back(positions[vertexOf(first, c)]);
  const size_t begin = cuts.triangles.size();
  const PolygonCut cut = cutPolygon(corners, cuts.triangles);
  if (cut == PolygonCut::None) ++cuts.uncut;
  if (cut != PolygonCut::Swept) {
    cuts.triangles.resize(begin);
    return;
  }
  for (size_t t = begin; isTracking_ && t < cuts.triangles.size(); ++t)
    cuts.corners.push_back(cuts.triangles[t] + cornerNumbers[fans_[fan].first].x);
  for (size_t t = begin; t < cuts.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) cuts.triangles[t][c] = vertexOf(first, cuts.triangles[t][c]);
  cuts.fans.push_back(static_cast<uint32_t>(fan));
  cuts.ends.push_back(cuts.triangles.size());
}

void Polygons::replace(std::span<const Cuts> parts, std::vector<glm::uvec3> Cuts::*cut,
                       std::vector<glm::uvec3>& fans) const {
  std::vector<glm::uvec3> all;
  all.reserve(fans.size());
  auto kept = fans.begin();
  for (const Cuts& part : parts) {
    auto begin = (part.*cut).begin();
    for (size_t i = 0; i < part.fans.size(); ++i) {
      const Fan& fan = fans_[part.fans[i]];
      const auto first = fans.begin() + fan.first;
      const auto end = (part.*cut).begin() + static_cast<ptrdiff_t>(part.ends[i]);
      all.insert(all.end(), kept, first);
      all.insert(all.end(), begin, end);
      kept = first + (fan.corners - 2);
      begin = end;
    }
  }
  all.insert(all.end(), kept, fans.end());
  fans = std::move(all);
}

template <class Vec>
size_t Polygons::cut(const std::vector<Vec>& positions) {
  constexpr size_t kFansPerTask = 1 << 12;
  std::vector<Cuts> parts((fans_.size() + kFansPerTask - 1) / kFansPerTask);
  parallelFor(parts.size(), 1, [&](size_t part, size_t) {
    const size_t end = std::min((part + 1) * kFansPerTask, fans_.size());
    for (size_t fan = part * kFansPerTask; fan < end; ++fan) cutFan(fan, positions, parts[part]);
  });
  size_t uncut = 0;
  for (const Cuts& part : parts) uncut += part.uncut;
  if (std::ranges::any_of(parts, [](const Cuts& part) { return !part.fans.empty(); })) {
    replace(parts, &Cuts::triangles, triangles);
    if (isTracking_) replace(parts, &Cuts::corners, cornerNumbers);
  }
  fans_.clear();
  return uncut;
}

template size_t Polygons::cut(const std::vector<glm::vec3>& positions);
template size_t Polygons::cut(const std::vector<glm::dvec3>& positions);

CutPolygons cutPolygons(std::span<const glm::dvec3> positions, std::span<const uint32_t> corners,
                        std::span<const uint32_t> sizes) {
  Polygons polygons;
  for (size_t p = 0, begin = 0; p < sizes.size(); begin += sizes[p++]) {
    if (sizes[p] > corners.size() - begin)
      throw Error(ErrorCode::Usage, "polygon " + std::to_string(p) + " has " + std::to_string(sizes[p]) +
                                        " corners, but only " + std::to_string(corners.size() - begin) +
                                        " are left");
    const std::span<const uint32_t> polygon = corners.subspan(begin, sizes[p]);
    for (const uint32_t vertex : polygon)
      if (vertex >= positions.size())
        throw Error(ErrorCode::Input, "polygon " + std::to_string(p) + " uses vertex " +
                                          std::to_string(vertex) + ", but there are only " +
                                          std::to_string(positions.size()));
    polygons.add(polygon);
  }
  const std::vector<glm::dvec3> copy(positions.begin(), positions.end());
  const size_t uncut = polygons.cut(copy);
  return {std::move(polygons.triangles), uncut};
}

}  // namespace raymap
