#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace raymap::vulkan {

/// Memory that an invocation read or wrote.
struct Access {
  enum class Kind : uint32_t { Read, Write, Atomic };

  /// Of a buffer: bits 0 to 47 of the address. Of shared memory: the offset, and from bit 32 on the
  /// variable's id in the shader. Bits 48 and 49 hold the kind, bit 50 is set for shared memory, those above
  /// hold the number of words.
  uint64_t what;
  uint32_t who;  ///< Group modulo 2^14 from bit 18 on, subgroup from bit 10 on, then the index in the group.
  /// Barriers before it that order this kind of memory: those of the group from bit 16 on, below them those
  /// of the subgroup and of the group.
  uint32_t phases;

  uint64_t place() const { return what & 0xFFFFFFFFFFFFU; }
  Kind kind() const { return Kind(what >> 48 & 3); }
  bool isShared() const { return (what >> 50 & 1) != 0; }
  uint64_t words() const { return what >> 51; }
  uint32_t group() const { return who >> 18; }
  uint32_t subgroup() const { return who >> 10 & 255; }
  uint32_t index() const { return who & 1023; }
  auto operator<=>(const Access&) const = default;
};
static_assert(sizeof(Access) == 16);

/// Entries of a log begin behind their number, which counts those beyond its end too.
inline constexpr size_t kAccessHeader = 64;
/// Entries that have place behind the last of them, for what is lost.
inline constexpr size_t kLostAccesses = 4096;

/// Returns the code of a compute shader, changed to log its accesses to buffers and shared memory at
/// `address`, where `capacity` entries have place.
std::vector<uint32_t> withAccessLog(std::span<const uint32_t> code, uint64_t address, uint32_t capacity);

}  // namespace raymap::vulkan
