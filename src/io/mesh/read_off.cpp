// Object File Format of Geomview: OFF, with colours (COFF), normals (NOFF) or texture coordinates (STOFF).

#include <algorithm>

#include <raymap/error.h>

#include "io/mesh/mesh_file.h"
#include "io/mesh/text_scanner.h"

namespace raymap {

namespace {

/// Skips the header word, which is optional.
void readKeyword(const MeshFile& file, TextScanner& text) {
  if (!text.more()) file.fail("the file is empty");
  TextScanner ahead = text;
  const std::string_view word = ahead.word();
  if (!word.ends_with("OFF")) return;
  if (word.find_first_of("4n") != word.npos)
    throw Error(ErrorCode::Unsupported,
                file.path.string() + ": " + std::string(word) + " with other than three dimensions");
  text.word();
  ahead.moreOnLine();
  if (ahead.restOfLine().starts_with("BINARY"))
    throw Error(ErrorCode::Unsupported, file.path.string() + ": binary OFF; save it as text");
}

uint64_t readCount(const MeshFile& file, TextScanner& text, std::string_view noun) {
  const int64_t count = text.integer();
  if (count < 0) text.fail("a negative count: " + std::to_string(count));
  // Every vertex and every face takes at least two characters.
  if (static_cast<uint64_t>(count) > file.bytes.size() / 2)
    text.fail("the file announces " + counted(static_cast<uint64_t>(count), noun) + ", but has only " +
              counted(file.bytes.size(), "byte"));
  return static_cast<uint64_t>(count);
}

uint32_t readCorner(TextScanner& text, uint64_t face, uint64_t vertexCount) {
  const int64_t vertex = text.integer();
  if (vertex < 0 || static_cast<uint64_t>(vertex) >= vertexCount)
    text.fail("face " + std::to_string(face) + ": " + outOfRange(vertex, vertexCount));
  return static_cast<uint32_t>(vertex);
}

}  // namespace

Mesh readOff(const MeshFile& file) {
  TextScanner text(file);
  readKeyword(file, text);
  const uint64_t vertexCount = readCount(file, text, "vertex");
  const uint64_t faceCount = readCount(file, text, "face");
  text.nextLine();  // Skips the number of edges, which is unused and missing in some files.

  // After a position or a face, the rest of the line holds colours, normals and so on.
  std::vector<glm::dvec3> positions;
  positions.reserve(vertexCount);
  for (uint64_t v = 0; v < vertexCount; ++v) {
    glm::dvec3 p;
    for (int c = 0; c < 3; ++c) p[c] = text.real();
    positions.push_back(p);
    text.nextLine();
  }

  std::vector<glm::uvec3> triangles;
  triangles.reserve(faceCount);
  std::vector<uint32_t> corners;
  uint64_t dropped = 0;
  for (uint64_t f = 0; f < faceCount; ++f) {
    const int64_t count = text.integer();
    if (count < 0) text.fail("face " + std::to_string(f) + " has " + std::to_string(count) + " corners");
    corners.clear();
    for (int64_t c = 0; c < count; ++c) corners.push_back(readCorner(text, f, vertexCount));
    if (count < 3) ++dropped;
    appendFan(corners, triangles);
    text.nextLine();
  }
  warnDropped(file, dropped);
  return finishMesh(file, std::move(positions), std::move(triangles));
}

}  // namespace raymap
