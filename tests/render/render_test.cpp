#include <gtest/gtest.h>
#include <png.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>

#include "analytic_fields.h"
#include "cpu/render/sphere_trace.h"
#include "error_code.h"
#include "field/field_sampler.h"
#include "picture/camera.h"
#include "picture/colour.h"
#include "picture/shape.h"
#include "pictures.h"
#include "shapes.h"

namespace raymap {
namespace {

using analytic::cube;
using analytic::sampled;

Field ball(int n, double radius) {
  return sampled(cube(n, 2.0), [&](const glm::dvec3& p) { return analytic::sphere(p, radius); });
}

/// Counts the pixels whose centre shows the shape.
size_t silhouette(const Field& field, const RenderOptions& options) {
  const Shape shape(field, options);
  const Camera camera(options, shape);
  size_t hits = 0;
  for (int y = 0; y < options.height; ++y)
    for (int x = 0; x < options.width; ++x) hits += cpu::trace(shape, camera.ray(x + 0.5, y + 0.5)) ? 1 : 0;
  return hits;
}

std::optional<ErrorCode> refusal(const Field& field, const RenderOptions& options,
                                 const MachineOptions& machine = {}) {
  return codeOf([&] { renderField(field, options, machine); });
}

/// Counts the pixels of a colour, with a tolerance for lighting and rounding.
size_t countPixels(const Picture& picture, const std::function<bool(int, int, int)>& isWanted) {
  size_t count = 0;
  for (size_t p = 0; p < picture.rgb.size(); p += 3)
    count += isWanted(picture.rgb[p], picture.rgb[p + 1], picture.rgb[p + 2]) ? 1 : 0;
  return count;
}

TEST(RenderDefects, ColoursWhatIsWrong) {
  const auto isRed = [](int r, int g, int b) { return r > 2 * g && r > 2 * b; };
  const auto isBlue = [](int r, int, int b) { return b > r + 60; };
  const auto isOrange = [](int r, int g, int b) { return r > g + 30 && g > b + 30; };
  const RenderOptions options{.width = 200, .height = 150};
  const Mesh whole = shapes::sphere(1.0, 3);
  const Picture plain = renderDefects(whole, options);
  for (const auto& colour :
       {std::function<bool(int, int, int)>(isRed), std::function<bool(int, int, int)>(isBlue)})
    EXPECT_EQ(countPixels(plain, colour), 0u);
  EXPECT_EQ(countPixels(plain, isOrange), 0u);

  Mesh holed = whole, flipped = whole;
  std::erase_if(holed.triangles, [&](const glm::uvec3& t) { return whole.vertices[t.x].z > 0.7f; });
  EXPECT_GT(countPixels(renderDefects(holed, options), isRed), 100u);
  for (glm::uvec3& t : flipped.triangles)
    if (whole.vertices[t.x].z > 0.7f) std::swap(t.x, t.y);
  EXPECT_GT(countPixels(renderDefects(flipped, options), isBlue), 500u);
  const Mesh crossing = shapes::joined(whole, shapes::box({-0.3, -0.3, 0.5}, {0.3, 0.35, 2.0}));
  EXPECT_GT(countPixels(renderDefects(crossing, options), isOrange), 50u);
}

// Faces on the same corners differ in depth by rounding only.
TEST(RenderDefects, DrawsFacesInTheSamePlaceAlike) {
  const RenderOptions options{.width = 400, .height = 300};
  const auto isYellow = [](int r, int g, int b) { return r > b + 50 && g > b + 50; };
  const auto isGreen = [](int r, int g, int b) { return g > r + 20 && g > b + 20; };
  const auto isGrey = [](int r, int g, int b) {
    return std::abs(r - g) < 12 && std::abs(b - g) < 22 && g < 190;
  };
  const Mesh whole = shapes::sphere(1.0, 1, {3, 4, 5});
  const size_t grey = countPixels(renderDefects(whole, options), isGrey);
  ASSERT_GT(grey, 20'000u);
  for (const bool isReversed : {false, true}) {
    SCOPED_TRACE(isReversed);
    Mesh doubled = whole;
    for (const glm::uvec3& t : whole.triangles)
      doubled.triangles.push_back(isReversed ? glm::uvec3(t.y, t.x, t.z) : glm::uvec3(t.y, t.z, t.x));
    const Picture picture = renderDefects(doubled, options);
    EXPECT_LT(countPixels(picture, isGrey), grey / 50);  // None but on the outline.
    const size_t coloured = isReversed ? countPixels(picture, isGreen) : countPixels(picture, isYellow);
    EXPECT_GT(coloured, grey / 2);  // The edges are violet.
  }
}

TEST(RenderDefects, RefusesInvalidMeshes) {
  EXPECT_THROW(renderDefects({}), Error);
}

TEST(RenderDefects, DrawsAViewLikeTheMesh) {
  const Mesh stored = shapes::sphere(1.0, 3, {1e6, -2e6, 3e6});
  std::vector<glm::dvec3> positions;
  for (uint32_t v = 0; v < stored.vertices.size(); ++v) positions.push_back(stored.position(v));
  const MeshView view(positions, stored.triangles);
  EXPECT_EQ(renderDefects(view, {.width = 40, .height = 30}).rgb,
            renderDefects(makeMesh(positions, stored.triangles), {.width = 40, .height = 30}).rgb);
}

TEST(FieldSampler, ReproducesALinearFunction) {
  const Grid grid{{5, 6, 7}, {1.0, 2.0, 3.0}, 0.5};
  const Field field = sampled(grid, [](const glm::dvec3& p) { return p.x + 2 * p.y - 3 * p.z + 20; });
  const FieldSampler sampler(field);
  const glm::dvec3 at(1.25, 3.5, 2.75);
  const glm::dvec3 p = grid.position(at);
  EXPECT_NEAR(sampler.value(at), (p.x + 2 * p.y - 3 * p.z + 20) / 0.5, 1e-5);
  const glm::dvec3 g = sampler.gradient(at);
  EXPECT_NEAR(glm::length(g - glm::dvec3(1, 2, -3)), 0.0, 1e-5);
}

TEST(FieldSampler, NeverOverestimatesOutsideTheGrid) {
  const Field field = ball(32, 0.7);
  const FieldSampler sampler(field);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> where(-40.0, 70.0);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 s(where(random), where(random), where(random));
    const double exact = analytic::sphere(field.grid.position(s), 0.7) / field.grid.spacing;
    EXPECT_LE(sampler.value(s), exact + 0.05) << s.x << " " << s.y << " " << s.z;
  }
}

TEST(Shape, NormalsMirrorWithTheField) {
  const auto lopsided = [](const glm::dvec3& p) {
    return std::min(analytic::sphere(p - glm::dvec3(0.2, 0.1, 0.0), 0.4),
                    analytic::box(p + glm::dvec3(0.3, 0.0, 0.1), {0.3, 0.2, 0.4}));
  };
  const Field field = sampled(cube(40, 2.0), lopsided);
  const Field mirror = sampled(cube(40, 2.0), [&](const glm::dvec3& p) {
    return lopsided({-p.x, p.y, p.z});
  });
  const Shape shape(field, {}), mirrored(mirror, {});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> where(4.0, 35.0);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 p(where(random), where(random), where(random));
    const glm::dvec3 n = shape.normal(p);
    const glm::dvec3 m = mirrored.normal({39.0 - p.x, p.y, p.z});
    EXPECT_NEAR(glm::length(n - glm::dvec3(-m.x, m.y, m.z)), 0.0, 1e-4);
  }
}

TEST(Render, SilhouetteOfASphereIsItsProjectedDisc) {
  RenderOptions options{.width = 240, .height = 180};
  const Field field = ball(64, 0.7);
  const Shape shape(field, options);
  const Camera camera(options, shape);
  const double distance = glm::length(camera.eye() - shape.centre());
  const double radius = 0.7 / field.grid.spacing;
  const double disc = std::tan(std::asin(radius / distance)) / camera.pixelAngle();  // In pixels.
  const double pixels = double(silhouette(field, options));
  EXPECT_NEAR(std::sqrt(pixels / std::numbers::pi), disc, 0.5);
  EXPECT_GT(disc, 0.35 * options.height);  // It fills the picture.
}

TEST(Render, TheCameraStandsStillBeforeAFrame) {
  const RenderOptions options{.width = 120, .height = 90, .frame = Box{{-0.9, -0.5, -0.8}, {0.8, 0.9, 0.8}}};
  const auto camera = [&](const Field& field) { return Camera(options, Shape(field, options)); };
  const Field small = ball(48, 0.3), large = ball(48, 0.6);
  EXPECT_EQ(camera(small).eye(), camera(large).eye());
  EXPECT_EQ(camera(small).floor(), camera(large).floor());
  EXPECT_NEAR(std::sqrt(double(silhouette(large, options)) / double(silhouette(small, options))), 2.0, 0.1);
  // The box fills the picture: all its corners are visible, and some are near an edge.
  double closest = 1.0;
  const Camera still = camera(small);
  for (int corner = 0; corner < 8; ++corner) {
    const Box& box = *options.frame;
    const glm::dvec3 p{corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                       corner & 4 ? box.max.z : box.min.z};
    const glm::dvec3 to = (p - small.grid.origin) / small.grid.spacing - still.eye();
    const double scale = 2.0 / (still.pixelAngle() * glm::dot(to, still.forward()));
    const double edge = std::max(std::abs(glm::dot(to, still.right())) * scale / 120.0,
                                 std::abs(glm::dot(to, still.up())) * scale / 90.0);
    EXPECT_LE(edge, 0.87);
    closest = std::min(closest, 1.0 - edge);
  }
  EXPECT_NEAR(closest, 0.14, 0.01);
}

TEST(Render, RefusesFramesWithoutSize) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const Box& box : {Box{}, Box{glm::dvec3(1), glm::dvec3(1)}, Box{glm::dvec3(0), glm::dvec3(inf)}})
    EXPECT_EQ(refusal(ball(16, 0.7), {.frame = box}), ErrorCode::Usage);
}

TEST(Render, BandedFieldTracesLikeTheWholeOne) {
  const RenderOptions options{.width = 120, .height = 90};
  const auto shape = [](const glm::dvec3& p) { return analytic::torus(p, 0.6, 0.2); };
  const Field whole = sampled(cube(48, 2.0), shape);
  Field banded = sampled(cube(48, 2.0), [&](const glm::dvec3& p) { return std::clamp(shape(p), -0.1, 0.1); });
  banded.clampDistance = 0.1;
  const double pixels = double(silhouette(whole, options));
  EXPECT_GT(pixels, 500.0);
  EXPECT_NEAR(double(silhouette(banded, options)) / pixels, 1.0, 0.02);
}

TEST(Render, UnsignedFieldShowsItsSurface) {
  const RenderOptions options{.width = 120, .height = 90};
  const Field field =
      sampled(cube(48, 2.0), [](const glm::dvec3& p) { return std::abs(analytic::sphere(p, 0.7)); });
  EXPECT_NEAR(double(silhouette(field, options)) / double(silhouette(ball(48, 0.7), options)), 1.0, 0.03);
}

TEST(Render, TheCameraStandsAtTheEye) {
  RenderOptions options{
      .width = 240, .height = 180, .direction = {0, 0, -1}, .eye = glm::dvec3(0.0, 0.0, 4.0)};
  const Field field = ball(64, 0.7);
  const Camera camera(options, Shape(field, options));
  const double disc = std::tan(std::asin(0.7 / 4.0)) / camera.pixelAngle();
  EXPECT_NEAR(std::sqrt(double(silhouette(field, options)) / std::numbers::pi), disc, 0.5);
  options.iso = 0.2;  // A larger ball.
  const double larger = std::tan(std::asin(0.9 / 4.0)) / camera.pixelAngle();
  EXPECT_NEAR(std::sqrt(double(silhouette(field, options)) / std::numbers::pi), larger, 0.5);
  options.eye->z = NAN;
  EXPECT_EQ(refusal(field, options), ErrorCode::Usage);
}

TEST(Render, APlaneCutsAndASliceShowsDistances) {
  RenderOptions options{
      .width = 120, .height = 120, .direction = {0, 0, -1}, .eye = glm::dvec3(0.0, 0.0, 3.0)};
  const Field field = ball(64, 0.7);
  const auto pixel = [&](int x, int y) { return pixelAt(renderField(field, options), x, y); };
  // The normal's length does not count, and what lies on its side is gone: the face is 0.3 lower.
  options.cutPlane = Plane{{0.0, 0.0, 10.0}, 4.0};
  const Shape shape(field, options);
  const auto hit = cpu::trace(shape, Camera(options, shape).ray(60, 60));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(*hit * field.grid.spacing, 3.0 - 0.4, 1e-3);
  const glm::ivec3 face = pixel(60, 60);
  EXPECT_GT(face.z, face.x);  // Cool.
  // A slice in front of all hides the shape: warm where it is outside.
  options.slice = Plane{{0.0, 0.0, 1.0}, 0.9};
  const glm::ivec3 above = pixel(60, 60);
  EXPECT_GT(above.x, above.z);
  options.slice = Plane{{0.0, 0.0, 1.0}, -0.9};  // Behind the shape.
  EXPECT_EQ(pixel(60, 60), face);
  EXPECT_GT(pixel(60, 6).x, pixel(60, 6).z);  // But beside it, it is seen.
  for (const Plane& plane : {Plane{glm::dvec3(0.0), 0.0}, Plane{{0, 0, 1}, NAN}}) {
    RenderOptions broken = options;
    broken.slice = plane;
    EXPECT_EQ(refusal(field, broken), ErrorCode::Usage);
    broken.slice = {};
    broken.cutPlane = plane;
    EXPECT_EQ(refusal(field, broken), ErrorCode::Usage);
  }
  options.iso = NAN;
  EXPECT_EQ(refusal(field, options), ErrorCode::Usage);
}

/// A picture from above of a ball, cut at z = 0.2, in which the pixel x, y shows the point (x - 60, 60 - y) /
/// 100 of the cut.
RenderOptions fromAbove() {
  return {.width = 120,
          .height = 120,
          .direction = {0, 0, -1},
          .fieldOfView = 2.0 * std::atan(0.2) * 180.0 / std::numbers::pi,
          .eye = glm::dvec3(0.0, 0.0, 3.2),
          .cutPlane = Plane{{0.0, 0.0, 1.0}, 0.2}};
}

TEST(Render, ShowsWindingNumbersAndConfidencesInColour) {
  Field field = ball(64, 0.7);
  field.winding = sampled(cube(64, 2.0), [](const glm::dvec3& p) { return 4.0 * p.x; }).distance;
  field.confidence = sampled(cube(64, 2.0), [](const glm::dvec3& p) { return 0.5 + p.y; }).distance;
  RenderOptions options = fromAbove();
  options.array = FieldArray::Winding;
  const Picture winding = renderField(field, options);
  const auto nearly = [](const glm::ivec3& a, const glm::ivec3& b) { return colourGap(a, b) <= 8; };
  EXPECT_TRUE(nearly(pixelAt(winding, 85, 60), {116, 173, 214}));  // w = 1.
  EXPECT_TRUE(nearly(pixelAt(winding, 35, 60), {122, 190, 124}));  // w = -1.
  EXPECT_TRUE(nearly(pixelAt(winding, 60, 60), {247, 190, 120}));  // w = 0.
  EXPECT_TRUE(nearly(pixelAt(winding, 85, 80), pixelAt(winding, 85, 40)));
  // Lines lie at 0.5 and 1.5, and a slice shows the same as the cut.
  EXPECT_LT(pixelAt(winding, 72, 60).y, pixelAt(winding, 74, 60).y - 30);
  EXPECT_LT(pixelAt(winding, 97, 60).y, pixelAt(winding, 99, 60).y - 15);
  RenderOptions sliced = options;
  sliced.slice = Plane{{0.0, 0.0, 1.0}, 0.2001};
  EXPECT_TRUE(nearly(pixelAt(renderField(field, sliced), 85, 60), {116, 173, 214}));
  // Winding numbers do not colour the surface, confidences do.
  options.array = FieldArray::Confidence;
  const Picture confidence = renderField(field, options);
  for (const auto& [y, number] : {std::pair(50, 0.595), std::pair(15, 0.945)}) {
    Picture one = makePicture(1, 1);
    setPixel(one, 0, 0, confidenceColour(number));
    EXPECT_TRUE(nearly(pixelAt(confidence, 60, y), pixelAt(one, 0, 0))) << number;
  }
  RenderOptions whole{.width = 60, .height = 60, .direction = {0, 0, -1}};
  const glm::ivec3 clay = pixelAt(renderField(field, whole), 30, 30);
  whole.array = FieldArray::Winding;
  EXPECT_EQ(pixelAt(renderField(field, whole), 30, 30), clay);
  whole.array = FieldArray::Confidence;
  const glm::ivec3 teal = pixelAt(renderField(field, whole), 30, 30);
  EXPECT_GT(clay.x, clay.y);
  EXPECT_GT(teal.y, teal.x + 40);
  // The field must have the array, finite, and triangles have no such colours.
  options.array = FieldArray::Triangle;
  EXPECT_EQ(refusal(field, options), ErrorCode::Usage);
  options.array = FieldArray::Winding;
  field.winding[7] = NAN;
  EXPECT_EQ(refusal(field, options), ErrorCode::Input);
  field.winding = {};
  EXPECT_EQ(refusal(field, options), ErrorCode::Usage);
}

TEST(ColourBar, HasTheColoursOfASlice) {
  RenderOptions options = fromAbove();
  options.frame = Box{glm::dvec3(-0.7), glm::dvec3(0.7)};
  options.slice = Plane{{0.0, 0.0, 1.0}, 0.2001};
  for (const double iso : {0.0, 0.05}) {
    options.iso = iso;
    const ColourBar bar = colourBar(options, 101);
    ASSERT_EQ(bar.colours.size(), 101u);
    EXPECT_NEAR(bar.least, -0.7, 1e-12);
    EXPECT_NEAR(bar.most, iso + 0.7 * std::sqrt(3.0), 1e-12);
    const Picture picture = renderField(ball(64, 0.7), options);
    int alike = 0;
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 120; ++x) {
        const double d = glm::length(glm::dvec3((x - 59.5) / 100.0, (59.5 - y) / 100.0, 0.2)) - 0.7;
        const auto& c = bar.colours[size_t(std::lround(100.0 * (d - bar.least) / (bar.most - bar.least)))];
        alike += colourGap(pixelAt(picture, x, y), {c[0], c[1], c[2]}) <= 6 ? 1 : 0;
      }
    EXPECT_GT(alike, 120 * 120 * 7 / 10);  // The others are lines.
  }
  options.shell = 0.1;
  EXPECT_NEAR(colourBar(options).least, options.iso - 0.1, 1e-12);
}

TEST(ColourBar, HasWindingNumbersConfidencesAndDifferences) {
  const ColourBar winding = colourBar({.array = FieldArray::Winding}, 4);
  EXPECT_EQ(winding.least, -1.0);
  EXPECT_EQ(winding.most, 2.0);
  EXPECT_EQ(winding.colours[2], (std::array<uint8_t, 3>{116, 173, 214}));
  EXPECT_EQ(colourBar({.array = FieldArray::Confidence}, 3).colours[1],
            (std::array<uint8_t, 3>{36, 136, 128}));
  const ColourBar difference = differenceBar(0.1, 3);
  EXPECT_EQ(difference.least, -0.1);
  EXPECT_EQ(difference.colours[0], (std::array<uint8_t, 3>{33, 102, 172}));
  EXPECT_EQ(difference.colours[2], (std::array<uint8_t, 3>{178, 24, 43}));
  EXPECT_THROW(colourBar({}), Error);
  EXPECT_THROW(colourBar({.array = FieldArray::Triangle}), Error);
  EXPECT_THROW(colourBar({.array = FieldArray::Winding}, 1), Error);
  EXPECT_THROW(differenceBar(0.0), Error);
}

TEST(Render, ShowsTheDifferenceOfTwoFieldsInColour) {
  const Field field = ball(64, 0.7);
  const auto shown = [&](double radius, double range, int samples = 64) {
    const Field other = ball(samples, radius);
    RenderOptions options = fromAbove();
    options.other = &other;
    options.range = range;
    return pixelAt(renderField(field, options), 62, 63);
  };
  const auto near = [](const glm::ivec3& a, const glm::ivec3& b) { return colourGap(a, b) <= 3; };
  // A smaller ball has larger distances.
  EXPECT_TRUE(near(shown(0.6, 0.1), {178, 24, 43}));
  EXPECT_TRUE(near(shown(0.65, 0.1), {244, 165, 130}));
  EXPECT_TRUE(near(shown(0.7, 0.1), {245, 245, 245}));
  EXPECT_TRUE(near(shown(0.75, 0.1), {146, 197, 222}));
  EXPECT_TRUE(near(shown(0.9, 0.1), {33, 102, 172}));
  EXPECT_TRUE(near(shown(0.7 - 0.5 * field.grid.spacing, 0.0), {244, 165, 130}));  // Of the spacing.
  EXPECT_TRUE(near(shown(0.65, 0.1, 80), {244, 165, 130}));                        // On another grid.
  // It colours the surface too.
  const Field larger = ball(64, 0.8);
  RenderOptions whole{.width = 60, .height = 60, .direction = {0, 0, -1}, .other = &larger, .range = 0.1};
  const glm::ivec3 blue = pixelAt(renderField(field, whole), 30, 30);
  EXPECT_GT(blue.z, blue.x + 60);
  whole.array = FieldArray::Winding;
  EXPECT_EQ(refusal(field, whole), ErrorCode::Usage);
  whole.array = FieldArray::Distance;
  Field broken = ball(64, 0.8);
  broken.distance[7] = NAN;
  whole.other = &broken;
  EXPECT_EQ(refusal(field, whole), ErrorCode::Input);
}

TEST(Render, CutShowsTheInsideAndShellHollowsIt) {
  // Straight from the front: the cut face of the ball is a disc, that of the shell a ring.
  RenderOptions options{.width = 200, .height = 200, .direction = {0, 0, -1}, .cut = true};
  const Field field = ball(64, 0.7);
  const auto cutFace = [&] {
    const Shape shape(field, options);
    const Camera camera(options, shape);
    const double scale = glm::dot(shape.centre() - camera.eye(), camera.forward()) * camera.pixelAngle();
    size_t pixels = 0;
    for (int y = 0; y < options.height; ++y)
      for (int x = 0; x < options.width; ++x) {
        const Ray ray = camera.ray(x + 0.5, y + 0.5);
        const auto t = cpu::trace(shape, ray);
        pixels += t && shape.isOnCutFace(ray.origin + *t * ray.direction) ? 1 : 0;
      }
    return double(pixels) * scale * scale * field.grid.spacing * field.grid.spacing;  // Area in mesh units.
  };
  const double pi = std::numbers::pi;
  EXPECT_NEAR(cutFace(), pi * 0.49, 0.05);
  options.shell = 0.2;
  EXPECT_NEAR(cutFace(), pi * (0.49 - 0.25), 0.05);
}

TEST(Render, PictureIsTheSameForAnyNumberOfThreads) {
  const Field field = ball(32, 0.7);
  const RenderOptions options{.width = 80, .height = 60};
  EXPECT_EQ(renderField(field, options, {.threads = 1}).rgb, renderField(field, options, {.threads = 4}).rgb);
}

TEST(Render, EmptyFieldIsAnEmptyPicture) {
  const Field far = sampled(cube(8, 2.0), [](const glm::dvec3&) { return 100.0; });
  const Picture picture = renderField(far, {.width = 16, .height = 12});
  for (int x = 1; x < 16; ++x) EXPECT_EQ(pixelAt(picture, x, 0), pixelAt(picture, 0, 0));
}

TEST(Render, SolidIsCutOffByTheGrid) {
  // Every sample is deeper inside than the grid is large, so the picture shows the grid's box.
  RenderOptions options{.width = 100, .height = 100, .direction = {0, 0, -1}};
  for (const double depth : {1.0, 50.0, 1e30}) {
    const Field field = sampled(cube(16, 2.0), [&](const glm::dvec3&) { return -depth; });
    EXPECT_NEAR(double(silhouette(field, options)), 86.0 * 86.0, 400.0) << depth;
  }
}

TEST(Render, ReportsProgressAndStops) {
  const Field field = ball(16, 0.7);
  std::atomic<int> calls{0};
  const RenderOptions options{.width = 32, .height = 24};
  const auto note = [&](std::string_view, double done) {
    EXPECT_GE(done, 0.0);
    EXPECT_LE(done, 1.0);
    return ++calls > 0;
  };
  renderField(field, options, {.progress = note});
  EXPECT_GT(calls.load(), 1);
  const auto stop = [](std::string_view, double) { return false; };
  EXPECT_EQ(refusal(field, options, {.progress = stop}), ErrorCode::Cancelled);
}

TEST(Render, RefusesWhatCannotBeDrawn) {
  Field field = ball(16, 0.7);
  EXPECT_EQ(refusal(Field{}, {}), ErrorCode::Usage);
  EXPECT_EQ(refusal(field, {.width = 0}), ErrorCode::Usage);
  EXPECT_EQ(refusal(field, {.height = 1 << 20}), ErrorCode::Usage);
  EXPECT_EQ(refusal(field, {.direction = {0, 0, 0}}), ErrorCode::Usage);
  EXPECT_EQ(refusal(field, {.up = {NAN, 0, 0}}), ErrorCode::Usage);
  EXPECT_EQ(refusal(field, {.fieldOfView = 180.0}), ErrorCode::Usage);
  EXPECT_EQ(refusal(field, {.shell = -1.0}), ErrorCode::Usage);
  field.clampDistance = 0.1;
  EXPECT_EQ(refusal(field, {.shell = 0.2}), ErrorCode::Usage);
  Field tiny = ball(16, 0.7);
  tiny.grid.spacing = 1e-310;  // Distances in such samples are not finite.
  EXPECT_EQ(refusal(tiny, {}), ErrorCode::Usage);
  field.distance[77] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(refusal(field, {}), ErrorCode::Input);
  Field nowhere = ball(16, 0.7);
  nowhere.grid.origin.z = NAN;
  EXPECT_EQ(refusal(nowhere, {}), ErrorCode::Usage);
  EXPECT_THROW(renderSlice(nowhere, 2), Error);
  EXPECT_THROW(compareFields(nowhere, nowhere), Error);
}

TEST(Slice, LiesAsDocumented) {
  // A box, long in x, medium in y and short in z, lies towards high x, y and z.
  const Grid grid{{40, 30, 20}, {0.5, 0.5, 0.5}, 1.0};
  const Field field = sampled(grid, [](const glm::dvec3& p) {
    return analytic::box(p - glm::dvec3(30, 22, 14), {8, 6, 4});
  });
  const auto isInside = [](const Picture& p, int x, int y) {
    return pixelAt(p, x, y).b > pixelAt(p, x, y).r + 10;  // cool
  };
  const Picture z = renderSlice(field, 2, 14, 400);  // x right, y up, 10 pixels a sample
  ASSERT_EQ(z.height, 300);
  EXPECT_TRUE(isInside(z, 300, 300 - 220));
  EXPECT_FALSE(isInside(z, 100, 300 - 220));
  EXPECT_FALSE(isInside(z, 300, 220));
  const Picture y = renderSlice(field, 1, 22, 400);  // x right, z up
  ASSERT_EQ(y.height, 200);
  EXPECT_TRUE(isInside(y, 300, 200 - 140));
  EXPECT_FALSE(isInside(y, 300, 140));
  const Picture x = renderSlice(field, 0, 30, 300);  // y right, z up
  ASSERT_EQ(x.height, 200);
  EXPECT_TRUE(isInside(x, 220, 200 - 140));
  EXPECT_FALSE(isInside(x, 80, 200 - 140));
  EXPECT_FALSE(isInside(x, 220, 140));
}

TEST(Slice, DrawsTheZeroContourWhereItIs) {
  const Field field = ball(50, 0.6);
  const Picture slice = renderSlice(field, 2, -1, 500);  // 250 pixels a unit, through z = 0.02
  const double radius = 250.0 * std::sqrt(0.36 - 0.02 * 0.02);
  for (int step = 0; step < 64; ++step) {
    const double angle = step * std::numbers::pi / 32;
    const int x = int(250 + radius * std::cos(angle)), y = int(250 - radius * std::sin(angle));
    EXPECT_LT(pixelAt(slice, x, y).r, 120) << angle;
  }
}

TEST(Slice, RefusesWhatDoesNotExist) {
  const Field field = ball(8, 0.7);
  EXPECT_THROW(renderSlice(field, 3), Error);
  EXPECT_THROW(renderSlice(field, 2, 8), Error);
  EXPECT_THROW(renderSlice(field, 2, -1, 0), Error);
  const Field needle = sampled({{1, 100000, 1}, {0, 0, 0}, 1.0}, [](const glm::dvec3& p) { return p.y; });
  EXPECT_THROW(renderSlice(needle, 2), Error);
}

TEST(Slice, SurvivesWhatIsNotFinite) {
  Field field = ball(8, 0.7);
  field.distance[100] = std::numeric_limits<float>::infinity();
  field.distance[300] = std::numeric_limits<float>::quiet_NaN();
  for (int axis = 0; axis < 3; ++axis)
    for (int index = 0; index < 8; ++index) EXPECT_EQ(renderSlice(field, axis, index, 32).height, 32);
}

using Rgb = glm::ivec3;

/// Returns a field of one row of columns, each four samples wide, whose other arrays are of these values.
Field columns(const std::vector<float>& values) {
  const Grid grid{{4 * int(values.size()), 4, 1}, {0, 0, 0}, 0.25};
  Field field{.grid = grid};
  for (Buffer<float>* array : {&field.winding, &field.confidence}) {
    array->resizeUninitialized(grid.sampleCount());
    for (size_t n = 0; n < array->size(); ++n) (*array)[n] = values[n % size_t(grid.dims.x) / 4];
  }
  return field;
}

/// Returns the colour in the middle of each column, at 10 pixels a sample.
std::vector<Rgb> coloursOf(const Field& field, FieldArray array) {
  const Picture picture = renderSlice(field, 2, 0, 10 * field.grid.dims.x, array);
  std::vector<Rgb> colours;
  for (int x = 20; x < picture.width; x += 40) colours.push_back(pixelAt(picture, x, 20));
  return colours;
}

TEST(Slice, ColoursWindingNumbersByTurns) {
  const Field field = columns({0, 1, 2, 3, 9, -1, -2, -3, 0.25f, -0.25f, NAN});
  const std::vector<Rgb> colours = coloursOf(field, FieldArray::Winding);
  const std::vector<Rgb> expected{{247, 190, 120}, {116, 173, 214}, {38, 84, 148}, {16, 30, 66},
                                  {16, 30, 66},    {122, 190, 124}, {34, 108, 66}, {12, 44, 30}};
  EXPECT_EQ(std::vector(colours.begin(), colours.begin() + 8), expected);
  EXPECT_EQ(colours[8], colours[9]);  // Outside by either sign.
  EXPECT_GT(colours[8][2], 120);
  EXPECT_LT(colours[8][2], 232);
  EXPECT_EQ(colours[10], (Rgb{140, 60, 160}));
}

TEST(Slice, DrawsTheThresholdAndPartsTheTurns) {
  const auto darkest = [](const std::vector<float>& values) {
    const Picture picture = renderSlice(columns(values), 2, 0, 80, FieldArray::Winding);
    Rgb least{255, 255, 255};
    int column = 0;
    for (int x = 30; x < 50; ++x)
      if (const Rgb colour = pixelAt(picture, x, 20); colour[2] < least[2]) least = colour, column = x;
    return std::pair(least, column);
  };
  // Between samples 3 and 4, whose centres lie at pixels 35 and 45.
  EXPECT_EQ(darkest({0, 1}), std::pair(Rgb({24, 26, 32}), 39));
  EXPECT_EQ(darkest({-1, 0}), std::pair(Rgb({24, 26, 32}), 39));
  EXPECT_EQ(darkest({0.25f, 0.75f}), std::pair(Rgb({24, 26, 32}), 39));
  EXPECT_GT(darkest({0.75f, 1.25f}).first[2], 160);  // No line at 1.
  EXPECT_GT(darkest({0, 0.45f}).first[2], 100);
  // A thin line at 1.5 is darker than both sides of it.
  const Picture turns = renderSlice(columns({1, 2}), 2, 0, 800, FieldArray::Winding);
  EXPECT_LT(pixelAt(turns, 399, 200)[2], pixelAt(turns, 396, 200)[2] - 10);
  EXPECT_LT(pixelAt(turns, 399, 200)[2], pixelAt(turns, 403, 200)[2] - 10);
}

TEST(Slice, ColoursConfidencesFromDarkToPale) {
  const std::vector<Rgb> colours =
      coloursOf(columns({0, 0.5f, 1, -3, 3, NAN, 0.25f, 0.75f}), FieldArray::Confidence);
  const Rgb none{34, 30, 40}, half{36, 136, 128}, sure{240, 247, 214};
  const std::vector<Rgb> expected{none, half, sure, none, sure, {140, 60, 160}};
  EXPECT_EQ(std::vector(colours.begin(), colours.begin() + 6), expected);
  for (const int c : {1, 2}) {
    EXPECT_TRUE(none[c] < colours[6][c] && colours[6][c] < half[c]) << c;
    EXPECT_TRUE(half[c] < colours[7][c] && colours[7][c] < sure[c]) << c;
  }
}

TEST(Slice, GivesEachTriangleAColour) {
  Field field{.grid = {{60, 1, 2}, {0, 0, 0}, 1.0}};
  field.triangle.resizeUninitialized(120);
  for (uint32_t n = 0; n < 120; ++n) field.triangle[n] = n % 60 == 59 ? kNoTriangle : n % 60 / 2;
  const Picture picture = renderSlice(field, 2, 1, 600, FieldArray::Triangle);
  std::vector<Rgb> seen;
  for (int triangle = 0; triangle < 29; ++triangle) {
    const Rgb colour = pixelAt(picture, 20 * triangle, 0);
    for (int x = 20 * triangle; x < 20 * triangle + 20; ++x)  // Two samples with sharp borders.
      for (const int y : {0, 9}) ASSERT_EQ(pixelAt(picture, x, y), colour) << x << " " << y;
    for (const Rgb& other : seen) {
      const Rgb gap = glm::abs(colour - other);
      EXPECT_GT(gap.r + gap.g + gap.b, 8) << triangle;
    }
    seen.push_back(colour);
  }
  EXPECT_EQ(pixelAt(picture, 595, 5), (Rgb{238, 239, 241}));
}

TEST(Slice, SaysWhichArrayIsMissing) {
  const Field field = ball(8, 0.7);
  const auto refused = [](const Field& of, FieldArray array) {
    return usageMessage([&] { renderSlice(of, 2, -1, 64, array); });
  };
  EXPECT_EQ(refused(field, FieldArray::Winding), "the field is empty: it has no winding numbers");
  EXPECT_EQ(refused(field, FieldArray::Confidence), "the field is empty: it has no confidences");
  EXPECT_EQ(refused(field, FieldArray::Triangle), "the field is empty: it has no triangles");
  Field alone = columns({1});
  EXPECT_EQ(refused(alone, FieldArray::Distance), "the field is empty: it has no distances");
  EXPECT_EQ(refused(alone, FieldArray::Winding), "no error");
  alone.winding.resizeUninitialized(3);
  EXPECT_EQ(refused(alone, FieldArray::Winding),
            "the field holds 3 winding numbers but its grid has 16 samples");
}

TEST(WritePng, ReadsBackTheSame) {
  Picture picture{7, 5, {}};
  for (int i = 0; i < 7 * 5 * 3; ++i) picture.rgb.push_back(uint8_t(i * 37));
  const auto path = std::filesystem::path(testing::TempDir()) / "raymap_render_test.png";
  writePng(path, picture);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&image, path.c_str()), 0) << image.message;
  EXPECT_EQ(image.width, 7u);
  EXPECT_EQ(image.height, 5u);
  image.format = PNG_FORMAT_RGB;
  std::vector<uint8_t> read(PNG_IMAGE_SIZE(image));
  ASSERT_NE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr), 0) << image.message;
  EXPECT_EQ(read, picture.rgb);
  std::filesystem::remove(path);
}

TEST(WritePng, RefusesWhatItCannotWrite) {
  EXPECT_THROW(writePng("unwritten.png", Picture{}), Error);
  EXPECT_THROW(writePng("unwritten.png", Picture{4, 4, std::vector<uint8_t>(47)}), Error);
  EXPECT_FALSE(std::filesystem::exists("unwritten.png"));
  EXPECT_EQ(codeOf([] {
              writePng("/nonexistent/folder/picture.png", Picture{1, 1, {1, 2, 3}});
            }),
            ErrorCode::File);
}

}  // namespace
}  // namespace raymap
