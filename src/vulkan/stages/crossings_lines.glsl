// Finds the lattice lines that a triangle crosses and the places of the crossings, as in
// predicates/lattice_line_triangle.h: simulation of simplicity (Edelsbrunner & Mücke 1990) on integers. The including
// file defines `Wide`, a type for products of two coordinates, and its functions.

const int kLongRun = 8;  // Runs longer than this are first tested as a whole.

// Triangle in the projection along an axis: counterclockwise, with its normal towards plus axis.
struct Facet {
  i64vec3 a, b, c;
  Wide normalU, normalV, normalW;
  int tie;
  int direction;
};

// Returns false for a triangle that projects to a line: the displaced lattice lines miss it.
bool makeFacet(SnappedTriangle t, uint axis, out Facet facet) {
  facet.a = inFrame(t.a, axis);
  facet.b = inFrame(t.b, axis);
  facet.c = inFrame(t.c, axis);
  const i64vec3 b = facet.b - facet.a, c = facet.c - facet.a;
  facet.normalU = sum(product(b.y, c.z), product(-b.z, c.y));
  facet.normalV = sum(product(b.z, c.x), product(-b.x, c.z));
  facet.normalW = sum(product(b.x, c.y), product(-b.y, c.x));
  const bool isFlipped = isPositive(negative(facet.normalW));
  if (!isFlipped && !isPositive(facet.normalW)) return false;
  if (isFlipped) {
    facet.normalU = negative(facet.normalU);
    facet.normalV = negative(facet.normalV);
    facet.normalW = negative(facet.normalW);
    const i64vec3 swapped = facet.b;
    facet.b = facet.c;
    facet.c = swapped;
  }
  // (u, v, axis) is a left-handed frame for the y axis.
  facet.direction = isFlipped == (axis == 1) ? 1 : -1;
  // The displacement adds n . (e, e^2, e^3): the first nonzero component along x, y, z decides.
  const bool isUNegative = isPositive(negative(facet.normalU));
  const bool isUZero = !isUNegative && !isPositive(facet.normalU);
  facet.tie = 1;
  if (axis > 0 && isUNegative) facet.tie = 0;
  if (axis == 2 && isUZero && isPositive(negative(facet.normalV))) facet.tie = 0;
  return true;
}

// Returns orient2d of a directed edge and the displaced lattice line: positive for lines to the left of the
// edge. The displacement adds du * e_v - dv * e_u, and e_u is infinitely larger than e_v.
Wide edgeFunction(i64vec3 from, i64vec3 to, i64vec2 line) {
  const i64vec2 d = to.xy - from.xy, offset = line - from.xy;
  const int64_t tie = int64_t(d.y < 0 || (d.y == 0 && d.x > 0));
  return sum(sum(product(d.x, offset.y), product(-d.y, offset.x)), product(tie, 1l));
}

Wide edgeStep(i64vec3 from, i64vec3 to, int bits) {
  return product(from.y - to.y, 1l << bits);
}

// Returns the number of a line's samples below the plane: all before `begin`, none from `end` on. The number
// is also the index of the lattice edge at which the triangle crosses the line.
int countBelow(Facet facet, i64vec2 line, int begin, int end, int bits) {
  if (begin == end) return begin;
  const i64vec2 offset = line - facet.a.xy;
  const Int128 across = sum(sum(longProduct(facet.normalU, offset.x), longProduct(facet.normalV, offset.y)),
                            Int128(facet.tie, 0));
  while (begin < end) {
    const int middle = (begin + end) / 2;
    const int64_t height = (int64_t(middle) << int64_t(bits)) - facet.a.z;
    if (isPositive(sum(across, longProduct(facet.normalW, height))))
      end = middle;
    else
      begin = middle + 1;
  }
  return begin;
}

// Returns whether none of `count` lines lies to the left of an edge.
bool misses(Wide edge, Wide step, int count) {
  return !isPositive(edge) && !isPositive(sum(edge, product(step, int64_t(count - 1))));
}

// Counts the crossings with `count` lines of a row, from `first` on.
void scanRun(Facet facet, uint axis, ivec2 first, int count, ivec2 depths, int bits) {
  i64vec2 line = i64vec2(first) << int64_t(bits);
  Wide edge0 = edgeFunction(facet.a, facet.b, line);
  Wide edge1 = edgeFunction(facet.b, facet.c, line);
  Wide edge2 = edgeFunction(facet.c, facet.a, line);
  const Wide step0 = edgeStep(facet.a, facet.b, bits);
  const Wide step1 = edgeStep(facet.b, facet.c, bits);
  const Wide step2 = edgeStep(facet.c, facet.a, bits);
  if (count > kLongRun) {
    if (misses(edge0, step0, count) || misses(edge1, step1, count) || misses(edge2, step2, count)) return;
  }
  for (int i = 0; i < count; ++i) {
    if (isPositive(edge0) && isPositive(edge1) && isPositive(edge2)) {
      const int edge = countBelow(facet, line, depths.x, depths.y, bits);
      addCrossing(axis, ivec3(first.x + i, first.y, edge), facet.direction);
    }
    line.x += 1l << bits;
    edge0 = sum(edge0, step0);
    edge1 = sum(edge1, step1);
    edge2 = sum(edge2, step2);
  }
}
