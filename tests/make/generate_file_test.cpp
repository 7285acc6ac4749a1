#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/generate_file.h>
#include <raymap/surface.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "error_code.h"
#include "files.h"
#include "shapes.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

bool hasVdb() {
  const std::vector<std::string> extensions = fieldExtensions();
  return std::ranges::find(extensions, ".vdb") != extensions.end();
}

/// Fields of a ball. Those of `large_` take 16.4 MB.
class GenerateFile : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  FieldPlan plan(const std::string& name, const FieldOptions& options = {},
                 const MachineOptions& machine = {}) {
    return planFile(mesh_, large_, options, {.distance = path(name)}, machine);
  }
  FieldForm form(const std::string& name, const FieldOptions& options = {},
                 const MachineOptions& machine = {}) {
    return plan(name, options, machine).form;
  }
  std::string refusal(const FieldFiles& files, const FieldOptions& options = {}) {
    return usageMessage([&] { generateFile(mesh_, small_, options, files, cpu_); });
  }
  Field regionOf(const Grid& grid, const RegionOptions& options) {
    return Surface(mesh_).generateRegion(grid, {{0, 0, 0}, grid.dims}, options);
  }
  /// Checks that a file has the bytes that `writeField` writes.
  void expectFile(const std::string& name, const Field& field, const FieldWriteOptions& options = {}) {
    writeField(path("expected_" + name), field, options);
    EXPECT_TRUE(readBytes(path(name)) == readBytes(path("expected_" + name))) << name;
  }

  TemporaryFolder folder_;
  Mesh mesh_ = shapes::sphere(1.0, 2);
  Grid small_ = fitGrid(mesh_, {.resolution = 20}), large_ = fitGrid(mesh_, {.resolution = 160});
  MachineOptions cpu_{.device = "cpu"}, few_{.device = "cpu", .threads = 1, .memoryLimit = size_t{15} << 20};
};

TEST_F(GenerateFile, PlansByFormatAndMemory) {
  const FieldPlan whole = plan("f.npy");
  EXPECT_EQ(whole.form, FieldForm::Whole);
  EXPECT_EQ(whole.planes, 160);
  EXPECT_EQ(whole.bytes, large_.sampleCount() * sizeof(float));
  const FieldPlan slabs = plan("f.npy", {}, few_);
  EXPECT_EQ(slabs.form, FieldForm::Slabs);
  EXPECT_GT(slabs.planes, 0);
  EXPECT_LT(slabs.planes, 160);
  EXPECT_EQ(slabs.bytes, regionBytes({160, 160, 2 * slabs.planes}, {}, few_));
  EXPECT_LE(slabs.bytes, few_.memoryLimit);
  for (const FieldOptions& options : {FieldOptions{.distance = DistanceMode::Cell},
                                      {.sign = SignMode::Rays},
                                      {.invert = true},
                                      {.closeHoles = true}})
    EXPECT_EQ(form("f.npy", options, few_), FieldForm::Whole);
  MachineOptions gpu = few_;
  gpu.device = "vulkan:0";
  EXPECT_EQ(form("f.npy", {}, gpu), FieldForm::Whole);
  EXPECT_EQ(form("f.npz", {}, few_), FieldForm::Whole);
  EXPECT_EQ(form("f.vti", {.winding = true}, few_), FieldForm::Slabs);
  const auto formWith = [&](const FieldFiles& files) {
    return planFile(mesh_, large_, {}, files, few_).form;
  };
  EXPECT_EQ(formWith({.distance = path("f"), .format = ".nrrd"}), FieldForm::Slabs);
  EXPECT_EQ(formWith({.distance = path("f.npy"), .winding = path("w.npz")}), FieldForm::Whole);
  EXPECT_EQ(formWith({.distance = path("f.npy"), .half = true}), FieldForm::Whole);
  EXPECT_EQ(formWith({.distance = path("f.npy"), .keepsField = true}), FieldForm::Whole);
  const Grid beyondNumbers{glm::ivec3(1 << 24), glm::dvec3(-1.0), 1e-6};  // 2^72 samples.
  EXPECT_EQ(planFile(mesh_, beyondNumbers, {}, {.distance = path("f.npy")}).form, FieldForm::Slabs);
  EXPECT_EQ(planFile(Mesh{}, large_, {.allowEmpty = true}, {.distance = path("f.npy")}, few_).form,
            FieldForm::Whole);
}

TEST_F(GenerateFile, PlansNarrowBands) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  const Grid many = fitGrid(mesh_, {.resolution = 300});
  const auto formOn = [&](const Grid& grid, const FieldFiles& files, const FieldOptions& options) {
    return planFile(mesh_, grid, options, files).form;
  };
  EXPECT_EQ(formOn(many, {.distance = path("f.vdb")}, {.band = 3.0}), FieldForm::NarrowBand);
  EXPECT_EQ(formOn(many, {.distance = path("f.vdb")}, {}), FieldForm::Whole);
  EXPECT_EQ(formOn(many, {.distance = path("f.npz")}, {.band = 3.0}), FieldForm::Whole);
  EXPECT_EQ(formOn(many, {.distance = path("f.vdb")}, {.band = 3.0, .winding = true}), FieldForm::Whole);
  EXPECT_EQ(formOn(small_, {.distance = path("f.nvdb")}, {.band = 3.0}), FieldForm::Whole);
  EXPECT_EQ(formOn(small_, {.distance = path("f.nvdb"), .fullInside = true}, {.band = 3.0}),
            FieldForm::NarrowBand);
}

TEST_F(GenerateFile, WritesWholeFields) {
  const Generated made = generate(mesh_, small_, {.winding = true}, cpu_);
  const FileReport report = generateFile(
      mesh_, small_, {}, {.distance = path("f.npz"), .winding = path("w.nrrd"), .half = true}, cpu_);
  EXPECT_EQ(report.plan.form, FieldForm::Whole);
  EXPECT_EQ(report.stats.device, "cpu");
  expectFile("f.npz", made.field, {.half = true});
  expectFile("w.nrrd", made.field, {.array = FieldArray::Winding});
}

TEST_F(GenerateFile, WritesSlabsWithAllArrays) {
  std::vector<FieldForm> told;
  FieldFiles files{.distance = path("f.vti"), .confidence = path("c.npy")};
  files.planned = [&](const FieldPlan& plan) { told.push_back(plan.form); };
  const Grid grid = fitGrid(mesh_, {.resolution = 120});
  const FileReport report = generateFile(mesh_, grid, {.band = 3.0, .triangle = true}, files, few_);
  EXPECT_EQ(told, std::vector{FieldForm::Slabs});
  EXPECT_EQ(report.plan.form, FieldForm::Slabs);
  EXPECT_GE(report.stats.bytes, report.plan.bytes);
  EXPECT_EQ(report.stats.stages.back().name, "slabs");
  const Field whole = regionOf(grid, {.band = 3.0, .triangle = true, .confidence = true});
  expectFile("f.vti", whole);
  expectFile("c.npy", whole, {.array = FieldArray::Confidence});
}

// The samples fit into memory, but not the work on all of them.
TEST_F(GenerateFile, MakesSlabsWhereAWholeFieldNeedsMore) {
  const Grid grid = fitGrid(mesh_, {.resolution = 120});
  const MachineOptions machine{.device = "cpu", .threads = 1, .memoryLimit = size_t{9} << 20};
  std::vector<FieldForm> told;
  FieldFiles files{.distance = path("f.npy")};
  files.planned = [&](const FieldPlan& plan) { told.push_back(plan.form); };
  FileGenerator generator;
  EXPECT_EQ(generator.make(mesh_, grid, {.band = 3.0}, files, machine).plan.form, FieldForm::Slabs);
  EXPECT_EQ(told, (std::vector{FieldForm::Whole, FieldForm::Slabs}));
  EXPECT_TRUE(generator.field().distance.empty());
  expectFile("f.npy", regionOf(grid, {.band = 3.0}));
  generator.write();  // Nothing is left.
  expectFile("f.npy", regionOf(grid, {.band = 3.0}));
  files.distance = path("f.npz");
  EXPECT_EQ(codeOf([&] { generator.make(mesh_, grid, {.band = 3.0}, files, machine); }), ErrorCode::Memory);
  generator.write();
  EXPECT_FALSE(fs::exists(path("f.npz")));
}

TEST_F(GenerateFile, GoesOnWithSlabs) {
  const FieldFiles files{.distance = path("f.nrrd")};
  MachineOptions stopped = few_;
  stopped.progress = [](std::string_view stage, double done) { return stage != "region" || done < 0.5; };
  const auto make = [&](const FieldOptions& options, const MachineOptions& machine) {
    generateFile(mesh_, large_, options, files, machine);
  };
  EXPECT_EQ(codeOf([&] { make({.band = 3.0}, stopped); }), ErrorCode::Cancelled);
  EXPECT_TRUE(fs::exists(path("f.nrrd.part")));
  std::vector<std::string> warnings;
  MachineOptions warned = few_;
  warned.warn = [&](const Warning& warning) { warnings.push_back(warning.message); };
  const auto isWarnedOf = [&](const char* text) {
    return std::ranges::any_of(warnings,
                               [&](const std::string& each) { return each.find(text) != each.npos; });
  };
  warned.progress = stopped.progress;
  EXPECT_EQ(codeOf([&] { make({.threshold = 0.4, .band = 3.0}, warned); }), ErrorCode::Cancelled);
  EXPECT_TRUE(isWarnedOf("is of another mesh, grid or options"));
  warned.progress = {};
  make({.threshold = 0.4, .band = 3.0}, warned);
  EXPECT_TRUE(isWarnedOf(": goes on after "));
  EXPECT_FALSE(fs::exists(path("f.nrrd.part")));
  expectFile("f.nrrd", regionOf(large_, {.band = 3.0}));
}

TEST_F(GenerateFile, WritesNarrowBands) {
  if (!hasVdb()) GTEST_SKIP() << "a build without OpenVDB";
  FileGenerator generator;
  Mesh given = mesh_;
  const FieldFiles files{.distance = path("f.nvdb"), .gridName = "surface", .fullInside = true};
  const FileReport report = generator.make(std::move(given), small_, {.band = 2.0}, files, cpu_);
  EXPECT_EQ(report.plan.form, FieldForm::NarrowBand);
  generator.write();
  writeField(path("expected.nvdb"),
             Surface(mesh_).generateBand(small_,
                                         {.outside = 2.0, .inside = std::numeric_limits<double>::infinity()}),
             {.gridName = "surface"});
  EXPECT_TRUE(readBytes(path("f.nvdb")) == readBytes(path("expected.nvdb")));
}

TEST_F(GenerateFile, KeepsItsMemoryForTheNextMesh) {
  FileGenerator generator;
  const FieldFiles files{.distance = path("f.npy")};
  generator.make(mesh_, small_, {}, files, cpu_);
  const float* memory = generator.field().distance.data();
  generator.make(shapes::sphere(0.9, 2), small_, {}, files, cpu_);
  EXPECT_EQ(generator.field().distance.data(), memory);
  generator.write();
  expectFile("f.npy", generate(shapes::sphere(0.9, 2), small_, {}, cpu_).field);
}

TEST_F(GenerateFile, RefusesFilesBeforeItMakesTheField) {
  EXPECT_EQ(refusal({}), "a field needs a file to be written into");
  EXPECT_NE(refusal({.distance = path("f.obj")}).find("is not a format for fields"), std::string::npos);
  EXPECT_NE(refusal({.distance = path("f.npy"), .winding = path("w.csv")}).find("w.csv: '.csv' is not"),
            std::string::npos);
  EXPECT_NE(refusal({.distance = path("f.nrrd"), .half = true}).find("has no type for numbers of 16 bits"),
            std::string::npos);
  EXPECT_NE(
      refusal({.distance = path("f.npy"), .gridName = "a"}).find("only a .vdb or .nvdb has a grid's name"),
      std::string::npos);
  EXPECT_NE(
      refusal({.distance = path("f.npy")}, {.winding = true}).find("write the winding numbers into another"),
      std::string::npos);
  EXPECT_NE(refusal({.distance = path("f.npy"), .fullInside = true}, {.band = 3.0}).find("the whole inside"),
            std::string::npos);
  EXPECT_NE(usageMessage([&] { planFile(mesh_, Grid{}, {}, {.distance = path("f.npy")}); }), "no error");
  EXPECT_EQ(folder_.fileCount(), 0u);
}

TEST_F(GenerateFile, WritesDenseFieldsOfBands) {
  const Field band = Surface(mesh_).generateBand(small_, {.winding = true});
  const Field dense = toDense(band);
  for (const std::string extension : {".npy", ".vti", ".npz"}) {
    writeDense(path("f" + extension), band);
    expectFile("f" + extension, dense);
  }
  writeDense(path("w.npy"), band, {.array = FieldArray::Winding});
  expectFile("w.npy", dense, {.array = FieldArray::Winding});
  writeDense(path("h.npy"), band, {.half = true});
  expectFile("h.npy", dense, {.half = true});
}

}  // namespace
}  // namespace raymap
