#pragma once

// Krayer & Müller 2019, §3.5: the lattice lines that a triangle crosses, and where. GPU twin:
// vulkan/stages/crossings_lines.glsl.
//
// Precision: exact, on integers.
// Ties: all samples are taken as displaced by the same (e, e^2, e^3), e > 0 infinitely small: simulation of
// simplicity (Edelsbrunner & Mücke 1990).

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "predicates/int128.h"

namespace raymap {

/// Axes across a lattice line; u is the lower one.
struct LineAxes {
  int u, v;
  explicit constexpr LineAxes(int axis) : u(axis == 0 ? 1 : 0), v(axis == 2 ? 1 : 2) {}
};

/// Vertex in units of 2^-bits cells.
using FixedVertex = glm::i64vec3;

template <class Wide>
Wide floorDivide(Wide numerator, Wide positiveDenominator) {
  const Wide quotient = numerator / positiveDenominator;
  return quotient - (numerator % positiveDenominator < 0);
}

/// Computes orient2d of a directed edge and the displaced lattice line.
template <class Wide>
class EdgeFunction {
 public:
  EdgeFunction(const FixedVertex& from, const FixedVertex& to, LineAxes axes, int bits)
      : du_(to[axes.u] - from[axes.u]),
        dv_(to[axes.v] - from[axes.v]),
        u_(from[axes.u]),
        v_(from[axes.v]),
        bits_(bits),
        // The displacement adds du * e_v - dv * e_u, and e_u is infinitely larger than e_v.
        tie_(dv_ < 0 || (dv_ == 0 && du_ > 0) ? 1 : 0) {}

  /// Returns a positive value for lines to the left of the edge. The tie rule is included.
  Wide at(int64_t u, int64_t v) const {
    return Wide(du_) * ((v << bits_) - v_) - Wide(dv_) * ((u << bits_) - u_) + tie_;
  }
  Wide stepU() const { return -Wide(dv_) * (Wide(1) << bits_); }

  /// Shrinks [begin, end) of row v to lines that may lie to the left; never drops one that does.
  void narrow(int64_t v, int64_t& begin, int64_t& end) const {
    if (dv_ == 0) return;
    const double crossing =
        std::ldexp(double(u_) + double(du_) * double((v << bits_) - v_) / double(dv_), -bits_);
    if (dv_ > 0)
      end = static_cast<int64_t>(std::clamp(crossing + 2.0, double(begin), double(end)));
    else
      begin = static_cast<int64_t>(std::clamp(crossing - 1.0, double(begin), double(end)));
  }

 private:
  int64_t du_, dv_, u_, v_;
  int bits_;
  int tie_;
};

/// Plane of a triangle, its normal towards plus `axis`. Finds the lattice edge at which a line crosses it.
template <class Wide>
class DepthFunction {
 public:
  DepthFunction(const std::array<FixedVertex, 3>& p, int axis, LineAxes axes, int bits)
      : origin_(p[0]), axis_(axis), axes_(axes), bits_(bits) {
    const FixedVertex a = p[1] - p[0], b = p[2] - p[0];
    normal_ = {Wide(a.y) * b.z - Wide(a.z) * b.y, Wide(a.z) * b.x - Wide(a.x) * b.z,
               Wide(a.x) * b.y - Wide(a.y) * b.x};
    if (normal_[axis] < 0)
      for (Wide& n : normal_) n = -n;
    // The displacement adds n . (e, e^2, e^3): the first component of n that is not zero decides.
    const Wide first = normal_[0] != 0 ? normal_[0] : normal_[1] != 0 ? normal_[1] : normal_[2];
    tie_ = first > 0 ? 1 : 0;
  }

  /// Returns the last sample of line (u, v) below the plane: the largest i with n . (sample - origin) < 0.
  int64_t lastBelow(int64_t u, int64_t v) const {
    const Int128 across = Int128(normal_[axes_.u]) * ((u << bits_) - origin_[axes_.u]) +
                          Int128(normal_[axes_.v]) * ((v << bits_) - origin_[axes_.v]);
    const auto height = static_cast<int64_t>(floorDivide<Int128>(-across - tie_, normal_[axis_]));
    return (origin_[axis_] + height) >> bits_;
  }

 private:
  FixedVertex origin_;
  std::array<Wide, 3> normal_;
  int axis_;
  LineAxes axes_;
  int bits_;
  int tie_;
};

}  // namespace raymap
