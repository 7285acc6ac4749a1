#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>
#include <ostream>
#include <system_error>

#include "io/mesh/mesh_formats.h"

namespace raymap {

namespace {

constexpr const char* kAdded = "added";  // Part and material of faces that have none behind others that do.

/// A line of numbers, each with the fewest digits that read back exactly.
class Line {
 public:
  explicit Line(const char* keyword) {
    while (*keyword != '\0') *at_++ = *keyword++;
  }

  template <class T>
  Line& add(T number, char before = ' ') {
    *at_++ = before;
    at_ = std::to_chars(at_, at_ + kLongest, number).ptr;
    return *this;
  }
  void write(std::ostream& out) {
    *at_++ = '\n';
    out.write(text_, at_ - text_);
  }

 private:
  static constexpr size_t kLongest = 32, kNumbers = 6;  // Longest number, in characters; most numbers.
  char text_[4 + kNumbers * (1 + kLongest)];
  char* at_ = text_;
};

/// Returns a name without what would end a line or join it with the next one.
std::string nameText(std::string name) {
  for (char& c : name)
    if (static_cast<unsigned char>(c) < ' ') c = '_';
  if (name.ends_with('\\')) name.back() = '_';
  return name;
}

/// Writes the files of the materials, as seen from the folder of the mesh.
void writeLibraries(std::ostream& out, const MeshAttributes& attributes, const std::filesystem::path& given) {
  const bool isStream = (given / "").string().starts_with("/dev/");
  for (const std::filesystem::path& library : attributes.libraries) {
    std::error_code error;
    const std::filesystem::path folder =
        isStream || given.empty() ? std::filesystem::current_path(error) : given;
    const std::filesystem::path relative =
        std::filesystem::relative(std::filesystem::absolute(library, error), folder, error);
    out << "mtllib " << nameText((relative.empty() ? library : relative).generic_string()) << "\n";
  }
}

/// Writes lines that name the parts and the materials of faces, where these change.
class FaceNames {
 public:
  FaceNames(std::ostream& out, const MeshAttributes& attributes) : out_(out), attributes_(attributes) {}

  void begin(size_t face) {
    const uint32_t part = attributes_.partOf.empty() ? kNoAttribute : attributes_.partOf[face];
    if (part != part_) {
      part_ = part;
      const MeshPart& names = part == kNoAttribute ? kNoPart : attributes_.parts[part];
      change("o", names.object, part == kNoAttribute, object_);
      change("g", names.group, part == kNoAttribute, group_);
    }
    const uint32_t material = attributes_.materialOf.empty() ? kNoAttribute : attributes_.materialOf[face];
    if (material == material_) return;
    material_ = material;
    change("usemtl", material == kNoAttribute ? std::string() : attributes_.materials[material],
           material == kNoAttribute, materialName_);
  }

 private:
  static inline const MeshPart kNoPart{};

  void change(const char* keyword, const std::string& given, bool isNone, std::string& current) {
    const std::string& name = isNone && !current.empty() ? added_ : given;
    if (name == current) return;
    current = name;
    out_ << keyword << (name.empty() ? "" : " ") << nameText(name) << "\n";
  }

  std::ostream& out_;
  const MeshAttributes& attributes_;
  const std::string added_ = kAdded;
  uint32_t part_ = kNoAttribute, material_ = kNoAttribute;
  std::string object_, group_, materialName_;
};

/// Returns the numbers of faces so that each object, or group outside of objects, is written once; nothing if
/// they have no names.
std::vector<uint32_t> facesByObject(const MeshAttributes& attributes) {
  const std::vector<MeshPart>& parts = attributes.parts;
  std::map<std::string, uint32_t> ranks;
  std::vector<uint32_t> rankOf(parts.size() + 1, kNoAttribute);  // The last one is of faces without a name.
  const auto rank = [&](uint32_t f) -> uint32_t& {
    return rankOf[std::min<size_t>(attributes.partOf[f], parts.size())];
  };
  std::vector<uint32_t> order(attributes.partOf.size());
  std::iota(order.begin(), order.end(), 0U);
  for (const uint32_t f : order) {
    if (rank(f) != kNoAttribute) continue;
    const MeshPart names = attributes.partOf[f] == kNoAttribute ? MeshPart{} : parts[attributes.partOf[f]];
    const auto next = uint32_t(ranks.size());
    rank(f) = ranks.try_emplace(names.object.empty() ? names.group : names.object, next).first->second;
  }
  std::ranges::stable_sort(order, {}, rank);
  return order;
}

void writeVertices(std::ostream& out, const WritableMesh& mesh) {
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const glm::dvec3 p = mesh.exactPosition(v);
    Line line("v");
    line.add(p.x).add(p.y).add(p.z);
    if (!mesh.colours.ids.empty()) {
      const glm::vec4 colour = colourOf(mesh, v);
      line.add(colour.x).add(colour.y).add(colour.z);
    }
    line.write(out);
  }
}

}  // namespace

void writeObj(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset) {
  static const MeshAttributes kNoAttributes;
  const MeshAttributes& attributes = mesh.attributes ? *mesh.attributes : kNoAttributes;
  if (const std::string note = offsetNote(offset); !note.empty()) out << "# " << note << "\n";
  if (!attributes.materialOf.empty()) writeLibraries(out, attributes, mesh.folder);
  writeVertices(out, mesh);
  for (const glm::vec2& uv : attributes.uvs.values) Line("vt").add(uv.x).add(uv.y).write(out);
  FaceNames names(out, attributes);
  const std::vector<uint32_t> order = facesByObject(attributes);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const size_t f = order.empty() ? i : order[i];
    names.begin(f);
    const glm::uvec3 uvs =
        attributes.uvs.corners.empty() ? glm::uvec3(kNoAttribute) : attributes.uvs.corners[f];
    const bool hasUvs = uvs.x != kNoAttribute && uvs.y != kNoAttribute && uvs.z != kNoAttribute;
    Line line("f");
    for (int c = 0; c < 3; ++c) {
      line.add(mesh.triangles[f][c] + uint64_t{1});
      if (hasUvs) line.add(uvs[c] + uint64_t{1}, '/');
    }
    line.write(out);
  }
}

}  // namespace raymap
