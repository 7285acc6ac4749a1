#include <gtest/gtest.h>

#include <algorithm>

#include "mesh_samples.h"

namespace raymap {
namespace {

using samples::binaryStl;
using samples::contains;
using samples::errorOf;
using samples::isSquare;
using samples::kTextStl;
using samples::read;
using samples::replaced;

TEST(ReadStl, TellsTextAndBinaryApartByContent) {
  EXPECT_TRUE(isSquare(read(readStl, kTextStl).mesh));
  EXPECT_TRUE(isSquare(read(readStl, binaryStl()).mesh));
  EXPECT_TRUE(isSquare(read(readStl, binaryStl().replace(0, 6, "solid ")).mesh)) << "binary that says solid";
}

/// Returns a binary file with these bytes after each facet, as their attributes say.
std::string withPayload(const std::string& bytes, uint32_t announced = 2) {
  std::string file = binaryStl(announced);
  for (const size_t end : {file.size(), file.size() - 50}) {
    file.insert(end, bytes);
    file.replace(end - 2, 2, samples::raw(static_cast<uint16_t>(bytes.size())));
  }
  return file;
}

TEST(ReadStl, CutsConcaveLoops) {
  for (size_t first = 0; first < samples::kU.size(); ++first)
    for (const bool isReversed : {false, true}) {
      std::string loop = "solid\nfacet normal 0 0 1\nouter loop\n";
      for (size_t c = 0; c < samples::kU.size(); ++c) {
        const glm::ivec2 p = samples::kU[(first + (isReversed ? 8 - c : c)) % 8];
        loop += "vertex " + std::to_string(p.x) + " " + std::to_string(p.y) + " 0\n";
      }
      EXPECT_TRUE(samples::isU(read(readStl, loop + "endloop\nendfacet\nendsolid\n").mesh));
      EXPECT_TRUE(samples::isU(read(readStl, loop + "endfacet\nendsolid\n").mesh));
    }
}

TEST(ReadStl, TakesStatementsInTwoWords) {
  const std::string text = replaced(replaced(kTextStl, "endloop", "end loop"), "endfacet", "End  Facet");
  EXPECT_TRUE(isSquare(read(readStl, text).mesh));
  const samples::Reading reading = read(readStl, replaced(text, "endsolid square", "end solid square"));
  EXPECT_TRUE(isSquare(reading.mesh));
  EXPECT_EQ(reading.warnings, "");
  EXPECT_EQ(read(readStl, replaced(kTextStl, "endsolid square", "ENDSOLIDsquare")).warnings, "");
  EXPECT_TRUE(contains(errorOf(readStl, replaced(kTextStl, " endloop", " end lop")),
                       "line 7: expected facet, vertex or the like, found 'end'"));
  EXPECT_TRUE(contains(errorOf(readStl, replaced(kTextStl, " endloop", " end\nloop")), "found 'end'"));
}

TEST(ReadStl, TakesSeveralStatementsALine) {
  std::string one = kTextStl;
  std::ranges::replace(one, '\n', ' ');
  EXPECT_TRUE(isSquare(read(readStl, one).mesh)) << "all on one line";
  EXPECT_EQ(read(readStl, one).warnings, "");
  EXPECT_TRUE(isSquare(read(readStl, one.substr(one.find("facet"))).mesh));
  std::string facets = kTextStl;
  for (size_t at = facets.find("facet normal"); at < facets.rfind("endfacet"); ++at)
    if (facets[at] == '\n' && facets.substr(at + 1, 12) != "facet normal") facets[at] = ' ';
  EXPECT_TRUE(isSquare(read(readStl, facets).mesh)) << "a facet a line";
  EXPECT_EQ(read(readStl, one + one).mesh.triangles.size(), 4u);
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "1 1 0\n endloop", "1 1 0 # end\n endloop")).mesh));
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "endfacet\n", "endfacet end of it\n")).mesh));
}

TEST(ReadStl, SkipsNamesAndColours) {
  for (const char* solid :
       {"solid\nsquare", "solid square\nmade by hand\n\n units mm", "solid square\ncolor 1 0 0",
        "solid square\nCOLOR 1 0 0", "Solid endfacet", "solid facet", "solidSquare", ""})
    EXPECT_TRUE(isSquare(
        read(readStl, replaced(kTextStl, "solid square\nfacet", std::string(solid) + "\nfacet")).mesh))
        << solid;
  EXPECT_TRUE(
      isSquare(read(readStl, replaced(kTextStl, " outer loop", " color 0.1 0.2 0.3\n outer loop")).mesh));
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, " endloop", " color 0.1 0.2 0.3\n endloop")).mesh));
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "  vertex 1 0 0", "  vertex 1 0 0 255 0 0")).mesh));
  EXPECT_TRUE(isSquare(read(readStl, "\xef\xbb\xbf" + kTextStl).mesh)) << "a byte order mark";
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "endsolid square", "endsolid\nsquare")).mesh));
}

TEST(ReadStl, JoinsCornersThatNoiseAboutZeroTakesApart) {
  const auto corners = [](const char* z) {
    const std::string text =
        std::string("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n") +
        "vertex 0 1 1.1\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 " + z +
        "\nvertex 0 1 1.1\nvertex -1 1 0\nendloop\nendfacet\nendsolid\n";
    return diagnose(read(readStl, text).mesh, {}).weldedVertices;
  };
  EXPECT_EQ(corners("0"), 4u);
  EXPECT_EQ(corners("-2.7e-16"), 4u);
  EXPECT_EQ(corners("2.7e-7"), 5u);
}

TEST(ReadStl, ReadsFacetsOutsideOfASolid) {
  const std::string facets = kTextStl.substr(kTextStl.find("facet"));
  const samples::Reading whole = read(readStl, facets);
  EXPECT_TRUE(isSquare(whole.mesh));
  EXPECT_EQ(whole.warnings, "");
  const samples::Reading open = read(readStl, facets.substr(0, facets.find("endsolid")));
  EXPECT_TRUE(isSquare(open.mesh));
  EXPECT_EQ(open.warnings, "sample.mesh: the file ends without endsolid: it may have been cut short\n");
}

TEST(ReadStl, TakesBinaryThatSaysSolid) {
  const std::string solid = binaryStl().replace(0, 80, "solid x" + std::string(73, '\0'));
  for (const std::string& rest : {std::string("abc"), std::string(49, '\0'), std::string(1000, '\0')}) {
    const samples::Reading reading = read(readStl, solid + rest);
    EXPECT_TRUE(isSquare(reading.mesh)) << rest.size();
    EXPECT_EQ(reading.warnings,
              "sample.mesh: " + std::to_string(rest.size()) + " bytes after the last triangle ignored\n");
  }
  EXPECT_TRUE(isSquare(read(readStl, binaryStl().replace(0, 6, "solid\n") + "x").mesh));
}

TEST(ReadStl, BelievesTheSizeWhereTheCountIsWrong) {
  for (const uint32_t count : {0u, 1u, 2147483648u, 4294967295u}) {
    const samples::Reading reading = read(readStl, binaryStl(count));
    EXPECT_TRUE(isSquare(reading.mesh)) << count;
    EXPECT_EQ(reading.warnings, std::string("sample.mesh: its header announces ") +
                                    (count == 1 ? "1 triangle" : "no number of triangles") +
                                    ", but the file has the size of 2, which were read\n");
  }
  // A number that is too large tells of a file cut short.
  for (const uint32_t count : {3u, 20u, 2147483647u})
    for (const char* rest : {"", "x"})
      EXPECT_EQ(errorOf(readStl, binaryStl(count) + rest),
                "sample.mesh: the file announces " + std::to_string(count) +
                    " triangles, but holds only 2: it is cut short");
  for (const uint32_t count : {0u, 4294967295u})
    EXPECT_EQ(errorOf(readStl, binaryStl(count) + "x"),
              "sample.mesh: its header has no number of triangles, and its size fits none: it is cut short");
  EXPECT_EQ(read(readStl, binaryStl() + std::string(50, '\0')).warnings,
            "sample.mesh: 50 bytes after the last triangle ignored\n");
  EXPECT_EQ(read(readStl, binaryStl() + std::string(50, '\xff')).warnings,
            "sample.mesh: 50 bytes after the last triangle ignored\n");
}

TEST(ReadStl, SkipsWhatAttributesAnnounce) {
  for (const std::string& payload :
       {std::string("ABCD"), std::string(50, 'x'), std::string(1, '\0'), std::string(65535, 'y')}) {
    const samples::Reading reading = read(readStl, withPayload(payload));
    EXPECT_TRUE(isSquare(reading.mesh)) << payload.size();
    EXPECT_EQ(reading.warnings, "");
  }
  // Bytes left over, where only the attributes make sense of the second facet.
  const samples::Reading more = read(readStl, withPayload(std::string(10, '\xff')) + "xyz");
  EXPECT_TRUE(isSquare(more.mesh));
  EXPECT_EQ(more.warnings, "sample.mesh: 3 bytes after the last triangle ignored\n");
  // Colours are attributes too.
  EXPECT_TRUE(isSquare(read(readStl, binaryStl().replace(132, 2, samples::raw<uint16_t>(40000))).mesh));
}

TEST(ReadStl, SaysOfOtherDataThatTheyAreNoStl) {
  const std::string none =
      "sample.mesh: it is no STL file: it is neither text, nor do its bytes make triangles";
  std::string noise;
  uint32_t state = 1;
  for (int i = 0; i < 2000; ++i) noise += static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
  EXPECT_EQ(errorOf(readStl, noise), none);
  EXPECT_EQ(errorOf(readStl, noise.substr(0, 84 + 50 * 9)), none);
  EXPECT_EQ(errorOf(readStl, std::string(83, '\0')), none);
  EXPECT_EQ(errorOf(readStl, std::string(85, '\0')), none);
  EXPECT_EQ(errorOf(readStl, std::string(134, '\0')), none);
  EXPECT_EQ(errorOf(readStl, std::string(4096, '\0')), none);
  EXPECT_EQ(
      errorOf(readStl, std::string(4096, '0')),
      "sample.mesh: line 1: expected facet, vertex or the like, found '" + std::string(20, '0') + "...'");
  EXPECT_EQ(errorOf(readStl, std::string("\xff\xfes\0o\0l\0i\0d\0", 12)),
            "sample.mesh: it is text in UTF-16; save it as UTF-8");
}

TEST(ReadStl, KeepsThreeVerticesAFacet) {
  EXPECT_EQ(read(readStl, binaryStl()).mesh.vertices.size(), 6u);
  EXPECT_EQ(read(readStl, kTextStl).mesh.vertices.size(), 6u);
}

TEST(ReadStl, TakesAllLayoutsOfText) {
  for (const char* end : {"\r\n", "\r", " \t\n\n"}) {
    std::string text;
    for (const char c : kTextStl) text += c == '\n' ? end : std::string(1, c);
    EXPECT_TRUE(isSquare(read(readStl, text).mesh)) << testing::PrintToString(end);
  }
  std::string upper = kTextStl;
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  EXPECT_TRUE(isSquare(read(readStl, upper).mesh));
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "solid square", "solid facet vertex 1 2 3")).mesh));
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "endloop", "endloop remark 7")).mesh));
  EXPECT_TRUE(isSquare(read(readStl, replaced(kTextStl, "normal 0 0 1", "normal nan nan nan")).mesh));
  EXPECT_EQ(read(readStl, kTextStl + kTextStl).mesh.triangles.size(), 4u) << "two solids";
}

TEST(ReadStl, WarnsOfLooseEnds) {
  EXPECT_EQ(read(readStl, binaryStl() + "xyz").warnings,
            "sample.mesh: 3 bytes after the last triangle ignored\n");
  EXPECT_TRUE(
      contains(read(readStl, replaced(kTextStl, "endsolid square\n", "")).warnings, "without endsolid"));
}

TEST(ReadStl, NamesWhatIsWrong) {
  EXPECT_EQ(errorOf(readStl, binaryStl(20)),
            "sample.mesh: the file announces 20 triangles, but holds only 2: it is cut short");
  EXPECT_TRUE(contains(errorOf(readStl, replaced(kTextStl, "1 0 0", "1 O 0")),
                       "line 5: expected a number, found 'O'"));
  EXPECT_TRUE(
      contains(errorOf(readStl, replaced(kTextStl, "1 0 0", "1 inf 0")), "vertex 1 (used by triangle 0)"));
  EXPECT_TRUE(
      contains(errorOf(readStl, kTextStl.substr(0, kTextStl.rfind("vertex"))), "ends within a facet"));
  EXPECT_TRUE(
      contains(errorOf(readStl, replaced(kTextStl, " endloop\nendfacet", "")), "begins within a facet"));
  EXPECT_TRUE(contains(errorOf(readStl, replaced(kTextStl, "endfacet\nfacet", "endfacet\nfascet")),
                       "line 9: expected facet, vertex or the like, found 'fascet'"));
  EXPECT_TRUE(contains(errorOf(readStl, replaced(kTextStl, "1 0 0", "1.0D+00 0 0")), "found '1.0D+00'"));
  EXPECT_TRUE(contains(errorOf(readStl, replaced(kTextStl, "1 0 0", "1,0 0 0")), "found '1,0'"));
  EXPECT_EQ(errorOf(readStl, "solid Empty\nendsolid Empty"), "sample.mesh: the file has no triangles");
  EXPECT_EQ(errorOf(readStl, binaryStl(0).substr(0, 84)), "sample.mesh: the file has no triangles");
  EXPECT_NE(errorOf(readStl, ""), "");
}

}  // namespace
}  // namespace raymap
