#include "measure/random_numbers.h"

#include <array>
#include <bit>
#include <cmath>

namespace raymap {

namespace {

/// Spreads a seed over as many bits as a generator needs (O'Neill 2015), as NumPy's SeedSequence does.
class SeedPool {
 public:
  explicit SeedPool(uint64_t seed) {
    pool_ = {hash(uint32_t(seed)), hash(uint32_t(seed >> 32)), hash(0), hash(0)};
    for (uint32_t& from : pool_)
      for (uint32_t& to : pool_)
        if (&from != &to) {
          const uint32_t mixed = 0xca01f9ddu * to - 0x4973f715u * hash(from);
          to = mixed ^ mixed >> 16;
        }
  }

  /// Returns the first two or the next two numbers of 64 bits.
  UInt128 number() {
    UInt128 result = 0;
    for (const int at : {64, 96, 0, 32}) result |= UInt128{word()} << at;
    return result;
  }

 private:
  static uint32_t scramble(uint32_t value, uint32_t& constant, uint32_t factor) {
    value ^= constant;
    constant *= factor;
    value *= constant;
    return value ^ value >> 16;
  }
  uint32_t hash(uint32_t value) { return scramble(value, poolConstant_, 0x931e8875u); }
  uint32_t word() { return scramble(pool_[count_++ % pool_.size()], wordConstant_, 0x58f38dedu); }

  uint32_t poolConstant_ = 0x43b0d7e5u, wordConstant_ = 0x8b51f9ddu;
  std::array<uint32_t, 4> pool_;
  size_t count_ = 0;
};

}  // namespace

RandomNumbers::RandomNumbers(uint64_t seed) {
  SeedPool pool(seed);
  const UInt128 start = pool.number();
  increment_ = pool.number() << 1 | 1;
  step();
  state_ += start;
  step();
}

void RandomNumbers::step() {
  constexpr UInt128 kFactor = UInt128{0x2360ed051fc65da4} << 64 | 0x4385df649fccf645;
  state_ = state_ * kFactor + increment_;
}

uint64_t RandomNumbers::next() {
  step();
  const auto high = uint64_t(state_ >> 64), low = uint64_t(state_);
  return std::rotr(high ^ low, int(high >> 58));
}

double RandomNumbers::uniform() {
  return double(next() >> 11) * 0x1p-53;
}

std::vector<double> RandomNumbers::uniforms(size_t count) {
  std::vector<double> numbers(count);
  for (double& number : numbers) number = uniform();
  return numbers;
}

template <int N>
std::vector<glm::vec<N, double>> RandomNumbers::inBall(size_t count) {
  std::vector<glm::vec<N, double>> found;
  found.reserve(count);
  while (found.size() < count)
    // By rejection from the ball's cube. Candidates come in batches, which NumPy users' points were made of.
    for (size_t left = 2 * (count - found.size()) + 16; left > 0; --left) {
      glm::vec<N, double> point;
      for (int c = 0; c < N; ++c) point[c] = 2.0 * uniform() - 1.0;
      const double square = glm::dot(point, point);
      if (square < 1.0 && square > 0.0 && found.size() < count) found.push_back(point);
    }
  return found;
}
template std::vector<glm::dvec3> RandomNumbers::inBall<3>(size_t);

std::vector<double> RandomNumbers::normals(size_t count) {
  std::vector<double> numbers;
  numbers.reserve(count + 1);
  for (const glm::dvec2& point : inBall<2>((count + 1) / 2)) {  // Marsaglia's polar method.
    const double square = glm::dot(point, point);
    const double factor = std::sqrt(-2.0 * portableLog(square) / square);
    numbers.push_back(point.x * factor);
    numbers.push_back(point.y * factor);
  }
  numbers.resize(count);
  return numbers;
}

double portableLog(double x) {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  if (mantissa < std::sqrt(0.5)) mantissa *= 2.0, --exponent;
  // At most 0.172: the 11 terms of atanh's series leave 1e-18.
  const double s = (mantissa - 1.0) / (mantissa + 1.0);
  double series = 0.0;
  for (int k = 21; k > 0; k -= 2) series = series * (s * s) + 1.0 / k;
  return exponent * 0.6931471805599453 + 2.0 * s * series;
}

}  // namespace raymap
