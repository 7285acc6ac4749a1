// Every encoding that VTK, ParaView and PyVista write, of the same samples.

#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/io.h>

#include "mesh_samples.h"
#include "zip_file.h"

namespace raymap {
namespace {

using namespace samples;

std::string base64(const std::string& bytes) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t at = 0; at < bytes.size(); at += 3) {
    uint32_t bits = 0;
    for (size_t i = 0; i < 3; ++i)
      bits = bits << 8 | (at + i < bytes.size() ? static_cast<unsigned char>(bytes[at + i]) : 0);
    for (size_t i = 0; i < 4; ++i) text += at + i <= bytes.size() ? letters[bits >> (18 - 6 * i) & 63] : '=';
  }
  return text;
}

/// Returns the bytes compressed in zlib's format.
std::string packed(const std::string& bytes) {
  return "\x78\x9c" + deflated(bytes) +
         raw(static_cast<uint32_t>(
                 adler32(1, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()))),
             true);
}

const std::string kSamples = raw<float>({1, 2, -3, 4, 5.5F, -6, 7, 8, 9, 10, 11, 12});

/// Returns compressed blocks of 20 bytes, the last of 8.
std::string blocksHeader(const std::vector<std::string>& blocks) {
  std::string header = raw<uint32_t>({static_cast<uint32_t>(blocks.size()), 20, 8});
  for (const std::string& block : blocks) header += raw(static_cast<uint32_t>(block.size()));
  return header;
}
std::vector<std::string> blocks() {
  return {packed(kSamples.substr(0, 20)), packed(kSamples.substr(20, 20)), packed(kSamples.substr(40))};
}

/// Returns a .vti file. `array` holds the attributes and text of the DataArray, `appended` the bytes after
/// the underscore.
std::string vti(const std::string& attributes, const std::string& array, const std::string& appended = "") {
  std::string text = "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\"" + attributes +
                     "><ImageData WholeExtent=\"0 2 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece "
                     "Extent=\"0 2 0 1 0 1\">"
                     "<PointData Scalars=\"distance\"><DataArray type=\"Float32\" Name=\"distance\" format=" +
                     array + "</DataArray></PointData></Piece></ImageData>";
  if (!appended.empty()) text += "<AppendedData encoding=" + appended + "</AppendedData>";
  return text + "</VTKFile>";
}

std::string samplesOf(const std::string& bytes) {
  const TemporaryFile file("field.vti", bytes);
  const Field field = readField(file.path());
  EXPECT_EQ(field.grid.dims, glm::ivec3(3, 2, 2));
  return {reinterpret_cast<const char*>(field.distance.data()), field.distance.size() * sizeof(float)};
}

const std::string kZlib = " compressor=\"vtkZLibDataCompressor\"";
const std::string kCount = raw(static_cast<uint32_t>(48));

TEST(Vti, ReadsEveryEncoding) {
  EXPECT_EQ(samplesOf(vti("", "\"ascii\">1 2 -3 4 5.5 -6\n7 8 9 10 11 12")), kSamples);
  EXPECT_EQ(samplesOf(vti("", "\"binary\">\n " + base64(kCount + kSamples) + "\n")), kSamples);
  EXPECT_EQ(samplesOf(vti("", "\"binary\">" + base64(kCount) + base64(kSamples))), kSamples);
  const std::string appended = "\"appended\" offset=\"0\">";
  EXPECT_EQ(samplesOf(vti("", appended, "\"base64\">_" + base64(kCount + kSamples))), kSamples);
  EXPECT_EQ(samplesOf(vti("", appended, "\"raw\">_" + kCount + kSamples)), kSamples);
}

/// Returns a file with this DataArray as field data and another one beside the distance.
std::string vtiWithMore(const std::string& data, const std::string& more, const std::string& appended = "") {
  std::string text = vti("", "\"ascii\">1 2 3 4 5 6 7 8 9 10 11 12", appended);
  text.insert(text.find("<Piece"), "<FieldData>" + data + "</FieldData>");
  return text.insert(text.find("</PointData>"), more);
}

TEST(Vti, ReadsTheClampDistanceInEveryEncoding) {
  const std::string start =
      "<DataArray type=\"Float64\" Name=\"clamp_distance\" NumberOfTuples=\"1\" format=";
  const std::string count = raw(static_cast<uint32_t>(8)), number = raw(2.5);
  for (const auto& [array, appended] : std::vector<std::pair<std::string, std::string>>{
           {"\"ascii\"> 2.5 ", ""},
           {"\"binary\">" + base64(count + number), ""},
           {"\"appended\" offset=\"0\">", "\"raw\">_" + count + number},
           {"\"appended\" offset=\"0\">", "\"base64\">_" + base64(count + number)}}) {
    const TemporaryFile file("field.vti", vtiWithMore(start + array + "</DataArray>", "", appended));
    EXPECT_EQ(readField(file.path()).clampDistance, 2.5) << array;
  }
  const TemporaryFile file("field.vti", vtiWithMore(start + "\"ascii\">wide</DataArray>", ""));
  EXPECT_THROW(readField(file.path()), Error);
}

TEST(Vti, ReadsItsOwnArraysBesideOthers) {
  const std::string numbers = "0 1 2 3 4 5 6 7 8 9 10 11</DataArray>";
  const auto array = [&](const std::string& name, const std::string& type) {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"ascii\">" + numbers;
  };
  const TemporaryFile file("field.vti",
                           vtiWithMore("", array("pressure", "Float32") + array("triangle", "UInt32") +
                                               array("winding", "Float32")));
  const Field field = readField(file.path());
  ASSERT_EQ(field.triangle.size(), 12u);
  ASSERT_EQ(field.winding.size(), 12u);
  EXPECT_TRUE(field.confidence.empty());
  for (size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(field.distance[i], float(i + 1));
    EXPECT_EQ(field.triangle[i], i);
    EXPECT_EQ(field.winding[i], float(i));
  }
  const TemporaryFile twice("field.vti",
                            vtiWithMore("", array("winding", "Float32") + array("winding", "Float32")));
  EXPECT_THROW(readField(twice.path()), Error);
}

TEST(Vti, NamesTheArraysThatItLeavesOut) {
  std::string more, cells;
  for (int k = 0; k < 9; ++k) more += "<DataArray type=\"Float32\" Name=\"p" + std::to_string(k) + "\"/>";
  std::string text = vtiWithMore("<DataArray type=\"Float64\" Name=\"TimeValue\"/>", more);
  text.insert(text.find("</PointData>") + 12, "<CellData><DataArray Name=\"c\"/></CellData>");
  const TemporaryFile file("field.vti", text);
  std::string message;
  readField(file.path(), {.warn = [&](const Warning& warning) { message += warning.message; }});
  EXPECT_EQ(message, file.path().string() +
                         ": it also holds 'p0', 'p1', 'p2', 'p3', 'p4', 'p5', 'p6', 'p7' and 2 more, which a "
                         "field has no place for");
}

TEST(Vti, ReadsCompressedBlocks) {
  const std::vector<std::string> parts = blocks();
  const std::string header = blocksHeader(parts), data = parts[0] + parts[1] + parts[2];
  const std::string appended = "\"appended\" offset=\"0\">";
  EXPECT_EQ(samplesOf(vti(kZlib, appended, "\"raw\">_" + header + data)), kSamples);
  EXPECT_EQ(samplesOf(vti(kZlib, appended, "\"base64\">_" + base64(header) + base64(data))), kSamples);
  EXPECT_EQ(samplesOf(vti(kZlib, "\"binary\">" + base64(header) + base64(data))), kSamples);
}

TEST(Vti, RefusesSpacingsThatMakeNoGrid) {
  const auto messageOf = [](const std::string& spacing) {
    std::string text = vti("", "\"ascii\">1 2 3 4 5 6 7 8 9 10 11 12");
    text.replace(text.find("1 1 1\"><Piece"), 5, spacing);
    try {
      samplesOf(text);
    } catch (const Error& error) {
      return (error.code() == ErrorCode::Input ? "Input: " : "") + std::string(error.what());
    }
    return std::string("read");
  };
  EXPECT_EQ(messageOf("2 2 2.00001"), "read");
  EXPECT_TRUE(messageOf("1 1 1.1").ends_with(": its cells are not cubes; resample it"));
  for (const std::string wrong : {"nan", "inf", "0", "-1"})
    for (const std::string& spacing : {wrong + " 1 1", "1 1 " + wrong, wrong + " " + wrong + " " + wrong}) {
      const std::string message = messageOf(spacing);
      EXPECT_TRUE(message.starts_with("Input: ")) << message;
      EXPECT_TRUE(message.ends_with(": the grid's spacing is " + wrong + ", not a positive number"))
          << message;
    }
}

TEST(Vti, RefusesDamagedBlocks) {
  const std::vector<std::string> parts = blocks();
  const std::string header = blocksHeader(parts), data = parts[0] + parts[1] + parts[2];
  const auto refuse = [](const std::string& bytes) {
    EXPECT_THROW(samplesOf(vti(kZlib, "\"appended\" offset=\"0\">", "\"raw\">_" + bytes)), Error);
  };
  for (const uint32_t wrong : {0U, 1U, 2U, 4U, 0x7fffffffU, 0xffffffffU})
    for (const size_t word : {0, 1, 2, 3, 4, 5}) {
      std::string damaged = header;
      damaged.replace(4 * word, 4, raw(wrong));
      refuse(damaged + data);
    }
  for (size_t size = 0; size < header.size() + data.size(); size += 5)
    refuse((header + data).substr(0, size));
  std::string damaged = data;
  damaged[20] = static_cast<char>(damaged[20] ^ 0x55);
  refuse(header + damaged);
  EXPECT_THROW(
      samplesOf(vti(" compressor=\"vtkLZ4DataCompressor\"", "\"binary\">" + base64(header) + base64(data))),
      Error);
}

}  // namespace
}  // namespace raymap
