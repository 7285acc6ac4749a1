// KHR_meshopt_compression, appendix A, mode 0: bytes of elements as differences to the element before.

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "io/gltf/meshopt.h"
#include "io/gltf/meshopt_bytes.h"

namespace raymap {

namespace {

constexpr size_t kGroup = 16, kMostElements = 256;

/// Differences of one byte of all elements of a block.
using Plane = std::array<uint8_t, kMostElements>;

/// Reads a group of 16 values of `bits` bits. A value with all bits set stands for a byte behind the group.
void readGroup(MeshoptBytes& in, int bits, uint8_t* out) {
  if (bits == 0) return;
  const std::span<const std::byte> packed = in.take(2 * static_cast<size_t>(bits));
  if (packed.empty()) return;
  const int perByte = 8 / bits, most = (1 << bits) - 1;
  for (int i = 0; i < static_cast<int>(kGroup); ++i) {
    const int at = i % perByte;
    const int shift = bits == 1 ? at : 8 - bits * (at + 1);
    const int value = (static_cast<int>(packed[static_cast<size_t>(i / perByte)]) >> shift) & most;
    out[i] = value == most && bits < 8 ? in.byte() : static_cast<uint8_t>(value);
  }
}

/// Reads groups whose numbers of bits are among `bits`, as the header before them chooses.
void readPlane(MeshoptBytes& in, const std::array<int, 4>& bits, size_t groups, Plane& plane) {
  const std::span<const std::byte> header = in.take((groups + 3) / 4);
  for (size_t g = 0; g < groups && !in.failed(); ++g) {
    const auto choice = (static_cast<size_t>(header[g / 4]) >> (2 * (g % 4))) & 3;
    readGroup(in, bits[choice], &plane[kGroup * g]);
  }
}

template <class T>
T loadFrom(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

template <class T>
void storeTo(std::byte* at, T value) {
  std::memcpy(at, &value, sizeof value);
}

class AttributeDecoder {
 public:
  AttributeDecoder(std::span<const std::byte> in, size_t stride) : stride_(stride) {
    if (in.empty() || (in[0] != std::byte{0xa0} && in[0] != std::byte{0xa1})) return;
    isSecond_ = in[0] == std::byte{0xa1};
    const size_t modes = isSecond_ ? stride / 4 : 0;
    const size_t tail = std::max(stride + modes, size_t{isSecond_ ? 24U : 32U});
    if (in.size() < 1 + tail) return;
    in_ = MeshoptBytes(in.subspan(1, in.size() - 1 - tail));
    std::ranges::copy(in.last(stride + modes).first(stride), before_.begin());
    std::ranges::copy(in.last(modes), modes_.begin());
    isOpen_ = std::all_of(modes_.begin(), modes_.end(), [](std::byte mode) {
      const int kind = static_cast<int>(mode) & 15;
      return kind == 2 || (kind < 2 && static_cast<int>(mode) < 16);
    });
  }

  bool decode(std::span<std::byte> out) {
    const size_t most = stride_ * std::min((8192 / stride_) & ~size_t{15}, kMostElements);
    for (; isOpen_ && !in_.failed() && !out.empty(); out = out.subspan(std::min(most, out.size())))
      readBlock(out.first(std::min(most, out.size())));
    return isOpen_ && !in_.failed() && in_.isAtEnd();
  }

 private:
  void readBlock(std::span<std::byte> out) {
    const size_t count = out.size() / stride_;
    std::span<const std::byte> controls;
    if (isSecond_) controls = in_.take(stride_ / 4);
    for (size_t channel = 0; channel < stride_ / 4 && !in_.failed(); ++channel) {
      std::array<Plane, 4> planes{};
      for (size_t k = 0; k < 4 && !in_.failed(); ++k) {
        const int control = isSecond_ ? (static_cast<int>(controls[channel]) >> (2 * k)) & 3 : -1;
        readDifferences(control, count, planes[k]);
      }
      add(planes, channel, out);
    }
    if (!out.empty()) std::ranges::copy(out.last(stride_), before_.begin());
  }

  void readDifferences(int control, size_t count, Plane& plane) {
    const size_t groups = (count + kGroup - 1) / kGroup;
    if (control == -1) return readPlane(in_, {0, 2, 4, 8}, groups, plane);
    if (control == 0) return readPlane(in_, {0, 1, 2, 4}, groups, plane);
    if (control == 1) return readPlane(in_, {1, 2, 4, 8}, groups, plane);
    if (control == 2) return;
    const std::span<const std::byte> plain = in_.take(count);
    for (size_t i = 0; i < plain.size(); ++i) plane[i] = static_cast<uint8_t>(plain[i]);
  }

  /// Adds the differences of four bytes of each element to those of the element before.
  void add(const std::array<Plane, 4>& planes, size_t channel, std::span<std::byte> out) const {
    const int mode = static_cast<int>(modes_[channel]);
    const std::byte* before = &before_[4 * channel];
    for (size_t i = 0; i < out.size() / stride_; ++i) {
      std::byte* const at = &out[i * stride_ + 4 * channel];
      const std::array<uint8_t, 4> step{planes[0][i], planes[1][i], planes[2][i], planes[3][i]};
      if (mode == 0) {
        for (size_t k = 0; k < 4; ++k)
          at[k] = static_cast<std::byte>(static_cast<uint8_t>(before[k]) + unzigzag(step[k]));
      } else if (mode == 1) {
        for (size_t k = 0; k < 4; k += 2) {
          const auto difference = static_cast<uint16_t>(step[k] | step[k + 1] << 8);
          storeTo(at + k, static_cast<uint16_t>(loadFrom<uint16_t>(before + k) + unzigzag(difference)));
        }
      } else {
        storeTo(at, loadFrom<uint32_t>(before) ^ std::rotr(std::bit_cast<uint32_t>(step), mode >> 4));
      }
      before = at;
    }
  }

  size_t stride_;
  MeshoptBytes in_{{}};
  bool isOpen_ = false, isSecond_ = false;
  std::array<std::byte, 256> before_{};
  std::array<std::byte, 64> modes_{};
};

}  // namespace

bool decodeMeshoptAttributes(std::span<const std::byte> in, std::span<std::byte> out, size_t stride) {
  return AttributeDecoder(in, stride).decode(out);
}

}  // namespace raymap
