#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "files.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const std::vector<glm::dvec3> kTwo{{1.5, -2.0, 3e-9}, {4.0, 5.25, 1e300}};

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Returns a .npy of version 1, whose header is the dictionary of these values.
std::string npy(const std::string& type, const std::string& fortran, const std::string& shape,
                const std::string& data) {
  const std::string text =
      "{'descr': '" + type + "', 'fortran_order': " + fortran + ", 'shape': " + shape + ", }\n";
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += {static_cast<char>(text.size()), 0};
  return bytes + text + data;
}

class PointFiles : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
    return folder_.path() / name;
  }
  std::vector<glm::dvec3> read(const std::string& name, const std::string& bytes) const {
    return readPoints(write(name, bytes));
  }
  void expectError(const std::string& name, const std::string& bytes, const std::string& message,
                   ErrorCode code = ErrorCode::Input) const {
    SCOPED_TRACE(message);
    try {
      read(name, bytes);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), (folder_.path() / name).string() + ": " + message);
      EXPECT_EQ(error.code(), code);
    }
  }
  std::string written(const std::string& name, const std::vector<glm::dvec3>& points,
                      const QueryResult& result, bool colour = false) const {
    writeQuery(folder_.path() / name, points, result, {.colour = colour});
    return readBytes(folder_.path() / name);
  }

  TemporaryFolder folder_;
};

TEST_F(PointFiles, ReadsRowsWithoutAHeader) {
  for (const char* text :
       {"1.5,-2,3e-9\n4,5.25,1e300\n", "1.5, -2 ,3e-9\r\n4,5.25,1e300", "1.5;-2;3e-9\r4;+5.25;1e300\r",
        "\n# a,b\n1.5\t-2  3e-9\n \t\n  4 5.25 1e300  \n\n",
        "\xef\xbb\xbf\"1.5\",\"-2\",3e-9\n4,5.25,1e300\n"})
    EXPECT_EQ(read("p.csv", text), kTwo) << text;
}

TEST_F(PointFiles, FindsTheColumnsOfAHeader) {
  EXPECT_EQ(read("p.csv", "x,y,z\n1.5,-2,3e-9\n4,5.25,1e300\n"), kTwo);
  EXPECT_EQ(read("p.csv", ",\"Z\",name,X,y\n0,3e-9,a b,1.5,-2\n1,1e300,,4,5.25\n"), kTwo);
  EXPECT_EQ(read("p.txt", "//X Y Z R\nx y z w\n1.5 -2 3e-9 7\n4 5.25 1e300 8\n"), kTwo);
}

TEST_F(PointFiles, LeavesOutNormalsOfAnXyz) {
  EXPECT_EQ(read("p.xyz", "1.5 -2 3e-9 0 0 1\n4 5.25 1e300 0 0 1\n"), kTwo);
  expectError("p.csv", "1,2,3,4\n",
              "line 1: 4 columns; a row without a header holds x, y and z; add a header row that names the "
              "columns");
}

TEST_F(PointFiles, TakesNaNAndInfinityForNumbers) {
  const auto points = read("p.csv", "nan,1,2\nNaN,-inf,2\n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_TRUE(std::isnan(points[0].x) && std::isnan(points[1].x));
  EXPECT_EQ(points[1].y, -std::numeric_limits<double>::infinity());
}

TEST_F(PointFiles, NamesTheLineAndTheValue) {
  expectError("p.csv", "1,2,3\n\n# a\n1,two,3\n", "line 4: y is 'two', which is not a number");
  expectError("p.csv", "1,2,3\r\n1,2,3e\r\n", "line 2: z is '3e', which is not a number");
  expectError("p.csv", "1,2,3\n1,2\n", "line 2: 2 columns, but line 1 has 3");
  expectError("p.csv", "x,y,z\n1,2,3,4\n", "line 2: 4 columns, but line 1 has 3");
  expectError("p.csv", "1,,3\n",
              "line 1: y is '', which is not a number; write nan for a point that is not known");
  expectError("p.csv", "x,z\n1,2\n",
              "line 1: no column is called y: the header names 'x', 'z'; call three columns x, y and z");
  expectError("p.xyz", "2\n", "line 1: 1 column; a row without a header holds x, y and z");
  expectError("p.csv", "1,2,1e999\n", "line 1: z is '1e999', which is not a number");
  expectError("p.obj", "v 0 0 0\n", "'.obj' is not a format for points; use one of .csv .npy .ply .xyz .txt",
              ErrorCode::Usage);
}

TEST_F(PointFiles, ReadsArraysOfNumPy) {
  const std::vector<double> rows{1.5, -2.0, 3e-9, 4.0, 5.25, 1e300},
      columns{1.5, 4.0, -2.0, 5.25, 3e-9, 1e300};
  EXPECT_EQ(read("p.npy", npy("<f8", "False", "(2, 3)", bytesOf(rows))), kTwo);
  EXPECT_EQ(read("p.npy", npy("<f8", "False", "(1, 2, 3)", bytesOf(rows))), kTwo);
  EXPECT_EQ(read("p.npy", npy("<f8", "True", "(2, 3)", bytesOf(columns))), kTwo);
  EXPECT_EQ(read("p.npy", npy("<f4", "False", "(3,)", bytesOf(std::vector<float>{1, 2, 0.1f}))),
            (std::vector<glm::dvec3>{{1, 2, 0.1f}}));
  EXPECT_EQ(read("p.npy", npy("<i4", "False", "(1, 3)", bytesOf(std::vector<int32_t>{1, -2, 3}))),
            (std::vector<glm::dvec3>{{1, -2, 3}}));
}

TEST_F(PointFiles, RefusesOtherArrays) {
  const std::string data(48, '\0');
  expectError("p.npy", npy("<f8", "False", "(3, 2)", data), "its shape is 3 x 2; points need one of N x 3");
  expectError("p.npy", npy("<f8", "False", "()", data), "its shape is no axes; points need one of N x 3");
  expectError("p.npy", npy("<f8", "False", "(0, 2)", data), "its shape is 0 x 2; points need one of N x 3");
  expectError("p.npy", npy("<f8", "False", "(-1, 3)", data), "its shape is -1 x 3");
  expectError("p.npy", npy("<f8", "False", "(3, 3)", data),
              "its shape is 3 x 3, more than its bytes can hold");
  expectError("p.npy", npy("<f8", "False", "(4611686018427387904, 4, 3)", data),
              "its shape is 4611686018427387904 x 4 x 3, more than its bytes can hold");
  expectError("p.npy", npy("<f8", "False", "(3,)", data.substr(0, 23)),
              "its shape is 3, more than its bytes can hold");
  expectError("p.npy", npy("<f8", "True", "(1, 2, 3)", data),
              "points of more than two axes in Fortran order; save them in C order", ErrorCode::Unsupported);
}

TEST_F(PointFiles, ReadsVerticesWithAndWithoutFaces) {
  const std::string start = "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n",
                    rest = "property double z\nproperty uchar red\n", end = "end_header\n",
                    rows = "1.5 -2 3e-9 7\n4 5.25 1e300 8\n";
  EXPECT_EQ(read("p.ply", start + rest + end + rows), kTwo);
  EXPECT_EQ(read("p.ply", start + rest + "element face 1\nproperty list uchar int vertex_indices\n" + end +
                              rows + "3 0 1 99\n"),
            kTwo);
  // Line breaks mean nothing where the rows share a line.
  EXPECT_EQ(read("p.ply", start + rest + end + "1.5 -2 3e-9 7 4 5.25 1e300 8\n"), kTwo);
}

TEST_F(PointFiles, ReadsAndWritesNoPoints) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n";
  const std::vector<glm::dvec3> none;
  EXPECT_EQ(read("p.ply", ply), none);
  EXPECT_EQ(read("p.csv", ""), none);
  EXPECT_EQ(read("p.csv", "x,y,z\n"), none);
  EXPECT_EQ(read("p.npy", npy("<f8", "False", "(0, 3)", "")), none);
  EXPECT_EQ(read("p.npy", npy("<f4", "True", "(0, 3)", "")), none);
  EXPECT_EQ(read("p.npy", npy("<f8", "False", "(0,)", "")), none);
}

QueryResult twoResults() {
  QueryResult result;
  result.distance = Buffer<double>(2);
  result.distance[0] = -0.1;
  result.distance[1] = kNaN;
  result.triangle = Buffer<uint32_t>(2);
  result.triangle[0] = 7;
  result.triangle[1] = kNoTriangle;
  result.closest = Buffer<glm::dvec3>(2);
  result.closest[0] = {1, 2, 0.1};
  result.closest[1] = glm::dvec3(-kNaN);
  result.winding = Buffer<float>(2);
  result.winding[0] = 0.1f;
  result.winding[1] = 1.0f;
  return result;
}

TEST_F(PointFiles, WritesARowPerPoint) {
  EXPECT_EQ(written("r.csv", kTwo, twoResults()),
            "x,y,z,distance,closest_x,closest_y,closest_z,triangle,winding\n"
            "1.5,-2,3e-09,-0.1,1,2,0.1,7,0.1\n"
            "4,5.25,1e+300,nan,nan,nan,nan,-1,1\n");
  EXPECT_EQ(readPoints(folder_.path() / "r.csv"), kTwo);
  QueryResult result;
  result.barycentric = Buffer<glm::dvec3>(1);
  result.barycentric[0] = {0.25, 0.5, 0.25};
  result.direction = Buffer<glm::dvec3>(1);
  result.direction[0] = {0, 0, -1};
  EXPECT_EQ(written("r.csv", {{1, 2, 3}}, result),
            "x,y,z,barycentric_0,barycentric_1,barycentric_2,direction_x,direction_y,direction_z\n"
            "1,2,3,0.25,0.5,0.25,0,0,-1\n");
}

TEST_F(PointFiles, WritesOneArrayForNumPy) {
  QueryResult result;
  result.closest = twoResults().closest.clone();
  const std::string bytes = written("r.npy", kTwo, result);
  ASSERT_EQ(bytes.size() % 64, 48u);
  EXPECT_NE(bytes.find("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }"), std::string::npos);
  EXPECT_EQ(std::memcmp(bytes.data() + bytes.size() - 48, result.closest.data(), 48), 0);
  result.closest.release();
  result.triangle = twoResults().triangle.clone();
  EXPECT_NE(written("r.npy", kTwo, result).find("{'descr': '<u4', 'fortran_order': False, 'shape': (2,), }"),
            std::string::npos);
}

TEST_F(PointFiles, WritesEveryArrayForNumPy) {
  const std::string bytes = written("r.npz", kTwo, twoResults());
  for (const char* name : {"distance.npy", "closest.npy", "triangle.npy", "winding.npy"})
    EXPECT_NE(bytes.find(name), std::string::npos) << name;
  EXPECT_EQ(bytes.find("confidence"), std::string::npos);
  EXPECT_NE(bytes.find("{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }"), std::string::npos);
}

TEST_F(PointFiles, WritesVerticesWithProperties) {
  const std::string bytes = written("r.ply", kTwo, twoResults(), true);
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty double x\nproperty double "
      "y\nproperty "
      "double z\nproperty float distance\nproperty double closest_x\nproperty double closest_y\nproperty "
      "double "
      "closest_z\nproperty uint triangle\nproperty float winding\nproperty uchar red\nproperty uchar "
      "green\nproperty uchar blue\nend_header\n";
  ASSERT_EQ(bytes.substr(0, header.size()), header);
  constexpr size_t kRow = 24 + 4 + 24 + 4 + 4 + 3;
  ASSERT_EQ(bytes.size(), header.size() + 2 * kRow);
  float distance = 0.0f;
  std::memcpy(&distance, bytes.data() + header.size() + 24, 4);
  EXPECT_EQ(distance, -0.1f);
  // The only point inside is the deepest, and NaN has a colour of its own.
  EXPECT_EQ(bytes.substr(header.size() + kRow - 3, 3), "\x26\x54\x94");
  EXPECT_EQ(bytes.substr(bytes.size() - 3), "\x8c\x3c\xa0");
  EXPECT_EQ(readPoints(folder_.path() / "r.ply"), kTwo);
}

TEST_F(PointFiles, ColoursEachSideByItsLargestDistance) {
  QueryResult result;
  result.distance = Buffer<double>(4);
  const std::array<double, 4> distances{-2.0, -1.0, 0.0, 0.5};
  std::ranges::copy(distances, result.distance.begin());
  const std::string bytes = written("r.ply", std::vector<glm::dvec3>(4), result, true);
  const auto colour = [&](size_t point) { return bytes.substr(bytes.size() - (4 - point) * 31 + 28, 3); };
  EXPECT_EQ(colour(0), "\x26\x54\x94");
  EXPECT_EQ(colour(1), "\x74\xad\xd6");
  EXPECT_EQ(colour(2), "\xff\xf6\xe8");
  EXPECT_EQ(colour(3), "\xce\x68\x34");
}

TEST_F(PointFiles, RefusesResultsThatDoNotFit) {
  const auto expect = [&](const std::string& name, const std::vector<glm::dvec3>& points,
                          const QueryResult& result, bool colour, const std::string& message) {
    try {
      written(name, points, result, colour);
      ADD_FAILURE() << message;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Usage);
      EXPECT_EQ(error.what(), (folder_.path() / name).string() + ": " + message);
    }
    EXPECT_FALSE(fs::exists(folder_.path() / name));
  };
  expect("r.npy", kTwo, twoResults(), false, "a .npy holds one array; ask for one, or write a .npz");
  expect("r.csv", {{0, 0, 0}}, twoResults(), false, "the results are those of another number of points");
  expect("r.csv", kTwo, QueryResult(), false, "there are no results to write");
  expect("r.csv", kTwo, twoResults(), true, "colours need distances and a .ply");
  QueryResult noDistance;
  noDistance.winding = twoResults().winding.clone();
  expect("r.ply", kTwo, noDistance, true, "colours need distances and a .ply");
  expect("r.vti", kTwo, twoResults(), false,
         "'.vti' is not a format for the results of a query; use one of .csv .npy .npz .ply");
}

}  // namespace
}  // namespace raymap
