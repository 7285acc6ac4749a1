// Streams of meshopt, as meshoptimizer 1.0 encodes them (the package meshoptimizer of npm).

#include "io/gltf/meshopt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "io/gltf/gltf_uri.h"

namespace raymap {
namespace {

using Stream = std::vector<std::byte>;

Stream streamOf(const std::string& base64) {
  const Buffer<std::byte> bytes = loadUri({}, "data:;base64," + base64);
  return {bytes.begin(), bytes.end()};
}

template <class T>
Stream streamOf(const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {bytes.begin(), bytes.end()};
}

/// 40 elements of 16 bytes: noise; two numbers of 16 bits that step; a float that steps; mostly zeros.
Stream streamedElements() {
  Stream out(640);
  uint32_t state = 1;
  for (uint32_t i = 0; i < 40; ++i) {
    std::byte* at = &out[16 * static_cast<size_t>(i)];
    for (int k = 0; k < 4; ++k) at[k] = static_cast<std::byte>((state = state * 1664525 + 1013904223) >> 24);
    const std::array<uint16_t, 2> steps{static_cast<uint16_t>(i * 300), static_cast<uint16_t>(65535 - i * 3)};
    const float number = 1.0F + static_cast<float>(i) / 8.0F;
    const uint32_t rare = i % 16 == 5 ? 77 : 0;
    std::memcpy(at + 4, &steps, 4);
    std::memcpy(at + 8, &number, 4);
    std::memcpy(at + 12, &rare, 4);
  }
  return out;
}

const std::string kFirstVersion =
    "oB8AXw/ZirYrRCRE/IsvuN7aB2ingXBttq92XFvVqtLF0v//AADl6vrsxYTG8R8AAIpm+nHJFnYGCWCTuF+680FUXN4Hk1Ci7Wed"
    "bIXMJv//AACQakD8UR18BB8AivQH5Mj5sur6jq5T//dlReSOVrnSEeIu4ZZqC0ygwf//AAA1/szcfgiCGx8AS0Ph5W0gZ75UrWVP"
    "BDb21royhJySyyr0S0PMoU7AYv//AADaljEbCcr0qR8AWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWP//AABYWFhYWFhY"
    "WBUqrqrqBASuququBAQEq6oAAAQqBVVVVVVVVVVVVVVVVVVVVVVVVVUAAAAAAAAALwAgICAgICAgIBAQEBAQEBAQEBAQEBAQEBAI"
    "CAgICAgIiIiIiAAAAAABAACAABUAPAAAmpkAPAAAmpkAPAAAmpkAAAAAAAAAAAAAAAAAAAAAAAAAPF6BtAAA//8AAIA/AAAAAA==";
const std::string kSecondVersion =
    "of+XaKkAXw/ZirYrRCRE/IsvuN7aB2ingXBttq92XFvVqtLF0uXq+uzFhMbxAACKZvpxyRZ2Bglgk7hfuvNBVFzeB5NQou1nnWyF"
    "zCaQakD8UR18BACK9AfkyPmy6vqOrlP/92VF5I5WudIR4i7hlmoLTKDBNf7M3H4IghsAS0Ph5W0gZ75UrWVPBDb21royhJySyyr0"
    "S0PMoU7AYtqWMRsJyvSpAFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWBUqqqqqqqqqqqqqAAAqBVVVVVVV"
    "VVVVVVVVVVVVVVVVVVUAAAAAAQABHxoExPTE8mLiYhz88mLiYvExcTEePt3dAAAPAwcDAGAAmplgAJqZYACamQAAAAA8XoG0AAD/"
    "/wAAgD8AAAAAAAFiAA==";
const std::string kTriangleStream =
    "4f4eEA4QDhAOzh4WDhUOFA7OHhQOFA4UDs4eFA4UDhQO//9f/g8K/QAv/9gEyQTIBAT/9gqQtggAdodWZ3iphmWJaJgBaQAA";
const std::string kSequenceStream = "0QAUDhQOFMGLEQ4UDhQABAASAAAAAA==";

/// Returns a grid of 4 x 4 squares as the encoder orders its corners, then four triangles apart.
std::vector<uint32_t> streamedTriangles() {
  std::vector<uint32_t> out;
  for (uint32_t y = 0; y < 4; ++y)
    for (uint32_t x = 0; x < 4; ++x) {
      const uint32_t a = 5 * y + x;
      for (const uint32_t corner : {a, a + 1, a + 5, a + 5, a + 1, a + 6}) out.push_back(corner);
    }
  for (const uint32_t corner : {24, 0, 12, 300, 7, 299, 0, 24, 301, 5, 1000, 70000}) out.push_back(corner);
  return out;
}

/// Returns each triangle with its smallest corner first: the encoder turns them.
std::vector<uint32_t> turned(std::vector<uint32_t> corners) {
  for (size_t t = 0; t < corners.size(); t += 3)
    std::rotate(&corners[t], std::min_element(&corners[t], &corners[t] + 3), &corners[t] + 3);
  return corners;
}

using StreamDecoder = bool (*)(std::span<const std::byte> in, std::span<std::byte> out, size_t stride);

/// Expects that every shorter stream is refused, one with a byte more, and one with another first byte.
void expectRefused(StreamDecoder decode, const Stream& whole, size_t size, size_t stride) {
  Stream out(size);
  ASSERT_TRUE(decode(whole, out, stride));
  for (size_t length = 0; length < whole.size(); ++length)
    EXPECT_FALSE(decode(std::span(whole).first(length), out, stride)) << length;
  Stream more = whole;
  more.insert(more.begin() + 1, std::byte{0});
  EXPECT_FALSE(decode(more, out, stride));
  more = whole;
  more[0] = std::byte{0x42};
  EXPECT_FALSE(decode(more, out, stride));
}

TEST(Meshopt, DecodesAttributesOfBothVersions) {
  for (const std::string& text : {kFirstVersion, kSecondVersion}) {
    Stream out(640);
    ASSERT_TRUE(decodeMeshoptAttributes(streamOf(text), out, 16));
    EXPECT_EQ(out, streamedElements());
    expectRefused(decodeMeshoptAttributes, streamOf(text), 640, 16);
  }
}

TEST(Meshopt, RefusesUnknownModesOfChannels) {
  Stream stream = streamOf(kSecondVersion), out(640);
  for (const int mode : {3, 15, 0x10, 0x21}) {
    stream.back() = static_cast<std::byte>(mode);
    EXPECT_FALSE(decodeMeshoptAttributes(stream, out, 16)) << mode;
  }
  stream.back() = std::byte{1};  // Another one that is known.
  EXPECT_TRUE(decodeMeshoptAttributes(stream, out, 16));
}

TEST(Meshopt, DecodesTheExampleOfTheStandard) {
  // The group of KHR_meshopt_compression as the first byte of 16 elements, after a header of one group of 4
  // bits; the other three bytes do not change.
  const std::vector<uint8_t> group{0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5};
  std::vector<uint8_t> stream{0xa0, 2};
  stream.insert(stream.end(), group.begin(), group.end());
  stream.insert(stream.end(), 3 + 32, 0);
  const std::vector<int> steps{-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0};
  Stream out(64);
  ASSERT_TRUE(decodeMeshoptAttributes(streamOf(stream), out, 4));
  uint8_t expected = 0;
  for (size_t i = 0; i < 16; ++i) {
    expected = static_cast<uint8_t>(expected + steps[i]);
    EXPECT_EQ(static_cast<uint8_t>(out[4 * i]), expected) << i;
    EXPECT_EQ(out[4 * i + 1], std::byte{0});
  }
}

TEST(Meshopt, DecodesBlocksOfAtMost256Elements) {
  // Each block of a stream of zeros has a byte for each four groups of each byte.
  for (const auto& [count, headers] : std::vector<std::pair<size_t, size_t>>{{256, 4}, {257, 5}, {600, 10}}) {
    Stream stream(1 + 4 * headers + 32), out(4 * count, std::byte{1});
    stream[0] = std::byte{0xa0};
    stream.back() = std::byte{9};
    ASSERT_TRUE(decodeMeshoptAttributes(stream, out, 4)) << count;
    EXPECT_EQ(out[4 * count - 1], std::byte{9});
    EXPECT_EQ(out[4 * count - 2], std::byte{0});
    stream.insert(stream.begin() + 1, std::byte{0});
    EXPECT_FALSE(decodeMeshoptAttributes(stream, out, 4)) << count;
  }
}

TEST(Meshopt, DecodesTriangles) {
  const std::vector<uint32_t> expected = streamedTriangles();
  std::vector<uint32_t> out(expected.size());
  ASSERT_TRUE(decodeMeshoptTriangles(streamOf(kTriangleStream), std::as_writable_bytes(std::span(out)), 4));
  EXPECT_EQ(turned(out), turned(expected));
  std::vector<uint16_t> narrow(expected.size());
  ASSERT_TRUE(
      decodeMeshoptTriangles(streamOf(kTriangleStream), std::as_writable_bytes(std::span(narrow)), 2));
  for (size_t i = 0; i < out.size(); ++i) EXPECT_EQ(narrow[i], static_cast<uint16_t>(out[i])) << i;
  expectRefused(decodeMeshoptTriangles, streamOf(kTriangleStream), 4 * expected.size(), 4);
}

TEST(Meshopt, DecodesSequences) {
  const std::vector<uint32_t> expected{0, 5, 1, 6, 2, 7, 70000, 3, 8, 4, 9, 9, 10, 10, 5};
  std::vector<uint32_t> out(expected.size());
  ASSERT_TRUE(decodeMeshoptIndices(streamOf(kSequenceStream), std::as_writable_bytes(std::span(out)), 4));
  EXPECT_EQ(out, expected);
  std::vector<uint16_t> narrow(expected.size());
  ASSERT_TRUE(decodeMeshoptIndices(streamOf(kSequenceStream), std::as_writable_bytes(std::span(narrow)), 2));
  EXPECT_EQ(narrow[6], 70000 - 65536);
  EXPECT_EQ(narrow[7], 3);
  expectRefused(decodeMeshoptIndices, streamOf(kSequenceStream), 4 * expected.size(), 4);
}

TEST(Meshopt, RefusesNumbersOfMoreThanFiveBytes) {
  std::vector<uint8_t> stream{0xd1, 0x84, 0x80, 0x80, 0x80, 0x00, 0, 0, 0, 0};
  Stream out(4);
  ASSERT_TRUE(decodeMeshoptIndices(streamOf(stream), out, 4));
  EXPECT_EQ(out[0], std::byte{1});
  stream[5] = 0x80;
  EXPECT_FALSE(decodeMeshoptIndices(streamOf(stream), out, 4));
}

template <class T>
std::vector<T> unfiltered(const char* filter, std::vector<T> data, size_t stride) {
  EXPECT_TRUE(undoMeshoptFilter(filter, std::as_writable_bytes(std::span(data)), stride));
  return data;
}

TEST(Meshopt, UndoesFilters) {
  EXPECT_EQ(unfiltered<uint32_t>("NONE", {7, 8}, 4), (std::vector<uint32_t>{7, 8}));
  // A mantissa of 3 times 2 to the power of -2, and -5 times 2 to the power of 1.
  const std::vector<int32_t> numbers =
      unfiltered<int32_t>("EXPONENTIAL", {(-2 << 24) | 3, (1 << 24) | 0xfffffb}, 8);
  EXPECT_EQ(std::bit_cast<float>(numbers[0]), 0.75F);
  EXPECT_EQ(std::bit_cast<float>(numbers[1]), -10.0F);
  // The largest component, 0.6 of 0.8 / sqrt(2) each, comes at the index in the lowest bits.
  const int16_t one = 2047 & ~3, part = static_cast<int16_t>(std::lround(0.6 * std::sqrt(2.0) * 2047));
  for (int16_t largest = 0; largest < 4; ++largest) {
    const std::vector<int16_t> turn =
        unfiltered<int16_t>("QUATERNION", {part, 0, 0, static_cast<int16_t>(one | largest)}, 8);
    EXPECT_NEAR(turn[static_cast<size_t>(largest)], 0.8 * 32767, 10.0);
    EXPECT_NEAR(turn[static_cast<size_t>((largest + 1) % 4)], 0.6 * 32767, 10.0);
    EXPECT_EQ(turn[static_cast<size_t>((largest + 2) % 4)], 0);
    EXPECT_EQ(turn[static_cast<size_t>((largest + 3) % 4)], 0);
  }
  EXPECT_EQ(unfiltered<int8_t>("OCTAHEDRAL", {127, 0, 127, 5}, 4), (std::vector<int8_t>{127, 0, 0, 5}));
  EXPECT_EQ(unfiltered<int8_t>("OCTAHEDRAL", {0, -31, 31, 5}, 4), (std::vector<int8_t>{0, -127, 0, 5}));
  // A corner of the square is the lowest point of the octahedron.
  EXPECT_EQ(unfiltered<int16_t>("OCTAHEDRAL", {511, 511, 511, -9}, 8),
            (std::vector<int16_t>{0, 0, -32767, -9}));
}

TEST(Meshopt, RefusesFiltersOfOtherSizes) {
  Stream data(48);
  for (const auto& [filter, stride] : std::vector<std::pair<const char*, size_t>>{
           {"OCTAHEDRAL", 12}, {"QUATERNION", 4}, {"QUATERNION", 16}, {"COLOR", 4}, {"SQUARE", 4}})
    EXPECT_FALSE(undoMeshoptFilter(filter, data, stride)) << filter << stride;
}

}  // namespace
}  // namespace raymap
