// The shaders' replacements of double precision and of exact division, compiled as C++ and on the device,
// compared with this machine's arithmetic.

#include <bit>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <random>

#include "shaders/shader_arithmetic.h"
#include "shaders/shader_arithmetic_spv.h"
#include "vulkan_device.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace raymap::vulkan {
namespace {

// The functions below have the same text in GLSL and C++.
namespace glsl {
float uintBitsToFloat(uint bits) {
  return std::bit_cast<float>(bits);
}
uint floatBitsToUint(float value) {
  return std::bit_cast<uint>(value);
}
int findMSB(uint value) {
  return 31 - std::countl_zero(value);
}
using std::abs, std::clamp, std::floor, std::max, std::min, std::sqrt;
#define precise
#include "vulkan/primitives/float_pair.glsl"
#include "vulkan/primitives/rounded_division.glsl"
#include "vulkan/primitives/soft_double.glsl"
#undef Double
#undef precise
}  // namespace glsl

constexpr double kInfinity = std::numeric_limits<double>::infinity();

uint64_t bitsOf(double value) {
  return std::bit_cast<uint64_t>(value);
}
double valueOf(uint64_t bits) {
  return std::bit_cast<double>(bits);
}

/// Lets floats that are too small for normal ones become 0, as some GPUs do, while it lives.
class FlushSubnormals {
 public:
#if defined(__x86_64__)
  FlushSubnormals() {
    _mm_setcsr(before_ | kFlushToZero | kSubnormalsAreZero);
  }
  ~FlushSubnormals() {
    _mm_setcsr(before_);
  }

 private:
  static constexpr unsigned kFlushToZero = 1u << 15, kSubnormalsAreZero = 1u << 6;
  unsigned before_ = _mm_getcsr();
#endif
};

/// Random numbers: mantissas with few bits, with long runs, as from floats, and any others.
class Numbers {
 public:
  /// Exponents lie within `range` of 0.
  double next(int range) {
    uint64_t mantissa = random_();
    switch (random_() % 4) {
      case 0:
        mantissa = uint64_t{1} << (random_() % 52) | uint64_t{1} << (random_() % 52);
        break;
      case 1:
        mantissa = ~uint64_t{0} << (random_() % 52);
        break;
      case 2:
        mantissa <<= 28;  // As from a float.
        break;
      default:
        break;
    }
    const int exponent = static_cast<int>(random_() % (2 * uint64_t(range) + 1)) - range;
    return std::ldexp(1.0 + std::ldexp(double(mantissa & ((uint64_t{1} << 52) - 1)), -52), exponent) *
           (random_() % 2 ? 1.0 : -1.0);
  }
  double special() {
    static const double all[] = {0.0,  -0.0,           1.0,      -1.0,      0.5,
                                 -0.5, 1e-12,          -2.5,     3.0,       4503599627370496.0,
                                 -1e9, 0x1.fffffep127, 0x1p-149, 0x1.8p-149};
    return all[random_() % std::size(all)];
  }
  float nextFloat() { return std::bit_cast<float>(static_cast<uint32_t>(random_())); }
  uint64_t random() { return random_(); }

 private:
  std::mt19937_64 random_{1};
};

/// Returns the CPU's result in the terms of soft_double.glsl: no subnormal numbers.
uint64_t expected(double value) {
  return std::abs(value) < std::numeric_limits<double>::min() ? bitsOf(std::copysign(0.0, value))
                                                              : bitsOf(value);
}

bool isOrdinary(double value) {
  return value == 0.0 || std::abs(value) >= 2 * std::numeric_limits<double>::min();
}

std::vector<std::pair<double, double>> somePairs(size_t count) {
  Numbers numbers;
  std::vector<std::pair<double, double>> pairs;
  while (pairs.size() < count) {
    const int range = pairs.size() % 3 == 0 ? 2 : pairs.size() % 3 == 1 ? 60 : 1000;
    double a = numbers.next(range), b = numbers.next(range);
    if (pairs.size() % 16 == 0) a = numbers.special();
    if (pairs.size() % 16 < 2) b = numbers.special();
    if (pairs.size() % 16 == 2) b = std::nextafter(-a, 0.0);
    if (pairs.size() % 16 == 3) b = -a;
    pairs.emplace_back(a, b);
  }
  return pairs;
}

TEST(ShaderArithmetic, IsThatOfDoubles) {
  for (const auto& [a, b] : somePairs(500'000)) {
    SCOPED_TRACE(::testing::Message() << std::hexfloat << a << " and " << b);
    const double sum = a + b, difference = a - b, product = a * b, quotient = a / b;
    if (isOrdinary(sum)) {
      ASSERT_EQ(glsl::sum(bitsOf(a), bitsOf(b)), expected(sum));
    }
    if (isOrdinary(difference)) {
      ASSERT_EQ(glsl::difference(bitsOf(a), bitsOf(b)), expected(difference));
    }
    if (isOrdinary(product)) {
      ASSERT_EQ(glsl::product(bitsOf(a), bitsOf(b)), expected(product));
    }
    if (isOrdinary(quotient) && b != 0.0) {
      ASSERT_EQ(glsl::quotient(bitsOf(a), bitsOf(b)), expected(quotient));
    }
    ASSERT_EQ(valueOf(glsl::minimum(bitsOf(a), bitsOf(b))), std::min(a, b));
    ASSERT_EQ(valueOf(glsl::maximum(bitsOf(a), bitsOf(b))), std::max(a, b));
    ASSERT_EQ(glsl::orderOf(bitsOf(a)) < glsl::orderOf(bitsOf(b)), a < b);
    ASSERT_EQ(std::bit_cast<uint32_t>(glsl::floatOf(bitsOf(a))),
              std::bit_cast<uint32_t>(static_cast<float>(a)));
    if (std::abs(a) < 1e9) {
      ASSERT_EQ(glsl::floorOf(bitsOf(a)), std::floor(a));
      ASSERT_EQ(glsl::ceilOf(bitsOf(a)), std::ceil(a));
    } else {
      ASSERT_GT(std::copysign(1.0, a) * glsl::floorOf(bitsOf(a)), 0x1p29);
    }
  }
}

TEST(ShaderArithmetic, RoundsDoublesBetweenFloatsToNearestEven) {
  Numbers numbers;
  for (int i = 0; i < 1'000'000; ++i) {
    const float low = numbers.nextFloat();
    if (!std::isfinite(low)) continue;
    const float high = std::nextafter(low, 2 * low);
    const double middle = std::isfinite(high) ? 0.5 * (double(low) + double(high)) : 1.5 * double(low);
    for (const double value :
         {double(low), middle, std::nextafter(middle, kInfinity), std::nextafter(middle, 0.0)}) {
      ASSERT_EQ(std::bit_cast<uint32_t>(glsl::floatOf(bitsOf(value))),
                std::bit_cast<uint32_t>(static_cast<float>(value)))
          << std::hexfloat << value;
    }
    ASSERT_EQ(glsl::doubleOf(low), bitsOf(double(low)));
    const int integer = static_cast<int>(numbers.random());
    ASSERT_EQ(glsl::doubleOf(integer >> (i % 32)), bitsOf(double(integer >> (i % 32))));
  }
}

TEST(ShaderArithmetic, OverflowsLikeDoubles) {
  const uint64_t most = bitsOf(std::numeric_limits<double>::max());
  EXPECT_EQ(valueOf(glsl::sum(most, most)), kInfinity);
  EXPECT_EQ(valueOf(glsl::product(most, glsl::negative(most))), -kInfinity);
  EXPECT_EQ(valueOf(glsl::product(bitsOf(1e-200), bitsOf(-1e-200))), 0.0);
  EXPECT_EQ(glsl::floatOf(bitsOf(1e39)), std::numeric_limits<float>::infinity());
  EXPECT_EQ(glsl::floatOf(bitsOf(-0x1.ffffffp127)), -std::numeric_limits<float>::infinity());
}

TEST(ShaderArithmetic, MultipliesByPowersOfTwo) {
  Numbers numbers;
  for (int i = 0; i < 10'000; ++i) {
    const double value = numbers.next(100);
    const int exponent = i % 81 - 40;
    ASSERT_EQ(glsl::timesPowerOfTwo(bitsOf(value), exponent), bitsOf(std::ldexp(value, exponent)));
  }
  EXPECT_EQ(glsl::timesPowerOfTwo(bitsOf(0.0), 3), bitsOf(0.0));
  EXPECT_EQ(valueOf(glsl::kHalf), 0.5);
}

TEST(ShaderArithmetic, DividesDoublesWhateverTheDevicesDivisionRounds) {
  for (const auto& [a, b] : somePairs(300'000)) {
    if (b == 0.0 || !isOrdinary(a / b)) continue;
    const float inverse = glsl::inverseMantissa(bitsOf(b));
    for (const int steps : {-4, -1, 1, 4}) {
      const float rough = inverse * (1.0f + static_cast<float>(steps) * 0x1p-23f);
      ASSERT_EQ(glsl::quotientBy(bitsOf(a), bitsOf(b), rough), expected(a / b))
          << std::hexfloat << a << " / " << b;
    }
  }
}

bool sameBits(float a, float b) {
  return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b);
}

/// Returns whether a device's quotient must have the CPU's bits. It may flush subnormal floats to 0, and GLSL
/// promises nothing for divisors beyond 2^126.
bool isPromised(float a, float b) {
  const auto isOrdinary = [](float x) { return std::isfinite(x) && std::abs(x) >= 0x1p-125f; };
  return isOrdinary(a) && isOrdinary(b) && isOrdinary(a / b) && std::abs(b) <= 0x1p126f;
}

/// Checks a quotient, for devices that flush subnormal floats to 0 only where that is promised.
void expectQuotient(float a, float b) {
  const float truth = a / b;
  ASSERT_TRUE(sameBits(glsl::divideRounded(a, b), truth)) << std::hexfloat << a << " / " << b;
  if (!isPromised(a, b)) return;
  const FlushSubnormals flush;
  ASSERT_TRUE(sameBits(glsl::divideRounded(a, b), truth)) << std::hexfloat << a << " / " << b;
}

TEST(ShaderArithmetic, DividesFloatsLikeTheCpu) {
  Numbers numbers;
  for (int i = 0; i < 2'000'000; ++i) {
    const float a = numbers.nextFloat(), b = numbers.nextFloat();
    const auto c = static_cast<float>(numbers.next(10)), d = static_cast<float>(numbers.next(10));
    if (std::isfinite(a) && std::isfinite(b) && b != 0.0f) expectQuotient(a, b);
    expectQuotient(c, d);
    expectQuotient(c * 0x1p-130f, d);
    expectQuotient(c, d * 0x1p-130f);
    if (HasFatalFailure()) return;
  }
  for (const float one : {0.0f, -0.0f, 1.0f, 3.0f, 0x1p-149f, 0x1p-126f, 0x1.fffffep127f})
    for (const float other : {1.0f, -1.0f, 3.0f, 0x1p-149f, 0x1p-126f, 0x1.fffffep127f})
      expectQuotient(one, other);
}

TEST(ShaderArithmetic, TellsOrdinaryFloats) {
  for (const float one : {1.0f, -3.0f, 0x1p-125f, -0x1p-125f, 0x1.fffffep127f, -0x1.fffffep127f})
    EXPECT_TRUE(glsl::isOrdinary(std::bit_cast<uint32_t>(one))) << std::hexfloat << one;
  for (const float one : {0.0f, -0.0f, 0x1.fffffep-126f, -0x1p-126f, 0x1p-149f, INFINITY, -INFINITY, NAN})
    EXPECT_FALSE(glsl::isOrdinary(std::bit_cast<uint32_t>(one))) << std::hexfloat << one;
}

/// Returns the quotient to which `stepTowards` leads from `rough`, like divideRounded.
float quotientFrom(float rough, float a, float b) {
  auto bits = std::bit_cast<uint32_t>(rough);
  for (int steps = 0; steps < 40; ++steps) {
    const uint32_t step = glsl::stepTowards(std::bit_cast<uint32_t>(a), std::bit_cast<uint32_t>(b), bits);
    if (step == 0) return std::bit_cast<float>(bits);
    bits += step;
  }
  return NAN;
}

TEST(ShaderArithmetic, DividesFloatsWhateverTheDevicesDivisionRounds) {
  Numbers numbers;
  for (int i = 0; i < 1'000'000; ++i) {
    auto a = static_cast<float>(numbers.next(60)), b = static_cast<float>(numbers.next(60));
    if (i % 4 == 0) b = std::ldexp(a, i % 7 - 3);  // The quotient is a power of two,
    if (i % 4 == 1)
      b = std::nextafter(std::ldexp(a, i % 7 - 3), i % 8 == 1 ? 0.0f : 2 * b);  // or next to one.
    const float truth = a / b;
    const auto bits = std::bit_cast<uint32_t>(truth);
    for (const int steps : {-14, -3, -1, 0, 1, 3, 28}) {
      const auto rough = std::bit_cast<float>(bits + static_cast<uint32_t>(steps));
      ASSERT_TRUE(sameBits(quotientFrom(rough, a, b), truth))
          << std::hexfloat << a << " / " << b << " from " << rough;
    }
  }
}

glsl::FloatPair pairOf(double value) {
  const auto high = static_cast<float>(value);
  return {high, static_cast<float>(value - high)};
}
double valueOf(const glsl::FloatPair& pair) {
  return double(pair.high) + double(pair.low);
}

/// Checks a result that may be off by `units` in the 47th bit.
void expectPair(const glsl::FloatPair& pair, double truth, double units) {
  ASSERT_NEAR(valueOf(pair), truth, units * 0x1p-47 * std::abs(truth)) << std::hexfloat << truth;
  ASSERT_EQ(pair.high + pair.low, pair.high);
}

TEST(ShaderArithmetic, OfFloatPairsKeeps46Bits) {
  Numbers numbers;
  for (int i = 0; i < 500'000; ++i) {
    const glsl::FloatPair a = pairOf(numbers.next(20)), b = pairOf(numbers.next(20));
    const double x = valueOf(a), y = valueOf(b);
    ASSERT_EQ(valueOf(glsl::exactProduct(a.high, b.high)), double(a.high) * double(b.high));
    const glsl::FloatPair exact = glsl::exactSum(a.high, b.high);
    ASSERT_EQ(exact.high, a.high + b.high);
    ASSERT_EQ(valueOf(exact), double(a.high) + double(b.high));
    expectPair(glsl::pairSum(a, b), x + y, 1.0);
    expectPair(glsl::pairProduct(a, b), x * y, 2.0);
    expectPair(glsl::pairQuotient(a, b), x / y, 2.0);
    expectPair(glsl::pairRoot(pairOf(std::abs(x))), std::sqrt(std::abs(x)), 2.0);
    // Numbers that cancel.
    const glsl::FloatPair near = pairOf(-x * (1.0 + std::ldexp(1.0, -1 - i % 40)));
    expectPair(glsl::pairSum(a, near), x + valueOf(near), 1.0);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(glsl::pairRoot(glsl::pairOf(0.0f)).high, 0.0f);
}

class VulkanShaderArithmetic : public VulkanTest {};

TEST_F(VulkanShaderArithmetic, IsThatOfTheCpu) {
  const auto pairs = somePairs(100'000);
  std::vector<uint64_t> operands;
  for (const auto& [a, b] : pairs) operands.insert(operands.end(), {bitsOf(a), bitsOf(b)});
  const DeviceBuffer from = upload(operands);
  DeviceBuffer to(device(), "results");
  to.resize<uint64_t>(kArithmeticResults * pairs.size());
  Kernel<ShaderArithmeticPush> kernel(device(), shaders::kShaderArithmetic, 64);
  run([&](Commands& commands) {
    const auto count = static_cast<uint32_t>(pairs.size());
    commands.dispatch(kernel, {.pairs = from.address(), .results = to.address(), .count = count}, count);
  });
  const std::vector<uint64_t> results = download<uint64_t>(to);
  for (size_t i = 0; i < pairs.size(); ++i) {
    const auto [a, b] = pairs[i];
    SCOPED_TRACE(::testing::Message() << std::hexfloat << a << " and " << b);
    const uint64_t* ours = results.data() + kArithmeticResults * i;
    const uint64_t x = bitsOf(a), y = bitsOf(b);
    ASSERT_EQ(ours[0], glsl::sum(x, y));
    ASSERT_EQ(ours[1], glsl::difference(x, y));
    ASSERT_EQ(ours[2], glsl::product(x, y));
    if (b != 0.0) {
      ASSERT_EQ(ours[3], glsl::quotient(x, y));
    }
    ASSERT_EQ(uint32_t(ours[4]), std::bit_cast<uint32_t>(static_cast<float>(a)));
    ASSERT_EQ(int32_t(ours[5]), glsl::floorOf(x));
    ASSERT_EQ(int32_t(ours[6]), glsl::ceilOf(x));
    const auto c = std::bit_cast<float>(uint32_t(x)), d = std::bit_cast<float>(uint32_t(y));
    if (isPromised(c, d)) {
      ASSERT_EQ(uint32_t(ours[7]), std::bit_cast<uint32_t>(c / d));
    }
  }
}

}  // namespace
}  // namespace raymap::vulkan
