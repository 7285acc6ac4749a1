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

  Mesh mesh_ = flawedBox();
  Handle<raymap_mesh, raymap_mesh_free> cMesh_;
  Handle<raymap_options, raymap_options_free> cOptions_;
};

using Drawn = Handle<raymap_picture, raymap_picture_free>;

/// Expects a mesh of C to have these vertices and triangles.
void expectSame(const raymap_mesh* given, const Mesh& mesh) {
  ASSERT_EQ(raymap_mesh_vertex_count(given), mesh.vertices.size());
  ASSERT_EQ(raymap_mesh_triangle_count(given), mesh.triangles.size());
  std::vector<glm::uvec3> triangles(mesh.triangles.size());
  raymap_mesh_copy_triangles(given, &triangles.data()->x);
  EXPECT_EQ(triangles, mesh.triangles);
  std::vector<glm::dvec3> positions(mesh.vertices.size());
  raymap_mesh_copy_positions(given, &positions.data()->x);
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_EQ(positions[v], mesh.position(v));
}

void expectSame(const raymap_picture* given, const Picture& picture) {
  ASSERT_NE(given, nullptr) << raymap_last_error_message();
  ASSERT_EQ(raymap_picture_width(given), picture.width);
  ASSERT_EQ(raymap_picture_height(given), picture.height);
  EXPECT_EQ(std::memcmp(raymap_picture_rgb(given), picture.rgb.data(), picture.rgb.size()), 0);
}

/// Expects a narrow band of C to have these leaves, tiles and values.
void expectSame(const raymap_sparse_field* given, const SparseField& band) {
  ASSERT_NE(given, nullptr) << raymap_last_error_message();
  auto numbers = RAYMAP_INIT(raymap_sparse_numbers);
  raymap_sparse_field_numbers(given, &numbers);
  ASSERT_EQ(numbers.leaves, band.leaves.size());
  ASSERT_EQ(numbers.tiles, band.tiles.size());
  EXPECT_EQ(numbers.active, band.activeCount());
  EXPECT_EQ(numbers.bytes, band.bytes());
  EXPECT_EQ(numbers.outside, band.outside);
  EXPECT_EQ(numbers.inside, band.inside);
  const auto expectValues = [](const void* data, const auto& values) {
    ASSERT_EQ(data == nullptr, values.empty());
    if (data) {
      EXPECT_EQ(std::memcmp(data, values.data(), values.size() * sizeof values[0]), 0);
    }
  };
  expectValues(raymap_sparse_field_leaves(given), band.leaves);
  expectValues(raymap_sparse_field_tiles(given), band.tiles);
  expectValues(raymap_sparse_field_distance(given), band.distance);
  expectValues(raymap_sparse_field_triangle(given), band.triangle);
  expectValues(raymap_sparse_field_winding(given), band.winding);
  expectValues(raymap_sparse_field_confidence(given), band.confidence);
}

/// Removes what differs from run to run.
Json withoutTimes(Json report) {
  report["stats"].erase("milliseconds");
  for (Json& stage : report["stats"]["stages"]) stage.erase("milliseconds");
  return report;
}

TEST_F(CResults, InspectionIsThatOfTheThreeFunctions) {
  const Diagnostics found = diagnose(mesh_);
  const SelfIntersections crossings = findSelfIntersections(mesh_);
  const Verdict verdict = judge(mesh_, found, crossings);
  ASSERT_GT(crossings.pairs, 0u);
  ASSERT_EQ(found.holes.size(), 2u);

  const Handle<raymap_inspection, raymap_inspection_free> inspection(raymap_inspect(cMesh_.get(), nullptr));
  auto findings = RAYMAP_INIT(raymap_findings);
  ASSERT_EQ(raymap_inspection_findings(inspection.get(), &findings), RAYMAP_OK);
  EXPECT_EQ(findings.kind, name(verdict.kind));
  EXPECT_EQ(findings.remedy, name(verdict.remedy));
  EXPECT_EQ(findings.vertices, found.vertices);
  EXPECT_EQ(findings.welded_vertices, found.weldedVertices);
  EXPECT_EQ(findings.triangles, found.triangles);
  EXPECT_EQ(findings.components, found.components);
  EXPECT_EQ(findings.open_components, found.openComponents);
  EXPECT_EQ(findings.inward_components, found.inwardComponents);
  EXPECT_EQ(findings.sheets, found.sheets);
  EXPECT_EQ(findings.holes, found.holes.size());
  EXPECT_EQ(findings.boundary_edges, found.boundaryEdges);
  EXPECT_EQ(findings.non_manifold_edges, found.nonManifoldEdges);
  EXPECT_EQ(findings.flipped_edges, found.flippedEdges);
  EXPECT_EQ(findings.flipped_faces, found.flippedFaces);
  EXPECT_EQ(findings.degenerate_faces, found.degenerateFaces);
  EXPECT_EQ(findings.duplicate_faces, found.duplicateFaces);
  EXPECT_EQ(findings.double_sided_faces, found.doubleSidedFaces);
  EXPECT_EQ(findings.crossing_pairs, crossings.pairs);
  EXPECT_EQ(findings.crossing_faces, crossings.faces.size());
  EXPECT_EQ(findings.crossings_complete, crossings.complete);
  EXPECT_EQ(findings.watertight, found.watertight);
  EXPECT_EQ(findings.consistently_oriented, found.consistentlyOriented);
  EXPECT_EQ(findings.balanced, found.balanced);
  EXPECT_EQ(findings.signed_volume, found.signedVolume);
  EXPECT_EQ(findings.area, found.area);
  for (int a = 0; a < 3; ++a) {
    EXPECT_EQ(findings.min[a], found.bounds.min[a]);
    EXPECT_EQ(findings.max[a], found.bounds.max[a]);
  }
  EXPECT_EQ(std::isnan(findings.thinnest), !verdict.thinnest);

  const Handle<char, raymap_text_free> json(raymap_inspection_json(inspection.get()));
  Json expected = toJson(Inspection{found, crossings});
  expected["verdict"] = toJson(verdict);
  EXPECT_EQ(Json::parse(json.get()), expected);
  EXPECT_EQ(json.get(), textOf(expected));
}

TEST_F(CResults, AThinPartHasItsThickness) {
  for (glm::vec3& vertex : mesh_.vertices) vertex.z *= 0.05f;  // The C mesh views the same array.
  mesh_.triangles.pop_back();
  mesh_.triangles.insert(mesh_.triangles.end(), {{1, 3, 5}, {3, 7, 5}});
  auto arrays = RAYMAP_INIT(raymap_mesh_arrays);
  arrays.vertices = mesh_.vertices.data();
  arrays.vertex_count = mesh_.vertices.size();
  arrays.triangles = mesh_.triangles.data();
  arrays.triangle_count = mesh_.triangles.size();
  const Handle<raymap_mesh, raymap_mesh_free> plate(raymap_mesh_from_arrays(&arrays));
  const Handle<raymap_inspection, raymap_inspection_free> inspection(raymap_inspect(plate.get(), nullptr));
  auto findings = RAYMAP_INIT(raymap_findings);
  raymap_inspection_findings(inspection.get(), &findings);
  const Verdict verdict = judge(mesh_, diagnose(mesh_), findSelfIntersections(mesh_));
  ASSERT_TRUE(verdict.thinnest && verdict.voxelSize);
  EXPECT_NEAR(findings.thinnest, 0.05, 1e-4);
  EXPECT_EQ(findings.thinnest, *verdict.thinnest);
  EXPECT_EQ(findings.voxel_size, *verdict.voxelSize);
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
  auto cHow = RAYMAP_INIT(raymap_repair_options);
  cHow.offset = how.offset;
  cHow.shell = how.shell;
  cHow.drain_hole = how.drainHole;
  cHow.drain_holes = how.drainHoles;
  cHow.down[1] = -1;
  cHow.remesh = true;
  cHow.has_tolerance = true;
  cHow.tolerance = 0.02;
  const Repaired expected = repair(mesh_, grid, {}, how, {.device = "cpu"});
  ASSERT_EQ(expected.report.holes, 2u);
  const Handle<raymap_repaired, raymap_repaired_free> repaired(
      raymap_repair(cMesh_.get(), &cGrid, &cHow, cOptions_.get()));
  ASSERT_NE(repaired, nullptr) << raymap_last_error_message();
  expectSame(raymap_repaired_mesh(repaired.get()), expected.mesh);

  auto numbers = RAYMAP_INIT(raymap_repair_numbers);
  ASSERT_EQ(raymap_repaired_numbers(repaired.get(), &numbers), RAYMAP_OK);
  const RepairReport& report = expected.report;
  EXPECT_EQ(numbers.solids, report.solids);
  EXPECT_EQ(numbers.cavities, report.cavities);
  EXPECT_EQ(numbers.hollows, report.hollows);
  EXPECT_EQ(numbers.filled_hollows, report.filledHollows);
  EXPECT_EQ(numbers.drain_holes, report.holes);
  EXPECT_EQ(numbers.dropped, report.dropped.count);
  EXPECT_EQ(numbers.filled, report.filled.count);
  EXPECT_EQ(numbers.closed_holes, report.closedHoles);
  EXPECT_EQ(numbers.kept, report.kept);
  EXPECT_EQ(numbers.parts_overlap, report.partsOverlap);
  EXPECT_EQ(numbers.watertight, report.after.watertight);
  EXPECT_EQ(numbers.consistently_oriented, report.after.consistentlyOriented);
  EXPECT_EQ(numbers.volume, report.after.signedVolume);
  EXPECT_EQ(numbers.result_from_mesh, report.ofResult.max);
  EXPECT_EQ(numbers.mesh_from_result, report.ofMesh.max);
  EXPECT_EQ(numbers.lost_share, report.lostShare);
  EXPECT_EQ(numbers.buried_share, report.buriedShare);
  const Handle<char, raymap_text_free> json(raymap_repaired_json(repaired.get()));
  EXPECT_EQ(withoutTimes(Json::parse(json.get())), withoutTimes(toJson(report)));
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
  auto how = RAYMAP_INIT(raymap_repair_options);
  how.has_base = true;
  how.base = -1.0;
  raymap_grid grid{};
  ASSERT_EQ(raymap_fit_repair_grid(sheet.get(), nullptr, &how, &grid), RAYMAP_OK);
  const Handle<raymap_repaired, raymap_repaired_free> repaired(
      raymap_repair(sheet.get(), &grid, &how, cOptions_.get()));
  ASSERT_NE(repaired, nullptr) << raymap_last_error_message();
  auto numbers = RAYMAP_INIT(raymap_repair_numbers);
  ASSERT_EQ(raymap_repaired_numbers(repaired.get(), &numbers), RAYMAP_OK);
  EXPECT_TRUE(numbers.kept);
  EXPECT_NEAR(numbers.volume, 0.5 * (2.0 + 2.0 + 3.0) / 3.0, 1e-6);
}

TEST_F(CResults, OtherOptionsOfRepairAreThoseOfCpp) {
  const auto [grid, cGrid] = fit(32);
  const RepairOptions how{
      .closeHoles = false, .minThickness = 0.4, .dropSmaller = 0.0, .keepCavities = true, .measure = false};
  auto cHow = RAYMAP_INIT(raymap_repair_options);
  cHow.close_holes_in_steps = true;
  cHow.min_thickness = *how.minThickness;
  cHow.has_drop_smaller = true;
  cHow.keep_cavities = true;
  cHow.is_brief = true;
  const Repaired expected = repair(mesh_, grid, {}, how, {.device = "cpu"});
  const Handle<raymap_repaired, raymap_repaired_free> repaired(
      raymap_repair(cMesh_.get(), &cGrid, &cHow, cOptions_.get()));
  ASSERT_NE(repaired, nullptr) << raymap_last_error_message();
  expectSame(raymap_repaired_mesh(repaired.get()), expected.mesh);
  const Handle<char, raymap_text_free> json(raymap_repaired_json(repaired.get()));
  EXPECT_EQ(withoutTimes(Json::parse(json.get())), withoutTimes(toJson(expected.report)));
}

TEST_F(CResults, RepairGridIsThatOfCpp) {
  auto cHow = RAYMAP_INIT(raymap_repair_options);
  cHow.min_thickness = 0.5;
  auto options = RAYMAP_INIT(raymap_grid_options);
  options.voxel_size = 0.1;
  options.has_padding = true;
  options.padding = 0.25;
  raymap_grid fitted;
  ASSERT_EQ(raymap_fit_repair_grid(cMesh_.get(), &options, &cHow, &fitted), RAYMAP_OK);
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
  const Handle<raymap_mesh, raymap_mesh_free> cFine(raymap_isosurface(field.get(), 0.0, nullptr));
  for (const SimplifyOptions& how : {SimplifyOptions{.tolerance = 0.02, .step = 0.1},
                                     SimplifyOptions{.tolerance = 1.0, .step = 0.1, .triangles = 200}}) {
    const Simplified expected = simplify(fine, how);
    ASSERT_LT(expected.mesh.triangles.size(), fine.triangles.size());
    auto cHow = RAYMAP_INIT(raymap_simplify_options);
    cHow.tolerance = how.tolerance;
    cHow.step = how.step;
    cHow.triangles = how.triangles;
    auto simplified = RAYMAP_INIT(raymap_simplified);
    const Handle<raymap_mesh, raymap_mesh_free> coarse(
        raymap_simplify(cFine.get(), &cHow, nullptr, &simplified));
    expectSame(coarse.get(), expected.mesh);
    EXPECT_EQ(simplified.deviation, expected.deviation);
    EXPECT_EQ(simplified.undone, expected.undone);
    EXPECT_EQ(simplified.tolerance, expected.tolerance);
  }
}

TEST_F(CResults, RepairedMeshHasAsFewTrianglesAsAskedFor) {
  const auto [grid, cGrid] = fit(32);
  auto how = RAYMAP_INIT(raymap_repair_options);
  how.remesh = true;
  how.triangles = 200;
  const Handle<raymap_repaired, raymap_repaired_free> repaired(
      raymap_repair(cMesh_.get(), &cGrid, &how, cOptions_.get()));
  ASSERT_NE(repaired, nullptr) << raymap_last_error_message();
  EXPECT_LE(raymap_mesh_triangle_count(raymap_repaired_mesh(repaired.get())), 200u);
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
  ASSERT_EQ(raymap_surface_thickness(surface.get(), &positions.data()->x, triangles.data(), points.size(),
                                     1.5, nullptr, &arrays),
            RAYMAP_OK);
  for (size_t p = 0; p < points.size(); ++p)
    EXPECT_EQ((Thickness{Part(part[p]), diameter[p], inward[p]}), expected[p]);
  static_assert(int(Part::Wall) == RAYMAP_PART_WALL && int(Part::Edge) == RAYMAP_PART_EDGE &&
                int(Part::Corner) == RAYMAP_PART_CORNER && int(Part::Solid) == RAYMAP_PART_SOLID &&
                int(Part::Sheet) == RAYMAP_PART_SHEET && int(Part::Buried) == RAYMAP_PART_BURIED);
}

TEST_F(CResults, BandsAreThoseOfCpp) {
  const auto [grid, cGrid] = fit(40);
  for (const char* array : {"triangle", "winding", "confidence"})
    raymap_options_set_number(cOptions_.get(), array, 1);
  const Handle<raymap_surface, raymap_surface_free> cSurface(raymap_surface_create(cMesh_.get(), nullptr));
  auto widths = RAYMAP_INIT(raymap_band_options);
  widths.outside = 2.0;
  widths.inside = 3.5;
  const BandOptions options{
      .outside = 2.0, .inside = 3.5, .triangle = true, .winding = true, .confidence = true};
  using Band = Handle<raymap_sparse_field, raymap_sparse_field_free>;
  const Band made(raymap_surface_generate_band(cSurface.get(), &cGrid, &widths, cOptions_.get()));
  const SparseField band = Surface(mesh_).generateBand(grid, options);
  expectSame(made.get(), band);

  const Handle<raymap_field, raymap_field_free> dense(raymap_generate(cMesh_.get(), &cGrid, cOptions_.get()));
  const Band cut(raymap_field_to_sparse(dense.get(), &widths, cOptions_.get()));
  const FieldOptions arrays{.triangle = true, .winding = true, .confidence = true};
  expectSame(cut.get(), toSparse(generate(mesh_, grid, arrays, {.device = "cpu"}).field, options));

  const Handle<raymap_mesh, raymap_mesh_free> contour(
      raymap_sparse_field_isosurface(made.get(), 0.01, nullptr));
  expectSame(contour.get(), isosurface(band, {.iso = 0.01}));
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
  raymap_options_set_number(cOptions_.get(), "winding", 1);
  const Handle<raymap_surface, raymap_surface_free> surface(raymap_surface_create(cMesh_.get(), nullptr));
  const Handle<raymap_sparse_field, raymap_sparse_field_free> cBand(
      raymap_surface_generate_band(surface.get(), &cGrid, nullptr, cOptions_.get()));
  const SparseField band = Surface(mesh_).generateBand(grid, {.winding = true});
  auto view = RAYMAP_INIT(raymap_view);
  view.width = 60;
  view.height = 40;
  view.cut = true;
  const RenderOptions how{.width = 60, .height = 40, .cut = true};
  expectSame(Drawn(raymap_render_sparse_field(cBand.get(), &view, cOptions_.get())).get(),
             renderField(band, how, {.device = "cpu"}));
  expectSame(Drawn(raymap_render_sparse_slice(cBand.get(), 1, 5, 50, "winding")).get(),
             renderSlice(band, 1, 5, 50, FieldArray::Winding));
  expectSame(Drawn(raymap_render_sparse_slice(cBand.get(), 2, -1, 0, nullptr)).get(), renderSlice(band, 2));

  const TemporaryFolder folder;
  const std::string path = (folder.path() / "band.html").string();
  auto page = RAYMAP_INIT(raymap_page_options);
  page.title = "a band";
  page.max_size = 20;
  page.other_sparse = cBand.get();
  ASSERT_EQ(raymap_write_sparse_page(cBand.get(), path.c_str(), &view, &page, cOptions_.get()), RAYMAP_OK);
  const PageOptions shown{.title = "a band", .maxSize = 20, .otherBand = &band};
  EXPECT_EQ(readBytes(path), makePage(band, how, shown, {.device = "cpu"}).html);
  EXPECT_EQ(raymap_write_sparse_page(nullptr, path.c_str(), nullptr, nullptr, nullptr), RAYMAP_ERROR_USAGE);
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
  auto view = RAYMAP_INIT(raymap_view);
  view.width = 60;
  view.height = 40;
  view.direction[0] = 1;
  view.direction[1] = 0.5;
  view.direction[2] = -0.2;
  view.up[2] = 1;
  view.field_of_view = 45;
  view.cut = true;
  view.shell = 0.2;
  view.has_frame = true;
  for (int a = 0; a < 3; ++a) {
    view.frame_min[a] = how.frame->min[a];
    view.frame_max[a] = how.frame->max[a];
  }
  expectSame(Drawn(raymap_render_field(cField.get(), &view, cOptions_.get())).get(),
             renderField(field, how, machine));
  RenderOptions open = how;
  open.eye = glm::dvec3(-4.0, -2.0, 3.0);
  open.iso = 0.125;
  open.cutPlane = Plane{{1, 0.5, 0.25}, 1.5};
  open.slice = Plane{{0, 2, 1}, 0.75};
  view.has_eye = true;
  for (int a = 0; a < 3; ++a) {
    view.eye[a] = (*open.eye)[a];
    view.cut_plane[a] = open.cutPlane->normal[a];
    view.slice_plane[a] = open.slice->normal[a];
  }
  view.iso = open.iso;
  view.cut_plane[3] = open.cutPlane->offset;
  view.slice_plane[3] = open.slice->offset;
  expectSame(Drawn(raymap_render_field(cField.get(), &view, cOptions_.get())).get(),
             renderField(field, open, machine));
  // The first version of the struct ended before these.
  view.size = offsetof(raymap_view, has_eye);
  expectSame(Drawn(raymap_render_field(cField.get(), &view, cOptions_.get())).get(),
             renderField(field, how, machine));
  expectSame(Drawn(raymap_render_defects(cMesh_.get(), &view, cOptions_.get())).get(),
             renderDefects(mesh_, how));
  expectSame(Drawn(raymap_render_slice(cField.get(), 1, 5, 50, "winding")).get(),
             renderSlice(field, 1, 5, 50, FieldArray::Winding));
  expectSame(Drawn(raymap_render_slice(cField.get(), 2, -1, 0, nullptr)).get(), renderSlice(field, 2));
}

TEST_F(CResults, PictureWithoutAViewIsThatOfCpp) {
  const auto [grid, cGrid] = fit(24);
  const Handle<raymap_field, raymap_field_free> field(raymap_generate(cMesh_.get(), &cGrid, cOptions_.get()));
  expectSame(Drawn(raymap_render_field(field.get(), nullptr, cOptions_.get())).get(),
             renderField(generate(mesh_, grid, {}, {.device = "cpu"}).field, {}, {.device = "cpu"}));
}

}  // namespace
}  // namespace raymap
