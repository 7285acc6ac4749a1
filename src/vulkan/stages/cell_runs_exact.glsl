// The cells of a row that a triangle touches, with the same rounding as on the CPU.

#include "method/cell_runs_shared.h"

struct Interval {
  Double low;
  Double high;
};

// Keeps the x with from <= factor * x <= to. An empty interval ends below 0.
void clip(inout Interval interval, Double factor, Double from, Double to) {
  if (orderOf(factor) == 0) {
    if (orderOf(from) > 0 || orderOf(to) < 0) interval.high = doubleOf(-1);
    return;
  }
  Double a = 0, b = to;
  [[dont_unroll]] for (uint n = 0; n < 2; ++n) {
    const Double next = quotient(n == 0 ? from : to, factor);
    a = b;
    b = next;
  }
  interval.low = maximum(interval.low, minimum(a, b));
  interval.high = minimum(interval.high, maximum(a, b));
}

bool isEmpty(Interval interval) {
  return orderOf(interval.low) > orderOf(interval.high);
}

// Corners relative to the lowest cell of the triangle's bounds, in cells. The code below loops over axes and corners by
// rotating them, because compilers put arrays with variable indices into slow memory, and copy functions to each call.
struct ExactCorners {
  u64vec3 a, b, c;
  Double margin;  // Half a cell, and a bit more to make up for rounding.
};

Double pick(u64vec3 v, uint axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

ExactCorners exactCorners(LocalTriangle local) {
  ExactCorners corners;
  Double far = 0;
  [[dont_unroll]] for (uint n = 0; n < 9; ++n) {
    const uint corner = n / 3, axis = n % 3;
    const vec3 vertex = corner == 0 ? local.a : corner == 1 ? local.b : local.c;
    const float coordinate = axis == 0 ? vertex.x : axis == 1 ? vertex.y : vertex.z;
    const int base = axis == 0 ? local.base.x : axis == 1 ? local.base.y : local.base.z;
    const Double at = difference(inCells(push.lattice, axis, doubleOf(coordinate)), doubleOf(base));
    far = maximum(far, absolute(at));
    corners.a = u64vec3(corners.a.yz, corners.b.x);
    corners.b = u64vec3(corners.b.yz, corners.c.x);
    corners.c = u64vec3(corners.c.yz, at);
  }
  corners.margin = sum(kHalf, product(kSlackBits, sum(doubleOf(1), far)));
  return corners;
}

// Clips by an edge in a projection: the rows in that along x, and the cells of row j, k in those along y and z.
void clipByEdge(inout Interval interval, ExactCorners corners, uint edge, uint along, int j, int k) {
  const u64vec3 a = edge == 0 ? corners.a : edge == 1 ? corners.b : corners.c;
  const u64vec3 b = edge == 0 ? corners.b : edge == 1 ? corners.c : corners.a;
  const u64vec3 c = edge == 0 ? corners.c : edge == 1 ? corners.a : corners.b;
  const uint axis = along == 0 ? 1 : 0, other = along == 2 ? 1 : 2;
  const Double aX = pick(a, axis), aY = pick(a, other), cX = pick(c, axis), cY = pick(c, other);
  const Double factor = difference(pick(b, other), aY);
  const Double across = negative(difference(pick(b, axis), aX));
  const Double m0 = sum(product(factor, aX), product(across, aY));
  const Double m1 = sum(product(factor, cX), product(across, cY));
  const Double reach = product(corners.margin, sum(absolute(factor), absolute(across)));
  const Double shift = product(across, doubleOf(along == 2 ? j : k));
  clip(interval, factor, difference(difference(minimum(m0, m1), reach), shift),
       difference(sum(maximum(m0, m1), reach), shift));
}

// Clips by the triangle's plane.
void clipByPlane(inout Interval row, ExactCorners corners, int j, int k) {
  u64vec3 a = u64vec3(0), b = u64vec3(0), corner = corners.a;
  [[dont_unroll]] for (uint axis = 0; axis < 3; ++axis) {
    a = u64vec3(a.yz, difference(pick(corners.b, axis), pick(corners.a, axis)));
    b = u64vec3(b.yz, difference(pick(corners.c, axis), pick(corners.a, axis)));
  }
  Double height = 0, size = 0, shift = 0, alongX = 0;
  [[dont_unroll]] for (uint axis = 0; axis < 3; ++axis) {
    const Double normal = difference(product(a.y, b.z), product(b.y, a.z));
    height = sum(height, product(normal, corner.x));
    size = sum(size, absolute(normal));
    if (axis == 0)
      alongX = normal;
    else
      shift = sum(shift, product(normal, doubleOf(axis == 1 ? j : k)));
    a = a.yzx;
    b = b.yzx;
    corner = corner.yzx;
  }
  const Double reach = product(corners.margin, size);
  clip(row, alongX, difference(difference(height, reach), shift), difference(sum(height, reach), shift));
}

// The clips of a row are independent: three edges in three projections, and the plane. The first three are of the rows.
const uint kClips = 10;

Interval clipOf(LocalTriangle local, uint n, int j, int k) {
  const ExactCorners corners = exactCorners(local);
  Interval interval = Interval(0, doubleOf(n < 3 ? local.extent.y : local.extent.x));
  if (n + 1 == kClips)
    clipByPlane(interval, corners, j, k);
  else
    clipByEdge(interval, corners, n % 3, n / 3, j, k);
  return interval;
}

ivec2 runBetween(Interval rows, Interval row, int j) {
  const bool isReached = !isEmpty(rows) && j >= ceilOf(rows.low) && j <= floorOf(rows.high);
  return isReached && !isEmpty(row) ? ivec2(ceilOf(row.low), floorOf(row.high)) : ivec2(0, -1);
}
