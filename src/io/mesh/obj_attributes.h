#pragma once

#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "io/mesh/mesh_file.h"
#include "io/mesh/text_scanner.h"
#include "mesh/attribute_words.h"

namespace raymap {

/// Collects the attributes of an OBJ: names of objects and groups, materials, texture coordinates, and the
/// colours behind the coordinates of vertices. What is malformed is left out, with a warning.
class ObjAttributes {
 public:
  explicit ObjAttributes(const MeshFile& file) : file_(file) {}

  /// Reads a line that begins with a keyword.
  void read(std::string_view keyword, TextScanner& text);
  /// Reads a colour behind the coordinates of a vertex, if there is one.
  void readColour(TextScanner& text, size_t vertex);
  /// Adds a corner of a face by what follows the number of its vertex: "", "/vt", "/vt/vn" or "//vn".
  void addCorner(std::string_view rest);
  /// Stores what the file has for the triangles of its polygons, which tracked their corners.
  void finish(const Polygons& polygons);

 private:
  /// Part and material of the faces from a corner on.
  struct Run {
    size_t corner;
    uint32_t part, material;
  };

  std::vector<float> numbers(TextScanner& text);
  void startRun();
  void addLibraries(std::string_view names);
  void finishUvs(const Polygons& polygons);
  void finishColours(const Polygons& polygons);

  const MeshFile& file_;
  MeshAttributes found_;
  MeshPart part_;
  std::map<std::pair<std::string, std::string>, uint32_t> parts_;
  std::map<std::string, uint32_t, std::less<>> materials_;
  std::vector<Run> runs_;
  uint32_t material_ = kNoAttribute;
  bool isNewRun_ = false;
  std::vector<uint32_t> uvOfCorner_, colourOfVertex_;
  size_t malformed_ = 0;  // Texture coordinates and corners.
};

}  // namespace raymap
