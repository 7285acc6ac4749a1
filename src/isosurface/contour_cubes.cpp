#include "isosurface/contour_cubes.h"

#include <algorithm>

namespace raymap {

namespace {

void turn(ContourCube& cube, int face) {
  cube.joined = static_cast<uint8_t>(cube.joined ^ 1u << face);
  cube.cycles = CubeCycles(cube.corners, cube.joined);
}

}  // namespace

ContourCubes::ContourCubes(const Field& field, double iso, Progress& progress)
    : field_(field),
      iso_(iso),
      progress_(progress),
      dims_(field.grid.dims + 1),
      rowBegin_(size_t(dims_.y) * size_t(dims_.z) + 1) {
  findCubes();
  splitDoubledEdges();
  numberAll();
}

double ContourCubes::value(const glm::ivec3& sample) const {
  return double(field_.distance[field_.grid.index(sample)]) - iso_;
}

/// Calls `visit(x, corners)` for each cube of a row that has corners inside and outside.
template <class Visit>
void ContourCubes::scanRow(int y, int z, Visit&& visit) const {
  const glm::ivec3 last = field_.grid.dims - 1;
  std::array<const float*, 4> samples{};
  for (int r = 0; r < 4; ++r) {
    const int j = y - 1 + (r & 1), k = z - 1 + (r >> 1);
    if (j >= 0 && j <= last.y && k >= 0 && k <= last.z)
      samples[r] = field_.distance.data() + field_.grid.index({0, j, k});
  }
  unsigned low = 0;
  for (int x = 0; x < dims_.x; ++x) {
    unsigned high = 0;
    if (x <= last.x)
      for (int r = 0; r < 4; ++r)
        if (samples[r] && samples[r][x] < iso_) high |= 1u << 2 * r;
    const unsigned corners = low | high << 1;
    if (corners != 0 && corners != 255) visit(x, corners);
    low = high;
  }
}

void ContourCubes::findCubes() {
  forEachRow([&](size_t row, int y, int z) { scanRow(y, z, [&](int, unsigned) { ++rowBegin_[row + 1]; }); });
  for (size_t row = 1; row < rowBegin_.size(); ++row) rowBegin_[row] += rowBegin_[row - 1];
  cubes_.resize(rowBegin_.back());
  forEachRow([&](size_t row, int y, int z) {
    ContourCube* cube = cubes_.data() + rowBegin_[row];
    scanRow(y, z, [&](int x, unsigned corners) { *cube++ = makeCube({x, y, z}, corners); });
  });
}

ContourCube ContourCubes::makeCube(const glm::ivec3& place, unsigned corners) const {
  const unsigned ambiguous = ambiguousFaces(corners);
  unsigned joined = 0;
  for (int f = 0; ambiguous >> f != 0; ++f)
    if ((ambiguous >> f & 1) != 0 && isJoined(place, corners, kCubeFaceTable[f])) joined |= 1u << f;
  return {place.x,
          static_cast<uint8_t>(corners),
          static_cast<uint8_t>(ambiguous),
          static_cast<uint8_t>(joined),
          CubeCycles(corners, joined),
          0,
          0};
}

/// Returns whether the inside corners of an ambiguous face are joined. The bilinear value between them
/// decides (Nielson & Hamann 1991), so both cubes at the face agree.
bool ContourCubes::isJoined(const glm::ivec3& place, unsigned corners, const CubeFace& face) const {
  const auto at = [&](int i) { return value(place - 1 + cornerOffset(face.corners[i])); };
  const double even = at(0) * at(2), odd = at(1) * at(3);
  const bool isEvenInside = (corners >> face.corners[0] & 1) != 0;
  return isEvenInside ? even > odd : odd > even;
}

size_t ContourCubes::find(const glm::ivec3& place) const {
  const size_t row = size_t(place.z) * size_t(dims_.y) + size_t(place.y);
  const auto begin = cubes_.begin() + ptrdiff_t(rowBegin_[row]);
  const auto end = cubes_.begin() + ptrdiff_t(rowBegin_[row + 1]);
  const auto found =
      std::lower_bound(begin, end, place.x, [](const ContourCube& cube, int x) { return cube.x < x; });
  return size_t(found - cubes_.begin());
}

/// Returns the last cube whose first vertex or quad is not above the number.
ContourCubes::Found ContourCubes::last(uint32_t ContourCube::*first, uint32_t number) const {
  const auto cube = std::upper_bound(cubes_.begin(), cubes_.end(), number,
                                     [&](uint32_t n, const ContourCube& c) { return n < c.*first; }) -
                    1;
  const auto row = std::upper_bound(rowBegin_.begin(), rowBegin_.end(), size_t(cube - cubes_.begin())) - 1;
  const auto r = int(row - rowBegin_.begin());
  return {*cube, {cube->x, r % dims_.y, r / dims_.y}};
}

/// Splits a sheet that passes the face between two cubes twice, in both cubes. Its two vertices would
/// otherwise be joined by two edges at the same place. Joining the face's other corners makes two sheets in
/// each cube. This is rare, so it runs in order on one thread.
void ContourCubes::splitDoubledEdges() {
  for (size_t row = 0; row + 1 < rowBegin_.size(); ++row)
    for (size_t c = rowBegin_[row]; c < rowBegin_[row + 1]; ++c)
      if (cubes_[c].ambiguous != 0)
        splitDoubledEdges(cubes_[c], {cubes_[c].x, int(row % dims_.y), int(row / dims_.y)});
}

void ContourCubes::splitDoubledEdges(ContourCube& cube, const glm::ivec3& place) {
  for (int axis = 0; axis < 3; ++axis) {
    const int high = 2 * axis + 1, low = 2 * axis;
    if ((cube.ambiguous >> high & 1) == 0 || !cube.cycles.passTwice(high)) continue;
    ContourCube& next = cubes_[find(place + along(axis))];
    if (!next.cycles.passTwice(low)) continue;
    turn(cube, high);
    turn(next, low);
  }
}

void ContourCubes::numberAll() {
  for (ContourCube& cube : cubes_) {
    cube.firstVertex = static_cast<uint32_t>(vertexCount_);
    cube.firstQuad = static_cast<uint32_t>(quadCount_);
    vertexCount_ += size_t(cube.cycles.count());
    for (int axis = 0; axis < 3; ++axis) quadCount_ += cube.isCrossed(axis) ? 1 : 0;
  }
}

}  // namespace raymap
