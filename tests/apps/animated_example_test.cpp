#include <png.h>
#include <raymap/raymap.h>

#include "bending_tube.h"
#include "files.h"
#include "framing.h"
#include "mesh_folder.h"
#include "run_program.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap {
namespace {

constexpr int kFrames = 3, kResolution = 24, kSide = 64;

Picture readPng(const std::filesystem::path& path) {
  png_image image{.version = PNG_IMAGE_VERSION};
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) return {};
  image.format = PNG_FORMAT_RGB;
  Picture picture{int(image.width), int(image.height), std::vector<uint8_t>(PNG_IMAGE_SIZE(image))};
  png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr);
  return picture;
}

/// A test that is skipped where no device is usable.
class AnimatedExample : public vulkan::VulkanTest {
 protected:
  static ProgramRun run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), RAYMAP_ANIMATED_BINARY);
    if (const char* index = std::getenv("RAYMAP_VULKAN_DEVICE"))
      arguments.insert(arguments.end(), {"--device", index});
    return runProgram(arguments);
  }

  /// Runs a few frames of the mesh at `path` and compares each with the CPU's picture.
  static void expectTheCpusPictures(const AnimatedMesh& mesh, const std::filesystem::path& path) {
    const TemporaryFolder folder;
    std::vector<std::string> arguments{"-o", (folder.path() / "out").string()};
    for (const auto& [name, value] :
         {std::pair("--frames", kFrames), std::pair("--every", 2), std::pair("--resolution", kResolution)})
      arguments.insert(arguments.end(), {name, std::to_string(value)});
    arguments.insert(arguments.end(), {"--size", std::to_string(kSide) + "x" + std::to_string(kSide)});
    if (!path.empty()) arguments.push_back(path.string());
    const ProgramRun result = run(arguments);
    ASSERT_EQ(result.code, 0) << result.error;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/frame_00001.png"));
    const Box box = reach(mesh, kFrames);
    for (const int frame : {0, 2}) {
      const Mesh moved = posed(mesh, secondsOf(frame, kFrames, mesh));
      const Field field = generate(moved, gridOver(mesh, box, kResolution), {}, {.device = "cpu"}).field;
      vulkan::requireSamePicture(
          readPng(folder.path() / ("out/frame_0000" + std::to_string(frame) + ".png")),
          renderField(field, {.width = kSide, .height = kSide, .frame = box}, {.device = "cpu"}));
    }
  }
};

TEST_F(AnimatedExample, DrawsATube) {
  expectTheCpusPictures(bendingTube(), {});
}

TEST_F(AnimatedExample, DrawsASkinnedFile) {
  const std::filesystem::path path = meshFolder() / "draco__CesiumMan.glb";
  RAYMAP_NEED_MESHES();
  expectTheCpusPictures(readAnimatedMesh(path), path);
}

TEST_F(AnimatedExample, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string out = folder.path().string();
  ProgramRun result = run({"-o", out, (folder.path() / "missing.glb").string()});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("missing.glb: cannot read"), std::string::npos) << result.error;
  EXPECT_EQ(run({}).code, 2);
  EXPECT_EQ(run({"-o", out, "--frames", "0"}).code, 2);
  EXPECT_EQ(run({"-o", out, "--size", "640"}).code, 2);
  EXPECT_EQ(run({"-o", out, "--device", "99"}).code, 2);
}

}  // namespace
}  // namespace raymap
