// Reads a mesh, makes its signed distance field on the CPU, samples it along a line and writes it.
//
//   raymap_generate bunny.obj bunny.nrrd

#include <raymap/raymap.h>

#include <cstdio>
#include <string>
#include <vector>

namespace {

void warn(const raymap::Warning& warning) {
  std::fprintf(stderr, "warning: %s\n", warning.message.c_str());
}

void run(const char* from, const char* to) {
  // Load. Any mesh will do, with holes and flipped faces too.
  const raymap::Mesh mesh = raymap::readMesh(from, {.warn = warn});

  // Generate: 100 samples along the longest side of the padded bounds.
  const raymap::Grid grid = raymap::fitGrid(mesh, {.resolution = 100});
  const auto [field, stats] = raymap::generate(mesh, grid, {}, {.device = "cpu"});
  std::printf("%zu samples in %.0f ms, %.3g %% of them doubtful\n", grid.sampleCount(), stats.milliseconds,
              100.0 * stats.doubtfulShare);

  // Sample: five points from one corner of the mesh's bounds to the other.
  const raymap::Box box = raymap::bounds(mesh);
  std::vector<glm::dvec3> points;
  for (int i = 0; i <= 4; ++i) points.push_back(glm::mix(box.min, box.max, i / 4.0));
  const raymap::Samples samples = raymap::sample(field, points, {.gradients = true});
  for (size_t i = 0; i < points.size(); ++i)
    std::printf("(%g, %g, %g): distance %g, gradient (%.2f, %.2f, %.2f)\n", points[i].x, points[i].y,
                points[i].z, double(samples.distance[i]), double(samples.gradient[i].x),
                double(samples.gradient[i].y), double(samples.gradient[i].z));

  // Write. The extension decides the format: .vdb, .nrrd, .npz, .npy or .vti.
  raymap::writeField(to, field);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s MESH FIELD\n", argv[0]);
    return 2;
  }
  try {
    run(argv[1], argv[2]);
    return 0;
  } catch (const raymap::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
