#include "io/3mf/write_3mf.h"

#include <raymap/error.h>
#include <raymap/version.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "io/3mf/properties.h"
#include "io/3mf/units.h"
#include "io/3mf/xml_text.h"
#include "io/mesh/named_objects.h"
#include "io/zip/zip_writer.h"
#include "mesh/compact.h"
#include "mesh/weld.h"

namespace raymap {

namespace {

constexpr std::string_view kXml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// Appends a number with the fewest digits that read back exactly.
template <class T>
void append(std::string& text, T value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof(digits), value).ptr);
}

void addText(ZipWriter& zip, const std::string& name, std::string_view text) {
  zip.addDeflated(name, 1, [text](size_t) { return std::string(kXml).append(text); });
}

/// Returns whether no two corners of triangles share a vertex, as in an STL.
bool isSoup(const WritableMesh& mesh) {
  if (3 * mesh.triangles.size() > mesh.vertices.size()) return false;
  std::vector<bool> isUsed(mesh.vertices.size());
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      if (isUsed[t[c]]) return false;
      isUsed[t[c]] = true;
    }
  return true;
}

/// An object, as the pieces of its text: what comes before the vertices, blocks of them, what comes before
/// the triangles, blocks of them, and the end.
class ObjectText {
 public:
  ObjectText(const NamedObject& object, size_t id, const PropertyText& properties)
      : mesh_(object.mesh()), name_(object.name), faces_(object.faces), id_(id), properties_(properties) {}

  size_t pieces() const { return trianglesAt() + blocks(mesh_.triangles.size()) + 1; }
  std::string piece(size_t i) const {
    if (i == 0) return begin();
    if (i < trianglesAt() - 1) return vertices(i - 1);
    if (i < trianglesAt()) return "</vertices>\n<triangles>\n";
    if (i < pieces() - 1) return triangles(i - trianglesAt());
    return "</triangles>\n</mesh>\n</object>\n";
  }

 private:
  static constexpr size_t kBlock = 4096;
  static size_t blocks(size_t count) { return (count + kBlock - 1) / kBlock; }
  size_t trianglesAt() const { return blocks(mesh_.vertices.size()) + 2; }

  std::string begin() const {
    const std::string name = name_.empty() ? "" : " name=\"" + xmlText(name_) + "\"";
    return "<object id=\"" + std::to_string(id_) + "\" type=\"model\"" + name +
           properties_.defaultOf(faces_, mesh_.triangles.size()) + ">\n<mesh>\n<vertices>\n";
  }

  std::string vertices(size_t block) const {
    // Vertices that no triangle uses may be anything, but 3MF holds finite numbers only.
    const auto finite = [](double value) { return std::isfinite(value) ? value : 0.0; };
    std::string text;
    const size_t end = std::min((block + 1) * kBlock, mesh_.vertices.size());
    for (size_t v = block * kBlock; v < end; ++v) {
      const glm::dvec3 p = mesh_.exactPosition(static_cast<uint32_t>(v));
      append(text += "<vertex x=\"", finite(p.x));
      append(text += "\" y=\"", finite(p.y));
      append(text += "\" z=\"", finite(p.z));
      text += "\"/>\n";
    }
    return text;
  }

  std::string triangles(size_t block) const {
    std::string text;
    const size_t begin = block * kBlock, count = std::min(kBlock, mesh_.triangles.size() - begin);
    for (size_t f = begin; f < begin + count; ++f) {
      const glm::uvec3& t = mesh_.triangles[f];
      if (!isIn3mf(t)) continue;
      append(text += "<triangle v1=\"", t.x);
      append(text += "\" v2=\"", t.y);
      append(text += "\" v3=\"", t.z);
      text += "\"" + properties_.of(faces_.empty() ? f : faces_[f]) + "/>\n";
    }
    return text;
  }

  const WritableMesh& mesh_;
  const std::string& name_;
  const std::vector<uint32_t>& faces_;
  size_t id_;
  const PropertyText& properties_;
};

/// The part that holds all objects. Several are components of another one, which the build places.
class ModelText {
 public:
  ModelText(const std::vector<NamedObject>& objects, const MeshAttributes* attributes, const About3mf& about)
      : about_(about), properties_(attributes, objects.size() + 2) {
    for (const NamedObject& object : objects) texts_.emplace_back(object, texts_.size() + 1, properties_);
  }

  size_t pieces() const {
    size_t count = 2;
    for (const ObjectText& text : texts_) count += text.pieces();
    return count;
  }
  std::string piece(size_t i) const {
    if (i-- == 0) return begin();
    for (const ObjectText& text : texts_) {
      if (i < text.pieces()) return text.piece(i);
      i -= text.pieces();
    }
    return end();
  }

 private:
  std::string begin() const {
    std::string text(kXml);
    text += "<model unit=\"" + std::string(nameIn3mf(about_.unit)) +
            "\" xml:lang=\"en-US\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"";
    const std::string groups = properties_.groups();
    if (groups.find("<m:") != groups.npos)
      text += " xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\"";
    text += ">\n";
    const auto metadata = [&](const char* name, const std::string& value) {
      if (!value.empty())
        text += "<metadata name=\"" + std::string(name) + "\">" + xmlText(value) + "</metadata>\n";
    };
    metadata("Title", about_.title);
    metadata("Description", about_.description);
    metadata("Application", std::string("raymap ") + version().text);
    return text + "<resources>\n" + groups;
  }

  std::string end() const {
    std::string text;
    const std::string last = std::to_string(texts_.size() + (texts_.size() > 1 ? 1 : 0));
    if (texts_.size() > 1) {
      text += "<object id=\"" + last + "\" type=\"model\">\n<components>\n";
      for (size_t id = 1; id <= texts_.size(); ++id)
        text += "<component objectid=\"" + std::to_string(id) + "\"/>\n";
      text += "</components>\n</object>\n";
    }
    return text + "</resources>\n<build>\n<item objectid=\"" + last + "\"/>\n</build>\n</model>\n";
  }

  std::vector<ObjectText> texts_;
  const About3mf& about_;
  PropertyText properties_;
};

/// Writes the parts of the package. Objects without a triangle that a 3MF can hold are left out.
void writeParts(std::ostream& out, std::vector<NamedObject>& objects, const MeshAttributes* attributes,
                const About3mf& about) {
  std::erase_if(objects, [](const NamedObject& object) {
    return std::ranges::none_of(object.mesh().triangles, isIn3mf);
  });
  if (objects.empty())
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
  const ModelText model(objects, attributes, about);
  zip.addDeflated("3D/3dmodel.model", model.pieces(), [&](size_t i) { return model.piece(i); });
  zip.finish();
}

/// Numbers the distinct positions in double precision.
Welding weldingOf(const std::vector<glm::dvec3>& positions) {
  using Key = std::array<uint64_t, 4>;  // Bits of a position, of which 0 and -0 are one, and its number.
  std::vector<Key> keys;
  const auto bits = [](double number) { return std::bit_cast<uint64_t>(number + 0.0); };
  for (const glm::dvec3& p : positions) keys.push_back({bits(p.x), bits(p.y), bits(p.z), keys.size()});
  std::ranges::sort(keys);
  Welding welding{Buffer<uint32_t>(positions.size())};
  for (size_t k = 0; k < keys.size(); ++k) {
    if (k == 0 || !std::equal(keys[k].begin(), keys[k].begin() + 3, keys[k - 1].begin())) ++welding.count;
    welding.ids[keys[k][3]] = uint32_t(welding.count - 1);
  }
  return welding;
}

/// Gives an object one vertex for each position that vertices share.
void weld(NamedObject& object) {
  const WritableMesh& mesh = object.mesh();
  std::vector<uint32_t> firsts;
  std::vector<glm::dvec3> exact;
  Mesh welded =
      weldedCopy(mesh, mesh.exact.empty() ? weldVertices(mesh.vertices) : weldingOf(mesh.exact), firsts);
  for (size_t k = 0; !mesh.exact.empty() && k < firsts.size(); ++k) exact.push_back(mesh.exact[firsts[k]]);
  object.part = std::move(welded);
  object.own = WritableMesh{object.part, std::move(exact)};
  object.whole = nullptr;
}

}  // namespace

void write3mf(std::ostream& out, const WritableMesh& mesh, const About3mf& about) {
  std::vector<NamedObject> objects = namedObjects(mesh);
  for (NamedObject& object : objects)
    if (isSoup(object.mesh())) weld(object);
  writeParts(out, objects, mesh.attributes, about);
}

}  // namespace raymap
