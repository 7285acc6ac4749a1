#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace raymap::vulkan {

/// Counters of one dispatch. A shader that `withCounters` made adds to them when its invocations end; 64-bit
/// numbers lie as two words, the lower first.
struct WorkCounters {
  uint64_t operations;  ///< Weighted operations of all invocations.
  /// The same, but each invocation counts what the busiest one in its subgroup did. Invocations that leave
  /// early count for themselves.
  uint64_t steppedOperations;
  uint64_t bytesRead;     ///< Bytes that loads and atomics asked of buffers.
  uint64_t bytesWritten;  ///< Bytes that stores and atomics wrote to buffers.
  uint32_t longest;       ///< Most operations of one invocation.
  uint32_t mostRounds;    ///< Most blocks with loads from buffers that one invocation ran through.
};

/// Returns the code of a compute shader, changed to add its work to the counters at `address`. Needs the
/// features of `requireFeatures`.
///
/// An operation is a scalar instruction of a simple ALU: a vector of three counts three, a float division
/// and a barrier of the work group eight,
/// an integer division 16; 64 bits count twice. Loads and stores of buffers count one, those of local
/// variables nothing, as they become registers.
std::vector<uint32_t> withCounters(std::span<const uint32_t> code, uint64_t address);

}  // namespace raymap::vulkan
