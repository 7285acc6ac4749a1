// KHR_meshopt_compression, appendix A, modes 1 and 2: triangles by recent edges and vertices, and sequences
// of indices.

#include <array>
#include <cstring>

#include "io/gltf/meshopt.h"
#include "io/gltf/meshopt_bytes.h"

namespace raymap {

namespace {

/// Writes indices of 2 or 4 bytes one after the other.
class IndexWriter {
 public:
  IndexWriter(std::span<std::byte> out, size_t stride) : out_(out), stride_(stride) {}
  bool isFull() const { return out_.empty(); }
  void put(uint32_t index) {
    std::memcpy(out_.data(), &index, stride_);  // The lower bytes come first.
    out_ = out_.subspan(stride_);
  }

 private:
  std::span<std::byte> out_;
  size_t stride_;
};

/// The 16 latest of some values. Those before the first are as large as possible: no mesh has such vertices.
template <class T>
class Recent {
 public:
  explicit Recent(T none) { values_.fill(none); }
  void push(T value) { values_[next_++ % 16] = value; }
  /// Returns the value that was pushed `back` values before the latest.
  T get(uint32_t back) const { return values_[(next_ - 1 - back) % 16]; }

 private:
  std::array<T, 16> values_;
  uint32_t next_ = 0;
};

struct Edge {
  uint32_t a, b;
};

class TriangleDecoder {
 public:
  TriangleDecoder(std::span<const std::byte> codes, std::span<const std::byte> data,
                  std::span<const std::byte> table)
      : codes_(codes), data_(data), table_(table) {}

  bool decode(IndexWriter out) {
    for (const std::byte code : codes_) {
      const uint32_t high = static_cast<uint32_t>(code) >> 4, low = static_cast<uint32_t>(code) & 15;
      if (high < 15)
        readAtEdge(high, low);
      else
        readAlone(low);
      for (const uint32_t corner : triangle_) out.put(corner);
    }
    return !data_.failed() && data_.isAtEnd();
  }

 private:
  /// Reads a triangle at a recent edge.
  void readAtEdge(uint32_t edge, uint32_t vertex) {
    const auto [a, b] = edges_.get(edge);
    uint32_t c = 0;
    if (vertex == 0)
      c = next_++;
    else if (vertex < 13)
      c = vertices_.get(vertex);
    else
      c = vertex == 13 ? --last_ : vertex == 14 ? ++last_ : coded();
    triangle_ = {a, b, c};
    edges_.push({c, b});
    edges_.push({a, c});
    if (vertex == 0 || vertex >= 13) vertices_.push(c);
  }

  void readAlone(uint32_t kind) {
    const bool isCoded = kind >= 14;
    const uint32_t both = isCoded ? data_.byte() : static_cast<uint32_t>(table_[kind]);
    if (isCoded && both == 0) next_ = 0;
    const uint32_t a = kind == 15 ? coded() : next_++;
    const uint32_t b = corner(both >> 4), c = corner(both & 15);
    triangle_ = {a, b, c};
    edges_.push({b, a});
    edges_.push({c, b});
    edges_.push({a, c});
    vertices_.push(a);
    if (both >> 4 == 0 || both >> 4 == 15) vertices_.push(b);
    if ((both & 15) == 0 || (both & 15) == 15) vertices_.push(c);
  }

  uint32_t corner(uint32_t kind) {
    if (kind == 0) return next_++;
    return kind == 15 ? coded() : vertices_.get(kind - 1);
  }

  /// Reads an index as its difference to the last one that was read so.
  uint32_t coded() { return last_ += unzigzag(data_.number()); }

  std::span<const std::byte> codes_;
  MeshoptBytes data_;
  std::span<const std::byte> table_;
  Recent<Edge> edges_{Edge{UINT32_MAX, UINT32_MAX}};
  Recent<uint32_t> vertices_{UINT32_MAX};
  uint32_t next_ = 0, last_ = 0;
  std::array<uint32_t, 3> triangle_{};
};

}  // namespace

bool decodeMeshoptTriangles(std::span<const std::byte> in, std::span<std::byte> out, size_t stride) {
  constexpr size_t kTable = 16;
  const size_t triangles = out.size() / stride / 3;
  if (in.size() < 1 + triangles + kTable || in[0] != std::byte{0xe1}) return false;
  return TriangleDecoder(in.subspan(1, triangles),
                         in.subspan(1 + triangles, in.size() - 1 - triangles - kTable), in.last(kTable))
      .decode({out, stride});
}

bool decodeMeshoptIndices(std::span<const std::byte> in, std::span<std::byte> out, size_t stride) {
  constexpr size_t kTail = 4;
  if (in.size() < 1 + kTail || in[0] != std::byte{0xd1}) return false;
  MeshoptBytes data(in.subspan(1, in.size() - 1 - kTail));
  std::array<uint32_t, 2> last{};
  for (IndexWriter writer(out, stride); !writer.isFull() && !data.failed();) {
    const uint32_t code = data.number();
    writer.put(last[code & 1] += unzigzag(code >> 1));
  }
  return !data.failed() && data.isAtEnd();
}

}  // namespace raymap
