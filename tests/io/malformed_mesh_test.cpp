// Damaged files of every format: each gives an Error that names the file, without taking much memory.

#include <gtest/gtest.h>
#include <malloc.h>
#include <raymap/io.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <new>

#include "files.h"
#include "import_samples.h"
#include "samples_3mf.h"

namespace {
// Bytes held by operator new, to measure a reader's memory.
std::atomic<size_t> held{0};
std::atomic<size_t> peak{0};
}  // namespace

void* operator new(size_t size) {
  void* memory = std::malloc(size);
  if (!memory) throw std::bad_alloc();
  const size_t now = held += malloc_usable_size(memory);
  for (size_t before = peak; before < now && !peak.compare_exchange_weak(before, now);) {
  }
  return memory;
}
void operator delete(void* memory) noexcept {
  held -= malloc_usable_size(memory);
  std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
  operator delete(memory);
}

namespace raymap {
namespace {

using namespace samples;

struct Sample {
  std::string extension;
  std::string bytes;
};

std::vector<Sample> wholeFiles() {
  return {{".obj", kObj},
          {".off", kOff},
          {".stl", kTextStl},
          {".stl", binaryStl()},
          {".ply", kTextPly},
          {".ply", binaryPly()},
          {".ply", binaryPly(true)},
          {".glb", glb()},
          {".3mf", threeMf()},
          {".off", binaryOff()},
          {".off", "OFF\n8 1 0\n" + cornersOfU() + "8" + faceOfU(1, false)},
          {".obj", cornersOfU("v ") + "f" + faceOfU(1, true, 1)}};
}

std::vector<Sample> importedFiles() {
  return {{".dae", dae()}, {".fbx", fbx()}};
}

/// Returns the Error's message; empty if the file was read. Fails if reading took too much memory or the
/// message lacks the name.
std::string refusal(const Sample& sample) {
  const TemporaryFile file("malformed" + sample.extension, sample.bytes);
  constexpr size_t kMost = size_t{50} << 20;
  std::string message;
  peak = held.load();
  const size_t before = held;
  try {
    validate(readMesh(file.path()));
  } catch (const Error& error) {
    message = error.what();
    EXPECT_TRUE(contains(message, file.path().string()));
    EXPECT_NE(error.code(), ErrorCode::Memory) << message;
  }
  EXPECT_LT(peak - before, kMost);
  return message;
}

TEST(MalformedMesh, CutShort) {
  for (const Sample& whole : wholeFiles()) {
    const bool countsItsParts = whole.extension != ".obj" && whole.bytes != kTextStl;
    for (size_t size = 0; size + 2 < whole.bytes.size(); ++size) {
      const std::string message = refusal({whole.extension, whole.bytes.substr(0, size)});
      EXPECT_TRUE(!message.empty() || !countsItsParts) << whole.extension << " cut to " << size << " bytes";
    }
  }
}

TEST(MalformedMesh, CutShortForTheImporter) {
  for (const Sample& whole : importedFiles())
    for (size_t part = 0; part < 8; ++part) {
      const size_t size = whole.bytes.size() * part / 8;
      EXPECT_NE(refusal({whole.extension, whole.bytes.substr(0, size)}), "")
          << whole.extension << " cut to " << size << " bytes";
    }
}

TEST(MalformedMesh, ZeroBytesAndNoise) {
  std::string noise;
  uint32_t state = 1;
  for (int i = 0; i < 4096; ++i) noise += static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
  for (const char* extension : {".obj", ".off", ".stl", ".ply", ".gltf", ".glb", ".3mf", ".dae", ".fbx"}) {
    EXPECT_NE(refusal({extension, ""}), "") << extension;
    EXPECT_NE(refusal({extension, std::string(4096, '\0')}), "") << extension;
    EXPECT_NE(refusal({extension, noise}), "") << extension;
  }
}

TEST(MalformedMesh, OneFormatUnderTheNameOfAnother) {
  for (const Sample& sample : wholeFiles())
    for (const char* extension : {".obj", ".off", ".stl", ".ply", ".gltf", ".3mf", ".dae", ".fbx"}) {
      const bool same =
          sample.extension == extension || (sample.extension == ".glb" && extension == std::string(".gltf"));
      if (same) continue;
      EXPECT_NE(refusal({extension, sample.bytes}), "") << sample.extension << " named " << extension;
    }
}

TEST(MalformedMesh, AnyByteChanged) {
  // A file that is read in spite of the change is valid (see refusal).
  for (const Sample& whole : wholeFiles())
    for (size_t at = 0; at < whole.bytes.size(); ++at)
      for (const char value : {'\0', '9', '-', '\xff'}) {
        Sample damaged = whole;
        damaged.bytes[at] = value;
        refusal(damaged);
      }
}

TEST(MalformedMesh, HugeCounts) {
  const std::string many = "4000000000";
  EXPECT_TRUE(contains(refusal({".off", replaced(kOff, "4 1 0", many + " 1 0")}), many));
  EXPECT_TRUE(contains(refusal({".off", replaced(kOff, "4 1 0", "4 " + many + " 0")}), many));
  EXPECT_NE(refusal({".off", replaced(kOff, "4 0 1 2 3", many + " 0 1 2 3")}), "");
  EXPECT_TRUE(contains(refusal({".stl", binaryStl(2000000000u)}), "2000000000"));
  EXPECT_EQ(refusal({".stl", binaryStl(4000000000u)}), "") << "the size tells the truth";
  EXPECT_NE(
      refusal({".off", replaced(binaryOff(), raw<int32_t>({4, 1}, true), raw(4000000000u) + raw(1, true))}),
      "");
  for (const std::string& whole : {kTextPly, binaryPly()}) {
    EXPECT_TRUE(contains(refusal({".ply", replaced(whole, "vertex 4", "vertex " + many)}), many));
    EXPECT_TRUE(contains(refusal({".ply", replaced(whole, "face 1", "face " + many)}), many));
    EXPECT_NE(refusal({".ply", replaced(whole, "face 1", "face 99999999999999999999")}), "");
  }
  std::string hugeList = replaced(binaryPly(), "list uchar", "list uint");
  hugeList.replace(hugeList.size() - 17, 1, raw(4000000000u));
  EXPECT_TRUE(contains(refusal({".ply", hugeList}), many));
  EXPECT_TRUE(contains(
      refusal({".glb", glb(replaced(gltf(R"("byteLength":60)"), R"("count":4)", R"("count":)" + many))}),
      many));
  EXPECT_TRUE(contains(refusal({".glb", replaced(glb(), raw(60u) + "BIN", raw(4000000000u) + "BIN")}), many));
  EXPECT_NE(refusal({".fbx", replaced(fbx(), "*12", "*" + many)}), "");
}

TEST(MalformedMesh, NotFinite) {
  for (const Sample& whole : wholeFiles()) {
    if (whole.bytes.find("1 1 0") == std::string::npos) continue;
    for (const char* value : {"nan", "-inf", "1e999"})
      EXPECT_TRUE(contains(
          refusal({whole.extension, replaced(whole.bytes, "1 1 0", std::string("1 ") + value + " 0")}),
          "is not finite"));
  }
  for (const Sample& whole :
       {Sample{".stl", binaryStl()}, Sample{".ply", binaryPly()}, Sample{".glb", glb()}})
    EXPECT_TRUE(contains(
        refusal({whole.extension, replaced(whole.bytes, raw<float>({1, 1, 0}), raw<float>({1, NAN, 0}))}),
        "is not finite"));
}

TEST(MalformedMesh, DeepNesting) {
  const size_t depth = 100000;
  EXPECT_NE(refusal({".gltf", std::string(depth, '[')}), "");
  EXPECT_NE(refusal({".gltf", R"({"extras":)" + std::string(depth, '[') + std::string(depth, ']') + "}"}),
            "");
  std::string nodes;
  for (size_t i = 0; i < depth; ++i) nodes += R"({"children":[)" + std::to_string(i + 1) + "]},";
  EXPECT_EQ(refusal({".glb", glb(gltf(R"("byteLength":60)", nodes + R"({"mesh":0})"))}), "")
      << "deep, but right";
}

TEST(MalformedMesh, NoFileAtAll) {
  const auto message = [](const std::filesystem::path& path) -> std::string {
    try {
      readMesh(path);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(message("/nonexistent/mesh.ply"),
            "/nonexistent/mesh.ply: cannot read it: No such file or directory");
  EXPECT_EQ(message("/nonexistent/mesh.fbx"),
            "/nonexistent/mesh.fbx: cannot read it: No such file or directory");
  EXPECT_TRUE(contains(message("/nonexistent/mesh.doc"), "mesh.doc: no such file"));
  EXPECT_TRUE(contains(message("mesh"), "mesh: no such file"));
  const TemporaryFolder outer;
  const std::filesystem::path folder = outer.path() / "folder.stl";
  std::filesystem::create_directory(folder);
  EXPECT_TRUE(contains(message(folder), "it is a folder"));
}

}  // namespace
}  // namespace raymap
