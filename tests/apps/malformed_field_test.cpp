// Damaged fields of every format, through the command line: each gives one line that names the file and the
// reason, an exit code that says what kind of error it is, no output, and takes little memory.

#include <raymap/raymap.h>

#include <algorithm>
#include <array>

#include "error_code.h"
#include "files.h"
#include "mesh_samples.h"
#include "run_program.h"
#include "shapes.h"
#include "zip_file.h"

namespace raymap {
namespace {

using namespace samples;

constexpr size_t kMostMemory = size_t{100} << 20;

/// Returns the bytes of a small field in this format. Its sides differ and it is clamped to a band.
std::string wholeFile(const std::string& extension) {
  const TemporaryFile file("whole" + extension, "");
  FieldOptions options;
  options.band = 2.0;
  const Mesh mesh = shapes::torus(1.0, 0.4, 12, 8);
  writeField(file.path(), generate(mesh, fitGrid(mesh, {.resolution = 12}), options).field);
  return readBytes(file.path());
}

/// Returns the program's message about a file with these bytes; empty if it reads the file.
std::string refusal(const std::string& extension, const std::string& bytes) {
  const TemporaryFile file("malformed" + extension, bytes), output("converted.npy", "");
  std::filesystem::remove(output.path());
  const ProgramRun run = runProgram({RAYMAP_BINARY, "convert", file.path(), output.path()});
  EXPECT_LT(run.peakBytes, kMostMemory) << run.error;
  EXPECT_EQ(std::filesystem::exists(output.path()), run.code == 0);
  if (run.code == 0) return {};
  EXPECT_TRUE(run.code == exitCode(ErrorCode::Input) || run.code == exitCode(ErrorCode::Unsupported))
      << run.code << run.error;
  const std::string start = "raymap: error: " + file.path().string() + ": ";
  EXPECT_EQ(run.error.substr(0, start.size()), start);
  EXPECT_EQ(run.error.find('\n') + 1, run.error.size()) << run.error;
  return run.error.size() > start.size() + 1 ? run.error.substr(start.size()) : "";
}

std::string noise(size_t size) {
  std::string bytes;
  uint32_t state = 1;
  while (bytes.size() < size) bytes += static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
  return bytes;
}

class MalformedField : public testing::TestWithParam<std::string> {};

TEST_P(MalformedField, CutShort) {
  const std::string whole = wholeFile(GetParam());
  // The last bytes are closing marks, which not every format needs.
  for (size_t part = 0; part < 10; ++part) {
    const size_t size = (whole.size() - 64) * part / 9;
    EXPECT_NE(refusal(GetParam(), whole.substr(0, size)), "") << "cut to " << size << " bytes";
  }
}

TEST_P(MalformedField, ZerosNoiseAndText) {
  const std::string start = wholeFile(GetParam()).substr(0, 64);
  for (const std::string& bytes :
       {std::string(), std::string(5000, '\0'), noise(5000), std::string("solid text\nfacet normal 0 0 1\n"),
        std::string(100'000, '('), start, start + std::string(5000, '\0'), start + noise(5000),
        start + std::string(5000, '\xff'), start + "solid text\nfacet normal 0 0 1\n"})
    EXPECT_NE(refusal(GetParam(), bytes), "") << bytes.substr(0, 100);
}

TEST_P(MalformedField, OneFormatUnderTheNameOfAnother) {
  for (const std::string& other : fieldExtensions()) {
    if (other == GetParam()) continue;
    EXPECT_NE(refusal(GetParam(), wholeFile(other)), "") << other;
  }
}

TEST_P(MalformedField, AnyWordChanged) {
  // A field that is read in spite of the change has another sample or another grid.
  const std::string whole = wholeFile(GetParam());
  const size_t header = std::min<size_t>(whole.size() - 8, 700);
  for (size_t at = 0; at < header; at += 1 + header / 6)
    for (const std::string& word : {std::string(8, '\xff'), raw(uint64_t{1} << 60)})
      refusal(GetParam(), std::string(whole).replace(at, word.size(), word));
}

std::string formatName(const testing::TestParamInfo<std::string>& info) {
  return info.param.substr(1);
}
INSTANTIATE_TEST_SUITE_P(Formats, MalformedField, testing::ValuesIn(fieldExtensions()), formatName);

/// Impossible sides of a grid, as text.
constexpr std::array kWrongSides{
    "0", "-1", "nan", "inf", "1.5", "1e300", "4000000000", "1152921504606846976", "2147483647", "two", ""};

TEST(MalformedNrrd, WrongHeaders) {
  const std::string whole =
      "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n"
      "spacings: 1 1 1\nspace origin: (0,0,0)\n\n" +
      std::string(32, '\1');
  const std::string gzip = replaced(whole, "raw", "gzip");
  ASSERT_EQ(refusal(".nrrd", whole), "");
  for (const std::string side : kWrongSides)
    for (const std::string& encoded : {whole, gzip})
      EXPECT_NE(refusal(".nrrd", replaced(encoded, "2 2 2", side + " 1 1")), "") << side;
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"float", "block"},
                                                        {"float", "int64"},
                                                        {"type: float\n", ""},
                                                        {"NRRD0004", "NRRD0004x"},
                                                        {"dimension: 3", "dimension: 2"},
                                                        {"dimension: 3", "dimension: 1152921504606846976"},
                                                        {"dimension: 3\n", ""},
                                                        {"sizes: 2 2 2\n", ""},
                                                        {"2 2 2", "4000000000 4000000000 4000000000"},
                                                        {"2 2 2", "-2 -2 2"},
                                                        {"(0,0,0)", "(inf,0,0)"},
                                                        {"raw", "hex"},
                                                        {"encoding: raw\n", ""},
                                                        {"endian: little", "endian: middle"},
                                                        {"1 1 1", "0 0 0"},
                                                        {"1 1 1", "-1 -1 -1"},
                                                        {"1 1 1", "nan nan nan"},
                                                        {"1 1 1", "1 2 1"},
                                                        {"1 1 1", "1e999 1e999 1e999"},
                                                        {"1 1 1", "1 1"},
                                                        {"(0,0,0)", "(nan,0,0)"},
                                                        {"(0,0,0)", "(0,0)"},
                                                        {"(0,0,0)", "none"},
                                                        {"\n\n", "\nband:=nan\n\n"},
                                                        {"\n\n", "\nband:=-1\n\n"},
                                                        {"\n\n", "\nsurface_bounds:=0 0 0 1 1\n\n"},
                                                        {"\n\n", "\nsurface_bounds:=0 0 0 1 -1 1\n\n"},
                                                        {"\n\n", "\nsurface_bounds:=0 0 0 1 inf 1\n\n"},
                                                        {"\n\n", "\nsurface_bounds:=nan 0 0 1 1 1\n\n"},
                                                        {"\n\n", "\ndata file: /etc/passwd\n\n"},
                                                        {"\n\n", "\nbyte skip: 8\n\n"}})
    EXPECT_NE(refusal(".nrrd", replaced(whole, from, to)), "") << to << " for " << from;
}

std::string npy(const std::string& dictionary, const std::string& samples = std::string(32, '\1')) {
  return "\x93NUMPY\x01" + raw<uint8_t>(0) + raw(static_cast<uint16_t>(dictionary.size())) + dictionary +
         samples;
}
const std::string kDictionary = "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 2, 2), }\n";

const std::vector<std::pair<std::string, std::string>> kWrongDictionary{{"<f4", "<i8"},
                                                                        {"<f4", "|O"},
                                                                        {"<f4", ""},
                                                                        {"'<f4'", "[('x', '<f4')]"},
                                                                        {"'<f4'", "4"},
                                                                        {"descr", "dtype"},
                                                                        {"True", "2"},
                                                                        {"fortran_order", "order"},
                                                                        {"(2, 2, 2)", "(2, 2)"},
                                                                        {"(2, 2, 2)", "()"},
                                                                        {"(2, 2, 2)", "8"},
                                                                        {"(2, 2, 2)", "(2, 2, 2"},
                                                                        {"(2, 2, 2)", "(2, 2, 1, 2)"},
                                                                        {"shape", "size"},
                                                                        {"{", "import os;"}};

TEST(MalformedNpy, WrongHeaders) {
  ASSERT_EQ(refusal(".npy", npy(kDictionary)), "");
  for (const std::string side : kWrongSides)
    EXPECT_NE(refusal(".npy", npy(replaced(kDictionary, "(2", "(" + side))), "") << side;
  for (const auto& [from, to] : kWrongDictionary)
    EXPECT_NE(refusal(".npy", npy(replaced(kDictionary, from, to))), "") << to << " for " << from;
  EXPECT_NE(refusal(".npy", npy(std::string(60'000, '('))), "");
  EXPECT_NE(refusal(".npy", "\x93NUMPY\x02" + raw<uint8_t>(0) + raw(uint32_t{0xffffffff}) + kDictionary), "");
  EXPECT_NE(refusal(".npy", "\x93NUMPY\x09" + npy(kDictionary).substr(7)), "");
}

TEST(MalformedNpz, WrongEntries) {
  const auto doubles = [](const std::string& shape, const std::vector<double>& values) {
    std::string bytes;
    for (const double value : values) bytes += raw(value);
    return npy("{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }\n", bytes);
  };
  using Members = std::vector<std::pair<std::string, std::string>>;
  const std::pair<std::string, std::string> distance{"distance.npy", npy(kDictionary)};
  const std::string origin = doubles("(3,)", {0, 0, 0}), spacing = doubles("()", {1});
  ASSERT_EQ(refusal(".npz", zipFile({distance, {"origin.npy", origin}, {"spacing.npy", spacing}})), "");
  const std::string flat = replaced(kDictionary, "2, 2, 2", "8, 1, 1");
  for (const Members& members :
       std::vector<Members>{{},
                            {{"colour.npy", npy(kDictionary)}},
                            {{"distance.npy", "text"}},
                            {{"distance.npy", std::string(500, '\0')}},
                            {distance, distance},
                            {distance, {"winding.npy", npy(flat)}},
                            {distance, {"triangle.npy", npy(kDictionary)}},
                            {distance, {"origin.npy", doubles("(3,)", {0, NAN, 0})}},
                            {distance, {"origin.npy", doubles("(2,)", {0, 0})}},
                            {distance, {"origin.npy", doubles("(1152921504606846976,)", {0, 0, 0})}},
                            {distance, {"origin.npy", npy(kDictionary)}},
                            {distance, {"spacing.npy", doubles("()", {0})}},
                            {distance, {"spacing.npy", doubles("()", {-1})}},
                            {distance, {"spacing.npy", doubles("()", {NAN})}},
                            {distance, {"spacing.npy", doubles("()", {})}},
                            {distance, {"band.npy", doubles("()", {-1})}},
                            {distance, {"band.npy", doubles("()", {INFINITY})}}})
    EXPECT_NE(refusal(".npz", zipFile(members)), "") << (members.empty() ? "" : members.back().first);
  for (const std::string side : kWrongSides)
    EXPECT_NE(refusal(".npz", zipFile({{"distance.npy", npy(replaced(kDictionary, "(2", "(" + side))}})), "")
        << side;
  for (const auto& [from, to] : kWrongDictionary)
    EXPECT_NE(refusal(".npz", zipFile({{"distance.npy", npy(replaced(kDictionary, from, to))}})), "") << to;
}

TEST(MalformedNpz, Bombs) {
  std::string zeros;
  zeros.resize(9'990'000);  // The memory of this process counts as the program's.
  const std::string cube = replaced(kDictionary, "2, 2, 2", "1024, 1024, 1024");
  const std::string slightlyMore = replaced(kDictionary, "2, 2, 2", "1000, 50, 50");
  // The first declares 4 GB but holds 10 MB. The others declare 10 kB more than they hold, the last one in
  // the archive's directory too.
  EXPECT_NE(refusal(".npz", zipFile({{"distance.npy", npy(cube, zeros)}}, Zip::Deflated)), "");
  EXPECT_NE(refusal(".npz", zipFile({{"distance.npy", npy(slightlyMore, zeros)}}, Zip::Deflated)), "");
  EXPECT_NE(refusal(".npz", zipFile({{"distance.npy", npy(slightlyMore, zeros)}}, Zip::DeflatedLying)), "");
}

TEST(MalformedNpz, HugeDirectories) {
  const std::string one = zipFile({{"distance.npy", npy(kDictionary)}}, Zip::StoredIn64Bits);
  ASSERT_EQ(refusal(".npz", one), "");
  const size_t end64 = one.rfind("PK\6\6");
  const auto changed = [&](size_t at, uint64_t value) {
    std::string damaged = one;
    return damaged.replace(end64 + at, sizeof value, raw(value));
  };
  const std::string damage =
      "it is not a whole zip file, as a .3mf or .npz must be: its directory is missing or damaged\n";
  for (const uint64_t huge : {uint64_t{1} << 24, uint64_t{1} << 40, UINT64_MAX}) {
    std::string entries = changed(24, huge);
    EXPECT_EQ(refusal(".npz", entries.replace(end64 + 32, sizeof huge, raw(huge))), damage) << huge;
    EXPECT_EQ(refusal(".npz", changed(40, huge)), damage) << huge << " bytes";
    EXPECT_EQ(refusal(".npz", changed(48, huge)), damage) << huge << " bytes before it";
  }
}

TEST(MalformedVti, WrongHeaders) {
  const std::string whole =
      R"(<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">)"
      R"(<ImageData WholeExtent="0 1 0 1 0 1" Origin="0 0 0" Spacing="1 1 1">)"
      R"(<Piece Extent="0 1 0 1 0 1"><PointData Scalars="distance">)"
      R"(<DataArray type="Float32" Name="distance" format="appended" offset="0"/></PointData>)"
      R"(</Piece></ImageData><AppendedData encoding="raw">_)" +
      raw(uint64_t{32}) + std::string(32, '\1') + "</AppendedData></VTKFile>";
  ASSERT_EQ(refusal(".vti", whole), "");
  const auto withExtent = [&](const std::string& extent) {
    return replaced(replaced(whole, "0 1 0 1 0 1", extent), "0 1 0 1 0 1", extent);
  };
  for (const std::string side : {"-1", "-4000000000", "nan", "inf", "1.5", "1e300", "4000000000",
                                 "2147483647", "1152921504606846976", "two", ""})
    EXPECT_NE(refusal(".vti", withExtent("0 " + side + " 0 1 0 1")), "") << side;
  for (const std::string& bytes : {raw(uint64_t{1} << 60), raw(uint64_t{0}), raw(int64_t{-1})})
    EXPECT_NE(refusal(".vti", replaced(whole, raw(uint64_t{32}), bytes)), "");
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"ImageData\"", "PolyData\""},
           {"<ImageData", "<StructuredGrid"},
           {"Float32", "Int8"},
           {"Float32", "String"},
           {"type=\"Float32\"", ""},
           {"UInt64", "UInt64\" compressor=\"vtkZLibDataCompressor"},
           {"raw", "base64"},
           {"appended", "binary"},
           {"appended", "ascii"},
           {"appended", "hex"},
           {"offset=\"0\"", "offset=\"1152921504606846976\""},
           {"offset=\"0\"", "offset=\"-1\""},
           {"offset=\"0\"", "offset=\"8\""},
           {"1 1 1\"", "0 0 0\""},
           {"1 1 1\"", "-1 -1 -1\""},
           {"1 1 1\"", "nan nan nan\""},
           {"1 1 1\"", "1 2 1\""},
           {"0 0 0", "0 nan 0"},
           {"0 0 0", "0 0"},
           {"\">_", "\">"},
           {"PointData", "CellData"},
           {"<DataArray", "<DataArray NumberOfComponents=\"3\""}})
    EXPECT_NE(refusal(".vti", replaced(whole, from, to)), "") << to << " for " << from;
  std::string deep;
  for (int i = 0; i < 50'000; ++i) deep += "<a>";
  EXPECT_NE(refusal(".vti", deep), "");
}

TEST(MalformedVdb, AnyWordChangedAnywhere) {
  const std::string whole = wholeFile(".vdb");
  for (size_t at = 0; at + 4 < whole.size(); at += 1 + whole.size() / 20)
    for (const std::string& word : {std::string(4, '\xff'), std::string("text")})
      refusal(".vdb", std::string(whole).replace(at, word.size(), word));
}

}  // namespace
}  // namespace raymap
