// Basic geometric functions. GPU twins of cpu/cells/triangle.h, with the same rounding. With
// RAYMAP_ROUGH_DIVISION the distances are faster, but depend on how the device divides.

float dotExactly(vec3 a, vec3 b) {
  precise const float sum = a.x * b.x + a.y * b.y + a.z * b.z;
  return sum;
}

vec3 crossExactly(vec3 a, vec3 b) {
  precise const vec3 product = vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
  return product;
}

float divide(float a, float b) {
#ifdef RAYMAP_ROUGH_DIVISION
  return a / b;
#else
  // Devices may divide floats inexactly. Their division of doubles is accurate enough to round correctly to a
  // float.
  return float(double(a) / double(b));
#endif
}

float squaredLength(vec3 v) {
  return dotExactly(v, v);
}

// Returns the squared distance from the origin to the segment from a to a + e, which may be a point.
float segmentSquaredDistance(vec3 a, vec3 e) {
  const float length2 = squaredLength(e);
  const float t = length2 > 0.0 ? clamp(divide(-dotExactly(a, e), length2), 0.0, 1.0) : 0.0;
  precise const vec3 closest = a + t * e;
  return squaredLength(closest);
}

// Returns the squared distance from p to the triangle abc, which may be a segment or a point.
float triangleSquaredDistance(vec3 p, vec3 a, vec3 b, vec3 c) {
  const vec3 pa = a - p, ab = b - a, ac = c - a;
  const vec3 n = crossExactly(ab, ac);
  const float area2 = squaredLength(n);
  // Barycentric coordinates of the projection of p, times area2.
  const float v = dotExactly(crossExactly(ac, pa), n);
  const float w = dotExactly(crossExactly(pa, ab), n);
  float inside = 1.0 / 0.0;
  if (v >= 0.0 && w >= 0.0 && v + w <= area2 && area2 > 0.0) {
    precise const vec3 closest = pa + divide(v, area2) * ab + divide(w, area2) * ac;
    inside = squaredLength(closest);
    // Except for slivers the projection is the closest point: the edges lie farther away.
    precise const float square = 1e-6 * squaredLength(ab) * squaredLength(ac);
    if (area2 > square) return inside;
  }
  const float edges = min(segmentSquaredDistance(pa, ab), segmentSquaredDistance(pa, ac));
  return min(min(inside, edges), segmentSquaredDistance(b - p, c - b));
}

// Slab low <= dot(axis, centre) <= high: where the projections of a unit cube and of the triangle on `axis`
// overlap.
struct Slab {
  dvec3 axis;
  double low;
  double high;
};

double dotExactly(dvec3 a, dvec3 b) {
  precise const double sum = a.x * b.x + a.y * b.y + a.z * b.z;
  return sum;
}

Slab slabBetween(dvec3 axis, double m0, double m1, double slack) {
  precise const double reach = (0.5 + slack) * (abs(axis.x) + abs(axis.y) + abs(axis.z));
  precise const double low = min(m0, m1) - reach;
  precise const double high = max(m0, m1) + reach;
  return Slab(axis, low, high);
}

Slab planeSlab(dvec3 corner[3], double slack) {
  const dvec3 a = corner[1] - corner[0], b = corner[2] - corner[0];
  precise const dvec3 normal = dvec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
  const double offset = dotExactly(normal, corner[0]);
  return slabBetween(normal, offset, offset, slack);
}

// Returns the slab of edge e in the projection along x, y or z.
Slab edgeSlab(dvec3 corner[3], uint e, uint along, double slack) {
  const dvec3 start = corner[e], apex = corner[(e + 2) % 3], edge = corner[(e + 1) % 3] - start;
  dvec3 axis = dvec3(0.0, edge.z, -edge.y);
  if (along == 1) axis = dvec3(-edge.z, 0.0, edge.x);
  if (along == 2) axis = dvec3(edge.y, -edge.x, 0.0);
  return slabBetween(axis, dotExactly(axis, start), dotExactly(axis, apex), slack);
}
