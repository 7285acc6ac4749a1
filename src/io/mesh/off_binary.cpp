#include "io/mesh/off_binary.h"

#include <bit>

namespace raymap {

namespace {

constexpr size_t kNumberBytes = 4;

class BinaryOffReader {
 public:
  BinaryOffReader(const MeshFile& file, const OffHeader& header)
      : file_(file), header_(header), at_(header.bytes) {}

  OffMesh read() {
    const uint64_t vertices = integer(), faces = integer();
    integer();  // The number of edges, which is unused.
    const auto others = static_cast<uint64_t>(header_.numbers(4));
    checkCount(vertices, 3 + others + (header_.isHomogeneous ? 1 : 0));
    mesh_.positions.reserve(vertices);
    for (uint64_t v = 0; v < vertices; ++v) {
      readVertex();
      skip(others);
    }
    checkCount(faces, 2);
    for (uint64_t f = 0; f < faces; ++f) readFace(f);
    if (at_ < file_.bytes.size())
      file_.warnThat(counted(file_.bytes.size() - at_, "byte") + " after the last face ignored");
    return std::move(mesh_);
  }

 private:
  void readVertex() {
    glm::dvec3 p;
    for (int c = 0; c < 3; ++c) p[c] = real();
    if (header_.isHomogeneous) p /= real();
    mesh_.positions.push_back(p);
  }

  /// Reads the corners of a face, and skips its colour.
  void readFace(uint64_t face) {
    const uint64_t count = integer();
    checkCount(count, 1);
    corners_.clear();
    for (uint64_t c = 0; c < count; ++c) {
      corners_.push_back(integer());
      if (corners_.back() >= mesh_.positions.size())
        file_.fail("face " + std::to_string(face) + ": " +
                   outOfRange(corners_.back(), mesh_.positions.size()));
    }
    mesh_.polygons.add(corners_);
    const uint32_t colours = integer();
    mesh_.hasFaceColours = mesh_.hasFaceColours || colours > 0;
    skip(colours);
  }

  /// Throws if fewer numbers follow than `count` things need.
  void checkCount(uint64_t count, uint64_t numbers) const {
    if (count > (file_.bytes.size() - at_) / kNumberBytes / numbers) failShort();
  }

  [[noreturn]] void failShort() const {
    file_.fail("its counts do not fit its size: it is cut short, or no binary OFF");
  }

  uint32_t integer() {
    if (file_.bytes.size() - at_ < kNumberBytes) failShort();
    uint32_t value = 0;
    for (size_t i = 0; i < kNumberBytes; ++i)
      value = value << 8 | static_cast<uint32_t>(file_.bytes[at_ + i]);
    at_ += kNumberBytes;
    return value;
  }
  double real() { return std::bit_cast<float>(integer()); }
  void skip(uint64_t numbers) {
    checkCount(numbers, 1);
    at_ += numbers * kNumberBytes;
  }

  const MeshFile& file_;
  const OffHeader& header_;
  size_t at_;
  OffMesh mesh_;
  std::vector<uint32_t> corners_;
};

}  // namespace

OffMesh readBinaryOff(const MeshFile& file, const OffHeader& header) {
  return BinaryOffReader(file, header).read();
}

}  // namespace raymap
