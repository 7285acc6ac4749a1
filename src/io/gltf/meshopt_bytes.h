#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace raymap {

/// Reads bytes one after the other. Behind their end it reads zeros, and `failed` is true.
class MeshoptBytes {
 public:
  explicit MeshoptBytes(std::span<const std::byte> bytes) : rest_(bytes) {}

  bool failed() const { return failed_; }
  bool isAtEnd() const { return rest_.empty(); }

  uint8_t byte() {
    const std::span<const std::byte> one = take(1);
    return one.empty() ? uint8_t{0} : static_cast<uint8_t>(one[0]);
  }

  /// Returns the next `count` bytes, or none if there are fewer.
  std::span<const std::byte> take(size_t count) {
    if (count > rest_.size()) {
      failed_ = true;
      rest_ = {};
      return {};
    }
    const std::span<const std::byte> taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

  /// Reads a number of up to five bytes with seven bits each, the lowest first.
  uint32_t number() {
    uint32_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const uint8_t part = byte();
      value |= static_cast<uint32_t>(part & 127) << shift;
      if (part < 128) return value;
    }
    failed_ = true;
    return 0;
  }

 private:
  std::span<const std::byte> rest_;
  bool failed_ = false;
};

/// Returns the signed number that an unsigned one stands for: 0, -1, 1, -2, 2 and so on, with wraparound.
template <class T>
T unzigzag(T value) {
  return static_cast<T>((value & 1) != 0 ? ~(value >> 1) : value >> 1);
}

}  // namespace raymap
