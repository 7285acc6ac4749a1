#include "isosurface/contour_cubes.h"

#include <algorithm>

namespace raymap {

namespace {

void turn(ContourCube& cube, int face) {
  cube.joined = static_cast<uint8_t>(cube.joined ^ 1u << face);
  cube.cycles = CubeCycles(cube.corners, cube.joined);
}

/// Returns whether the inside corners of an ambiguous face are joined. The bilinear value between them
/// decides (Nielson & Hamann 1991), so both cubes at the face agree.
bool isJoined(const glm::ivec3& place, unsigned corners, const CubeFace& face,
              const ContourCubes::SampleValue& value) {
  const auto at = [&](int i) { return value(place - 1 + cornerOffset(face.corners[i])); };
  const double even = at(0) * at(2), odd = at(1) * at(3);
  const bool isEvenInside = (corners >> face.corners[0] & 1) != 0;
  return isEvenInside ? even > odd : odd > even;
}

}  // namespace

ContourCubes::ContourCubes(ContourRows found, const SampleValue& value, Progress& progress)
    : found_(std::move(found)), progress_(progress) {
  joinCorners(value);
  splitDoubledEdges();
  numberAll();
}

/// Decides which corners of ambiguous faces are joined, and finds the cycles.
void ContourCubes::joinCorners(const SampleValue& value) {
  parallelFor(found_.rows.size(), kRowsPerTask, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (size_t c = found_.begin[row]; c < found_.begin[row + 1]; ++c) {
        ContourCube& cube = found_.cubes[c];
        const unsigned ambiguous = ambiguousFaces(cube.corners);
        unsigned joined = 0;
        for (int f = 0; ambiguous >> f != 0; ++f)
          if ((ambiguous >> f & 1) != 0 && isJoined(placeOf(row, c), cube.corners, kCubeFaceTable[f], value))
            joined |= 1u << f;
        cube.ambiguous = static_cast<uint8_t>(ambiguous);
        cube.joined = static_cast<uint8_t>(joined);
        cube.cycles = CubeCycles(cube.corners, joined);
      }
  });
}

size_t ContourCubes::find(const glm::ivec3& place) const {
  const auto row =
      std::ranges::lower_bound(found_.rows, ContourRows::Row{place.z, place.y}) - found_.rows.begin();
  const auto begin = found_.cubes.begin() + ptrdiff_t(found_.begin[size_t(row)]);
  const auto end = found_.cubes.begin() + ptrdiff_t(found_.begin[size_t(row) + 1]);
  return size_t(std::ranges::lower_bound(begin, end, place.x, {}, &ContourCube::x) - found_.cubes.begin());
}

/// Returns the last cube whose first vertex or quad is not above the number.
ContourCubes::Found ContourCubes::last(uint32_t ContourCube::*first, uint32_t number) const {
  const auto after = std::ranges::upper_bound(found_.cubes, number, {}, first);
  const auto cube = size_t(after - found_.cubes.begin()) - 1;
  const auto row = size_t(std::ranges::upper_bound(found_.begin, cube) - found_.begin.begin()) - 1;
  return {found_.cubes[cube], placeOf(row, cube)};
}

/// Splits a sheet that passes the face between two cubes twice, in both cubes. Its two vertices would
/// otherwise be joined by two edges at the same place. Joining the face's other corners makes two sheets in
/// each cube. This is rare, so it runs in order on one thread.
void ContourCubes::splitDoubledEdges() {
  for (size_t row = 0; row < found_.rows.size(); ++row)
    for (size_t c = found_.begin[row]; c < found_.begin[row + 1]; ++c)
      if (found_.cubes[c].ambiguous != 0) splitDoubledEdges(found_.cubes[c], placeOf(row, c));
}

void ContourCubes::splitDoubledEdges(ContourCube& cube, const glm::ivec3& place) {
  for (int axis = 0; axis < 3; ++axis) {
    const int high = 2 * axis + 1, low = 2 * axis;
    if ((cube.ambiguous >> high & 1) == 0 || !cube.cycles.passTwice(high)) continue;
    ContourCube& next = found_.cubes[find(place + along(axis))];
    if (!next.cycles.passTwice(low)) continue;
    turn(cube, high);
    turn(next, low);
  }
}

void ContourCubes::numberAll() {
  for (ContourCube& cube : found_.cubes) {
    cube.firstVertex = static_cast<uint32_t>(vertexCount_);
    cube.firstQuad = static_cast<uint32_t>(quadCount_);
    vertexCount_ += size_t(cube.cycles.count());
    for (int axis = 0; axis < 3; ++axis) quadCount_ += cube.isCrossed(axis) ? 1 : 0;
  }
}

}  // namespace raymap
