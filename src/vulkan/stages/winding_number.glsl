// Barill et al. 2018: the winding number of the triangles of a surface tree, from its moments.

// Capacity in nodes: a node's children leave seven others behind, on each of at most eleven levels.
const uint kStack = 7 * 11 + 1;
const float kPi = 3.14159265358979;

// Devices may compute the arc tangent with an error of 4096 units in the last place.
float arcTangent(float y, float x) {
  const float low = min(abs(x), abs(y)), high = max(abs(x), abs(y));
  if (high == 0) return 0;
  const float z = low / high, z2 = z * z;
  float angle = z * (0.99999934 + z2 * (-0.33329861 + z2 * (0.19946566 + z2 * (-0.1390863 + z2 * (0.096421974 +
                z2 * (-0.055912327 + z2 * (0.021862958 - z2 * 0.004054567)))))));
  if (abs(y) > abs(x)) angle = 0.5 * kPi - angle;
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}

// Returns half the solid angle of the triangle seen from p; zero in its plane (Van Oosterom & Strackee 1983).
float halfSolidAngle(Triangle t, vec3 p) {
  const vec3 q = p - t.a;
  const float u = dot(q, t.x), v = dot(q, t.y), w = dot(q, t.z);
  const vec3 a = vec3(-u, -v, -w), b = vec3(t.bx - u, -v, -w), c = vec3(t.cx - u, t.cy - v, -w);
  const float la = length(a), lb = length(b), lc = length(c);
  const float volume = -w * t.bx * t.cy;
  const float denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return volume == 0 ? 0 : arcTangent(volume, denominator);
}

float halfSolidAngle(Moments m, vec3 r, float r2) {
  const float inverse2 = 1.0 / r2;
  const float second = dot(r * r, m.squares) + 2.0 * dot(r * r.yzx, m.products);
  const float trace = m.squares.x + m.squares.y + m.squares.z;
  return 0.5 * (dot(r, m.area) + trace - 3.0 * second * inverse2) * inverse2 * inversesqrt(r2);
}

float leafAngle(uint leaf, vec3 p) {
  const uint first = (leaf - push.firstLeaf) * kArity;
  float sum = 0;
  [[unroll]] for (uint i = 0; i < kArity; ++i)
    if (first + i < push.triangleCount) sum += halfSolidAngle(readTriangle(push.frames, first + i), p);
  return sum;
}

// Returns the winding number of the triangles around p. `whole` is false if that took too much work.
float windingNumber(vec3 p, float distant, out bool whole) {
  uint stack[kStack];
  uint size = 1;
  stack[0] = 0;
  float sum = 0;
  uint turns = 0;
  for (; size > 0 && turns < push.mostTurns; ++turns) {
    const uint node = stack[--size];
    const Disc disc = readDisc(push.discs, node);
    if (disc.radius < 0) continue;
    const vec3 r = disc.centre - p;
    const float r2 = dot(r, r);
    if (r2 > distant * distant * (disc.radius * disc.radius + disc.halfThickness * disc.halfThickness))
      sum += halfSolidAngle(readMoments(node), r, r2);
    else if (node >= push.firstLeaf)
      sum += leafAngle(node, p);
    else
      [[unroll]] for (uint i = 0; i < kArity; ++i) stack[size++] = kArity * node + kArity - i;
  }
  whole = size == 0;
  return sum / (2.0 * kPi);
}
