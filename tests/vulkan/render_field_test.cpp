#include <raymap/raymap.h>

#include <limits>

#include "analytic_fields.h"
#include "bands.h"
#include "error_code.h"
#include "mesh_folder.h"
#include "picture/drawn_scene.h"
#include "pictures.h"
#include "vulkan/runtime/draw_scene.h"
#include "vulkan/self_test/compare.h"
#include "vulkan/stages/render_field.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

using analytic::cube;
using analytic::notchedBox;
using analytic::sampled;

Field torus(int n) {
  return sampled(cube(n, 2.0), [](const glm::dvec3& p) { return analytic::torus(p, 0.6, 0.25); });
}

class VulkanRender : public VulkanTest {
 protected:
  /// Draws a dense field or a narrow band.
  static Picture draw(const Field& field, const RenderOptions& options,
                      const ProgressCallback& callback = {}) {
    Picture picture{options.width, options.height,
                    std::vector<uint8_t>(3 * size_t(options.width) * size_t(options.height))};
    Progress progress(callback);
    drawScene(device(), DrawnScene(field, options), progress, picture);
    EXPECT_EQ(device().guards()->damaged(), "");
    return picture;
  }

  static void expectAsOnTheCpu(const Field& field, RenderOptions options = {}) {
    options.width = 160;
    options.height = 120;
    const Picture ours = draw(field, options);
    EXPECT_EQ(ours.rgb, draw(field, options).rgb);
    requireSamePicture(ours, renderField(field, options, {.device = "cpu"}));
  }
};

TEST_F(VulkanRender, SphereAndTorus) {
  expectAsOnTheCpu(sampled(cube(32, 2.0), [](const glm::dvec3& p) { return analytic::sphere(p, 0.7); }));
  expectAsOnTheCpu(torus(40), {.direction = {0.3, -1.0, 0.2}, .up = {0, 0, 1}, .fieldOfView = 60.0});
}

TEST_F(VulkanRender, CutAndShell) {
  const Field field = sampled(cube(48, 2.0), notchedBox);
  expectAsOnTheCpu(field);
  expectAsOnTheCpu(field, {.cut = true});
  expectAsOnTheCpu(field, {.shell = 0.15});
  expectAsOnTheCpu(field, {.direction = {1.0, -0.5, 0.4}, .cut = true, .shell = 0.1});
}

TEST_F(VulkanRender, FramedByABox) {
  const Field field = sampled(cube(40, 2.0), notchedBox);
  const Box box{glm::dvec3(-0.8, -0.4, -0.9), glm::dvec3(0.9, 1.1, 0.7)};
  expectAsOnTheCpu(field, {.frame = box});
  expectAsOnTheCpu(field, {.cut = true, .shell = 0.1, .frame = box});
}

TEST_F(VulkanRender, EyeIsoCutPlaneAndSlice) {
  const Field field = sampled(cube(40, 2.0), notchedBox);
  const RenderOptions at{.direction = {-1.0, -0.3, -0.5}, .eye = glm::dvec3(1.8, 0.7, 1.1)};
  expectAsOnTheCpu(field, at);
  RenderOptions options = at;
  options.iso = 0.1;
  options.cutPlane = Plane{{2.0, 1.0, 0.0}, 0.4};
  expectAsOnTheCpu(field, options);
  options.slice = Plane{{0.0, 1.0, 3.0}, 0.5};
  expectAsOnTheCpu(field, options);
}

// Part of the slice is nearer to the eye than the ball around the shape.
TEST_F(VulkanRender, ASliceBeforeTheShape) {
  const Field field = sampled(cube(60, 4.0), [](const glm::dvec3& p) { return analytic::sphere(p, 0.3); });
  const RenderOptions options{.direction = {-0.3, 0.3, -0.8}, .slice = Plane{{1.0, 0.0, 0.0}, 0.1}};
  expectAsOnTheCpu(field, options);
  const Picture picture = renderField(field, options, {.device = "cpu"});
  const Picture open = renderField(field, {.direction = options.direction}, {.device = "cpu"});
  EXPECT_NE(picture.rgb.front(), open.rgb.front());  // The slice fills the picture.
}

TEST_F(VulkanRender, NumbersAndDifferencesInColour) {
  Field field = sampled(cube(40, 2.0), notchedBox);
  field.winding = sampled(cube(40, 2.0), [](const glm::dvec3& p) { return 3.0 * p.x + p.y; }).distance;
  field.confidence = sampled(cube(40, 2.0), [](const glm::dvec3& p) { return 0.5 + 0.6 * p.z; }).distance;
  RenderOptions options{.cutPlane = Plane{{2.0, 1.0, 0.0}, 0.4}, .slice = Plane{{0.0, 1.0, 3.0}, 0.5}};
  for (const FieldArray array : {FieldArray::Winding, FieldArray::Confidence}) {
    options.array = array;
    expectAsOnTheCpu(field, options);
  }
  options.array = FieldArray::Distance;
  const Field other =
      sampled(cube(40, 2.0), [](const glm::dvec3& p) { return notchedBox(p + glm::dvec3(0.02, 0.05, 0.0)); });
  options.other = &other;
  for (const double range : {0.0, 0.2}) {
    options.range = range;
    expectAsOnTheCpu(field, options);
  }
}

TEST_F(VulkanRender, NarrowBands) {
  size_t view = 0;  // Each band is drawn in two views of four.
  for (const Field& band : someBands()) {
    const double width = std::min(band.narrow->inside, band.narrow->outside);
    const glm::dvec3 middle = band.grid.position(0.5 * glm::dvec3(band.grid.dims - 1));
    const RenderOptions views[] = {
        {.direction = {0.3, 1.0, 0.2}, .iso = 0.5 * width},
        {.cut = true, .shell = 0.6 * width},
        {.direction = {1, 0.1, 0}, .fieldOfView = 100.0, .eye = middle + 0.1},
        {.slice = Plane{{0.2, 0.1, 1.0}, 0.05}},
    };
    for (int n = 0; n < 2; ++n) expectAsOnTheCpu(band, views[view++ % std::size(views)]);
  }
}

TEST_F(VulkanRender, NumbersOfNarrowBandsInColour) {
  const std::vector<Field> bands = someBands();
  const Field& band = bands.front();
  RenderOptions options{.cutPlane = Plane{{2.0, 1.0, 0.0}, 0.4}, .slice = Plane{{0.0, 0.2, 1.0}, 0.1}};
  for (const FieldArray array : {FieldArray::Winding, FieldArray::Confidence}) {
    options.array = array;
    expectAsOnTheCpu(band, options);
    // The CPU draws violet what the band does not know, and so does the device.
    const Picture picture = renderField(band, options, {.device = "cpu"});
    size_t violet = 0;
    for (size_t p = 0; p < picture.rgb.size(); p += 3)
      violet += picture.rgb[p] == 140 && picture.rgb[p + 1] == 60 && picture.rgb[p + 2] == 160 ? 1 : 0;
    EXPECT_GT(violet, 1000u);
  }
}

TEST_F(VulkanRender, NoMoreThanKernelsCanNumber) {
  RenderFieldStage::checkSize(2147483647, 2147483647);
  const auto refused = [](size_t samples, size_t words) -> std::string {
    try {
      RenderFieldStage::checkSize(samples, words);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refused(size_t{4194304} * NarrowBand::kLeafSamples, 8),
            "the field has 2147483648 samples; a device draws up to 2147483647, draw it on the CPU");
  EXPECT_EQ(
      refused(512, 2147483648),
      "the field has 2147483648 words in the index of its leaves; a device draws up to 2147483647, draw it "
      "on the CPU");
}

TEST_F(VulkanRender, BandsWithFewSamples) {
  const Mesh ball = shapes::sphere(1.0, 2);
  expectAsOnTheCpu(Surface(ball).generateBand({{200, 1, 150}, {-1.4, 0.1, -1.2}, 0.014}));
  expectAsOnTheCpu(Surface(ball).generateBand({{1, 1, 90}, {0.0, 0.0, -1.0}, 0.02}));
  expectAsOnTheCpu(Surface(ball).generateBand({{30, 30, 30}, {5.0, 5.0, 5.0}, 0.1}));  // Nothing is near.
}

// A dense field of as many samples would need 1.6 GB.
TEST_F(VulkanRender, RaysOfALargeBandTakeFewSteps) {
  const Mesh ball = shapes::sphere(1.0, 4);
  const Field band = Surface(ball).generateBand(fitGrid(ball, {.resolution = 740}));
  expectAsOnTheCpu(band, {.slice = Plane{{0.0, 0.3, 1.0}, 0.2}});
  expectAsOnTheCpu(band, {.cut = true});
  const auto stepsOf = [&](const Field& drawn) {
    const DrawnScene scene(drawn, {.width = 64, .height = 48});
    const DeviceBuffer samples = upload(drawn.distance), index = upload(scene.shape.field().leafIndex(1.0)),
                       steps = upload(std::vector<uint32_t>{0});
    DeviceBuffer pixels(device(), "pixels");
    pixels.resize<uint32_t>(size_t{64} * 48);
    RenderFieldStage stage(device());
    run([&](Commands& commands) {
      stage.recordScene(commands, scene, 64, 48, {}, index.address());
      stage.recordRows(commands, {samples.address(), float(1.0 / drawn.grid.spacing)},
                       {.colour = pixels.address(), .steps = steps.address()}, 0, 48);
    });
    return download<uint32_t>(steps).at(0) / (64.0 * 48.0);
  };
  EXPECT_LT(stepsOf(band), 40.0);  // 126 without jumps over cubes without leaves.
}

// Another kernel, here an upload, left the field on the device, in the mesh's units.
TEST_F(VulkanRender, AFieldThatIsOnTheDevice) {
  const Field field = torus(32);
  const RenderOptions options{.width = 120, .height = 90, .frame = Box{glm::dvec3(-1.0), glm::dvec3(1.0)}};
  const Picture theirs = renderField(field, options, {.device = "cpu"});
  const DeviceBuffer samples = upload(field.distance);
  DeviceBuffer pixels(device(), "pixels"), depth(device(), "depth");
  pixels.resize<uint32_t>(120 * 90);
  depth.resize<float>(120 * 90);
  const Field elsewhere{.grid = field.grid};
  const DrawnScene scene(elsewhere, options);
  RenderFieldStage stage(device());
  run([&](Commands& commands) {
    stage.recordScene(commands, scene, 120, 90, {});
    stage.recordRows(commands, {samples.address(), float(1.0 / field.grid.spacing)},
                     {pixels.address(), depth.address()}, 0, 90);
  });
  requireSamePicture(pictureOf(download<uint32_t>(pixels), 120, 90), theirs);
  // The depth leads from the eye to the torus, and is the largest float where the background is.
  const std::vector<float> depths = download<float>(depth);
  int seen = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 120; ++x) {
      const float away = depths[size_t(y) * 120 + size_t(x)];
      if (away == std::numeric_limits<float>::max()) continue;
      const Ray ray = scene.camera.ray(x + 0.5, y + 0.5);
      const glm::dvec3 p = ray.origin + double(away) / field.grid.spacing * ray.direction;
      EXPECT_LT(analytic::torus(field.grid.origin + p * field.grid.spacing, 0.6, 0.25), 0.02);
      ++seen;
    }
  EXPECT_EQ(depths[0], std::numeric_limits<float>::max());
  EXPECT_GT(seen, 900);
}

TEST_F(VulkanRender, UnsignedAndBanded) {
  expectAsOnTheCpu(sampled(cube(32, 2.0), [](const glm::dvec3& p) { return std::abs(notchedBox(p)); }));
  Field banded =
      sampled(cube(48, 2.0), [](const glm::dvec3& p) { return std::clamp(notchedBox(p), -0.2, 0.2); });
  banded.clampDistance = 0.2;
  expectAsOnTheCpu(banded);
  expectAsOnTheCpu(banded, {.cut = true, .shell = 0.1});
}

TEST_F(VulkanRender, GridsThatCutTheShape) {
  expectAsOnTheCpu(sampled({{40, 20, 30}, {-0.5, -0.2, -0.4}, 0.03}, notchedBox));
  expectAsOnTheCpu(sampled({{30, 30, 1}, {-1.0, -1.0, 0.0}, 0.07}, notchedBox));
  expectAsOnTheCpu(sampled({{1, 1, 90}, {0.0, 0.0, -1.0}, 0.02}, notchedBox));
  expectAsOnTheCpu(sampled({{1, 1, 1}, {0.0, 0.0, 0.0}, 1.0}, notchedBox));
}

TEST_F(VulkanRender, HugeAndTinyValues) {
  for (const double depth : {50.0, 1e30})
    expectAsOnTheCpu(sampled(cube(16, 2.0), [&](const glm::dvec3&) { return -depth; }), {.cut = true});
  expectAsOnTheCpu(sampled(cube(8, 2.0), [](const glm::dvec3&) { return 1e30; }));
  for (const double scale : {1e-20, 1e20}) {
    Field field = torus(32);
    for (float& d : field.distance) d = float(d * scale);
    field.grid.spacing *= scale;
    field.grid.origin *= scale;
    expectAsOnTheCpu(field, {.cut = true, .shell = 0.1 * scale});
  }
}

TEST_F(VulkanRender, RealMeshes) {
  const std::vector<std::string> names = wellFormedMeshes();
  RAYMAP_NEED_MESHES();
  for (size_t n = 0; n < names.size(); n += 1 + names.size() / 6) {
    SCOPED_TRACE(names[n]);
    const Mesh mesh = readMesh(meshFolder() / names[n]);
    const Field field = generate(mesh, fitGrid(mesh, {.resolution = 40}), {}, {.device = "cpu"}).field;
    expectAsOnTheCpu(field);
    expectAsOnTheCpu(field, {.cut = true, .shell = 3.0 * field.grid.spacing});
  }
}

TEST_F(VulkanRender, AnEyeFarAway) {
  expectAsOnTheCpu(torus(48), {.fieldOfView = 1.0});
}

TEST_F(VulkanRender, PicturesOfAnySize) {
  const Field field = torus(24);
  for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(7, 61), glm::ivec2(130, 3)}) {
    RenderOptions options{.width = size.x, .height = size.y};
    const Picture ours = draw(field, options);
    requireSamePicture(ours, renderField(field, options, {.device = "cpu"}));
  }
}

TEST_F(VulkanRender, ReportsProgressAndStops) {
  const Field field = torus(24);
  int calls = 0;
  double last = 0.0;
  const RenderOptions options{.width = 40, .height = 120};
  const auto note = [&](std::string_view, double done) {
    EXPECT_GE(done, last);
    last = done;
    return ++calls > 0;
  };
  draw(field, options, note);
  EXPECT_GT(calls, 1);
  EXPECT_EQ(last, 1.0);
  try {
    draw(field, options, [](std::string_view, double) { return false; });
    FAIL() << "not stopped";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Cancelled);
  }
}

TEST_F(VulkanRender, RefusesShapesThatItsLoopsCannotCross) {
  const Field needle = sampled({{1, 1, 40000}, {0, 0, 0}, 1.0}, [](const glm::dvec3&) { return -1.0; });
  try {
    draw(needle, {.width = 4, .height = 4});
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
  }
}

TEST_F(VulkanRender, ByName) {
  const Field field = torus(24);
  const RenderOptions options{.width = 64, .height = 48};
  const Picture ours = renderField(field, options, {.device = "vulkan"});
  requireSamePicture(ours, renderField(field, options, {.device = "cpu"}));
  const Field band = toSparse(field);
  requireSamePicture(renderField(band, options, {.device = "vulkan"}),
                     renderField(band, options, {.device = "cpu"}));
  RenderOptions ofBoth = options;
  ofBoth.other = &field;
  EXPECT_EQ(codeOf([&] { renderField(band, ofBoth, {.device = "vulkan"}); }), ErrorCode::Usage);
  for (const auto& [name, code] :
       {std::pair("gpu", ErrorCode::Usage), std::pair("vulkan:99", ErrorCode::Unsupported)}) {
    try {
      renderField(field, options, {.device = name});
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code);
    }
  }
}

}  // namespace
}  // namespace raymap::vulkan
