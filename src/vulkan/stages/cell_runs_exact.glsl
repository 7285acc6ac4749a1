// The cells of a row that a triangle touches, with the same rounding as on the CPU.

// Cells grow by this share of the triangle's reach, which makes up for rounding in double precision.
const Double kSlack = 0x3d719799812dea11ul;  // 1e-12

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
  const float inverse = inverseMantissa(factor);
  const Double a = quotientBy(from, factor, inverse), b = quotientBy(to, factor, inverse);
  interval.low = maximum(interval.low, minimum(a, b));
  interval.high = minimum(interval.high, maximum(a, b));
}

bool isEmpty(Interval interval) {
  return orderOf(interval.low) > orderOf(interval.high);
}

// Corners relative to the lowest cell of the triangle's bounds, in cells.
struct ExactCorners {
  Double at[3][3];  // Corner, axis.
  Double margin;    // Half a cell, and a bit more to make up for rounding.
};

ExactCorners exactCorners(LocalTriangle local) {
  ExactCorners corners;
  Double far = 0;
  for (uint c = 0; c < 3; ++c)
    for (uint axis = 0; axis < 3; ++axis) {
      corners.at[c][axis] = difference(cornerInCells(local, c, axis), doubleOf(local.base[axis]));
      far = maximum(far, absolute(corners.at[c][axis]));
    }
  corners.margin = sum(kHalf, product(kSlack, sum(doubleOf(1), far)));
  return corners;
}

Double dotOfTwo(Double a, Double x, Double b, Double y) {
  return sum(product(a, x), product(b, y));
}

// Clips by the edges in the projection onto the plane of two axes. There, a line along `axis` lies at `at`.
void clipByEdges(inout Interval interval, ExactCorners corners, uint axis, uint other, int at) {
  for (uint e = 0; e < 3; ++e) {
    const uint end = (e + 1) % 3, apex = (e + 2) % 3;
    const Double factor = difference(corners.at[end][other], corners.at[e][other]);
    const Double across = negative(difference(corners.at[end][axis], corners.at[e][axis]));
    const Double m0 = dotOfTwo(factor, corners.at[e][axis], across, corners.at[e][other]);
    const Double m1 = dotOfTwo(factor, corners.at[apex][axis], across, corners.at[apex][other]);
    const Double reach = product(corners.margin, sum(absolute(factor), absolute(across)));
    const Double shift = product(across, doubleOf(at));
    clip(interval, factor, difference(difference(minimum(m0, m1), reach), shift),
         difference(sum(maximum(m0, m1), reach), shift));
  }
}

// Clips by the triangle's plane.
void clipByPlane(inout Interval interval, ExactCorners corners, int j, int k) {
  Double a[3], b[3];
  for (uint axis = 0; axis < 3; ++axis) {
    a[axis] = difference(corners.at[1][axis], corners.at[0][axis]);
    b[axis] = difference(corners.at[2][axis], corners.at[0][axis]);
  }
  Double normal[3];
  for (uint axis = 0; axis < 3; ++axis) {
    const uint u = (axis + 1) % 3, v = (axis + 2) % 3;
    normal[axis] = difference(product(a[u], b[v]), product(b[u], a[v]));
  }
  Double height = 0, size = 0;
  for (uint axis = 0; axis < 3; ++axis) {
    height = sum(height, product(normal[axis], corners.at[0][axis]));
    size = sum(size, absolute(normal[axis]));
  }
  const Double reach = product(corners.margin, size);
  const Double shift = dotOfTwo(normal[1], doubleOf(j), normal[2], doubleOf(k));
  clip(interval, normal[0], difference(difference(height, reach), shift), difference(sum(height, reach), shift));
}

ivec2 findRunExactly(LocalTriangle local, int j, int k) {
  const ExactCorners corners = exactCorners(local);
  const ivec2 none = ivec2(0, -1);
  Interval rows = Interval(0, doubleOf(local.extent.y));
  clipByEdges(rows, corners, 1, 2, k);
  if (isEmpty(rows) || j < ceilOf(rows.low) || j > floorOf(rows.high)) return none;
  Interval row = Interval(0, doubleOf(local.extent.x));
  clipByEdges(row, corners, 0, 2, k);
  clipByPlane(row, corners, j, k);
  clipByEdges(row, corners, 0, 1, j);
  return isEmpty(row) ? none : ivec2(ceilOf(row.low), floorOf(row.high));
}
