// GPU twin of field/field_sampler.h, picture/shape.h and cpu/render/sphere_trace.cpp, which give the reasons. Part of
// shade.glsl.

struct Ray {
  vec3 origin;
  vec3 direction;
};

float fieldValue(vec3 p) {
  const vec3 q = max(vec3(0), min(p, vec3(push.shape.nx, push.shape.ny, push.shape.nz) - 1));
  const float inGrid = trilinear(q);
  if (q == p) return inGrid;
  return length(vec2(distance(p, q), max(inGrid, 0)));
}

float fieldDistance(vec3 p) {
  return fieldValue(p) - push.shape.level;
}

float cutDistance(vec3 p) {
  return dot(push.shape.cutNormal, p) - push.shape.cutOffset;
}

bool isOnCutFace(vec3 p) {
  return abs(cutDistance(p)) < kCutTolerance;
}

float hollowed(float d) {
  return push.shape.wall > 0 ? max(d, -(d + push.shape.wall)) : d;
}

float shapeDistance(vec3 p) {
  return max(hollowed(fieldDistance(p)), cutDistance(p));
}

float stretched(float d) {
  return push.shape.band > 0 && d > 0 ? d / max(1 - d / push.shape.band, 1e-6) : d;
}

bool isClamped(float d) {
  const float band = d > 0 ? push.shape.band : push.shape.innerBand;
  return band > 0 && abs(d) > kClampedShare * band;
}

vec3 shapeNormal(vec3 p) {
  if (isOnCutFace(p)) return push.shape.cutNormal;
  vec3 gradient;
  for (int a = 0; a < 3; ++a) {
    vec3 step = vec3(0);
    step[a] = 1;
    gradient[a] = fieldValue(p + step) - fieldValue(p - step);
  }
  const float size = length(gradient);
  if (!(size > 0)) return vec3(0, 0, 1);
  const float d = fieldDistance(p);
  const bool isInnerWall = push.shape.wall > 0 && -(d + push.shape.wall) > d;
  return (isInnerWall ? -1 : 1) / size * gradient;
}

// Uses the foot of the centre on the ray, which is exact even for a distant origin.
vec2 clipToBall(Ray ray) {
  const vec3 toCentre = push.shape.centre - ray.origin;
  const float radius = push.shape.radius + kBallMargin;
  const float middle = dot(toCentre, ray.direction);
  const vec3 across = toCentre - middle * ray.direction;
  const float half2 = radius * radius - dot(across, across);
  if (half2 <= 0) return vec2(0, -1);
  return vec2(max(middle - sqrt(half2), 0), middle + sqrt(half2));
}

float refineHit(Ray ray, float outside, float inside, float dOut, float dIn) {
  for (int i = 0; i < kHitSteps && inside - outside > kHitTolerance; ++i) {
    const float share = i % 2 == 0 ? clamp(dOut / (dOut - dIn), kLeastSecant, kMostSecant) : 0.5;
    const float t = outside + share * (inside - outside);
    const float d = shapeDistance(ray.origin + t * ray.direction);
    if (abs(d) < kHitTolerance) return t;
    if (d > 0) {
      outside = t;
      dOut = d;
    } else {
      inside = t;
      dIn = d;
    }
  }
  return inside;
}

// Returns how far a ray may go on from a point whose distance is `d`, without meeting the surface.
float rayStep(vec3 p, vec3 direction, float d) {
  float value;
  const float plateau = plateauLength(p, direction, value);
  const bool isOpen = plateau > 0 && hollowed(value - push.shape.level) > 0;
  return max(kCaution * d, isOpen ? plateau : 0);
}

// Returns the ray's parameter at the hit; negative if nothing is hit.
float traceRay(Ray ray) {
  const vec2 part = clipToBall(ray);
  float before = part.x, dBefore = 1e30;
  for (float t = part.x; t <= part.y;) {
    const vec3 p = ray.origin + t * ray.direction;
    const float d = shapeDistance(p);
    if (d <= 0) return t > part.x ? refineHit(ray, before, t, dBefore, d) : t;
    before = t;
    dBefore = d;
    t += max(rayStep(p, ray.direction, d), kLeastStep);
  }
  return -1;
}

float softShadow(vec3 point, vec3 toLight) {
  const vec2 part = clipToBall(Ray(point, toLight));
  float clear = 1;
  float dBefore = kNothingNear, stepped = 1;
  for (float t = max(part.x, kShadowStart); t <= part.y;) {
    const vec3 p = point + t * toLight;
    const float d = shapeDistance(p);
    if (d <= 0) return 0;
    const float back = 0.5 * (stepped + (d - dBefore) / stepped * (d + dBefore));
    const bool isBetween = back > 0 && back < min(stepped, d);
    const float share = back / d;
    const float narrowest = stretched(d) * (isBetween ? sqrt(1 - share * share) : 1);
    clear = min(clear, narrowest / (kLightSize * (isBetween ? t - back : t)));
    if (clear < kDark) return 0;
    stepped = max(rayStep(p, toLight, d), 4 * kLeastStep);
    dBefore = stepped > max(d, 4 * kLeastStep) ? kNothingNear : d;
    t += stepped;
  }
  return clear * clear * (3 - 2 * clear);
}

float ambientOpenness(vec3 point, vec3 normal) {
  float blocked = 0, weight = 1, total = 0;
  for (int i = 0; i < kHeights; ++i) {
    const float height = kHeightShares[i] * push.shape.radius;
    const float open = stretched(shapeDistance(point + height * normal));
    blocked += weight * clamp(1 - open / height, 0, 1);
    total += weight;
    weight *= kHeightFading;
  }
  return max(1 - kOcclusion * blocked / total, 0);
}
