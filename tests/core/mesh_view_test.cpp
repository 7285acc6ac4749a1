#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <cstring>

#include "error_code.h"
#include "mesh/model.h"
#include "shapes.h"

namespace raymap {
namespace {

const glm::dvec3 kFar(1e6, -2e6, 3e6);

Mesh farBall() {
  return shapes::sphere(1.0, 3, kFar);
}

std::vector<glm::dvec3> positionsOf(const Mesh& mesh) {
  std::vector<glm::dvec3> positions;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) positions.push_back(mesh.position(v));
  return positions;
}

/// Elements with gaps between them, at odd addresses.
template <class T>
struct Strided {
  static constexpr size_t kStride = sizeof(T) + 5;
  explicit Strided(const std::vector<T>& values) : bytes(1 + kStride * values.size()) {
    for (size_t i = 0; i < values.size(); ++i)
      std::memcpy(bytes.data() + 1 + kStride * i, &values[i], sizeof(T));
  }
  const void* data() const { return bytes.data() + 1; }
  std::vector<std::byte> bytes;
};

void expectSameField(const Mesh& mesh, const MeshView& view) {
  const Grid grid = fitGrid(mesh, {.resolution = 20});
  EXPECT_EQ(fitGrid(view, {.resolution = 20}), grid);
  const Field a = generate(mesh, grid, {}, {.device = "cpu"}).field;
  const Field b = generate(view, grid, {}, {.device = "cpu"}).field;
  ASSERT_EQ(a.distance.size(), b.distance.size());
  EXPECT_EQ(std::memcmp(a.distance.data(), b.distance.data(), a.distance.size() * sizeof(float)), 0);
}

TEST(MeshView, OfAMeshIsReadInPlace) {
  const Mesh mesh = farBall();
  const Model packed(mesh);
  EXPECT_EQ(packed.vertices.data(), mesh.vertices.data());
  EXPECT_EQ(packed.triangles.data(), mesh.triangles.data());
  EXPECT_EQ(packed.origin, mesh.origin);
  EXPECT_EQ(packed.bytes(), 0u);
}

TEST(MeshView, OfPackedPointersIsReadInPlace) {
  const Mesh mesh = farBall();
  const MeshView view(&mesh.vertices[0].x, mesh.vertices.size(), &mesh.triangles[0].x, mesh.triangles.size(),
                      {}, mesh.origin);
  EXPECT_EQ(Model::bytesNeeded(view), 0u);
  expectSameField(mesh, view);
}

TEST(MeshView, GivesTheFieldOfTheMeshFromStridedFloats) {
  const Mesh mesh = farBall();
  const Strided vertices(mesh.vertices);
  const Strided triangles(mesh.triangles);
  expectSameField(mesh, MeshView(static_cast<const float*>(vertices.data()), mesh.vertices.size(),
                                 static_cast<const uint32_t*>(triangles.data()), mesh.triangles.size(),
                                 {vertices.kStride, triangles.kStride}, mesh.origin));
}

TEST(MeshView, CentresDoublePositionsAsMakeMeshDoes) {
  const Mesh stored = farBall();
  const std::vector<glm::dvec3> positions = positionsOf(stored);
  std::vector<glm::vec<3, uint64_t>> triangles(stored.triangles.begin(), stored.triangles.end());
  const Mesh mesh = makeMesh(positions, stored.triangles);
  expectSameField(mesh, MeshView(positions, triangles));
  expectSameField(mesh, MeshView(positions, stored.triangles));
  const Strided spread(positions);
  expectSameField(mesh, MeshView(static_cast<const double*>(spread.data()), positions.size(), &triangles[0].x,
                                 triangles.size(), {.vertex = spread.kStride}));
}

TEST(MeshView, HasTheBoundsOfThePackedMesh) {
  const double third = 1.0 / 3.0;
  const std::vector<glm::dvec3> vertices = {{1e5 - third, -third, -7e4 - third},
                                            {1e5 + third, third, -7e4 + third}};
  const std::vector<glm::uvec3> triangles = {{0, 1, 1}};
  const MeshView view(vertices, triangles);
  const Box box = bounds(view), packed = bounds(Model(view));
  EXPECT_EQ(box.min, packed.min);
  EXPECT_EQ(box.max, packed.max);
  EXPECT_EQ(box.max.y, double(float(third)));
}

TEST(MeshView, MovesByItsOrigin) {
  const std::vector<glm::dvec3> positions = positionsOf(shapes::sphere(1.0, 2));
  const std::vector<glm::uvec3> triangles = shapes::sphere(1.0, 2).triangles;
  const Box box = bounds(MeshView(positions, triangles, kFar));
  EXPECT_NEAR(box.centre().x, kFar.x, 1e-6);
  EXPECT_NEAR(box.centre().y, kFar.y, 1e-6);
  EXPECT_NEAR(box.size().z, 2.0, 1e-2);
}

TEST(MeshView, IsMeasuredAndRepairedLikeTheMesh) {
  const Mesh stored = farBall();
  const std::vector<glm::dvec3> positions = positionsOf(stored);
  const Mesh mesh = makeMesh(positions, stored.triangles);
  const MeshView view(positions, stored.triangles);
  EXPECT_EQ(diagnose(view).area, diagnose(mesh).area);
  EXPECT_EQ(findSelfIntersections(view).pairs, 0u);
  const Grid grid = fitGrid(mesh, {.resolution = 20});
  EXPECT_EQ(repair(view, grid, {}, {.remesh = true, .measure = false}, {.device = "cpu"}).mesh.vertices,
            repair(mesh, grid, {}, {.remesh = true, .measure = false}, {.device = "cpu"}).mesh.vertices);
}

void expectInputError(const MeshView& view, const std::string& text) {
  const auto expect = [&](auto&& work) {
    EXPECT_NE(messageOf(ErrorCode::Input, [&] { work(); }).find(text), std::string::npos);
  };
  expect([&] { validate(view); });
  expect([&] { generate(view, {.dims = {4, 4, 4}, .spacing = 1.0}, {}, {.device = "cpu"}); });
}

TEST(MeshView, RefusesWideIndicesOutOfRange) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  std::vector<glm::vec<3, uint64_t>> triangles(mesh.triangles.begin(), mesh.triangles.end());
  triangles[3].y = (uint64_t{1} << 32) + 2;  // Cut to 32 bits it would be vertex 2.
  expectInputError(MeshView(mesh.vertices, triangles), "triangle 3 uses vertex 4294967298");
}

TEST(MeshView, RefusesWhatIsNotFinite) {
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  std::vector<glm::dvec3> positions = positionsOf(box);
  const std::vector<glm::uvec3>& triangles = box.triangles;
  positions[5].z = NAN;
  expectInputError(MeshView(positions, triangles), "vertex 5 of triangle");
  const std::vector<glm::dvec3> nowhere(8, glm::dvec3(NAN));
  expectInputError(MeshView(nowhere, triangles), "is not finite");
  expectInputError(MeshView(positions, std::vector<glm::uvec3>()), "no triangles");
  expectInputError(MeshView(box.vertices, triangles, {0, NAN, 0}),
                   "the mesh's origin is not finite: (0, nan, 0)");
}

TEST(MeshView, NamesPositionsAsTheCallerGaveThem) {
  Mesh box = shapes::box({1e6, 0, 0}, {1e6 + 1, 2, 4});
  std::vector<glm::dvec3> positions = positionsOf(box);
  for (uint32_t v = 0; v < positions.size(); ++v) {
    if (positions[v] != glm::dvec3(1e6 + 1, 2, 0)) continue;
    positions[v].y = box.vertices[v].y = NAN;
    const std::string name = "vertex " + std::to_string(v) + " of triangle ",
                      at = " is not finite: (1000001, nan, 0)";
    for (const MeshView& view : {MeshView(box), MeshView(positions, box.triangles)}) {
      expectInputError(view, name);
      expectInputError(view, at);
    }
    expectInputError(Model(MeshView(positions, box.triangles)), at);
  }
}

TEST(MeshView, SkipsWhatLiesBetweenPositions) {
  const Mesh mesh = farBall();
  std::vector<glm::vec4> padded;
  for (const glm::vec3& v : mesh.vertices) padded.emplace_back(v, 1e9f);
  MeshView view(mesh);
  view.vertices = padded.data();
  view.vertexStride = sizeof(glm::vec4);
  const Model copy(view);
  for (uint32_t v = 0; v < padded.size(); ++v) EXPECT_EQ(copy.position(v), mesh.position(v));
}

TEST(MeshView, IsAsLargeAsItsOutermostTriangles) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-5, -6, -7}, {7, 6, 5}},
            std::vector<glm::uvec3>(100000, glm::uvec3(0, 1, 2))};
  mesh.triangles[50000].x = 3;
  mesh.triangles.back().y = 4;
  EXPECT_EQ(bounds(mesh).min, glm::dvec3(-5, -6, -7));
  EXPECT_EQ(bounds(mesh).max, glm::dvec3(7, 6, 5));
}

TEST(MeshView, NeedsTheMemoryOfItsCopy) {
  const Mesh mesh = farBall();
  EXPECT_EQ(Model::bytesNeeded(mesh), 0u);
  const std::vector<glm::dvec3> positions = positionsOf(mesh);
  const MeshView view(positions, mesh.triangles);
  const Model copy(view);
  EXPECT_EQ(Model::bytesNeeded(view), copy.vertices.size_bytes() + copy.triangles.size_bytes());
}

TEST(Model, ForgetsWhatItFoundInTheLastMesh) {
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  const Mesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  Model model(box);
  EXPECT_EQ(model.welding().count, 8u);
  EXPECT_EQ(model.halfEdges().size(), 36u);
  EXPECT_TRUE(model.rims(1.0).empty());
  model.keep(square);
  EXPECT_EQ(model.bytes(), 4 * sizeof(glm::vec3) + 2 * sizeof(glm::uvec3));
  EXPECT_NE(model.vertices.data(), square.vertices.data());
  EXPECT_EQ(model.rims(1.0).size(), 4u);
  EXPECT_EQ(model.halfEdges().size(), 6u);
  EXPECT_EQ(model.welding().count, 4u);
}

TEST(MeshView, HoldsItsCopyAgainstTheMemoryLimit) {
  const Mesh mesh = farBall();
  const std::vector<glm::dvec3> positions = positionsOf(mesh);
  EXPECT_EQ(codeOf([&] {
              generate(MeshView(positions, mesh.triangles), fitGrid(mesh, {.resolution = 8}), {},
                       {.device = "cpu", .memoryLimit = 1000});
            }),
            ErrorCode::Memory);
}

}  // namespace
}  // namespace raymap
