#include <algorithm>
#include <cmath>
#include <ostream>

#include "io/mesh/mesh_formats.h"

namespace raymap {

namespace {

/// Returns a share of full colour as a byte. NaN is 0.
uint8_t byteOf(float share) {
  return share > 0.0F ? static_cast<uint8_t>(std::lround(255.0F * std::min(share, 1.0F))) : uint8_t{0};
}

/// Writes what a vertex has beside its position.
class VertexWriter {
 public:
  explicit VertexWriter(const WritableMesh& mesh)
      : mesh_(mesh),
        hasColours_(!mesh.colours.ids.empty()),
        hasAlpha_(hasColours_ && std::ranges::any_of(mesh.attributes->colours.values,
                                                     [](const glm::vec4& c) { return c.w != 1.0F; })),
        hasUvs_(!mesh.uvs.ids.empty() && !mesh.uvs.differ) {}

  void writeHeader(std::ostream& out) const {
    if (hasColours_) out << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    if (hasAlpha_) out << "property uchar alpha\n";
    if (hasUvs_) out << "property float s\nproperty float t\n";
  }

  char* append(char* at, uint32_t vertex) const {
    if (hasColours_) {
      const glm::vec4 colour = colourOf(mesh_, vertex);
      for (int c = 0; c < (hasAlpha_ ? 4 : 3); ++c) at = raymap::append(at, byteOf(colour[c]));
    }
    if (!hasUvs_) return at;
    const uint32_t id = mesh_.uvs.ids[vertex];
    return raymap::append(at, id == kNoAttribute ? glm::vec2(0.0F) : mesh_.attributes->uvs.values[id]);
  }

 private:
  const WritableMesh& mesh_;
  bool hasColours_, hasAlpha_, hasUvs_;
};

}  // namespace

void writePly(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset) {
  const VertexWriter vertices(mesh);
  // Double precision holds every position: of a view, or a float relative to a double-precision origin.
  out << "ply\nformat binary_little_endian 1.0\n";
  if (const std::string note = offsetNote(offset); !note.empty()) out << "comment " << note << "\n";
  out << "element vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\n";
  vertices.writeHeader(out);
  out << "element face " << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    char bytes[sizeof(glm::dvec3) + 4 + sizeof(glm::vec2)];
    const char* const end = vertices.append(append(bytes, mesh.exactPosition(v)), v);
    out.write(bytes, end - bytes);
  }
  for (const glm::uvec3& face : mesh.triangles) {
    char bytes[1 + sizeof(glm::uvec3)];
    append(append(bytes, uint8_t{3}), face);
    out.write(bytes, sizeof(bytes));
  }
}

}  // namespace raymap
