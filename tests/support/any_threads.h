#pragma once

// Checks that a field is the same, bit for bit, for any number of threads.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <cstring>
#include <initializer_list>

namespace raymap {

template <class T>
bool sameBits(const Buffer<T>& a, const Buffer<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Compares every array of the field made on one thread with those made on each number of `threads`, by one
/// generator.
inline void expectSameForAnyThreads(const Mesh& mesh, const Grid& grid, FieldOptions options,
                                    std::initializer_list<int> threads) {
  options.triangle = options.distance != DistanceMode::Raster;
  options.winding = options.confidence = options.sign != SignMode::None;
  Generator generator;
  Field one, other;
  MachineOptions machine{.device = "cpu", .threads = 1};
  generator.generate(mesh, grid, options, one, machine);
  for (const int count : threads) {
    SCOPED_TRACE(testing::Message() << "distance " << int(options.distance) << ", sign " << int(options.sign)
                                    << ", " << count << " threads");
    machine.threads = count;
    generator.generate(mesh, grid, options, other, machine);
    EXPECT_TRUE(sameBits(one.distance, other.distance));
    EXPECT_TRUE(sameBits(one.triangle, other.triangle));
    EXPECT_TRUE(sameBits(one.winding, other.winding));
    EXPECT_TRUE(sameBits(one.confidence, other.confidence));
  }
}

}  // namespace raymap
