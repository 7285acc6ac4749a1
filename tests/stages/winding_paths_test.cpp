// Paths, evolution and the single ray against Eq. 9-11 of Krayer & Müller 2019, evaluated as they stand on
// curves that are cast one by one.

#include "cpu/sign/winding_paths.h"

#include <gtest/gtest.h>

#include "curves.h"
#include "method/winding_paths_offsets.h"
#include "sign_scene.h"

namespace raymap {
namespace {

using Points = std::vector<glm::ivec3>;

/// Returns the corners of a cube around the sample.
Points neighboursAt(int distance) {
  Points points;
  for (const int x : {-distance, distance})
    for (const int y : {-distance, distance})
      for (const int z : {-distance, distance}) points.emplace_back(x, y, z);
  return points;
}

/// A mesh and a grid of unit cells at the origin. The mesh need not fit into the grid.
struct Case {
  Mesh mesh;
  Grid grid;
  std::vector<int> distances;  ///< Distances of the paper's neighbours, pass by pass.
};

Case cube() {
  return {exactSoup(40, 4, {1, 1, 1}, {9, 8, 10}), {.dims = {12, 11, 13}, .spacing = 1.0}, {1, 2, 1}};
}
Case plank() {
  return {exactSoup(40, 6, {1, -2, -2}, {34, 8, 7}), {.dims = {37, 5, 4}, .spacing = 1.0}, {1, 2, 4, 8, 1}};
}

/// Evaluates the equations with the offset points of each pass.
class Equations {
 public:
  Equations(const Case& on, Sampling sampling) : curves_(on.mesh), grid_(on.grid), sampling_(sampling) {}

  /// Eq. 9 over all passes: the mean of all curves.
  std::vector<double> paths(const std::vector<Points>& passes) const {
    std::vector<double> winding;
    forEachSample([&](const glm::ivec3& p) {
      double sum = curves_.rays(p), count = 6.0;
      for (const Points& points : passes)
        for (const glm::ivec3& offset : points) {
          const glm::ivec3 q = pointOf(p, offset);
          sum += 6.0 * curves_.paths(p, q) + 6.0 * raysAt(q);
          count += 36.0;
        }
      winding.push_back(sum / count);
    });
    return winding;
  }

  /// Eq. 10-11: counts c and numbers of curves n, step by step.
  std::vector<double> evolution(const std::vector<Points>& steps) const {
    std::vector<double> c;
    forEachSample([&](const glm::ivec3& p) { c.push_back(curves_.rays(p)); });
    double n = 6.0;  // The same at every sample.
    for (const Points& points : steps) {
      std::vector<double> next;
      forEachSample([&](const glm::ivec3& p) {
        next.push_back(c[grid_.index(p)]);
        for (const glm::ivec3& offset : points) {
          const glm::ivec3 q = pointOf(p, offset);
          const double there = isInside(q) ? c[grid_.index(q)] : n / 6.0 * raysAt(q);
          next.back() += n * curves_.paths(p, q) + 6.0 * there;
        }
      });
      n += double(points.size()) * 6.0 * n;
      c.swap(next);
    }
    for (double& sum : c) sum /= n;
    return c;
  }

 private:
  template <class Work>
  void forEachSample(Work&& work) const {
    for (int k = 0; k < grid_.dims.z; ++k)
      for (int j = 0; j < grid_.dims.y; ++j)
        for (int i = 0; i < grid_.dims.x; ++i) work(glm::ivec3(i, j, k));
  }
  bool isInside(const glm::ivec3& q) const {
    return glm::all(glm::greaterThanEqual(q, glm::ivec3(0))) && glm::all(glm::lessThan(q, grid_.dims));
  }
  /// Returns an offset point. The mesh may reach beyond the grid: then a point outside the grid counts as
  /// farther out than all of the mesh (cpu/sign/ray_map.h).
  glm::ivec3 pointOf(const glm::ivec3& p, const glm::ivec3& offset) const {
    glm::ivec3 q = p + offset;
    for (int a = 0; a < 3; ++a)
      if (q[a] < 0 || q[a] >= grid_.dims[a]) q[a] = q[a] < 0 ? -100 : 100;
    return q;
  }
  double raysAt(const glm::ivec3& q) const {
    return isInside(q) || sampling_ == Sampling::Paper ? curves_.rays(q) : 0.0;
  }

  Curves curves_;
  Grid grid_;
  Sampling sampling_;
};

void expectNear(const Case& on, const FieldOptions& options, const std::vector<double>& expected) {
  const Buffer<float> winding = windingOf(on.mesh, on.grid, options, {.device = "cpu"}).winding;
  ASSERT_EQ(winding.size(), expected.size());
  for (size_t s = 0; s < expected.size(); ++s)
    ASSERT_NEAR(winding[s], expected[s], 1e-5 * (1.0 + std::abs(expected[s])))
        << "sample " << s << ", sign " << int(options.sign) << ", sampling " << int(options.sampling);
}

FieldOptions optionsFor(const std::vector<Points>& passes, Sampling sampling, SignMode sign) {
  return {.sign = sign, .orientation = Orientation::Keep, .passes = int(passes.size()), .sampling = sampling};
}

TEST(WindingPaths, SampleAsThePaper) {
  for (const Case& on : {cube(), plank()}) {
    std::vector<Points> passes;
    for (const int distance : on.distances) passes.push_back(neighboursAt(distance));
    const Equations equations(on, Sampling::Paper);
    expectNear(on, optionsFor(passes, Sampling::Paper, SignMode::Paths), equations.paths(passes));
    expectNear(on, optionsFor(passes, Sampling::Paper, SignMode::Evolution), equations.evolution(passes));
  }
}

// Offsets are used in turn: as many a pass as the mode and the sampling say.
TEST(WindingPaths, TakeTheOffsetsInTurn) {
  const Case on = cube();
  const Points offsets{{3, -2, 1}, {0, 0, 5}, {-40, 1, 0}, {2, 2, -2}, {-1, 14, 0}};
  for (const auto& [sign, sampling, perPass] : {std::tuple(SignMode::Paths, Sampling::Spread, 1),
                                                {SignMode::Evolution, Sampling::Spread, 4},
                                                {SignMode::Paths, Sampling::Paper, 8},
                                                {SignMode::Evolution, Sampling::Paper, 8}}) {
    std::vector<Points> passes(2);
    for (size_t point = 0; point < 2 * size_t(perPass); ++point)
      passes[point / size_t(perPass)].push_back(offsets[point % offsets.size()]);
    FieldOptions options = optionsFor(passes, sampling, sign);
    options.offsets = offsets;
    const Equations equations(on, sampling);
    expectNear(on, options, sign == SignMode::Paths ? equations.paths(passes) : equations.evolution(passes));
  }
}

TEST(WindingPaths, SpreadTheirOwnOffsets) {
  const Case on = plank();
  for (const auto& [sign, perPass] : {std::pair(SignMode::Paths, 1), {SignMode::Evolution, 4}}) {
    std::vector<Points> passes(3);
    FieldOptions options = optionsFor(passes, Sampling::Spread, sign);
    for (int point = 0; point < 3 * perPass; ++point)
      passes[size_t(point / perPass)].push_back(offsetOf(options, point, on.grid.dims));
    const Equations equations(on, Sampling::Spread);
    expectNear(on, options, sign == SignMode::Paths ? equations.paths(passes) : equations.evolution(passes));
  }
}

// Points fill a box with sides of 3/16 of the grid's, about the sample.
TEST(WindingPaths, KeepTheirOwnOffsetsClose) {
  const glm::ivec3 dims(64, 160, 33);
  const FieldOptions options{.sign = SignMode::Paths};
  glm::ivec3 low(0), high(0);
  for (int point = 0; point < 500; ++point) {
    low = glm::min(low, offsetOf(options, point, dims));
    high = glm::max(high, offsetOf(options, point, dims));
  }
  EXPECT_EQ(low, glm::ivec3(-6, -15, -3));
  EXPECT_EQ(high, glm::ivec3(6, 15, 3));
}

TEST(WindingPaths, PlaceThePapersPointsByThePass) {
  const FieldOptions options{.sign = SignMode::Evolution, .sampling = Sampling::Paper};
  EXPECT_EQ(offsetOf(options, 0, glm::ivec3(64)), glm::ivec3(-1));
  EXPECT_EQ(offsetOf(options, 7, glm::ivec3(64)), glm::ivec3(1));
  EXPECT_EQ(offsetOf(options, 8 * 4 + 1, glm::ivec3(9, 64, 9)), glm::ivec3(16, -16, -16));
  EXPECT_EQ(offsetOf(options, 8 * 4 + 6, glm::ivec3(64, 9, 9)), glm::ivec3(-16, 16, 16));
  EXPECT_EQ(offsetOf(options, 8 * 5, glm::ivec3(9, 9, 64)), glm::ivec3(-1));
  EXPECT_EQ(offsetOf(options, 8 * 4, glm::ivec3(63)), glm::ivec3(-1));
  EXPECT_EQ(offsetOf(options, 8 * 77, glm::ivec3(1, 2, 3)), glm::ivec3(-1));
}

TEST(WindingRays, TakeTheRayAlongX) {
  for (const Case& on : {cube(), plank()}) {
    const Curves curves(on.mesh);
    const Buffer<float> winding = windingOf(on.mesh, on.grid, SignMode::Ray).winding;
    size_t differing = 0;
    const Buffer<float> six = windingOf(on.mesh, on.grid, SignMode::Rays).winding;
    for (glm::ivec3 s(0); s.z < on.grid.dims.z; ++s.z)
      for (s.y = 0; s.y < on.grid.dims.y; ++s.y)
        for (s.x = 0; s.x < on.grid.dims.x; ++s.x) {
          const size_t index = on.grid.index(s);
          ASSERT_EQ(winding[index], float(curves.segment(s, 0, INFINITY)));
          ASSERT_NEAR(six[index], curves.rays(s) / 6.0, 1e-6);
          differing += winding[index] != six[index] ? 1 : 0;
        }
    EXPECT_GT(differing, winding.size() / 4);
  }
}

}  // namespace
}  // namespace raymap
