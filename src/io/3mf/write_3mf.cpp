#include "io/3mf/write_3mf.h"

#include <raymap/error.h>
#include <raymap/version.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "io/3mf/units.h"
#include "io/field/zip_writer.h"
#include "mesh/weld.h"

namespace raymap {

namespace {

constexpr std::string_view kXml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// Returns the length in bytes of the UTF-8 character that a text begins with; 0 if it is none that XML
/// allows.
size_t characterBytes(std::string_view text) {
  const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned lead = byte(0);
  if (lead < 0x80) return lead >= 0x20 && lead != 0x7f ? 1 : 0;
  const size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  uint32_t code = lead & (0xffU >> (bytes + 1));
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3fU);
  }
  constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool isSurrogate = code >= 0xd800 && code < 0xe000;
  const bool isCharacter = lead >= 0xc0 && lead < 0xf8 && code >= kLeast[bytes] && code <= 0x10ffff &&
                           !isSurrogate && (code & 0xfffeU) != 0xfffe;
  return isCharacter ? bytes : 0;
}

/// Returns a text as the content of an XML element.
std::string xmlText(std::string_view text) {
  std::string xml;
  while (!text.empty()) {
    const size_t bytes = characterBytes(text);
    const char first = text[0];
    if (bytes == 0)
      xml += '?';
    else if (first == '&' || first == '<' || first == '>')
      xml += first == '&' ? "&amp;" : first == '<' ? "&lt;" : "&gt;";
    else
      xml += text.substr(0, bytes);
    text.remove_prefix(std::max<size_t>(bytes, 1));
  }
  return xml;
}

/// Collects text and writes it to the zip in large pieces.
class Text {
 public:
  explicit Text(ZipWriter& zip) : zip_(zip) {}

  Text& operator<<(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() >= kPiece) flush();
    return *this;
  }
  /// Writes a number with the fewest digits that read back exactly.
  template <class T>
  Text& number(T value) {
    char digits[32];
    return *this << std::string_view(digits, std::to_chars(digits, digits + sizeof(digits), value).ptr);
  }
  void flush() {
    zip_.write(buffer_);
    buffer_.clear();
  }

 private:
  static constexpr size_t kPiece = size_t{1} << 18;
  ZipWriter& zip_;
  std::string buffer_;
};

void addText(ZipWriter& zip, const std::string& name, std::string_view text) {
  zip.beginDeflated(name, ZipWriter::Size::Below4GiB);
  zip.write(kXml);
  zip.write(text);
  zip.endFile();
}

/// Returns whether no two corners of triangles share a vertex, as in an STL.
bool isSoup(const PackedMesh& mesh) {
  if (3 * mesh.triangles.size() > mesh.vertices.size()) return false;
  std::vector<bool> isUsed(mesh.vertices.size());
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      if (isUsed[t[c]]) return false;
      isUsed[t[c]] = true;
    }
  return true;
}

/// Returns a mesh with one vertex for each position, in the order of the first ones.
Mesh joined(const PackedMesh& mesh) {
  const Welding welding = weldVertices(mesh.vertices);
  constexpr uint32_t kNone = UINT32_MAX;
  std::vector<uint32_t> indices(welding.count, kNone);
  Mesh result{.origin = mesh.origin};
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    uint32_t& index = indices[welding.ids[v]];
    if (index != kNone) continue;
    index = static_cast<uint32_t>(result.vertices.size());
    result.vertices.push_back(mesh.vertices[v]);
  }
  result.triangles.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles)
    result.triangles.emplace_back(indices[welding.ids[t.x]], indices[welding.ids[t.y]],
                                  indices[welding.ids[t.z]]);
  return result;
}

void writeVertices(Text& text, const PackedMesh& mesh) {
  // Vertices that no triangle uses may be anything, but 3MF holds finite numbers only.
  const auto finite = [](double value) { return std::isfinite(value) ? value : 0.0; };
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const glm::dvec3 p = mesh.position(v);
    text << "<vertex x=\"";
    text.number(finite(p.x)) << "\" y=\"";
    text.number(finite(p.y)) << "\" z=\"";
    text.number(finite(p.z)) << "\"/>\n";
  }
}

void writeTriangles(Text& text, const PackedMesh& mesh) {
  for (const glm::uvec3& t : mesh.triangles) {
    if (!isIn3mf(t)) continue;
    text << "<triangle v1=\"";
    text.number(t.x) << "\" v2=\"";
    text.number(t.y) << "\" v3=\"";
    text.number(t.z) << "\"/>\n";
  }
}

void writeModel(Text& text, const PackedMesh& mesh, const About3mf& about) {
  text << kXml << "<model unit=\"" << nameIn3mf(about.unit)
       << "\" xml:lang=\"en-US\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n";
  const auto metadata = [&](const char* name, const std::string& value) {
    if (!value.empty()) text << "<metadata name=\"" << name << "\">" << xmlText(value) << "</metadata>\n";
  };
  metadata("Title", about.title);
  metadata("Description", about.description);
  metadata("Application", std::string("raymap ") + version().text);
  text << "<resources>\n<object id=\"1\" type=\"model\">\n<mesh>\n<vertices>\n";
  writeVertices(text, mesh);
  text << "</vertices>\n<triangles>\n";
  writeTriangles(text, mesh);
  text << "</triangles>\n</mesh>\n</object>\n</resources>\n"
       << "<build>\n<item objectid=\"1\"/>\n</build>\n</model>\n";
  text.flush();
}

/// Writes the parts of the package.
void writeParts(std::ostream& out, const PackedMesh& mesh, const About3mf& about) {
  if (std::ranges::none_of(mesh.triangles, isIn3mf))
    throw Error(ErrorCode::Unsupported,
                "a 3MF holds triangles of three different vertices, and this mesh has none; write a .ply");
  ZipWriter zip(out);
  addText(zip, "[Content_Types].xml",
          "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
          "<Default Extension=\"rels\" "
          "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
          "<Default Extension=\"model\" "
          "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n</Types>\n");
  addText(zip, "_rels/.rels",
          "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
          "<Relationship Target=\"/3D/3dmodel.model\" Id=\"model\" "
          "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n</Relationships>\n");
  // The longest lines of a vertex and a triangle.
  constexpr uint64_t kVertexBytes = 100, kTriangleBytes = 64;
  const uint64_t most = kVertexBytes * mesh.vertices.size() + kTriangleBytes * mesh.triangles.size();
  zip.beginDeflated("3D/3dmodel.model", most < (uint64_t{1} << 32) - (1 << 20) ? ZipWriter::Size::Below4GiB
                                                                               : ZipWriter::Size::Any);
  Text text(zip);
  writeModel(text, mesh, about);
  zip.endFile();
  zip.finish();
}

}  // namespace

void write3mf(std::ostream& out, const PackedMesh& mesh, const About3mf& about) {
  if (isSoup(mesh))
    writeParts(out, joined(mesh), about);
  else
    writeParts(out, mesh, about);
}

}  // namespace raymap
