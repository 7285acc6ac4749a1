// A field of a moving mesh, made anew and drawn in every frame, by one command buffer a frame. Once the mesh
// is on the GPU nothing of it, of the field or of the picture crosses the bus: 48 bytes a joint go there, and
// the pictures that somebody asked for come back.
//
//   raymap_animated -o out                     a bending tube, 60 frames
//   raymap_animated man.glb -o out --every 1   a skinned glTF mesh, with a picture of every frame
//
// Read `Movie` from top to bottom: that is all there is to it.

#include <raymap/raymap.h>
#include <raymap/vulkan.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <string_view>

#include "bending_tube.h"
#include "framing.h"
#include "gpu.h"

namespace {

using raymap::AnimatedMesh;

struct Arguments {
  std::filesystem::path mesh, folder;
  size_t animation = 0;
  int frames = 60;
  int every = 10;
  int resolution = 64;
  int width = 640, height = 480;
  std::optional<uint32_t> device;
};

/// All that stays on the device, and what is done with it in a frame.
class Movie {
 public:
  Movie(Gpu& gpu, const AnimatedMesh& mesh, const Arguments& arguments)
      : gpu_(gpu), mesh_(mesh), generator_(gpu.handles()), skinner_(gpu.handles()), renderer_(gpu.handles()) {
    const raymap::Box box = reach(mesh, arguments.frames);
    grid_ = gridOver(mesh, box, arguments.resolution);
    view_ = {.width = arguments.width, .height = arguments.height, .frame = box};

    // Uploaded once.
    skin_ = {.rest = gpu.upload(mesh.rest.vertices).range(),
             .joints = gpu.upload(mesh.joints).range(),
             .weights = gpu.upload(mesh.weights).range(),
             .vertexCount = uint32_t(mesh.rest.vertices.size()),
             .jointCount = uint32_t(mesh.skeleton.size())};
    triangles_ = gpu.upload(mesh.rest.triangles);

    // Written on the device in every frame.
    matrices_ = gpu.makeBuffer(mesh.skeleton.size() * sizeof(raymap::JointMatrix));
    vertices_ = gpu.makeBuffer(mesh.rest.vertices.size() * sizeof(glm::vec3));
    distance_ = gpu.makeBuffer(grid_.sampleCount() * sizeof(float));
    pixels_ = gpu.makeBuffer(sizeof(uint32_t) * size_t(view_.width) * size_t(view_.height));
    picture_ = gpu.makeBuffer(pixels_.bytes, true);

    // All memory that the generator will ever want: recording allocates nothing.
    generator_.reserve({.vertices = skin_.vertexCount,
                        .triangles = uint32_t(mesh.rest.triangles.size()),
                        .dims = grid_.dims,
                        .distance = options_.distance,
                        .sign = options_.sign});
  }

  /// Makes and draws the frame; its picture comes back only if it is wanted.
  void run(double seconds, bool isWanted) {
    const VkCommandBuffer commands = gpu_.begin();
    gpu_.stamp();
    recordMatrices(commands, jointMatrices(mesh_, seconds));
    skin_.matrices = matrices_.range();
    skinner_.record(commands, skin_, vertices_.range());
    gpu_.stamp();
    // Each of raymap's recordings begins and ends with a barrier: they see each other's results as they are.
    generator_.record(commands,
                      {.vertices = vertices_.range(),
                       .vertexCount = skin_.vertexCount,
                       .triangles = triangles_.range(),
                       .triangleCount = uint32_t(mesh_.rest.triangles.size()),
                       .origin = mesh_.origin},
                      grid_, options_, {.distance = distance_.range()});
    gpu_.stamp();
    renderer_.record(commands, {.distance = distance_.range(), .grid = grid_}, view_,
                     {.pixels = pixels_.range()});
    gpu_.stamp();
    // With a window, this is where `pixels_` would go to the screen: vkCmdCopyBufferToImage into an image of
    // VK_FORMAT_R8G8B8A8_UNORM, then vkCmdBlitImage into that of the swapchain.
    if (isWanted) recordPicture(commands);
    // One frame at a time, to keep this short. A program that draws ahead has a command buffer, a fence and a
    // `picture_` for each frame on its way; all else may stay as it is, since work on one queue keeps its
    // order.
    gpu_.submitAndWait();
    // Nothing was checked on the way: the device leaves word of a mesh that it could not use.
    if (const std::optional<raymap::Error> error = generator_.status().error) throw *error;
  }

  /// Returns the picture of the frame that ran last, if it was wanted.
  raymap::Picture picture() const {
    raymap::Picture picture{.width = view_.width, .height = view_.height};
    const auto* pixels = static_cast<const uint32_t*>(picture_.mapped);
    for (size_t p = 0; p < picture_.bytes / sizeof(uint32_t); ++p)
      for (const int shift : {0, 8, 16}) picture.rgb.push_back(uint8_t(pixels[p] >> shift));
    return picture;
  }

 private:
  /// The few bytes that the host decides travel in the command buffer itself, 64 KiB at a time: no staging
  /// memory that a frame still on its way could be reading.
  void recordMatrices(VkCommandBuffer commands, const std::vector<raymap::JointMatrix>& matrices) const {
    constexpr VkDeviceSize kMost = 65536;
    const auto* bytes = reinterpret_cast<const std::byte*>(matrices.data());
    for (VkDeviceSize at = 0; at < matrices_.bytes; at += kMost)
      vkCmdUpdateBuffer(commands, matrices_.handle, at, std::min(kMost, matrices_.bytes - at), bytes + at);
  }

  void recordPicture(VkCommandBuffer commands) const {
    const VkBufferCopy all{.size = pixels_.bytes};
    vkCmdCopyBuffer(commands, pixels_.handle, picture_.handle, 1, &all);
    const VkMemoryBarrier toHost{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                 .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                 .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &toHost,
                         0, nullptr, 0, nullptr);
  }

  Gpu& gpu_;
  const AnimatedMesh& mesh_;
  raymap::vulkan::Generator generator_;
  raymap::vulkan::Skinner skinner_;
  raymap::vulkan::Renderer renderer_;
  raymap::Grid grid_;
  raymap::FieldOptions options_;
  raymap::RenderOptions view_;
  raymap::vulkan::SkinBuffers skin_;
  Buffer triangles_, matrices_, vertices_, distance_, pixels_, picture_;
};

constexpr const char* kStages[] = {"skin", "field", "picture"};

void print(const std::string& what, const std::vector<double>& times) {
  std::printf("%s:", what.c_str());
  for (size_t i = 0; i < std::min(times.size(), std::size(kStages)); ++i)
    std::printf(" %s %.3f ms", kStages[i], times[i]);
  std::printf("\n");
}

/// Returns the median time of each stage over all frames.
std::vector<double> medians(std::vector<std::vector<double>>& times) {
  std::vector<double> result;
  for (std::vector<double>& stage : times) {
    const auto middle = stage.begin() + std::ptrdiff_t(stage.size() / 2);
    std::nth_element(stage.begin(), middle, stage.end());
    result.push_back(*middle);
  }
  return result;
}

/// A frame takes faces as they point. So those that point the wrong way are turned once, beforehand, and the
/// other sides of double-sided ones are removed.
void turnWrongFaces(raymap::Mesh& mesh) {
  const raymap::Stats stats = generate(mesh, fitGrid(mesh, {.resolution = 64})).stats;
  turnFaces(mesh, stats.turnedFaces);
  removeFaces(mesh, stats.leftOutFaces);
}

void run(const Arguments& arguments) {
  const auto warn = [](const raymap::Warning& warning) {
    std::fprintf(stderr, "raymap_animated: warning: %s\n", warning.message.c_str());
  };
  AnimatedMesh mesh = arguments.mesh.empty()
                          ? bendingTube()
                          : raymap::readAnimatedMesh(arguments.mesh, arguments.animation, {.warn = warn});
  if (!mesh.morphs.empty())
    std::fprintf(stderr,
                 "raymap_animated: warning: its morph targets stay at rest: the GPU moves joints only\n");
  turnWrongFaces(mesh.rest);
  std::filesystem::create_directories(arguments.folder);
  Gpu gpu(arguments.device);
  std::printf("%zu triangles, %zu joints, on %s\n", mesh.rest.triangles.size(), mesh.skeleton.size(),
              gpu.name().c_str());
  Movie movie(gpu, mesh, arguments);
  std::vector<std::vector<double>> times;
  for (int frame = 0; frame < arguments.frames; ++frame) {
    const bool isWanted = frame % arguments.every == 0;
    movie.run(secondsOf(frame, arguments.frames, mesh), isWanted);
    const std::vector<double> took = gpu.times();
    times.resize(took.size());
    for (size_t i = 0; i < took.size(); ++i) times[i].push_back(took[i]);
    if (!isWanted) continue;
    char name[32];
    std::snprintf(name, sizeof name, "frame_%05d.png", frame);
    writePng(arguments.folder / name, movie.picture());
    print(name, took);
  }
  print("median of " + std::to_string(arguments.frames) + " frames", medians(times));
}

constexpr const char* kHelp = R"(Usage: raymap_animated [MESH] -o FOLDER [OPTIONS]
  MESH                    a glTF or GLB file (default: a bending tube)
  -o, --output FOLDER     folder for the pictures
  --animation N           which of the file's animations (default 0)
  --frames N              frames, once around (default 60)
  --every N               keep the picture of every so many frames (default 10)
  --resolution N          samples along the grid's longest side (default 64)
  --size WIDTHxHEIGHT     size of the pictures (default 640x480)
  --device K              which Vulkan device (default: a GPU if there is one))";

[[noreturn]] void refuse(const std::string& what) {
  throw raymap::Error(raymap::ErrorCode::Usage, what + "; see raymap_animated --help");
}

int numberFrom(int low, int high, const std::string& option, std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.begin(), text.end(), value);
  if (error != std::errc() || end != text.end() || value < low || value > high)
    refuse(option + ": must be from " + std::to_string(low) + " to " + std::to_string(high));
  return value;
}

void setOption(const std::string& option, const std::string& text, Arguments& arguments) {
  const auto number = [&](int low, int high) { return numberFrom(low, high, option, text); };
  if (option == "-o" || option == "--output") return void(arguments.folder = text);
  if (option == "--animation") return void(arguments.animation = size_t(number(0, 1000000)));
  if (option == "--frames") return void(arguments.frames = number(1, 1000000));
  if (option == "--every") return void(arguments.every = number(1, 1000000));
  if (option == "--resolution") return void(arguments.resolution = number(1, 2048));
  if (option == "--device") return void(arguments.device = uint32_t(number(0, 1000)));
  if (option != "--size") refuse("there is no option " + option);
  const size_t cross = std::min(text.find('x'), text.size() - 1);
  arguments.width = numberFrom(1, raymap::kMaxPictureSide, option, text.substr(0, cross));
  arguments.height = numberFrom(1, raymap::kMaxPictureSide, option, text.substr(cross + 1));
}

int parseAndRun(int argc, char** argv) {
  Arguments arguments;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "-h" || word == "--help") return std::puts(kHelp) < 0 ? 1 : 0;
    if (!word.starts_with('-'))
      arguments.mesh = word;
    else
      setOption(word, ++k < argc ? argv[k] : "", arguments);
  }
  if (arguments.folder.empty()) refuse("-o FOLDER is required");
  run(arguments);
  return 0;
}

int fail(int code, const char* why) {
  std::fprintf(stderr, "raymap_animated: error: %s\n", why);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return parseAndRun(argc, argv);
  } catch (const raymap::Error& error) {
    return fail(error.code() == raymap::ErrorCode::Usage ? 2 : 1, error.what());
  } catch (const std::exception& error) {
    return fail(1, error.what());
  }
}
