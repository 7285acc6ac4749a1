// Results of raymap/c.h beside those of the functions of C++ that it calls.

#include <gtest/gtest.h>
#include <raymap/c.h>
#include <raymap/json.h>
#include <raymap/raymap.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "files.h"

namespace raymap {
namespace {

using Json = nlohmann::ordered_json;

template <auto kFree>
struct Freed {
  void operator()(auto* handle) const { kFree(handle); }
};
template <class T, auto kFree>
using Handle = std::unique_ptr<T, Freed<kFree>>;

/// Returns a box of 4 x 2 x 1 with a wall through its middle, which crosses two of its sides, without its
/// last side.
Mesh flawedBox() {
  return {.vertices = {{0, 0, 0},
                       {4, 0, 0},
                       {0, 2, 0},
                       {4, 2, 0},
                       {0, 0, 1},
                       {4, 0, 1},
                       {0, 2, 1},
                       {4, 2, 1},
                       {1, 1, -1},
                       {3, 1, -1},
                       {2, 1.5f, 2}},
          .triangles = {{0, 2, 1},
                        {1, 2, 3},
                        {4, 5, 6},
                        {5, 7, 6},
                        {0, 1, 4},
                        {1, 5, 4},
                        {2, 6, 3},
                        {3, 6, 7},
                        {0, 4, 2},
                        {2, 4, 6},
                        {8, 9, 10}}};
}

/// Removes what differs from run to run.
Json withoutTimes(Json report) {
  report["stats"].erase("milliseconds");
  for (Json& stage : report["stats"]["stages"]) stage.erase("milliseconds");
  return report;
}

/// Expects a mesh of C to have these vertices and triangles.
void expectSame(const raymap_mesh* given, const Mesh& mesh) {
  ASSERT_NE(given, nullptr) << raymap_last_error_message();
  ASSERT_EQ(raymap_mesh_vertex_count(given), mesh.vertices.size());
  ASSERT_EQ(raymap_mesh_triangle_count(given), mesh.triangles.size());
  std::vector<glm::uvec3> triangles(mesh.triangles.size());
  raymap_mesh_copy_triangles(given, &triangles.data()->x);
  EXPECT_EQ(triangles, mesh.triangles);
  std::vector<glm::dvec3> positions(mesh.vertices.size());
  raymap_mesh_copy_positions(given, &positions.data()->x);
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_EQ(positions[v], mesh.position(v));
}

class CResults : public testing::Test {
 protected:
  CResults() {
    raymap_mesh_arrays arrays = RAYMAP_INIT(raymap_mesh_arrays);
    arrays.vertices = mesh_.vertices.data();
    arrays.vertex_count = mesh_.vertices.size();
    arrays.triangles = mesh_.triangles.data();
    arrays.triangle_count = mesh_.triangles.size();
    cMesh_.reset(raymap_mesh_from_arrays(&arrays));
    cOptions_.reset(raymap_options_create());
    raymap_options_set_text(cOptions_.get(), "device", "cpu");
  }

  /// Returns the same grid twice: for C++ and for C.
  std::pair<Grid, raymap_grid> fit(int resolution) const {
    const Grid grid = fitRepairGrid(mesh_, {.resolution = resolution});
    return {grid,
            {{grid.dims.x, grid.dims.y, grid.dims.z},
             {grid.origin.x, grid.origin.y, grid.origin.z},
             grid.spacing}};
  }

  /// Sets options of C by JSON.
  void set(const char* json) {
    ASSERT_EQ(raymap_options_set_json(cOptions_.get(), json), RAYMAP_OK) << raymap_last_error_message();
  }

  /// Expects the repair with the options of C to be that of C++.
  void expectSameRepair(const Grid& grid, const raymap_grid& cGrid, const RepairOptions& how) {
    const Repaired expected = repair(mesh_, grid, {}, how, {.device = "cpu"});
    char* report = nullptr;
    const Handle<raymap_mesh, raymap_mesh_free> repaired(
        raymap_repair(cMesh_.get(), &cGrid, cOptions_.get(), &report));
    expectSame(repaired.get(), expected.mesh);
    const Handle<char, raymap_text_free> json(report);
    EXPECT_EQ(withoutTimes(Json::parse(json.get())), withoutTimes(toJson(expected.report)));
  }

  Mesh mesh_ = flawedBox();
  Handle<raymap_mesh, raymap_mesh_free> cMesh_;
  Handle<raymap_options, raymap_options_free> cOptions_;
};

using Drawn = Handle<raymap_picture, raymap_picture_free>;

void expectSame(const raymap_picture* given, const Picture& picture) {
  ASSERT_NE(given, nullptr) << raymap_last_error_message();
  ASSERT_EQ(raymap_picture_width(given), picture.width);
  ASSERT_EQ(raymap_picture_height(given), picture.height);
  EXPECT_EQ(std::memcmp(raymap_picture_rgb(given), picture.rgb.data(), picture.rgb.size()), 0);
}

/// Expects a narrow band of C to have these leaves, tiles and values.
void expectSame(const raymap_field* given, const Field& band) {
  ASSERT_NE(given, nullptr) << raymap_last_error_message();
  ASSERT_EQ(raymap_field_leaf_count(given), band.narrow->leaves.size());
  ASSERT_EQ(raymap_field_tile_count(given), band.narrow->tiles.size());
  const Handle<char, raymap_text_free> text(raymap_field_json(given));
  const Json json = Json::parse(text.get());
  EXPECT_EQ(json["active"], band.activeCount());
  EXPECT_EQ(json["bytes"], band.bytes());
  EXPECT_EQ(json["outside"], band.narrow->outside);
  if (std::isinf(band.narrow->inside))
    EXPECT_TRUE(json["inside"].is_null());
  else
    EXPECT_EQ(json["inside"], band.narrow->inside);
  const auto expectValues = [](const void* data, const auto& values) {
    ASSERT_EQ(data == nullptr, values.empty());
    if (data) {
      EXPECT_EQ(std::memcmp(data, values.data(), values.size() * sizeof values[0]), 0);
    }
  };
  expectValues(raymap_field_leaves(given), band.narrow->leaves);
  expectValues(raymap_field_tiles(given), band.narrow->tiles);
  expectValues(raymap_field_distance(given), band.distance);
  expectValues(raymap_field_triangle(given), band.triangle);
  expectValues(raymap_field_winding(given), band.winding);
  expectValues(raymap_field_confidence(given), band.confidence);
}

TEST_F(CResults, InspectionIsThatOfTheThreeFunctions) {
  const Diagnostics found = diagnose(mesh_);
  const SelfIntersections crossings = findSelfIntersections(mesh_);
  ASSERT_GT(crossings.pairs, 0u);
  ASSERT_EQ(found.holes.size(), 2u);
  const Handle<char, raymap_text_free> json(raymap_inspect(cMesh_.get(), nullptr));
  Json expected = toJson(Inspection{found, crossings});
  const Verdict verdict = judge(mesh_, found, crossings);
  expected["verdict"] = toJson(verdict);
  expected["kind_text"] = describe(verdict, found, crossings);
  expected["defects_text"] = describeDefects(found, crossings);
  expected["thickness_text"] = describeThickness(mesh_, verdict);
  EXPECT_EQ(json.get(), textOf(expected));
}

TEST_F(CResults, RepairIsThatOfCpp) {
  const auto [grid, cGrid] = fit(48);
  const RepairOptions how{.offset = 0.1,
                          .shell = 0.25,
                          .drainHole = 0.3,
                          .drainHoles = 2,
                          .down = {0, -1, 0},
                          .remesh = true,
                          .tolerance = 0.02};
  set(R"({"offset": 0.1, "shell": 0.25, "drain_hole": 0.3, "drain_holes": 2, "down": [0, -1, 0],
          "remesh": true, "tolerance": 0.02})");
  expectSameRepair(grid, cGrid, how);
}

TEST_F(CResults, RepairJoinsASheetToABase) {
  const float positions[] = {0, 0, 1, 1, 0, 1, 0, 1, 2};
  const uint32_t faces[] = {0, 1, 2};
  auto arrays = RAYMAP_INIT(raymap_mesh_arrays);
  arrays.vertices = positions;
  arrays.vertex_count = 3;
  arrays.triangles = faces;
  arrays.triangle_count = 1;
  const Handle<raymap_mesh, raymap_mesh_free> sheet(raymap_mesh_from_arrays(&arrays));
  ASSERT_NE(sheet, nullptr) << raymap_last_error_message();
  set(R"({"base": -1})");
  raymap_grid grid{};
  ASSERT_EQ(raymap_fit_repair_grid(sheet.get(), cOptions_.get(), &grid), RAYMAP_OK);
  char* report = nullptr;
  const Handle<raymap_mesh, raymap_mesh_free> repaired(
      raymap_repair(sheet.get(), &grid, cOptions_.get(), &report));
  ASSERT_NE(repaired, nullptr) << raymap_last_error_message();
  const Handle<char, raymap_text_free> text(report);
  const Json json = Json::parse(text.get());
  EXPECT_EQ(json["depth"], "mended");
  EXPECT_NEAR(json["after"]["signed_volume"], 0.5 * (2.0 + 2.0 + 3.0) / 3.0, 1e-6);
}

TEST_F(CResults, OtherOptionsOfRepairAreThoseOfCpp) {
  const auto [grid, cGrid] = fit(32);
  set(R"({"close_holes": false, "min_thickness": 0.4, "drop_smaller": 0, "keep_cavities": true, "measure": false})");
  expectSameRepair(
      grid, cGrid,
      {.closeHoles = false, .minThickness = 0.4, .dropSmaller = 0.0, .keepCavities = true, .measure = false});
}

TEST_F(CResults, RepairGridIsThatOfCpp) {
  set(R"({"min_thickness": 0.5, "voxel_size": 0.1, "padding": 0.25})");
  raymap_grid fitted;
  ASSERT_EQ(raymap_fit_repair_grid(cMesh_.get(), cOptions_.get(), &fitted), RAYMAP_OK);
  const Grid grid = fitRepairGrid(mesh_, {.voxelSize = 0.1, .padding = 0.25}, {.minThickness = 0.5});
  for (int a = 0; a < 3; ++a) {
    EXPECT_EQ(fitted.dims[a], grid.dims[a]);
    EXPECT_EQ(fitted.origin[a], grid.origin[a]);
  }
  EXPECT_EQ(fitted.spacing, grid.spacing);
}

TEST_F(CResults, SimplifiedMeshIsThatOfCpp) {
  const auto [grid, cGrid] = fit(32);
  const Mesh fine = isosurface(generate(mesh_, grid, {}, {.device = "cpu"}).field);
  const Handle<raymap_field, raymap_field_free> field(raymap_generate(cMesh_.get(), &cGrid, cOptions_.get()));
  const Handle<raymap_mesh, raymap_mesh_free> cFine(raymap_isosurface(field.get(), nullptr));
  for (const SimplifyOptions& how : {SimplifyOptions{.tolerance = 0.02, .step = 0.1},
                                     SimplifyOptions{.tolerance = 1.0, .step = 0.1, .triangles = 200}}) {
    const Simplified expected = simplify(fine, how);
    ASSERT_LT(expected.mesh.triangles.size(), fine.triangles.size());
    const Json options{{"tolerance", how.tolerance}, {"step", how.step}, {"triangles", how.triangles}};
    set(options.dump().c_str());
    char* report = nullptr;
    const Handle<raymap_mesh, raymap_mesh_free> coarse(
        raymap_simplify(cFine.get(), cOptions_.get(), &report));
    expectSame(coarse.get(), expected.mesh);
    const Handle<char, raymap_text_free> text(report);
    const Json json = Json::parse(text.get());
    EXPECT_EQ(json["deviation"], expected.deviation);
    EXPECT_EQ(json["tolerance"], expected.tolerance);
    EXPECT_EQ(json["triangles_before"], fine.triangles.size());
  }
}

TEST_F(CResults, RepairedMeshHasAsFewTrianglesAsAskedFor) {
  const auto [grid, cGrid] = fit(32);
  set(R"({"remesh": true, "triangles": 200})");
  const Handle<raymap_mesh, raymap_mesh_free> repaired(
      raymap_repair(cMesh_.get(), &cGrid, cOptions_.get(), nullptr));
  ASSERT_NE(repaired, nullptr) << raymap_last_error_message();
  EXPECT_LE(raymap_mesh_triangle_count(repaired.get()), 200u);
}

TEST_F(CResults, ThicknessIsThatOfCpp) {
  const std::vector<FacePoint> points = sampleFaces(mesh_, 0.3);
  std::vector<glm::dvec3> positions;
  std::vector<uint32_t> triangles;
  for (const FacePoint& point : points) {
    positions.push_back(point.position);
    triangles.push_back(point.triangle);
  }
  const std::vector<Thickness> expected = Surface(mesh_).thickness(points, {.maxThickness = 1.5});
  std::vector<float> diameter(points.size());
  std::vector<int32_t> part(points.size());
  std::vector<glm::vec3> inward(points.size());
  const Handle<raymap_surface, raymap_surface_free> surface(raymap_surface_create(cMesh_.get(), nullptr));
  auto arrays = RAYMAP_INIT(raymap_thickness_arrays);
  arrays.diameter = diameter.data();
  arrays.part = part.data();
  arrays.inward = &inward.data()->x;
  set(R"({"max_thickness": 1.5})");
  ASSERT_EQ(raymap_surface_thickness(surface.get(), &positions.data()->x, triangles.data(), points.size(),
                                     cOptions_.get(), &arrays),
            RAYMAP_OK);
  for (size_t p = 0; p < points.size(); ++p)
    EXPECT_EQ((Thickness{Part(part[p]), diameter[p], inward[p]}), expected[p]);
  static_assert(int(Part::Wall) == RAYMAP_PART_WALL && int(Part::Edge) == RAYMAP_PART_EDGE &&
                int(Part::Corner) == RAYMAP_PART_CORNER && int(Part::Solid) == RAYMAP_PART_SOLID &&
                int(Part::Sheet) == RAYMAP_PART_SHEET && int(Part::Buried) == RAYMAP_PART_BURIED);
}

TEST_F(CResults, BandsAreThoseOfCpp) {
  const auto [grid, cGrid] = fit(40);
  set(R"({"triangle": true, "winding": true, "confidence": true, "outside": 2, "inside": 3.5, "iso": 0.01})");
  const Handle<raymap_surface, raymap_surface_free> cSurface(raymap_surface_create(cMesh_.get(), nullptr));
  const BandOptions options{
      .outside = 2.0, .inside = 3.5, .triangle = true, .winding = true, .confidence = true};
  using CField = Handle<raymap_field, raymap_field_free>;
  const CField made(raymap_surface_generate_band(cSurface.get(), &cGrid, cOptions_.get()));
  const Field band = Surface(mesh_).generateBand(grid, options);
  expectSame(made.get(), band);

  const CField dense(raymap_generate(cMesh_.get(), &cGrid, cOptions_.get()));
  const CField cut(raymap_field_to_narrow(dense.get(), cOptions_.get()));
  const FieldOptions arrays{.triangle = true, .winding = true, .confidence = true};
  expectSame(cut.get(), toSparse(generate(mesh_, grid, arrays, {.device = "cpu"}).field, options));

  const Handle<raymap_mesh, raymap_mesh_free> contour(raymap_isosurface(made.get(), cOptions_.get()));
  expectSame(contour.get(), isosurface(band, {.iso = 0.01}));

  raymap_options_set_number(cOptions_.get(), "inside", INFINITY);
  const CField whole(raymap_surface_generate_band(cSurface.get(), &cGrid, cOptions_.get()));
  BandOptions inside = options;
  inside.inside = INFINITY;
  expectSame(whole.get(), Surface(mesh_).generateBand(grid, inside));
}

TEST_F(CResults, CompactSurfacesAreThoseOfCpp) {
  raymap_options_set_number(cOptions_.get(), "compact", 1);
  const Handle<raymap_surface, raymap_surface_free> compact(
      raymap_surface_create(cMesh_.get(), cOptions_.get()));
  EXPECT_EQ(raymap_surface_bytes(compact.get()),
            Surface(mesh_, {.compact = true}, {.device = "cpu"}).bytes());
  EXPECT_LT(raymap_surface_bytes(compact.get()), Surface(mesh_, {}, {.device = "cpu"}).bytes());
}

TEST_F(CResults, PicturesOfBandsAreThoseOfCpp) {
  const auto [grid, cGrid] = fit(40);
  set(R"({"winding": true, "width": 60, "height": 40, "cut": true, "title": "a band", "max_size": 20})");
  const Handle<raymap_surface, raymap_surface_free> surface(raymap_surface_create(cMesh_.get(), nullptr));
  const Handle<raymap_field, raymap_field_free> cBand(
      raymap_surface_generate_band(surface.get(), &cGrid, cOptions_.get()));
  const Field band = Surface(mesh_).generateBand(grid, {.winding = true});
  const RenderOptions how{.width = 60, .height = 40, .cut = true};
  expectSame(Drawn(raymap_render_field(cBand.get(), cOptions_.get())).get(),
             renderField(band, how, {.device = "cpu"}));
  expectSame(Drawn(raymap_render_slice(cBand.get(), 2, -1, nullptr)).get(), renderSlice(band, 2));

  const TemporaryFolder folder;
  const std::string path = (folder.path() / "band.html").string();
  ASSERT_EQ(raymap_write_page(cBand.get(), path.c_str(), nullptr, cBand.get(), cOptions_.get()), RAYMAP_OK);
  const PageOptions shown{.title = "a band", .maxSize = 20, .other = &band};
  EXPECT_EQ(readBytes(path), makePage(band, how, shown, {.device = "cpu"}).html);
  set(R"({"array": "winding", "width": 50})");
  expectSame(Drawn(raymap_render_slice(cBand.get(), 1, 5, cOptions_.get())).get(),
             renderSlice(band, 1, 5, 50, FieldArray::Winding));
}

TEST_F(CResults, PicturesAreThoseOfCpp) {
  const auto [grid, cGrid] = fit(32);
  const Field field = generate(mesh_, grid, {.winding = true}, {.device = "cpu"}).field;
  raymap_options_set_number(cOptions_.get(), "winding", 1);
  const Handle<raymap_field, raymap_field_free> cField(
      raymap_generate(cMesh_.get(), &cGrid, cOptions_.get()));
  const RenderOptions how{.width = 60,
                          .height = 40,
                          .direction = {1, 0.5, -0.2},
                          .up = {0, 0, 1},
                          .fieldOfView = 45,
                          .cut = true,
                          .shell = 0.2,
                          .frame = Box{{-1, -1, -1}, {5, 3, 2}}};
  const MachineOptions machine{.device = "cpu"};
  set(R"({"width": 60, "height": 40, "direction": [1, 0.5, -0.2], "up": [0, 0, 1], "field_of_view": 45,
          "cut": true, "shell": 0.2, "frame": [[-1, -1, -1], [5, 3, 2]]})");
  expectSame(Drawn(raymap_render_field(cField.get(), cOptions_.get())).get(),
             renderField(field, how, machine));
  expectSame(Drawn(raymap_render_defects(cMesh_.get(), cOptions_.get())).get(), renderDefects(mesh_, how));
  RenderOptions open = how;
  open.eye = glm::dvec3(-4.0, -2.0, 3.0);
  open.iso = 0.125;
  open.cutPlane = Plane{{1, 0.5, 0.25}, 1.5};
  open.slice = Plane{{0, 2, 1}, 0.75};
  set(R"({"eye": [-4, -2, 3], "iso": 0.125, "cut_plane": [1, 0.5, 0.25, 1.5], "slice_plane": [0, 2, 1, 0.75]})");
  expectSame(Drawn(raymap_render_field(cField.get(), cOptions_.get())).get(),
             renderField(field, open, machine));
  set(R"({"array": "winding", "width": 50})");
  expectSame(Drawn(raymap_render_slice(cField.get(), 1, 5, cOptions_.get())).get(),
             renderSlice(field, 1, 5, 50, FieldArray::Winding));
  expectSame(Drawn(raymap_render_slice(cField.get(), 2, -1, nullptr)).get(), renderSlice(field, 2));
}

TEST_F(CResults, PictureWithoutAViewIsThatOfCpp) {
  const auto [grid, cGrid] = fit(24);
  const Handle<raymap_field, raymap_field_free> field(raymap_generate(cMesh_.get(), &cGrid, cOptions_.get()));
  expectSame(Drawn(raymap_render_field(field.get(), cOptions_.get())).get(),
             renderField(generate(mesh_, grid, {}, {.device = "cpu"}).field, {}, {.device = "cpu"}));
}

}  // namespace
}  // namespace raymap
