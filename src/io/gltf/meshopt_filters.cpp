// KHR_meshopt_compression, appendix B: filters, undone after decoding.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/gltf/meshopt.h"

namespace raymap {

namespace {

/// Replaces each group of numbers by what `change` makes of it.
template <class Group, class Change>
bool forEach(std::span<std::byte> data, Change change) {
  for (size_t at = 0; at + sizeof(Group) <= data.size(); at += sizeof(Group)) {
    Group group;
    std::memcpy(&group, &data[at], sizeof group);
    const auto changed = change(group);
    static_assert(sizeof changed == sizeof group);
    std::memcpy(&data[at], &changed, sizeof changed);
  }
  return true;
}

template <class T>
T roundedTo(float value) {
  constexpr float kMost = std::numeric_limits<T>::max();
  return static_cast<T>(std::round(std::clamp(std::isnan(value) ? 0.0F : value, -1.0F, 1.0F) * kMost));
}

/// Unit vectors: x and y on an octahedron, and the number that stands for 1.
template <class T>
std::array<T, 4> undoOctahedral(const std::array<T, 4>& in) {
  const auto one = static_cast<float>(in[2]);
  float x = static_cast<float>(in[0]) / one, y = static_cast<float>(in[1]) / one;
  const float z = 1.0F - std::abs(x) - std::abs(y), t = std::min(z, 0.0F);
  x -= std::copysign(t, x);
  y -= std::copysign(t, y);
  const float length = std::sqrt(x * x + y * y + z * z);
  return {roundedTo<T>(x / length), roundedTo<T>(y / length), roundedTo<T>(z / length), in[3]};
}

/// Rotations: all components but the largest, whose index is in the lowest bits of what stands for 1.
std::array<int16_t, 4> undoQuaternion(const std::array<int16_t, 4>& in) {
  const float scale = std::sqrt(0.5F) / static_cast<float>(in[3] | 3);
  const std::array<float, 3> others{in[0] * scale, in[1] * scale, in[2] * scale};
  float square = 1.0F;
  for (const float other : others) square -= other * other;
  std::array<int16_t, 4> out{};
  const auto largest = static_cast<size_t>(in[3] & 3);
  out[largest] = roundedTo<int16_t>(std::sqrt(std::max(square, 0.0F)));
  for (size_t i = 0; i < 3; ++i) out[(largest + 1 + i) % 4] = roundedTo<int16_t>(others[i]);
  return out;
}

/// Numbers as 24 bits of a mantissa and 8 bits of an exponent.
float undoExponential(int32_t in) {
  const int32_t mantissa = static_cast<int32_t>(static_cast<uint32_t>(in) << 8) >> 8;
  return std::ldexp(static_cast<float>(mantissa), in >> 24);
}

}  // namespace

bool undoMeshoptFilter(std::string_view filter, std::span<std::byte> data, size_t stride) {
  if (filter == "NONE") return true;
  if (filter == "OCTAHEDRAL" && stride == 4)
    return forEach<std::array<int8_t, 4>>(data, undoOctahedral<int8_t>);
  if (filter == "OCTAHEDRAL" && stride == 8)
    return forEach<std::array<int16_t, 4>>(data, undoOctahedral<int16_t>);
  if (filter == "QUATERNION" && stride == 8) return forEach<std::array<int16_t, 4>>(data, undoQuaternion);
  if (filter == "EXPONENTIAL") return forEach<int32_t>(data, undoExponential);
  return false;  // COLOR too: nothing that is read is a colour.
}

}  // namespace raymap
