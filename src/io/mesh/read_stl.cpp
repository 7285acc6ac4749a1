// Stereolithography files, binary and text. The contents decide which, because many binary files begin with
// `solid`.

#include <algorithm>
#include <optional>

#include "io/mesh/stl_facets.h"
#include "io/mesh/stl_words.h"
#include "io/mesh/text_scanner.h"

namespace raymap {

namespace {

/// Returns whether the first word is `solid` or `facet`, and the next line that is not empty, if any, begins
/// with another statement.
bool looksLikeText(const MeshFile& file) {
  TextScanner text(file);
  const StlWord first = readStlWord(text);
  if (first != StlWord::Solid && first != StlWord::Facet) return false;
  text.nextLine();
  return text.more() && readStlWord(text) != StlWord::Other;
}

/// Returns whether no byte near the beginning is a control character that text has not.
bool isPrintable(const MeshFile& file) {
  constexpr size_t kLookedAt = 1024;
  return std::ranges::none_of(file.text().substr(0, kLookedAt), [](char c) {
    return static_cast<unsigned char>(c) < ' ' && std::string_view("\t\n\v\f\r").find(c) == std::string::npos;
  });
}

/// Reads facets, each with three vertices of its own. The vertices stay separate, because no later step needs
/// them joined.
Mesh readBinary(const MeshFile& file, const StlFacets& facets) {
  if (facets.count() > UINT32_MAX / 3) file.fail("more triangles than 2^32 / 3");
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  positions.reserve(facets.count() * 3);
  triangles.reserve(facets.count());
  std::optional<uint16_t> attribute;  // Most programs write 0, or another number for all.
  bool areEqual = true;
  facets.forEach([&](const StlFacet& facet) {
    const auto first = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), facet.corners.begin(), facet.corners.end());
    triangles.emplace_back(first, first + 1, first + 2);
    areEqual = areEqual && facet.attribute == attribute.value_or(facet.attribute);
    attribute = facet.attribute;
  });
  if (file.attributes && !areEqual)
    file.attributes->lost.emplace_back("attributes of facets, such as colours");
  return finishMesh(file, std::move(positions), std::move(triangles));
}

class StlTextReader {
 public:
  explicit StlTextReader(const MeshFile& file) : file_(file), text_(file) {}

  Mesh read() {
    while (text_.more()) readStatement();
    if (!corners_.empty()) text_.fail("the file ends within a facet");
    if (file_.attributes && hasColours_) file_.attributes->lost.emplace_back("colours");
    if (open_) file_.warnThat("the file ends without endsolid: it may have been cut short");
    return finishPolygons(file_, std::move(positions_), std::move(polygons_));
  }

 private:
  void readStatement() {
    const TextScanner begin = text_;
    switch (readStlWord(text_)) {
      case StlWord::Solid:
        return beginOrEnd(true);
      case StlWord::EndSolid:
        return beginOrEnd(false);
      case StlWord::Facet:
        open_ = true;
        [[fallthrough]];
      case StlWord::Outer:
        mayName_ = false;
        if (!corners_.empty()) text_.fail("a facet begins within a facet");
        return skipRemark();
      case StlWord::Vertex:
        return readVertex();
      case StlWord::EndLoop:
        polygons_.add(corners_);
        corners_.clear();
        return skipRemark();
      case StlWord::EndFacet:
        if (!corners_.empty()) polygons_.add(corners_);
        corners_.clear();
        return skipRemark();
      case StlWord::Color:
        hasColours_ = true;
        return skipRemark();
      case StlWord::Other:
        break;
    }
    if (!mayName_) begin.failWord("facet, vertex or the like");
    text_.restOfLine();
  }

  /// Skips the rest of the line, which names the solid, up to a facet.
  void beginOrEnd(bool begins) {
    open_ = begins;
    mayName_ = true;
    if (!corners_.empty()) text_.fail("a solid begins or ends within a facet");
    for (; text_.moreOnLine(); text_.restOfWord())
      if (TextScanner ahead = text_; readStlWord(ahead) == StlWord::Facet && isNormal(ahead)) return;
  }

  static bool isNormal(TextScanner& text) {
    return text.moreOnLine() && equalsIgnoringCase(text.word(), "normal");
  }

  /// Skips the words up to the next statement on this line, such as a normal.
  void skipRemark() {
    for (; text_.moreOnLine(); text_.restOfWord())
      if (TextScanner ahead = text_; readStlWord(ahead) != StlWord::Other) return;
  }

  void readVertex() {
    corners_.push_back(static_cast<uint32_t>(positions_.size()));
    glm::dvec3 p;
    for (int c = 0; c < 3; ++c) p[c] = text_.real();
    positions_.push_back(p);
    skipRemark();
  }

  const MeshFile& file_;
  TextScanner text_;
  std::vector<glm::dvec3> positions_;
  Polygons polygons_;
  std::vector<uint32_t> corners_;
  bool open_ = false, hasColours_ = false;
  bool mayName_ = false;  // Whether a line may be a solid's name.
};

}  // namespace

Mesh readStl(const MeshFile& file) {
  StlFacets facets(file);
  if (!facets.fits()) {
    if (isPrintable(file) || looksLikeText(file)) return StlTextReader(file).read();
    facets.guess();
  }
  return readBinary(file, facets);
}

}  // namespace raymap
