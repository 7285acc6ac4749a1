#include <gtest/gtest.h>

#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::binaryPly;
using samples::contains;
using samples::errorOf;
using samples::isSquare;
using samples::kTextPly;
using samples::raw;
using samples::read;
using samples::replaced;

TEST(ReadPly, ReadsTextAndBothByteOrders) {
  EXPECT_TRUE(isSquare(read(readPly, kTextPly).mesh));
  EXPECT_TRUE(isSquare(read(readPly, binaryPly(false)).mesh));
  EXPECT_TRUE(isSquare(read(readPly, binaryPly(true)).mesh));
}

TEST(ReadPly, TakesAllLineEndsOfTheHeader) {
  const std::string plain = binaryPly();
  const size_t headerEnd = plain.find("end_header\n") + 11;
  for (const char* end : {"\r\n", "\r"}) {
    std::string header;
    for (const char c : plain.substr(0, headerEnd)) header += c == '\n' ? end : std::string(1, c);
    EXPECT_TRUE(isSquare(read(readPly, header + plain.substr(headerEnd)).mesh))
        << testing::PrintToString(end);
  }
}

TEST(ReadPly, KeepsDataThatBeginsLikeALineEnd) {
  // The first coordinate's first byte is LF, right after a header whose lines end in CR.
  std::string header = "ply\rformat binary_little_endian 1.0\r" + samples::kPlyElements;
  for (char& c : header)
    if (c == '\n') c = '\r';
  const float odd = std::bit_cast<float>(0x3f80000au);
  const Mesh mesh = read(readPly, header + raw<float>({odd, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) +
                                      raw<uint8_t>(4) + raw<int32_t>({0, 1, 2, 3}))
                        .mesh;
  EXPECT_NEAR(mesh.position(0).x, odd, 1e-7);
}

TEST(ReadPly, ReadsTriangleStrips) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  const std::string corners = raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  EXPECT_TRUE(isSquare(read(readPly, header + corners + raw<int32_t>({4, 0, 1, 2, 3})).mesh));
  EXPECT_TRUE(isSquare(read(readPly, header + corners + raw<int32_t>({8, 0, 1, 2, -1, 1, 3, 2, -1})).mesh));
  EXPECT_TRUE(isSquare(read(readPly, header + corners + raw<int32_t>({6, 0, 1, 2, 3, 3, 3})).mesh))
      << "degenerate end";
}

TEST(ReadPly, TakesElementsAndPropertiesInAnyOrder) {
  const std::string text =
      "ply\nformat ascii 1.0\nobj_info by hand\nelement camera 1\nproperty float focal\nproperty list uchar "
      "float k\n"
      "element face 1\nproperty uchar flags\nproperty list ushort uint vertex_index\nproperty list uchar "
      "float uv\n"
      "element vertex 4\nproperty uchar red\nproperty double z\nproperty short y\nproperty float x\n"
      "element nothing 4000000000\nend_header\n"
      "50 2 0.1 0.2\n0 4 0 1 2 3 2 0.5 0.5\n9 0 0 0\n9 0 0 1\n9 0 1 1\n9 0 1 0\n";
  EXPECT_TRUE(isSquare(read(readPly, text).mesh));
}

TEST(ReadPly, TakesAnyTypesInLists) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty double x\nproperty double "
      "y\nproperty double "
      "z\nelement face 1\nproperty list float double vertex_indices\nend_header\n";
  EXPECT_TRUE(isSquare(read(readPly, header + raw<double>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) +
                                         raw<float>(4) + raw<double>({0, 1, 2, 3}))
                           .mesh));
}

TEST(ReadPly, LeavesUnusedVerticesAlone) {
  EXPECT_TRUE(isSquare(
      read(readPly, replaced(replaced(kTextPly, "vertex 4", "vertex 5"), "4 0 1", "nan 0 0\n4 0 1")).mesh));
}

const std::string kLongRows = replaced(kTextPly, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
                                       "0 0 0\n1 0 0 0.5 7\n1 1 0\n0 1 0 4\n4 0 1 2 3 0 255\n");

TEST(ReadPly, CutsConcavePolygons) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (size_t first = 0; first < samples::kU.size(); ++first)
    for (const bool isReversed : {false, true})
      EXPECT_TRUE(samples::isU(
          read(readPly, header + samples::cornersOfU() + "8" + samples::faceOfU(first, isReversed)).mesh));
  std::string binary = replaced(header, "ascii", "binary_little_endian");
  for (const glm::ivec2& p : samples::kU) binary += samples::raw<float>({float(p.x), float(p.y), 0});
  EXPECT_TRUE(
      samples::isU(read(readPly, binary + '\x08' + samples::raw<int32_t>({1, 2, 3, 4, 5, 6, 7, 0})).mesh));
  EXPECT_EQ(read(readPly, replaced(kTextPly, "4 0 1 2 3", "4 0 2 1 3")).warnings,
            "sample.mesh: 1 face crosses itself, or its corners lie on a line: its triangles may overlap\n");
}

TEST(ReadPly, Takes64BitIntegers) {
  for (const char* type : {"int64", "uint64", "long", "ulong"})
    for (const char* count : {"uchar", "int64", "uint64"}) {
      const std::string list = std::string("list ") + count + " " + type;
      EXPECT_TRUE(isSquare(read(readPly, replaced(kTextPly, "list uchar int", list)).mesh)) << list;
      for (const bool isBig : {false, true}) {
        std::string file = replaced(binaryPly(isBig), "list uchar int", list);
        file.resize(file.size() - 17);
        file += *count == 'u' && count[1] == 'c' ? "\x04" : samples::raw<int64_t>(4, isBig);
        file += samples::raw<int64_t>({0, 1, 2, 3}, isBig);
        EXPECT_TRUE(isSquare(read(readPly, file).mesh)) << list;
        EXPECT_TRUE(contains(errorOf(readPly, file.substr(0, file.size() - 1)), "the file ends too early"));
      }
    }
  // Coordinates, among them one that single precision does not hold.
  std::string far = "ply\nformat binary_little_endian 1.0\n" + samples::kPlyElements;
  for (int axis = 0; axis < 3; ++axis) far = replaced(far, "float", "int64");
  const int64_t offset = int64_t{1} << 40;
  far += samples::raw<int64_t>({offset, 0, 0, offset + 1, 0, 0, offset + 1, 1, 0, offset, 1, 0});
  const Mesh mesh = read(readPly, far + '\x04' + samples::raw<int32_t>({0, 1, 2, 3})).mesh;
  EXPECT_EQ(mesh.origin.x, 0x1p40 + 0.5);
  EXPECT_EQ(mesh.vertices[1].x - mesh.vertices[0].x, 1.0f);
  // Numbers that are too large.
  std::string huge = replaced(binaryPly(), "list uchar int", "list uchar uint64");
  huge.resize(huge.size() - 16);
  EXPECT_TRUE(contains(errorOf(readPly, huge + samples::raw<uint64_t>({0, 1, 2, uint64_t{1} << 63})),
                       "vertex index 9223372036854775807 is out of range"));
}

TEST(ReadPly, EndsStripsOf64Bits) {
  for (const char* type : {"int64", "uint64"}) {
    std::string file = replaced(replaced(binaryPly(), "element face", "element tristrips"), "list uchar int",
                                std::string("list uchar ") + type);
    file.resize(file.size() - 17);
    file += '\x07' + samples::raw<int64_t>({0, 1, 2, -1, 0, 2, 3});
    EXPECT_TRUE(isSquare(read(readPly, file).mesh)) << type;
  }
}

TEST(ReadPly, TakesCapitalsAndAByteOrderMark) {
  std::string capitals = kTextPly;
  for (const char* name : {"x", "y", "z"})
    capitals = replaced(capitals, std::string("float ") + name, std::string("float ") + char(*name - 32));
  EXPECT_TRUE(isSquare(read(readPly, capitals).mesh));
  EXPECT_TRUE(isSquare(read(readPly, replaced(kTextPly, "float y", "float Y")).mesh));
  EXPECT_TRUE(contains(errorOf(readPly, replaced(kTextPly, "float y", "float v")),
                       "the vertices have no property y"));
  for (const std::string& file : {kTextPly, binaryPly(), binaryPly(true)})
    EXPECT_TRUE(isSquare(read(readPly, "\xef\xbb\xbf" + file).mesh));
  EXPECT_EQ(errorOf(readPly, "\xff\xfep"), "sample.mesh: it is text in UTF-16; save it as UTF-8");
}

TEST(ReadPly, IgnoresValuesBeyondARow) {
  const samples::Reading reading = read(readPly, kLongRows);
  EXPECT_TRUE(isSquare(reading.mesh));
  EXPECT_EQ(
      reading.warnings,
      "sample.mesh: line 11: 2 values more than the header declares for 'vertex' ignored, as on 2 later "
      "lines\n");
  EXPECT_EQ(read(readPly, replaced(kTextPly, "2 3\n", "2 3 x # 4 5\n")).warnings,
            "sample.mesh: line 14: 1 value more than the header declares for 'face' ignored\n");
  EXPECT_EQ(read(readPly, kTextPly).warnings, "");
}

TEST(ReadPly, CountsLinesOfLongRowsWithAnyLineEnd) {
  for (const char* end : {"\r\n", "\r"}) {
    std::string text;
    for (const char c : kLongRows) text += c == '\n' ? end : std::string(1, c);
    const samples::Reading reading = read(readPly, text);
    EXPECT_TRUE(isSquare(reading.mesh)) << testing::PrintToString(end);
    EXPECT_TRUE(contains(reading.warnings, "line 11: 2 values more")) << reading.warnings;
  }
}

TEST(ReadPly, TakesAFaceOfALongRowFromItsLine) {
  // Read one after the other, the values would fit too, and give the triangle 3 0 1 and another corner.
  const Mesh mesh =
      read(readPly, replaced(replaced(kTextPly, "0 1 0\n", "0 1 0 4\n"), "4 0 1 2 3", "3 0 1 2")).mesh;
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0], glm::uvec3(0, 1, 2));
}

TEST(ReadPly, JoinsBrokenRows) {
  for (const char* rows :
       {"0\n0 0\n1 0 0\n1 1\n\n0\n0 1 0\n4 0 1\n2 3\n", "0 0 0 1 0 0 1 1 0 0 1 0\n4 0 1 2 3\n",
        "0 0 0 1 0\n0 1 1\n0 0 1 0\n4 0 1\n2 3\n", "0 0 0 1 0 0 1 1 0 0 1 0 4 0 1 2 3"}) {
    const samples::Reading reading =
        read(readPly, replaced(kTextPly, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", rows));
    EXPECT_TRUE(isSquare(reading.mesh)) << rows;
    EXPECT_EQ(reading.warnings, "") << rows;
  }
}

TEST(ReadPly, RefusesLongRowsBesideWrongOnes) {
  EXPECT_EQ(errorOf(readPly, replaced(kLongRows, "4 0 1 2 3", "4 0 1 2 4")),
            "sample.mesh: face 0: vertex index 4 is out of range (the file has 4 vertices)");
  EXPECT_EQ(
      errorOf(readPly, replaced(kLongRows, "1 1 0\n", "1 1\n")),
      "sample.mesh: line 12: the line has fewer values than the header declares for 'vertex', and the row "
      "does not end with a later line either");
  EXPECT_EQ(
      errorOf(readPly, replaced(kTextPly, "1 1 0\n", "1 1\n")),
      "sample.mesh: line 12: the line has fewer values than the header declares for 'vertex', and the row "
      "does not end with a later line either");
  EXPECT_EQ(errorOf(readPly, replaced(kLongRows, "4 0 1 2 3 0 255\n", "4 0 1\n")),
            "sample.mesh: line 15: the file ends where a whole number should be");
  EXPECT_TRUE(contains(errorOf(readPly, replaced(replaced(kTextPly, "0 0 0\n1 0 0\n", "0 0 0 1 0 0\n"),
                                                 "4 0 1 2 3", "4 0 1 2 3 5")),
                       "line "));
}

TEST(ReadPly, NamesWhatIsWrong) {
  EXPECT_EQ(errorOf(readPly, replaced(kTextPly, "4 0 1 2 3", "4 0 1 2 99")),
            "sample.mesh: face 0: vertex index 99 is out of range (the file has 4 vertices)");
  EXPECT_TRUE(contains(errorOf(readPly, replaced(kTextPly, "4 0 1 2 3", "4 0 1 2 -1")), "vertex index -1"));
  EXPECT_TRUE(contains(errorOf(readPly, replaced(binaryPly(), "face 1", "face 4000000000")),
                       "announces 4000000000 faces of at least 1 byte"));
  EXPECT_TRUE(contains(errorOf(readPly, replaced(kTextPly, "vertex 4", "vertex 4000000000")),
                       "announces 4000000000 vertices"));
  EXPECT_TRUE(contains(errorOf(readPly, replaced(kTextPly, "4 0 1", "4000000000 0 1")),
                       "announces 4000000000 values"));
  EXPECT_TRUE(contains(errorOf(readPly, binaryPly().substr(0, binaryPly().size() - 1)), "cut short"));
  EXPECT_TRUE(
      contains(errorOf(readPly, replaced(kTextPly, "1 1 0", "1 nan 0")), "vertex 2 (used by triangle 0)"));
  EXPECT_TRUE(contains(errorOf(readPly, replaced(kTextPly, "float y", "float why")), "no property y"));
  EXPECT_TRUE(
      contains(errorOf(readPly, replaced(kTextPly, "float y", "floot y")), "line 5: expected the type"));
  EXPECT_TRUE(
      contains(errorOf(readPly, replaced(kTextPly, "ascii", "ebcdic")), "unknown PLY format 'ebcdic'"));
  EXPECT_TRUE(contains(errorOf(readPly, replaced(kTextPly, "end_header", "")), "expected element, property"));
  EXPECT_TRUE(
      contains(errorOf(readPly, replaced(kTextPly, "element face", "element vertex")), "two elements"));
  EXPECT_TRUE(contains(errorOf(readPly, "play\n"), "does not begin with 'ply'"));
}

}  // namespace
}  // namespace raymap
