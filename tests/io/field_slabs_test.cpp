#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/field_slabs.h>
#include <raymap/io.h>

#include <algorithm>
#include <fstream>
#include <numeric>

#include "error_code.h"
#include "files.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

Field counted() {
  Field field;
  field.grid = {.dims = {5, 4, 7}, .origin = {0.1, -2.0 / 3.0, 1e7}, .spacing = 0.3};
  const size_t samples = field.grid.sampleCount();
  field.distance.resizeUninitialized(samples);
  field.triangle.resizeUninitialized(samples);
  for (size_t i = 0; i < samples; ++i) field.distance[i] = 0.7f * float(i) - 11.0f;
  std::iota(field.triangle.begin(), field.triangle.end(), 5u);
  field.clampDistance = 0.9;
  field.surfaceBounds = {{-1.0, 0.25, 1e7}, {1.0 / 3.0, 2.0, 1e7 + 1}};
  return field;
}

Field planesOf(const Field& field, int begin, int end) {
  const size_t plane = size_t(field.grid.dims.x) * size_t(field.grid.dims.y),
               count = plane * size_t(end - begin);
  Field slab;
  slab.distance.resizeUninitialized(count);
  slab.triangle.resizeUninitialized(count);
  std::copy_n(field.distance.begin() + plane * size_t(begin), count, slab.distance.begin());
  std::copy_n(field.triangle.begin() + plane * size_t(begin), count, slab.triangle.begin());
  return slab;
}

/// A file that is written in slabs, of which some runs fail.
class FieldSlabs : public ::testing::Test {
 protected:
  /// Writes the field. Fails at the plane numbered `stop`.
  void write(const std::string& name, const SlabOptions& options = {}, int stop = 100) {
    asked_.clear();
    writeFieldInSlabs(
        path(name), field_,
        [&](int begin, int end) {
          asked_.push_back(begin);
          if (end > stop) throw Error(ErrorCode::Cancelled, "stopped");
          return planesOf(field_, begin, end);
        },
        options);
  }

  SlabOptions keyed(const std::string& key, int thickness = 2) {
    return {.thickness = thickness, .key = key, .warn = [&](const Warning& w) {
              EXPECT_EQ(w.code, WarningCode::PartFile);
              EXPECT_TRUE(w.fields.file.starts_with(folder_.path().string())) << w.fields.file;
              told_ += w.message + "\n";
            }};
  }

  void stop(const std::string& name, const SlabOptions& options, int plane) {
    EXPECT_EQ(codeOf([&] { write(name, options, plane); }), ErrorCode::Cancelled);
    EXPECT_FALSE(fs::exists(path(name)));
  }

  fs::path path(const std::string& name) const { return folder_.path() / name; }
  std::string whole(const std::string& extension, FieldArray array = FieldArray::Distance) {
    Field alone = planesOf(field_, 0, field_.grid.dims.z);
    alone.grid = field_.grid;
    alone.clampDistance = field_.clampDistance;
    alone.surfaceBounds = field_.surfaceBounds;
    if (array == FieldArray::Triangle)
      alone.distance = {};
    else
      alone.triangle = {};
    writeField(path("whole" + extension), alone, {.array = array});
    return readBytes(path("whole" + extension));
  }
  bool wasTold(const std::string& text) const { return told_.find(text) != std::string::npos; }

  TemporaryFolder folder_;
  Field field_ = counted();
  std::vector<int> asked_;
  std::string told_;
};

TEST_F(FieldSlabs, HaveTheBytesOfTheWholeField) {
  for (const std::string& extension : slabExtensions())
    for (const FieldArray array : {FieldArray::Distance, FieldArray::Triangle}) {
      const std::string expected = whole(extension, array);
      for (const int thickness : {1, 2, 3, 7, 1000})
        for (const char* key : {"", "a"}) {
          write("slabs" + extension, {.thickness = thickness, .array = array, .key = key});
          EXPECT_EQ(readBytes(path("slabs" + extension)), expected) << extension << ' ' << thickness;
          EXPECT_EQ(asked_.size(), size_t((7 + std::min(thickness, 7) - 1) / std::min(thickness, 7)));
          EXPECT_EQ(folder_.fileCount(), 2u);
        }
      fs::remove(path("whole" + extension));
      fs::remove(path("slabs" + extension));
    }
}

TEST_F(FieldSlabs, LeaveNothingOfARunWithoutAKey) {
  stop("a.npy", {.thickness = 2}, 5);
  EXPECT_EQ(folder_.fileCount(), 0u);
  stop("a.npy", keyed("k"), 1);  // No slab is whole.
  EXPECT_EQ(folder_.fileCount(), 0u);
  EXPECT_EQ(told_, "");
}

TEST_F(FieldSlabs, GoOnWhereARunStopped) {
  for (const std::string& extension : slabExtensions()) {
    SCOPED_TRACE(extension);
    const std::string name = "a" + extension;
    told_ = "";
    stop(name, keyed("k"), 5);
    EXPECT_TRUE(wasTold(name + ".part holds 4 of 7 planes; the same run goes on from there")) << told_;
    stop(name, keyed("k", 1), 5);
    EXPECT_EQ(asked_, (std::vector<int>{4, 5}));
    std::ofstream(path(name + ".part"), std::ios::app) << "half a slab";
    write(name, keyed("k", 10));
    EXPECT_EQ(asked_, std::vector<int>{5});
    EXPECT_TRUE(wasTold(name + ": goes on after 5 of 7 planes")) << told_;
    EXPECT_EQ(readBytes(path(name)), whole(extension));
    EXPECT_FALSE(fs::exists(path(name + ".part")));
    EXPECT_FALSE(fs::exists(path(name + ".part.done")));
  }
}

TEST_F(FieldSlabs, BeginAnewForOtherWork) {
  stop("a.npy", keyed("k"), 5);
  write("a.npy", keyed("other"));
  EXPECT_EQ(asked_.front(), 0);
  EXPECT_TRUE(wasTold("a.npy.part is of another mesh, grid or options")) << told_;
  fs::remove(path("a.npy"));
  stop("a.npy", keyed("k"), 5);
  field_.grid.origin.x += 1e-9;  // A .npy does not hold it.
  write("a.npy", keyed("k"));
  EXPECT_EQ(asked_.front(), 0);
  EXPECT_EQ(readBytes(path("a.npy")), whole(".npy"));
}

TEST_F(FieldSlabs, BeginAnewIfTheStartIsTorn) {
  stop("a.nrrd", keyed("k"), 5);
  fs::resize_file(path("a.nrrd.part"), fs::file_size(path("a.nrrd.part")) - 1);
  write("a.nrrd", keyed("k"));
  EXPECT_EQ(asked_.front(), 0);
  EXPECT_TRUE(wasTold("a.nrrd.part is shorter than the earlier run noted")) << told_;
  EXPECT_EQ(readBytes(path("a.nrrd")), whole(".nrrd"));
}

TEST_F(FieldSlabs, KeepWhatIsInTheWay) {
  std::ofstream(path("a.npy.part")) << "mine";
  EXPECT_EQ(codeOf([&] { write("a.npy", keyed("k")); }), ErrorCode::File);
  EXPECT_EQ(readBytes(path("a.npy.part")), "mine");
  EXPECT_EQ(folder_.fileCount(), 1u);
}

TEST_F(FieldSlabs, FollowLinksAndKeepPermissions) {
  std::ofstream(path("real.npy")) << "old";
  fs::permissions(path("real.npy"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("real.npy", path("link.npy"));
  write("link.npy", keyed("k"));
  EXPECT_TRUE(fs::is_symlink(path("link.npy")));
  EXPECT_EQ(readBytes(path("real.npy")), whole(".npy"));
  EXPECT_EQ(fs::status(path("real.npy")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(FieldSlabs, RefuseWhatMakesNoSense) {
  const auto code = [&](const std::string& name, const SlabOptions& options = {}) {
    return codeOf([&] { write(name, options); });
  };
  EXPECT_EQ(code("a.npz"), ErrorCode::Usage);
  EXPECT_EQ(code("a.npy", {.thickness = 0}), ErrorCode::Usage);
  EXPECT_EQ(code("a.npy", {.array = FieldArray::Winding}), ErrorCode::Usage);
  EXPECT_EQ(code("missing/a.npy"), ErrorCode::File);
  EXPECT_EQ(code("missing/a.npy", keyed("k")), ErrorCode::File);
  const Field good = counted();
  field_.grid.dims.x = 6;
  EXPECT_EQ(codeOf([&] {
              writeFieldInSlabs(path("a.npy"), field_, [&](int a, int b) { return planesOf(good, a, b); });
            }),
            ErrorCode::Usage);
  field_.grid.dims = glm::ivec3(1 << 24);  // More than 64 bits can number.
  EXPECT_EQ(code("a.npy"), ErrorCode::Usage);
  field_.grid.dims = glm::ivec3(1 << 18);  // 64 petabytes.
  for (const SlabOptions& options : {SlabOptions{}, keyed("k")}) {
    try {
      write("a.npy", options);
      FAIL() << "no disk has so much space";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::File);
      EXPECT_NE(std::string(error.what()).find("the file needs 68719476737 MiB, but only "),
                std::string::npos)
          << error.what();
    }
  }
  EXPECT_TRUE(asked_.empty());
  EXPECT_EQ(folder_.fileCount(), 0u);
}

}  // namespace
}  // namespace raymap
