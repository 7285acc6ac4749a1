#include "io/import/import_attributes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "io/mesh/base_colour.h"
#include "io/mesh/gltf_materials.h"
#include "mesh/attribute_words.h"

namespace raymap {

namespace {

bool isFinite(const auto& values) {
  for (int c = 0; c < values.length(); ++c)
    if (!std::isfinite(values[c])) return false;
  return true;
}

class AttributeReceiver {
 public:
  AttributeReceiver(const MeshFile& file, const MeshHeader& header, Importer& importer)
      : file_(file), header_(header), importer_(importer), found_(*file.attributes) {}

  void receive(std::span<const glm::uvec3> triangles) {
    const auto runs = values<MeshRun>(header_.runs);
    const std::vector<std::string> names = splitNames(values<char>(header_.nameBytes));
    const auto firstMaterial = names.begin() + ptrdiff_t(header_.parts);
    for (auto name = names.begin(); name < firstMaterial; ++name) found_.parts.push_back({*name});
    addMaterials({firstMaterial, names.end()}, values<glm::vec4>(header_.materials));
    found_.uvs.values = values<glm::vec2>(header_.hasUvs != 0 ? header_.vertices : 0);
    found_.colours.values = values<glm::vec4>(header_.hasColours != 0 ? header_.vertices : 0);
    addRuns(runs, triangles);
    finish(found_.uvs, "texture coordinates");
    finish(found_.colours, "colours");
    if (header_.parts == 0) found_.partOf.clear();
    if (header_.materials == 0) found_.materialOf.clear();
  }

 private:
  template <class T>
  std::vector<T> values(uint64_t count) {
    std::vector<T> received(count);
    importer_.receive(received.data(), count * sizeof(T));
    return received;
  }

  [[noreturn]] void fail() const { file_.fail("its attributes do not fit its triangles"); }

  std::vector<std::string> splitNames(const std::vector<char>& bytes) const {
    std::vector<std::string> names;
    for (auto begin = bytes.begin(); begin != bytes.end();) {
      const auto end = std::find(begin, bytes.end(), '\0');
      if (end == bytes.end()) fail();
      names.emplace_back(begin, end);
      begin = end + 1;
    }
    if (names.size() != header_.parts + header_.materials) fail();
    return names;
  }

  void addMaterials(std::vector<std::string> names, const std::vector<glm::vec4>& colours) {
    GltfMaterials looks;
    for (size_t m = 0; m < names.size(); ++m) {
      if (names[m].empty()) names[m] = "material " + std::to_string(m);
      const bool isColour = isFinite(colours[m]);
      looks.root["materials"].push_back(
          gltfMaterial(names[m], isColour ? glm::clamp(colours[m], 0.0F, 1.0F) : glm::vec4(1.0F)));
    }
    if (!names.empty()) found_.gltf = std::make_shared<const GltfMaterials>(std::move(looks));
    found_.materials = std::move(names);
  }

  void addRuns(const std::vector<MeshRun>& runs, std::span<const glm::uvec3> triangles) {
    size_t next = 0;
    const auto isNumber = [](uint32_t number, uint64_t count) {
      return number == MeshRun::kNone || number < count;
    };
    for (const MeshRun& run : runs) {
      if (run.triangles > triangles.size() - next || !isNumber(run.part, header_.parts) ||
          !isNumber(run.material, header_.materials))
        fail();
      found_.partOf.insert(found_.partOf.end(), run.triangles, run.part);
      found_.materialOf.insert(found_.materialOf.end(), run.triangles, run.material);
      for (const size_t end = next + run.triangles; next < end; ++next) {
        found_.uvs.corners.push_back(run.hasUvs != 0 ? triangles[next] : glm::uvec3(kNoAttribute));
        found_.colours.corners.push_back(run.hasColours != 0 ? triangles[next] : glm::uvec3(kNoAttribute));
      }
    }
    if (next != triangles.size()) fail();
  }

  /// Drops values that nothing has, or that are malformed.
  template <class Value>
  void finish(CornerValues<Value>& values, const std::string& name) {
    const bool areFinite = std::ranges::all_of(values.values, [](const Value& v) { return isFinite(v); });
    if (!areFinite) file_.warnThat("its " + name + " are not all finite numbers, and are left out");
    if (!areFinite || values.values.empty()) values = {};
  }

  const MeshFile& file_;
  const MeshHeader& header_;
  Importer& importer_;
  MeshAttributes& found_;
};

}  // namespace

uint64_t attributeBytes(const MeshHeader& header) {
  return header.runs * sizeof(MeshRun) + header.nameBytes + header.materials * sizeof(glm::vec4) +
         header.vertices * (header.hasUvs != 0 ? sizeof(glm::vec2) : 0) +
         header.vertices * (header.hasColours != 0 ? sizeof(glm::vec4) : 0);
}

void importAttributes(const MeshFile& file, const MeshHeader& header, std::span<const glm::uvec3> triangles,
                      Importer& importer) {
  AttributeReceiver(file, header, importer).receive(triangles);
  std::vector<std::string>& lost = file.attributes->lost;
  if (header.textures > 0) lost.push_back(counted(header.textures, "texture"));
  if (header.moreUvs != 0) lost.emplace_back("further texture coordinates");
  if (header.moreColours != 0) lost.emplace_back("further colours");
}

}  // namespace raymap
