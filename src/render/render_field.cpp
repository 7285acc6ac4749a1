// A picture of a field: sphere traced, lit by one round light and a sky, on a bright floor that shows nothing
// but the shadow.

#include <raymap/render.h>

#include <algorithm>
#include <atomic>

#include "camera.h"
#include "colour.h"
#include "cpu/parallel.h"
#include "progress.h"
#include "shape.h"
#include "sphere_trace.h"

namespace raymap {

namespace {

// Where in a pixel the four samples of antialiasing lie: a rotated square, so that near-horizontal and
// near-vertical edges get all four levels.
constexpr glm::dvec2 kSubPixels[] = {{0.375, 0.125}, {0.875, 0.375}, {0.625, 0.875}, {0.125, 0.625}};

const Colour kSun = 3.0 * srgb(255, 244, 228);
const Colour kSky = 0.85 * srgb(214, 230, 255);
const Colour kBounce = 0.42 * srgb(255, 226, 198);
const Colour kClay = srgb(226, 158, 104);

class Scene {
 public:
  Scene(const Field& field, const RenderOptions& options)
      : up_(unitVector(options.up, "up vector")),
        shape_(field, options),
        camera_(options, shape_),
        height_(options.height),
        toLight_(glm::normalize(-0.45 * camera_.right() - 0.55 * camera_.forward() + 0.95 * up_)),
        lineStep_(roundedUp(shape_.depth() / 12.0 * field.grid.spacing) / field.grid.spacing) {}

  Colour pixel(int x, int y) const {
    Colour sum(0.0);
    for (const glm::dvec2& s : kSubPixels) sum += light(camera_.ray(x + s.x, y + s.y), y + s.y);
    return 0.25 * sum;
  }

 private:
  Colour light(const Ray& ray, double y) const {
    if (const std::optional<double> t = trace(shape_, ray)) return surface(ray, *t);
    return background(y) * floorShade(ray);
  }
  Colour background(double y) const {
    return glm::mix(srgb(250, 251, 252), srgb(222, 226, 231), y / height_);
  }
  double floorShade(const Ray& ray) const;
  Colour surface(const Ray& ray, double t) const;
  Colour cutFace(const glm::dvec3& p, const glm::dvec3& n, double t) const;

  glm::dvec3 up_;
  Shape shape_;
  Camera camera_;
  double height_;
  glm::dvec3 toLight_;
  double lineStep_;
};

/// What the shape leaves of the light on the floor, seen along a ray that misses the shape.
double Scene::floorShade(const Ray& ray) const {
  const double down = -glm::dot(ray.direction, up_);
  const double t = (glm::dot(ray.origin, up_) - camera_.floor()) / down;
  if (!(down > 1e-6) || !(t > 0.0) || !std::isfinite(t)) return 1.0;
  const glm::dvec3 p = ray.origin + t * ray.direction;
  const double sun = softShadow(shape_, p, toLight_);
  const double sky = ambientOpenness(shape_, p, up_);
  return (0.55 + 0.45 * sun) * (0.45 + 0.55 * sky);
}

/// The cut face is a drawing, not a thing: the colours of a slice, unlit but for what stands on it.
Colour Scene::cutFace(const glm::dvec3& p, const glm::dvec3& n, double t) const {
  const double d = shape_.fieldDistance(p);
  const Colour ground = distanceColour(std::min(d, -1e-9), shape_.depth());
  return (0.6 + 0.4 * ambientOpenness(shape_, p, n)) *
         drawContour(drawIsoLines(ground, d, t * camera_.pixelAngle(), lineStep_), d,
                     t * camera_.pixelAngle(), kContour);
}

Colour Scene::surface(const Ray& ray, double t) const {
  const glm::dvec3 p = ray.origin + t * ray.direction;
  const glm::dvec3 n = shape_.normal(p);
  if (shape_.isOnCutFace(p)) return cutFace(p, n, t);
  const double facing = glm::dot(n, toLight_);
  const double sun = facing > 0.0 ? facing * softShadow(shape_, p + n, toLight_) : 0.0;
  const double open = ambientOpenness(shape_, p, n);
  const double upward = 0.5 + 0.5 * glm::dot(n, up_);
  const Colour incoming = sun * kSun + open * (upward * kSky + (1.0 - upward) * kBounce);
  const double grazing = std::pow(1.0 - std::clamp(-glm::dot(n, ray.direction), 0.0, 1.0), 5.0);
  const double shine = std::pow(std::max(glm::dot(n, glm::normalize(toLight_ - ray.direction)), 0.0), 50.0) *
                       (sun > 0.0 ? sun : 0.0);
  const Colour lit = 0.5 * kClay * incoming + 0.25 * grazing * open * kSky + 0.12 * shine * kSun;
  return lit * (1.0 + lit / 4.0) / (1.0 + lit);  // highlights bend instead of clipping
}

}  // namespace

Picture renderField(const Field& field, const RenderOptions& options) {
  validateField(field);
  Picture picture = makePicture(options.width, options.height);
  Options run;
  if (options.progress) run.progress = [&](std::string_view, double done) { return options.progress(done); };
  Stats stats;
  Progress progress(run, stats);
  const auto draw = [&] {
    const Scene scene(field, options);
    std::atomic<int> rows{0};
    parallelFor(size_t(options.height), 1, [&](size_t y, size_t) {
      for (int x = 0; x < options.width; ++x) setPixel(picture, x, int(y), scene.pixel(x, int(y)));
      progress.report(double(++rows) / options.height);
    });
  };
  progress.stage("render", [&] { withThreads(options.threads, draw); });
  return picture;
}

}  // namespace raymap
