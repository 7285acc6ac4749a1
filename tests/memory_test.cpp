// The command line's peak memory for a default field at 256^3: at most 24 bytes a sample plus 200 bytes a
// triangle.

#include <gtest/gtest.h>
#include <raymap/raymap.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>

#include "shapes.h"

namespace raymap {

namespace {

void writeOff(const std::filesystem::path& path, const Mesh& mesh) {
  std::ofstream file(path);
  file.precision(17);
  file << "OFF\n" << mesh.vertices.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const glm::dvec3 p = mesh.position(v);
    file << p.x << ' ' << p.y << ' ' << p.z << '\n';
  }
  for (const glm::uvec3& t : mesh.triangles) file << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
  ASSERT_TRUE(file.flush());
}

/// Runs the command line; gives the largest resident size it had, in bytes.
size_t peakOf(std::vector<std::string> arguments) {
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  pid_t child = 0;
  EXPECT_EQ(posix_spawn(&child, words[0], nullptr, nullptr, words.data(), environ), 0);
  int status = -1;
  rusage usage{};
  EXPECT_EQ(wait4(child, &status, 0, &usage), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << arguments[1];
  return size_t(usage.ru_maxrss) << 10;
}

TEST(Memory, DefaultFieldStaysLean) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need memory of their own";
#endif
  const std::filesystem::path folder = testing::TempDir();
  const std::string meshFile = folder / "memory_test.off", fieldFile = folder / "memory_test.nrrd";
  const Mesh mesh = shapes::sphere(1.0, 6);
  writeOff(meshFile, mesh);
  const size_t peak = peakOf({RAYMAP_PROGRAM, "generate", meshFile, "-o", fieldFile, "--resolution", "256"});
  const size_t samples = fitGrid(mesh, {.resolution = 256}).sampleCount();
  EXPECT_LE(peak, 24 * samples + 200 * mesh.triangles.size());
  std::filesystem::remove(meshFile);
  std::filesystem::remove(fieldFile);
}

}  // namespace

}  // namespace raymap
