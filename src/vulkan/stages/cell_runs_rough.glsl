// The cells of a row that a triangle touches, where floats suffice to tell: each number comes with a bound on its
// error, which is several times larger than the error of floats, and much larger than that of doubles. Else
// cell_runs_exact.glsl decides.

const float kRoughFarthest = 10000.0;  // In cells. Farther away, bounds of cells are too fine for floats.
const float kRoughShare = 1.0 / 1048576.0;  // Error of a sum, as a share of the sum of its terms' sizes: 2^-20.
const float kRoughLeast = 1.0 / 2147483648.0;  // Error of a number of the size of a cell's.

// Interval, each end of which lies between two bounds.
struct RoughInterval {
  vec2 low;
  vec2 high;
  bool isKnown;
};

// Number that lies within `error` of `value`.
struct RoughNumber {
  float value;
  float error;
};

// Keeps the x in [0, most] with from <= factor * x <= to, where `from` and `to` have the error `error`.
void clipRoughly(inout RoughInterval interval, RoughNumber factor, float from, float to, float error, float most) {
  if (abs(factor.value) <= 4.0 * factor.error) {  // It may be 0.
    const float reach = (abs(factor.value) + factor.error) * most + error;
    const bool keepsAll = from <= -reach && to >= reach, keepsNone = from > reach || to < -reach;
    if (keepsNone) interval.high = vec2(-1.0);
    interval.isKnown = interval.isKnown && (keepsAll || keepsNone);
    return;
  }
  const float a = from / factor.value, b = to / factor.value;
  const float low = min(a, b), high = max(a, b), size = abs(factor.value) - factor.error;
  const float lowError = (error + abs(low) * factor.error) / size + kRoughShare * abs(low);
  const float highError = (error + abs(high) * factor.error) / size + kRoughShare * abs(high);
  interval.low = max(interval.low, low + vec2(-lowError, lowError));
  interval.high = min(interval.high, high + vec2(-highError, highError));
}

struct RoughCorners {
  vec3 at[3];
  vec3 edge[3];  // From each corner to the next.
  float error;   // Error of a corner in addition to that of rounding it to floats.
  float least;   // Least error of an edge.
  vec3 most;     // Extent of the bounds.
};

RoughCorners roughCorners(LocalTriangle local) {
  RoughCorners corners;
  corners.edge[0] = (local.b - local.a) / push.lattice.size;
  corners.edge[1] = (local.c - local.b) / push.lattice.size;
  corners.edge[2] = (local.a - local.c) / push.lattice.size;
  vec3 first = vec3(0);
  if (!isOfSamples(push.lattice))
    first = vec3(floatOf(push.lattice.firstX), floatOf(push.lattice.firstY), floatOf(push.lattice.firstZ));
  corners.at[0] = (local.a - first) / push.lattice.size - vec3(local.base);
  corners.at[1] = (local.b - first) / push.lattice.size - vec3(local.base);
  corners.at[2] = (local.c - first) / push.lattice.size - vec3(local.base);
  const vec3 far = max(max(max(abs(corners.at[0]), abs(corners.at[1])), abs(corners.at[2])), vec3(1.0));
  const vec3 vertexFar = max(max(abs(local.a), abs(local.b)), abs(local.c));
  const vec3 cancelled = 3.0 * kRoughShare * (vertexFar + abs(first)) / push.lattice.size;
  corners.error = isOfSamples(push.lattice) ? 0.0 : max(max(cancelled.x, cancelled.y), cancelled.z);
  corners.least = kRoughLeast * (1.0 + max(max(far.x, far.y), far.z));
  corners.most = vec3(local.extent);
  return corners;
}

void clipByEdgesRoughly(inout RoughInterval interval, RoughCorners corners, uint axis, uint other, float at) {
  [[unroll]] for (uint e = 0; e < 3; ++e) {
    const uint apex = (e + 2) % 3;
    const float factor = corners.edge[e][other], across = -corners.edge[e][axis];
    const vec2 first = vec2(factor, across) * vec2(corners.at[e][axis], corners.at[e][other]);
    const vec2 second = vec2(factor, across) * vec2(corners.at[apex][axis], corners.at[apex][other]);
    const float m0 = first.x + first.y, m1 = second.x + second.y, shift = across * at;
    const float reach = 0.5 * (abs(factor) + abs(across));
    const float size = max(abs(first.x) + abs(first.y), abs(second.x) + abs(second.y)) + reach + abs(shift);
    clipRoughly(interval, RoughNumber(factor, kRoughShare * abs(factor) + corners.least), min(m0, m1) - reach - shift,
                max(m0, m1) + reach - shift, kRoughShare * size + 2.0 * reach * corners.error + corners.least,
                corners.most[axis]);
  }
}

void clipByPlaneRoughly(inout RoughInterval interval, RoughCorners corners, float j, float k) {
  const vec3 a = corners.edge[0], b = -corners.edge[2], start = corners.at[0];
  const vec3 first = a.yzx * b.zxy, second = b.yzx * a.zxy, normal = first - second;
  const vec3 sizes = abs(first) + abs(second);
  const float height = dot(normal, start) - (normal.y * j + normal.z * k);
  const float reach = 0.5 * (abs(normal.x) + abs(normal.y) + abs(normal.z));
  const float size = dot(sizes, abs(start) + vec3(0.5, 0.5 + j, 0.5 + k));
  const float farthest = corners.least / kRoughLeast;
  clipRoughly(interval, RoughNumber(normal.x, kRoughShare * sizes.x + 2.0 * corners.least), height - reach, height + reach,
              kRoughShare * size + dot(sizes, vec3(corners.error)) + 16.0 * farthest * corners.least, corners.most.x);
}

// Returns whether the run is known.
bool findRunRoughly(LocalTriangle local, int j, int k, out ivec2 run) {
  run = ivec2(0, -1);
  const RoughCorners corners = roughCorners(local);
  if (corners.least > kRoughLeast * kRoughFarthest) return false;
  RoughInterval rows = RoughInterval(vec2(0.0), vec2(local.extent.y), true);
  clipByEdgesRoughly(rows, corners, 1, 2, float(k));
  if (float(j) < rows.low.x || float(j) > rows.high.y) return true;
  if (!rows.isKnown || float(j) < rows.low.y || float(j) > rows.high.x) return false;
  RoughInterval row = RoughInterval(vec2(0.0), vec2(local.extent.x), true);
  clipByEdgesRoughly(row, corners, 0, 2, float(k));
  clipByPlaneRoughly(row, corners, float(j), float(k));
  clipByEdgesRoughly(row, corners, 0, 1, float(j));
  if (row.low.x > row.high.y) return true;
  const vec2 first = ceil(row.low), last = floor(row.high);
  run = ivec2(first.x, last.x);
  return row.isKnown && first.x == first.y && last.x == last.y;
}
