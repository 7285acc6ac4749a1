// Stereolithography files, binary and text. The contents decide which, because many binary files begin with
// `solid`.

#include <algorithm>
#include <cctype>
#include <cstring>

#include "io/mesh/mesh_file.h"
#include "io/mesh/text_scanner.h"

namespace raymap {

namespace {

constexpr size_t kHeaderBytes = 80;
constexpr size_t kFacetsAt = kHeaderBytes + sizeof(uint32_t);
constexpr size_t kFacetBytes = 50;

uint32_t announcedFacets(const MeshFile& file) {
  uint32_t count = 0;
  std::memcpy(&count, file.bytes.data() + kHeaderBytes, sizeof count);
  return count;
}

bool equalsIgnoringCase(std::string_view word, std::string_view lower) {
  return std::ranges::equal(word, lower, [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == static_cast<unsigned char>(b);
  });
}

/// Returns whether the first word is `solid` and the next line that is not empty, if any, begins with `facet`
/// or `endsolid`.
bool looksLikeText(const MeshFile& file) {
  TextScanner text(file);
  if (!equalsIgnoringCase(text.word(), "solid")) return false;
  text.nextLine();
  const std::string_view word = text.word();
  return word.empty() || equalsIgnoringCase(word, "facet") || equalsIgnoringCase(word, "endsolid");
}

bool isBinary(const MeshFile& file) {
  const size_t size = file.bytes.size();
  if (size >= kFacetsAt && size == kFacetsAt + kFacetBytes * size_t{announcedFacets(file)}) return true;
  return size >= kFacetsAt && !looksLikeText(file);
}

/// Reads facets, each with three vertices of its own. The vertices stay separate, because no later step needs
/// them joined.
Mesh readBinary(const MeshFile& file) {
  const uint64_t announced = announcedFacets(file);
  const uint64_t room = (file.bytes.size() - kFacetsAt) / kFacetBytes;
  if (announced > room)
    file.fail("the file announces " + counted(announced, "triangle") + ", but holds only " +
              std::to_string(room) + " (it is cut short, or not an STL file)");
  if (const uint64_t rest = file.bytes.size() - kFacetsAt - announced * kFacetBytes; rest > 0)
    file.warnThat(counted(rest, "byte") + " after the last triangle ignored");
  if (announced > UINT32_MAX / 3) file.fail("more triangles than 2^32 / 3");

  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  positions.reserve(announced * 3);
  triangles.reserve(announced);
  for (uint32_t t = 0; t < announced; ++t) {
    float facet[12];  // The normal, then three corners; two bytes of attributes follow.
    std::memcpy(facet, file.bytes.data() + kFacetsAt + t * kFacetBytes, sizeof facet);
    for (int c = 3; c < 12; c += 3) positions.emplace_back(facet[c], facet[c + 1], facet[c + 2]);
    triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
  }
  return finishMesh(file, std::move(positions), std::move(triangles));
}

class StlTextReader {
 public:
  explicit StlTextReader(const MeshFile& file) : file_(file), text_(file) {}

  Mesh read() {
    for (std::string_view word = text_.word(); !word.empty(); word = text_.word()) readStatement(word);
    if (!corners_.empty()) text_.fail("the file ends within a facet");
    if (open_) file_.warnThat("the file ends without endsolid: it may have been cut short");
    warnDropped(file_, dropped_);
    return finishMesh(file_, std::move(positions_), std::move(triangles_));
  }

 private:
  /// Reads a statement. Skips the rest of a line that begins or ends something: it holds names and remarks.
  void readStatement(std::string_view word) {
    const auto is = [&](std::string_view keyword) { return equalsIgnoringCase(word, keyword); };
    if (is("vertex")) {
      readVertex();
    } else if (is("endloop") || is("endfacet")) {
      endLoop(is("endloop"));
      text_.restOfLine();
    } else if (is("solid") || is("endsolid")) {
      open_ = is("solid");
      if (!corners_.empty()) text_.fail("a solid begins or ends within a facet");
      text_.restOfLine();
    } else if (is("facet") || is("outer")) {
      if (!corners_.empty()) text_.fail("a facet begins within a facet");
      text_.restOfLine();
    } else {
      text_.fail("expected facet, vertex or the like, found '" + std::string(word.substr(0, 40)) + "'");
    }
  }

  void readVertex() {
    corners_.push_back(static_cast<uint32_t>(positions_.size()));
    glm::dvec3 p;
    for (int c = 0; c < 3; ++c) p[c] = text_.real();
    positions_.push_back(p);
  }

  void endLoop(bool isLoop) {
    if (isLoop && corners_.size() < 3) ++dropped_;
    appendFan(corners_, triangles_);
    corners_.clear();
  }

  const MeshFile& file_;
  TextScanner text_;
  std::vector<glm::dvec3> positions_;
  std::vector<glm::uvec3> triangles_;
  std::vector<uint32_t> corners_;
  uint64_t dropped_ = 0;
  bool open_ = false;
};

}  // namespace

Mesh readStl(const MeshFile& file) {
  return isBinary(file) ? readBinary(file) : StlTextReader(file).read();
}

}  // namespace raymap
