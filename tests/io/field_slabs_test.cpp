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
  field.confidence.resizeUninitialized(samples);
  for (size_t i = 0; i < samples; ++i) field.confidence[i] = 1.0f / float(i + 1);
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
  slab.confidence.resizeUninitialized(count);
  std::copy_n(field.confidence.begin() + plane * size_t(begin), count, slab.confidence.begin());
  return slab;
}

/// A file that is written in slabs, of which some runs fail.
class FieldSlabs : public ::testing::Test {
 protected:
  using Arrays = std::vector<FieldArray>;

  /// Writes the distances. Fails at the plane numbered `stop`.
  void write(const std::string& name, const SlabOptions& options = {}, int stop = 100) {
    writeFiles({{.path = path(name)}}, options, stop);
  }
  void writeFiles(const std::vector<SlabFile>& files, const SlabOptions& options, int stop = 100) {
    asked_.clear();
    writeFieldInSlabs(
        files, field_,
        [&](int begin, int end) {
          asked_.push_back(begin);
          if (end > stop) throw Error(ErrorCode::Cancelled, "stopped");
          return planesOf(field_, begin, end);
        },
        options);
  }

  SlabOptions keyed(const std::string& key, int thickness = 2) {
    return {.planes = thickness, .key = key, .warn = [&](const Warning& w) {
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
  /// Returns the bytes that `writeField` writes of these arrays.
  std::string whole(const std::string& extension, const Arrays& arrays = {FieldArray::Distance}) {
    Field alone = planesOf(field_, 0, field_.grid.dims.z);
    alone.grid = field_.grid;
    alone.clampDistance = field_.clampDistance;
    alone.surfaceBounds = field_.surfaceBounds;
    const auto isAsked = [&](FieldArray array) { return std::ranges::count(arrays, array) > 0; };
    if (!isAsked(FieldArray::Distance)) alone.distance = {};
    if (!isAsked(FieldArray::Triangle)) alone.triangle = {};
    if (!isAsked(FieldArray::Confidence)) alone.confidence = {};
    const fs::path file = path("whole" + extension);
    writeField(file, alone, {.array = arrays.front()});
    const std::string bytes = readBytes(file);
    fs::remove(file);
    return bytes;
  }
  bool wasTold(const std::string& text) const { return told_.find(text) != std::string::npos; }

  TemporaryFolder folder_;
  Field field_ = counted();
  std::vector<int> asked_;
  std::string told_;
};

TEST_F(FieldSlabs, HaveTheBytesOfTheWholeField) {
  for (const std::string& extension : slabExtensions())
    for (const Arrays& arrays :
         {Arrays{FieldArray::Distance}, Arrays{FieldArray::Triangle},
          Arrays{FieldArray::Distance, FieldArray::Triangle, FieldArray::Confidence}}) {
      if (arrays.size() > 1 && extension != ".vti") continue;
      const std::string expected = whole(extension, arrays);
      for (const int thickness : {1, 2, 3, 7, 1000})
        for (const char* key : {"", "a"}) {
          writeFiles({{.path = path("slabs" + extension), .arrays = arrays}},
                     {.planes = thickness, .key = key});
          EXPECT_EQ(readBytes(path("slabs" + extension)), expected) << extension << ' ' << thickness;
          EXPECT_EQ(asked_.size(), size_t((7 + std::min(thickness, 7) - 1) / std::min(thickness, 7)));
          EXPECT_EQ(folder_.fileCount(), 1u);
        }
      fs::remove(path("slabs" + extension));
    }
}

// Every slab is asked for once, and all files go on from the same plane.
TEST_F(FieldSlabs, AreWrittenIntoSeveralFiles) {
  const Arrays all{FieldArray::Distance, FieldArray::Confidence, FieldArray::Triangle};
  const std::vector<SlabFile> files{{.path = path("a.vti"), .arrays = all},
                                    {.path = path("c.npy"), .arrays = {FieldArray::Confidence}},
                                    {.path = path("t.nrrd"), .arrays = {FieldArray::Triangle}}};
  const auto expectWhole = [&] {
    EXPECT_EQ(readBytes(path("a.vti")), whole(".vti", all));
    EXPECT_EQ(readBytes(path("c.npy")), whole(".npy", {FieldArray::Confidence}));
    EXPECT_EQ(readBytes(path("t.nrrd")), whole(".nrrd", {FieldArray::Triangle}));
    EXPECT_EQ(folder_.fileCount(), 3u);
    for (const SlabFile& file : files) fs::remove(file.path);
  };
  const auto stopAt = [&](int plane, const SlabOptions& options) {
    told_ = "";
    EXPECT_EQ(codeOf([&] { writeFiles(files, options, plane); }), ErrorCode::Cancelled);
  };
  writeFiles(files, {.planes = 3});
  EXPECT_EQ(asked_, (std::vector<int>{0, 3, 6}));
  expectWhole();
  stopAt(5, {.planes = 2});
  EXPECT_EQ(folder_.fileCount(), 0u);

  stopAt(5, keyed("k"));
  for (const char* name : {"a.vti", "c.npy", "t.nrrd"})
    EXPECT_TRUE(wasTold(std::string(name) + ".part holds 4 of 7 planes")) << told_;
  EXPECT_EQ(folder_.fileCount(), 6u);
  writeFiles(files, keyed("k"));
  EXPECT_EQ(asked_, (std::vector<int>{4, 6}));
  expectWhole();

  stopAt(5, keyed("k"));
  fs::remove(path("c.npy.part"));
  fs::remove(path("c.npy.part.done"));
  writeFiles(files, keyed("k"));
  EXPECT_EQ(asked_.front(), 0);
  EXPECT_TRUE(wasTold("a.vti.part is made anew, because another file of the run has no part")) << told_;
  expectWhole();

  stopAt(5, keyed("k"));
  writeFiles({files[0]}, keyed("k"), 7);  // Its own part counts.
  EXPECT_EQ(asked_.front(), 4);
  fs::remove(path("a.vti"));
  const SlabFile winding{.path = path("c.npy"), .arrays = {FieldArray::Distance}};  // The same header.
  writeFiles({winding}, keyed("k"));
  EXPECT_EQ(asked_.front(), 0);
  EXPECT_EQ(readBytes(path("c.npy")), whole(".npy"));
}

TEST_F(FieldSlabs, LeaveNothingOfARunWithoutAKey) {
  stop("a.npy", {.planes = 2}, 5);
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

// As a run leaves them that is killed before it renames the file.
TEST_F(FieldSlabs, AskForNoPlanesIfAllAreWritten) {
  stop("a.npy", keyed("k"), 5);
  const std::string bytes = whole(".npy");
  std::string magic, key;
  std::ifstream(path("a.npy.part.done")) >> magic >> key;
  std::ofstream(path("a.npy.part.done")) << magic << ' ' << key << " 7 " << bytes.size() << '\n';
  std::ofstream(path("a.npy.part")) << bytes;
  write("a.npy", keyed("k"));
  EXPECT_EQ(asked_, std::vector<int>{});
  EXPECT_EQ(readBytes(path("a.npy")), bytes);
}

// A slab is written while the next is made, and an error of writing is not lost.
TEST_F(FieldSlabs, TellThatAPlaneDoesNotFit) {
  for (const int wrong : {0, 2, 6}) {
    const PlaneSource planes = [&](int begin, int end) {
      return planesOf(field_, begin, begin == wrong ? end - 1 : end);
    };
    EXPECT_EQ(codeOf([&] { writeFieldInSlabs({{.path = path("a.npy")}}, field_, planes, keyed("k")); }),
              ErrorCode::Usage);
    EXPECT_FALSE(fs::exists(path("a.npy")));
    EXPECT_EQ(fs::exists(path("a.npy.part")), wrong > 0);
    write("a.npy", keyed("k"));
    EXPECT_EQ(asked_.front(), wrong);
    EXPECT_EQ(readBytes(path("a.npy")), whole(".npy"));
    fs::remove(path("a.npy"));
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
  fs::permissions(path("real.npy"), fs::perms(07600));
  fs::create_symlink("real.npy", path("link.npy"));
  write("link.npy", keyed("k"));
  EXPECT_TRUE(fs::is_symlink(path("link.npy")));
  EXPECT_EQ(readBytes(path("real.npy")), whole(".npy"));
  EXPECT_EQ(fs::status(path("real.npy")).permissions(), fs::perms(0600)) << "without setuid and setgid";
}

TEST_F(FieldSlabs, RefuseWhatMakesNoSense) {
  const auto code = [&](const std::string& name, const SlabOptions& options = {}) {
    return codeOf([&] { write(name, options); });
  };
  EXPECT_EQ(code("a.npz"), ErrorCode::Usage);
  EXPECT_EQ(code("a.npy", {.planes = 0}), ErrorCode::Usage);
  const auto codeOfFiles = [&](const std::vector<SlabFile>& files, const SlabOptions& options = {}) {
    return codeOf([&] { writeFiles(files, options); });
  };
  const Arrays two{FieldArray::Distance, FieldArray::Triangle};
  EXPECT_EQ(codeOfFiles({{.path = path("a.npy"), .arrays = {FieldArray::Winding}}}), ErrorCode::Usage);
  EXPECT_EQ(codeOfFiles({{.path = path("a.npy"), .arrays = two}}), ErrorCode::Usage);
  EXPECT_EQ(codeOfFiles({{.path = path("a.nrrd"), .arrays = two}}), ErrorCode::Usage);
  EXPECT_EQ(codeOfFiles({{.path = path("a.vti"), .arrays = {}}}), ErrorCode::Usage);
  EXPECT_EQ(codeOfFiles({{.path = path("a.vti"), .arrays = {FieldArray::Distance, FieldArray::Distance}}}),
            ErrorCode::Usage);
  EXPECT_EQ(codeOfFiles({}), ErrorCode::Usage);
  EXPECT_EQ(codeOfFiles({}, keyed("k")), ErrorCode::Usage);
  EXPECT_EQ(code("missing/a.npy"), ErrorCode::File);
  EXPECT_EQ(code("missing/a.npy", keyed("k")), ErrorCode::File);
  const Field good = counted();
  field_.grid.dims.x = 6;
  EXPECT_EQ(codeOf([&] {
              writeFieldInSlabs({{.path = path("a.npy")}}, field_,
                                [&](int a, int b) { return planesOf(good, a, b); });
            }),
            ErrorCode::Usage);
  field_.grid.dims = glm::ivec3(1 << 24);  // More than 64 bits can number.
  EXPECT_EQ(code("a.npy"), ErrorCode::Usage);
  field_.grid.dims = glm::ivec3(1 << 18);  // 64 petabytes.
  for (const SlabOptions& options : {SlabOptions{}, keyed("k")}) {
    EXPECT_NE(messageOf(ErrorCode::File, [&] { write("a.npy", options); })
                  .find("the file needs 68719476737 MiB, but only "),
              std::string::npos);
  }
  EXPECT_TRUE(asked_.empty());
  EXPECT_EQ(folder_.fileCount(), 0u);
}

}  // namespace
}  // namespace raymap
