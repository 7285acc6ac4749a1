#include <cstring>

#include "cli.h"

namespace raymap {
namespace {

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

class CliSequence : public Cli {
 protected:
  /// Writes a torus with two clips of a second: "slide" moves it by 4 along x, "swell" makes it larger by
  /// a multiple of its size.
  void writeTori(float swollen = 1.0F) const {
    const Mesh torus = shapes::torus(2.0, 0.7, 24, 12);
    const std::string positions = bytesOf(torus.vertices), triangles = bytesOf(torus.triangles);
    const std::string keys = bytesOf<float>({0, 1, 0, 0, 0, 4, 0, 0, 0, swollen});
    const std::string buffer = positions + triangles + keys;
    const auto at = [](size_t offset) { return R"({"bufferView":0,"byteOffset":)" + std::to_string(offset); };
    const size_t end = positions.size() + triangles.size();
    const std::string vertices = R"(,"componentType":5126,"type":"VEC3","count":)";
    const std::string scalars = R"(,"componentType":5126,"type":"SCALAR","count":2})";
    std::string json =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"targets":[{"POSITION":0}]}]}],)"
        R"("animations":[{"name":"slide","channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],)"
        R"("samplers":[{"input":2,"output":3}]},{"name":"swell","channels":[{"sampler":0,)"
        R"("target":{"node":0,"path":"weights"}}],"samplers":[{"input":2,"output":4}]}],"accessors":[)" +
        at(0) + vertices + std::to_string(torus.vertices.size()) + "}," + at(positions.size()) +
        R"(,"componentType":5125,"type":"SCALAR","count":)" + std::to_string(3 * torus.triangles.size()) +
        "}," + at(end) + scalars + "," + at(end + 8) + vertices + "2}," + at(end + 32) + scalars +
        R"(],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(buffer.size()) +
        R"(}],"buffers":[{"byteLength":)" + std::to_string(buffer.size()) + "}]}";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto chunk = [](const char* name, const std::string& bytes) {
      return bytesOf<uint32_t>({uint32_t(bytes.size())}) + std::string(name, 4) + bytes;
    };
    const std::string chunks = chunk("JSON", json) + chunk("BIN\0", buffer);
    std::ofstream(path("torus.glb"), std::ios::binary)
        << "glTF" << bytesOf<uint32_t>({2, uint32_t(12 + chunks.size())}) << chunks;
  }

  /// Writes tori of different topology, numbered 3 to 5.
  void writeNumbered() const {
    for (int k = 3; k <= 5; ++k)
      writeMesh(path("t" + std::to_string(k) + ".ply"), shapes::torus(2.0 + k, 0.7, 16 + k, 10 + k));
  }
};

TEST_F(CliSequence, AllowsFramesWithoutTriangles) {
  writeNumbered();
  std::ofstream(path("t4.ply"))
      << "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float "
         "y\nproperty float z\nelement face 0\nproperty list uchar int "
         "vertex_indices\nend_header\n";
  const std::string make = "generate t%d.ply --frames 3:5 -o f%d.npz --resolution 16 --band 2 --device cpu";
  EXPECT_NE(run(make).err.find("t4.ply: the file has no triangles; --allow-empty"), std::string::npos);
  succeed(make + " --allow-empty");
  const Field before = readField(path("f3.npz")), empty = readField(path("f4.npz")),
              after = readField(path("f5.npz"));
  EXPECT_EQ(empty.grid, before.grid);  // That of the other frames.
  EXPECT_EQ(empty.distance[0], before.distance[0]);
  EXPECT_TRUE(std::ranges::all_of(empty.distance, [&](float d) { return d == before.distance[0]; }));
  EXPECT_LT(*std::ranges::min_element(after.distance), 0.0f);
}

TEST_F(CliSequence, MakesTheFieldsOfSinglePoses) {
  writeTori();
  const Result result = succeed(
      "generate torus.glb --frames 0:24:12 --clip slide --resolution 24 -o t.%03d.nrrd --winding w%d.npy "
      "--device cpu --stats stats.json");
  const AnimatedMesh animated = readAnimatedMesh(path("torus.glb"), "slide");
  Box box;
  for (const double seconds : {0.0, 0.5, 1.0}) {
    const Box each = bounds(posed(animated, seconds));
    box = {glm::min(box.min, each.min), glm::max(box.max, each.max)};
  }
  EXPECT_NEAR(box.size().x, 5.4 + 4.0, 1e-5);
  const Grid grid = fitGrid(box, {.resolution = 24});
  const Json stats = json("stats.json")["frames"];
  ASSERT_EQ(stats.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const std::string name = std::string("t.0") + (k == 0 ? "00" : k == 1 ? "12" : "24") + ".nrrd";
    EXPECT_NE(result.out.find("wrote " + name), std::string::npos) << result.out;
    const Field field = readField(path(name));
    EXPECT_EQ(field.grid, grid);
    EXPECT_TRUE(std::ranges::equal(
        field.distance, generate(posed(animated, 0.5 * k), grid, {}, {.device = "cpu"}).field.distance));
    EXPECT_TRUE(fs::exists(path("w" + std::to_string(12 * k) + ".npy")));
    EXPECT_EQ(stats[size_t(k)]["frame"], 12 * k);
    EXPECT_EQ(stats[size_t(k)]["diagnostics"]["triangles"], animated.rest.triangles.size());
  }
  EXPECT_EQ(fileCount(), 8u);
}

TEST_F(CliSequence, TakesTheTimeFromTheRate) {
  writeTori();
  succeed("generate torus.glb --frames 5 --fps 10 --clip 1 --resolution 16 -o swell%d.nrrd");
  const Box box = readField(path("swell5.nrrd")).surfaceBounds;
  EXPECT_NEAR(box.size().x, 1.5 * 5.4, 0.2);
}

TEST_F(CliSequence, KeepsTheLastPoseAndSaysSo) {
  writeTori();
  const Result result = run("generate torus.glb --frames 24:30:6 --resolution 16 -o t%d.npy");
  EXPECT_EQ(result.code, 0);
  EXPECT_NE(result.err.find("it has the animations 0 'slide', 1 'swell'; the first is taken"),
            std::string::npos);
  EXPECT_NE(result.err.find("the clip ends with frame 24; later ones keep its last pose"), std::string::npos);
  EXPECT_EQ(readBytes(path("t24.npy")), readBytes(path("t30.npy")));
}

TEST_F(CliSequence, ReadsNumberedMeshes) {
  writeNumbered();
  succeed("generate t%d.ply --frames 3:5 --voxel-size 0.5 -o t%d.nrrd --report r%02d.json --device cpu");
  Box box;
  for (int k = 3; k <= 5; ++k) {
    const Box each = bounds(readMesh(path("t" + std::to_string(k) + ".ply")));
    box = {glm::min(box.min, each.min), glm::max(box.max, each.max)};
  }
  for (int k = 3; k <= 5; ++k) {
    const Mesh mesh = readMesh(path("t" + std::to_string(k) + ".ply"));
    const Grid grid = fitGrid(box, {.voxelSize = 0.5});
    const Field field = readField(path("t" + std::to_string(k) + ".nrrd"));
    EXPECT_EQ(field.grid, grid);
    EXPECT_TRUE(
        std::ranges::equal(field.distance, generate(mesh, grid, {}, {.device = "cpu"}).field.distance));
    EXPECT_TRUE(fs::exists(path("r0" + std::to_string(k) + ".json")));
  }
  succeed("generate t%d.ply --frames 3:5 --bounds 0 0 0 4 4 4 --resolution 8 -o b%d.nrrd");
  EXPECT_EQ(readField(path("b4.nrrd")).grid,
            fitGrid(Box{{0, 0, 0}, {4, 4, 4}}, {.resolution = 8, .padding = 0}));
  EXPECT_EQ(run("generate t%d.ply --frames 3:5 --shape 6 5 4 -o s%d.nrrd").code, 0);
  EXPECT_EQ(readField(path("s5.nrrd")).grid, fitGrid(box, {.dims = glm::ivec3(6, 5, 4)}));
}

TEST_F(CliSequence, DrawsEachFrame) {
  writeTori();
  succeed("render torus.glb --frames 0:24:24 --clip slide --resolution 24 --size 80 60 -o t%d.png");
  EXPECT_NE(readBytes(path("t0.png")), readBytes(path("t24.png")));
  // A field of each frame gives the same pictures.
  succeed("generate torus.glb --frames 0:24:24 --clip slide --resolution 24 -o t%d.nrrd");
  succeed("render t%d.nrrd --frames 0:24:24 --size 80 60 -o f%d.png");
  EXPECT_TRUE(fs::exists(path("f24.png")));
  succeed("render t%d.nrrd --frames 0:24:24 --slice z --size 80 60 -o s%d.png");
  EXPECT_NE(readBytes(path("s0.png")), readBytes(path("s24.png")));
}

TEST_F(CliSequence, GivesFfmpegThePicturesOfAMovie) {
  writeTori();
  const std::string render =
      "render torus.glb --frames 0:24:12 --clip slide --resolution 16 --size 80 60 -o ";
  const Result absent = run(render + "m.mp4", "PATH=nowhere");
  EXPECT_EQ(absent.code, exitCode(ErrorCode::Unsupported));
  EXPECT_NE(absent.err.find("m.mp4: an MP4 needs ffmpeg, which no folder of PATH has"), std::string::npos);
  fs::create_directory(path("bin"));
  const auto writeFfmpeg = [&](const std::string& script) {
    std::ofstream(path("bin/ffmpeg")) << "#!/bin/sh\n" << script;
    fs::permissions(path("bin/ffmpeg"), fs::perms::owner_all);
  };
  writeFfmpeg("echo \"$@\" > words; ulimit -d > limit; cat > pictures; printf movie > /dev/fd/3\n");
  EXPECT_EQ(run(render + "'a;b $x.mp4' --memory-limit 4GB", "PATH=$PWD/bin:$PATH").code, 0);
  EXPECT_EQ(readBytes(path("a;b $x.mp4")), "movie");
  EXPECT_EQ(readBytes(path("limit")), shell("ulimit -d").out) << "The limit is one of raymap.";
  EXPECT_EQ(fs::file_size(path("pictures")), 3u * 80 * 60 * 3);
  const std::string words = readBytes(path("words"));
  EXPECT_NE(words.find("-s 80x60 -r 2 "), std::string::npos) << words;
  writeFfmpeg("cat > /dev/null; echo first >&2; echo 'no encoder' >&2; exit 3\n");
  const Result failed = run(render + "c.mp4", "PATH=$PWD/bin:$PATH");
  EXPECT_EQ(failed.code, exitCode(ErrorCode::File));
  EXPECT_NE(failed.err.find("c.mp4: ffmpeg failed with the code 3: no encoder\n"), std::string::npos)
      << failed.err;
  EXPECT_FALSE(fs::exists(path("c.mp4")));
}

TEST_F(CliSequence, SaysWhatIsWrong) {
  writeTori();
  writeNumbered();
  const auto refuse = [&](const std::string& arguments, const std::string& message) {
    expectFailure(arguments, ErrorCode::Usage, message);
  };
  for (const char* frames : {"5:2", "a", "1:", "-1:2", "1:2:0", "1:2:3:4", "1,2"})
    refuse(std::string("generate t%d.ply -o t%d.vdb --frames=") + frames,
           "must be FIRST:LAST or FIRST:LAST:STEP");
  for (const char* name : {"t.vdb", "t%dx%d.vdb", "t%4d.vdb", "t%x.vdb", "t%04.vdb"})
    refuse(std::string("generate t%d.ply --frames 3:5 -o ") + name, "holds the number of the frame once");
  refuse("generate t3.ply --frames 3:5 -o t%d.vdb", "t3.%04d.ply");
  refuse("generate t%d.ply --frames 3:5 --clip x -o t%d.vdb", "--clip is for an animated");
  refuse("generate torus.glb --clip slide -o t.vdb", "--frames");
  refuse("generate torus.glb --frames 0:1 --clip run -o t%d.vdb", "it has 0 'slide', 1 'swell'");
  refuse("render t%d.ply --frames 3:5 -o t.mp4.gif", ".mp4");
  refuse("render t3.ply -o t.mp4", ".png");
  expectFailure("generate t%d.ply --frames 3:6 -o t%d.vdb", ErrorCode::File,
                "t6.ply: there is no such file, and --frames 3:6 asks for it");
  EXPECT_EQ(fileCount(), 4u);
}

TEST_F(CliSequence, TakesTheNamesOfOtherPrograms) {
  writeNumbered();
  for (const char* name : {"a.$F4.npz", "b.####.npz", "c.%04d.npz"})
    succeed("generate t%d.ply --frames 3:3 --resolution 24 --device cpu -o '" + std::string(name) + "'");
  for (const char* name : {"a.0003.npz", "b.0003.npz", "c.0003.npz"})
    EXPECT_TRUE(std::filesystem::exists(path(name)));
  for (const char* name : {"$F-#.%d.npz", "#-$F.npz", "#.npz"})
    succeed("generate 't$F.ply' --frames 4:4 --resolution 24 --device cpu -o '" + std::string(name) + "'");
  for (const char* name : {"$F-#.4.npz", "#-4.npz", "4.npz"})
    EXPECT_TRUE(std::filesystem::exists(path(name)));
  succeed("generate 't#.ply' --frames 3:5 --resolution 24 --device cpu -o 'long##.npz'");
  EXPECT_TRUE(std::filesystem::exists(path("long05.npz")));
  for (const char* name : {"#.#.npz", "$F.$F4.npz", "%d.%04d.npz", "%d%.npz", "%5d.npz", "plain.npz"})
    expectFailure("generate t%d.ply --frames 3:3 -o '" + std::string(name) + "'", ErrorCode::Usage,
                  "with --frames a name holds the number of the frame once, as %d, %04d, $F4 or ####");
}

TEST_F(CliSequence, StartsAtAnyFrame) {
  writeTori();
  const std::string make =
      "generate torus.glb --clip slide --resolution 12 --device cpu --bounds -4 -4 -4 9 4 4 ";
  succeed(make + "--frames 6:18:12 -o a%d.npz");
  const Result moved = run(make + "--frames 1007:1031:12 --start-frame 1001 -o b%d.npz");
  for (const int frame : {6, 18})
    EXPECT_TRUE(std::ranges::equal(readField(path("a" + std::to_string(frame) + ".npz")).distance,
                                   readField(path("b" + std::to_string(frame + 1001) + ".npz")).distance));
  EXPECT_NE(moved.err.find("the clip ends with frame 1025"), std::string::npos) << moved.err;
  writeNumbered();
  expectFailure("generate t%d.ply --frames 3:5 --start-frame 3 -o c%d.npz", ErrorCode::Usage,
                "--start-frame is for an animated .gltf or .glb; leave it out for numbered files");
}

TEST_F(CliSequence, NamesTheFrameThatGrowsBeyondAllNumbers) {
  writeTori(3e38F);
  expectFailure("render torus.glb --frames 0:24:24 --clip swell -o t%d.png", ErrorCode::Input,
                "torus.glb: frame 24: vertex 0 of triangle 0 is not finite");
}

TEST_F(CliSequence, KeepsItsInputs) {
  writeNumbered();
  fs::create_symlink(path("t4.ply"), path("x5.nrrd"));
  expectFailure("generate t%d.ply --frames 3:5 -o x%d.nrrd", ErrorCode::Usage,
                "--output x5.nrrd: is the input t4.ply");
  EXPECT_EQ(fileCount(), 4u);
}

}  // namespace
}  // namespace raymap
