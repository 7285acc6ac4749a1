// Wavefront OBJ: `v` and `f` lines. Others describe parts and appearance, which are read if attributes are
// asked for, or curves, which are not.

#include <algorithm>

#include "io/mesh/mesh_file.h"
#include "io/mesh/obj_attributes.h"
#include "io/mesh/text_scanner.h"

namespace raymap {

namespace {

class ObjReader {
 public:
  explicit ObjReader(const MeshFile& file) : file_(file), text_(file), attributes_(file) {
    if (file.attributes) polygons_.trackCorners();
  }

  Mesh read() {
    for (; !atEnd(); text_.nextLine()) readLine();
    if (largest_ >= static_cast<int64_t>(positions_.size()))
      text_.failAt(largestAt_, outOfRange(largest_ + 1, positions_.size()));
    if (freeForm_) file_.warnThat("free-form curves and surfaces are not read");
    warnOfPolygons(file_, polygons_.dropped(), polygons_.cut(positions_));
    if (file_.attributes) attributes_.finish(polygons_);
    return finishMesh(file_, std::move(positions_), std::move(polygons_.triangles));
  }

 private:
  bool atEnd() const { return text_.position() == file_.bytes.size(); }

  void readLine() {
    if (!text_.moreOnLine()) return;
    const std::string_view keyword = text_.word();
    if (keyword == "v")
      readVertex();
    else if (keyword == "f")
      readFace();
    else if (keyword == "curv" || keyword == "curv2" || keyword == "surf")
      freeForm_ = true;
    else if (file_.attributes)
      attributes_.read(keyword, text_);
  }

  void readVertex() {
    glm::dvec3 p;
    for (int c = 0; c < 3; ++c) {
      if (!text_.moreOnLine()) text_.fail("a vertex needs three coordinates");
      p[c] = text_.real();
    }
    if (file_.attributes) attributes_.readColour(text_, positions_.size());
    positions_.push_back(p);
  }

  void readFace() {
    corners_.clear();
    while (text_.moreOnLine()) corners_.push_back(readCorner());
    polygons_.add(corners_);
  }

  /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`. Indices count from 1, or backwards from -1, the latest vertex.
  /// A face may precede its vertices, so `read` checks the largest index at the end.
  uint32_t readCorner() {
    const size_t position = text_.position();
    const int64_t index = text_.integerPrefix();
    const std::string_view rest = text_.restOfWord();
    if (file_.attributes) attributes_.addCorner(rest);
    const auto count = static_cast<int64_t>(positions_.size());
    const int64_t vertex = index < 0 ? count + index : index - 1;
    if (vertex < 0 || vertex >= int64_t{UINT32_MAX})
      text_.failAt(position, outOfRange(index, positions_.size()));
    if (vertex > largest_) {
      largest_ = vertex;
      largestAt_ = position;
    }
    return static_cast<uint32_t>(vertex);
  }

  const MeshFile& file_;
  TextScanner text_;
  ObjAttributes attributes_;
  std::vector<glm::dvec3> positions_;
  Polygons polygons_;
  std::vector<uint32_t> corners_;
  int64_t largest_ = -1;
  size_t largestAt_ = 0;
  bool freeForm_ = false;
};

}  // namespace

Mesh readObj(const MeshFile& file) {
  return ObjReader(file).read();
}

}  // namespace raymap
