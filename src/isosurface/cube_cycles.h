#pragma once

#include <array>
#include <cstdint>

namespace raymap {

// A lattice cube between eight samples. Corner c lies at (c & 1, c >> 1 & 1, c >> 2). Edge 4a + k runs along
// axis a; k & 1 and k >> 1 are its positions along the next axis and the one after. Face 2a + s is
// perpendicular to axis a, at the low (s = 0) or high (s = 1) end.

inline constexpr int kCubeEdges = 12;
inline constexpr int kCubeFaces = 6;

constexpr int edgeAt(int axis, int corner) {
  return 4 * axis + (corner >> (axis + 1) % 3 & 1) + 2 * (corner >> (axis + 2) % 3 & 1);
}

/// Returns the corner at the lower end of an edge; `edgeEnd` returns the other one.
constexpr int edgeStart(int edge) {
  const int axis = edge / 4;
  return (edge & 1) << (axis + 1) % 3 | (edge >> 1 & 1) << (axis + 2) % 3;
}

constexpr int edgeEnd(int edge) {
  return edgeStart(edge) + (1 << edge / 4);
}

// `corners` has the bits of the corners inside.

constexpr bool isCornerInside(unsigned corners, int corner) {
  return (corners >> corner & 1) != 0;
}
constexpr bool isEdgeCrossed(unsigned corners, int edge) {
  return isCornerInside(corners, edgeStart(edge)) != isCornerInside(corners, edgeEnd(edge));
}

/// Corners of a face in cyclic order, and its edges: edge i joins corners i and i + 1.
struct CubeFace {
  std::array<int, 4> corners, edges;
};

constexpr CubeFace cubeFace(int face) {
  const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3, first = (face & 1) << axis;
  const std::array<int, 4> corners{first, first + (1 << u), first + (1 << u) + (1 << v), first + (1 << v)};
  return {corners,
          {edgeAt(u, corners[0]), edgeAt(v, corners[1]), edgeAt(u, corners[3]), edgeAt(v, corners[0])}};
}

inline constexpr std::array<CubeFace, kCubeFaces> kCubeFaceTable{cubeFace(0), cubeFace(1), cubeFace(2),
                                                                 cubeFace(3), cubeFace(4), cubeFace(5)};

/// Returns the bits of the faces whose corners alternate between inside and outside. There the surface may
/// pass between the two inside corners or between the two outside ones.
unsigned ambiguousFaces(unsigned corners);

/// The edges of a cube that the surface crosses, in closed cycles around the cube, one for each sheet.
class CubeCycles {
 public:
  CubeCycles() = default;
  /// Finds the cycles. `joined` has the bits of the ambiguous faces whose inside corners are joined, instead
  /// of the outside ones.
  CubeCycles(unsigned corners, unsigned joined);

  int count() const { return static_cast<int>(bits_ >> kCountShift); }
  /// Returns the cycle of a crossed edge.
  int of(int edge) const { return static_cast<int>(bits_ >> 2 * edge & 3); }
  /// Returns whether all four edges of an ambiguous face are in one cycle, which then passes the face twice.
  bool passTwice(int face) const;

 private:
  static constexpr int kCountShift = 2 * kCubeEdges;
  uint32_t bits_ = 0;  // Two bits per edge for its cycle, one of at most four; then their number.
};

}  // namespace raymap
