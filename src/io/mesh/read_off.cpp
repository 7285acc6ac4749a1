// Object File Format of Geomview, text and binary. Letters before OFF say what a vertex has besides x, y and
// z: ST texture coordinates, C a colour, N a normal, 4 a number by which the coordinates are divided.

#include <raymap/error.h>

#include <cctype>
#include <exception>
#include <optional>

#include "base/text.h"
#include "io/mesh/off_binary.h"
#include "io/mesh/text_scanner.h"

namespace raymap {

namespace {

/// Removes a prefix. Returns whether it was there.
bool take(std::string_view& word, std::string_view prefix) {
  if (!word.starts_with(prefix)) return false;
  word.remove_prefix(prefix.size());
  return true;
}

/// Reads the header's words, which are optional.
OffHeader readHeader(const MeshFile& file) {
  TextScanner text(file);
  if (!text.more()) file.fail("the file is empty");
  OffHeader header;
  header.bytes = text.position();
  const std::string_view name = text.word();
  std::string upper(name);
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (!upper.ends_with("OFF")) return header;
  std::string_view word = upper;
  header.hasTexture = take(word, "ST");
  header.hasColour = take(word, "C");
  header.hasNormal = !name.ends_with("nOFF") && take(word, "N");
  header.isHomogeneous = take(word, "4");
  if (word != "OFF")
    throw Error(ErrorCode::Unsupported,
                file.path.string() + ": " + shortText(name) + " with other than three dimensions");
  header.bytes = text.position();
  if (text.moreOnLine() && text.word() == "BINARY") {
    text.nextLine();
    header.isBinary = true;
    header.bytes = text.position();
  }
  return header;
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

/// How the rows of a text file lie in its lines.
enum class OffRows {
  Lines,  ///< Each row ends a line. What follows a position or a face there is not read.
  Values  ///< Line breaks mean nothing.
};

class OffTextReader {
 public:
  /// `vertexRows` and `faceRows` say how the rows of each lie.
  OffTextReader(const MeshFile& file, const OffHeader& header, OffRows vertexRows, OffRows faceRows,
                int colours = 4)
      : file_(file),
        header_(header),
        vertexRows_(vertexRows),
        faceRows_(faceRows),
        colours_(colours),
        text_(file, header.bytes) {}

  OffMesh read() {
    const uint64_t vertices = readCount(file_, text_, "vertex");
    const uint64_t faces = readCount(file_, text_, "face");
    skipEdges();
    for (uint64_t v = 0; v < vertices; ++v) readVertex();
    for (uint64_t f = 0; f < faces; ++f) readFace(f, vertices);
    if (vertexRows_ == OffRows::Values && !isAtEnd()) text_.fail("more values than the counts ask for");
    return std::move(mesh_);
  }

  bool isAtEnd() { return !text_.more(); }

 private:
  void readVertex() {
    glm::dvec3 p;
    for (int c = 0; c < 3; ++c) p[c] = text_.real();
    if (header_.isHomogeneous) p /= text_.real();
    mesh_.positions.push_back(p);
    endRow(vertexRows_, header_.numbers(colours_));
  }

  void readFace(uint64_t face, uint64_t vertices) {
    const int64_t count = text_.integer();
    if (count < 0) text_.fail("face " + std::to_string(face) + " has " + std::to_string(count) + " corners");
    corners_.clear();
    for (int64_t c = 0; c < count; ++c) corners_.push_back(readCorner(text_, face, vertices));
    mesh_.polygons.add(corners_);
    if (faceRows_ == OffRows::Lines && text_.moreOnLine()) mesh_.hasFaceColours = true;
    endRow(faceRows_, 0);
  }

  /// Skips the number of edges, which some files lack. It may have a line of its own.
  void skipEdges() {
    if (vertexRows_ == OffRows::Values) {
      text_.integer();
      return;
    }
    const bool isOnLine = text_.moreOnLine();
    text_.nextLine();
    TextScanner ahead = text_;
    if (isOnLine || !ahead.more()) return;
    ahead.word();
    if (!ahead.moreOnLine()) text_.integer();
  }

  /// Skips numbers that are not read, or the rest of the line.
  void endRow(OffRows rows, int numbers) {
    if (rows == OffRows::Lines) return text_.nextLine();
    for (; numbers > 0; --numbers) text_.real();
  }

  const MeshFile& file_;
  const OffHeader& header_;
  OffRows vertexRows_, faceRows_;
  int colours_;  // Numbers of a colour.
  TextScanner text_;
  OffMesh mesh_;
  std::vector<uint32_t> corners_;
};

/// Reads the values of a text file one after the other, or those of its vertices, with each face on a line.
/// Returns nothing if they do not end with the file.
std::optional<OffMesh> readValues(const MeshFile& file, const OffHeader& header) {
  for (const OffRows faceRows : {OffRows::Values, OffRows::Lines})
    for (const int colours : {4, 3}) {
      try {
        return OffTextReader(file, header, OffRows::Values, faceRows, colours).read();
      } catch (const Error&) {
        if (!header.hasColour) break;
      }
    }
  return {};
}

/// Reads rows that are lines. If that fails or leaves something over, line breaks may mean nothing.
OffMesh readText(const MeshFile& file, const OffHeader& header) {
  OffTextReader reader(file, header, OffRows::Lines, OffRows::Lines);
  std::optional<OffMesh> mesh;
  std::exception_ptr failure;
  try {
    mesh = reader.read();
  } catch (const Error&) {
    failure = std::current_exception();
  }
  if (failure || !reader.isAtEnd())
    if (std::optional<OffMesh> values = readValues(file, header)) return std::move(*values);
  if (failure) std::rethrow_exception(failure);
  return std::move(*mesh);
}

}  // namespace

Mesh readOff(const MeshFile& file) {
  const OffHeader header = readHeader(file);
  if (file.attributes && header.hasColour) file.attributes->lost.emplace_back("colours");
  if (file.attributes && header.hasTexture) file.attributes->lost.emplace_back("texture coordinates");
  OffMesh mesh = header.isBinary ? readBinaryOff(file, header) : readText(file, header);
  if (file.attributes && mesh.hasFaceColours) file.attributes->lost.emplace_back("colours of faces");
  return finishPolygons(file, std::move(mesh.positions), std::move(mesh.polygons));
}

}  // namespace raymap
