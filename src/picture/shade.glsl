// GPU twin of cpu/render/shade.cpp. The shader that includes it has the headers of its constants and structs,
// `push.shape`, `push.width`, `push.height`, `trilinear`, which returns the value at a point of the grid, and
// `plateauLength`, which returns how far a ray goes on from a point in samples of one value; 0: they differ or are unknown.

#include "picture/sphere_trace.glsl"

// Returns a ray that starts where the ball around the shape may begin, so that positions near the shape are
// exact even for a distant eye. `skipped` is the distance from the eye to the start.
Ray cameraRay(RenderSceneData scene, vec2 at, out float skipped) {
  const vec2 off = scene.pixelAngle * (at - 0.5 * vec2(push.width, push.height));
  const vec3 direction = normalize(scene.forward + off.x * scene.right - off.y * scene.up);
  const vec3 toCentre = push.shape.centre - scene.eye;
  const float middle = dot(toCentre, direction);
  const float reach = push.shape.radius + kBallMargin;
  skipped = max(middle - reach, 0);
  if (skipped == 0) return Ray(scene.eye, direction);
  const vec3 foot = push.shape.centre - (toCentre - middle * direction);
  return Ray(foot - reach * direction, direction);
}

float lineCoverage(float pixels, float width) {
  return clamp(0.5 * width + 0.5 - pixels, 0, 1);
}

vec3 insideColour(RenderSceneData scene, float d) {
  const float depth = min(abs(d) / scene.depth, 1);
  return depth < 0.5 ? mix(scene.inside[0], scene.inside[1], 2 * depth)
                     : mix(scene.inside[1], scene.inside[2], 2 * depth - 1);
}

// Draws lines over `ground` at multiples of `step`.
vec3 drawIsoLines(vec3 ground, float d, float slope, float step) {
  const float strength = kIsoLineStrength * clamp(step / slope / kIsoLinePixels - 1, 0, 1);
  const float toLine = abs(d - step * round(d / step)) / slope;
  return ground * (1 - strength * lineCoverage(toLine, kIsoLineWidth));
}

// Draws a thick line over `ground` where the distance is zero.
vec3 drawContour(RenderSceneData scene, vec3 ground, float d, float slope) {
  return mix(ground, scene.contour, lineCoverage(abs(d) / slope, kContourWidth));
}

// Draws lines over `ground` where the field has a distance, but none where that is clamped.
vec3 drawLines(RenderSceneData scene, vec3 ground, float d, float slope, float step) {
  return isClamped(d) ? ground : drawContour(scene, drawIsoLines(ground, d, slope, step), d, slope);
}

vec3 cutFace(RenderSceneData scene, vec3 p, vec3 n, float slope) {
  const float d = fieldDistance(p);
  const vec3 ground = insideColour(scene, min(d, -1e-9));
  return (kCutOccluded + kCutSky * ambientOpenness(p, n)) * drawLines(scene, ground, d, slope, scene.lineStep);
}

vec3 surface(RenderSceneData scene, Ray ray, float t, float skipped) {
  const vec3 p = ray.origin + t * ray.direction;
  const vec3 n = shapeNormal(p);
  if (isOnCutFace(p)) return cutFace(scene, p, n, (skipped + t) * scene.pixelAngle);
  const float facing = dot(n, scene.toLight);
  const float sun = facing > 0 ? facing * softShadow(p + n, scene.toLight) : 0;
  const float open = ambientOpenness(p, n);
  const float upward = 0.5 + 0.5 * dot(n, scene.floorNormal);
  const vec3 incoming = sun * scene.sun + open * (upward * scene.sky + (1 - upward) * scene.bounce);
  const float grazing = pow(1 - clamp(-dot(n, ray.direction), 0, 1), kGrazingPower);
  const float shine = pow(max(dot(n, normalize(scene.toLight - ray.direction)), 0), kShinePower) * sun;
  const vec3 lit =
      kDiffusePart * scene.clay * incoming + kGrazingPart * grazing * open * scene.sky + kShinePart * shine * scene.sun;
  return lit * (1 + lit / kWhite) / (1 + lit);
}

float floorShade(RenderSceneData scene, Ray ray, float skipped) {
  const float down = -dot(ray.direction, scene.floorNormal);
  if (!(down > 1e-6)) return 1;
  const float t = (dot(ray.origin, scene.floorNormal) - scene.floorHeight) / down;
  if (!(skipped + t > 0)) return 1;
  const vec3 p = ray.origin + t * ray.direction;
  const float sun = softShadow(p, scene.toLight);
  const float sky = ambientOpenness(p, scene.floorNormal);
  return (kFloorInShadow + kFloorSun * sun) * (kFloorOccluded + kFloorSky * sky);
}

vec3 background(RenderSceneData scene, Ray ray, vec2 at, float skipped) {
  return mix(scene.top, scene.bottom, at.y / push.height) * floorShade(scene, ray, skipped);
}

// Returns the ray's parameter where it meets the slice inside the grid, which may lie before the ball around the shape;
// `kFarthestRay` if it does not.
float traceSlice(RenderSceneData scene, Ray ray, float skipped) {
  const float across = dot(ray.direction, scene.sliceNormal);
  if (across == 0) return kFarthestRay;
  const float t = (scene.sliceOffset - dot(ray.origin, scene.sliceNormal)) / across;
  const vec3 p = ray.origin + t * ray.direction;
  const vec3 last = vec3(push.shape.nx, push.shape.ny, push.shape.nz) - 1;
  const bool isInGrid = all(greaterThanEqual(p, vec3(-0.5))) && all(lessThanEqual(p, last + 0.5));
  return skipped + t >= 0 && isInGrid ? t : kFarthestRay;
}

vec3 encodeSrgb(vec3 linear) {
  linear = clamp(linear, 0, 1);
  return mix(1.055 * pow(linear, vec3(1 / 2.4)) - 0.055, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
}
