// Ours, after Krayer & Müller 2019, §3.5: the field beside the faces. Several faces are measured at once,
// with every instruction set to the same bits.

#include "cpu/sign/orientation.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/sign/orientation_measure.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include "base/parallel.h"
#include "method/orientation_shared.h"

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kLanes = 16;  // At most; see `lanes`.
using Tag = hn::CappedTag<float, kLanes>;
using IntTag = hn::RebindToSigned<Tag>;
using Float = hn::Vec<Tag>;
using Int = hn::Vec<IntTag>;
using Mask = hn::Mask<Tag>;

HWY_INLINE Float all(float value) {
  return hn::Set(Tag(), value);
}

struct Vector {
  Float x, y, z;

  HWY_INLINE Vector operator+(const Vector& v) const {
    return {hn::Add(x, v.x), hn::Add(y, v.y), hn::Add(z, v.z)};
  }
  HWY_INLINE Vector operator-(const Vector& v) const {
    return {hn::Sub(x, v.x), hn::Sub(y, v.y), hn::Sub(z, v.z)};
  }
  HWY_INLINE Vector operator*(Float s) const { return {hn::Mul(x, s), hn::Mul(y, s), hn::Mul(z, s)}; }
  HWY_INLINE Vector operator/(Float s) const { return {hn::Div(x, s), hn::Div(y, s), hn::Div(z, s)}; }
  HWY_INLINE Float squaredLength() const {
    return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  }
};

HWY_INLINE Vector cross(const Vector& a, const Vector& b) {
  const auto minor = [](Float p, Float q, Float r, Float s) { return hn::Sub(hn::Mul(p, q), hn::Mul(r, s)); };
  return {minor(a.y, b.z, b.y, a.z), minor(a.z, b.x, b.z, a.x), minor(a.x, b.y, b.x, a.y)};
}

/// Interpolates the field at one point per lane, in the order of `Trilinear`.
class FieldReader {
 public:
  FieldReader(const glm::ivec3& dims, const float* samples) : samples_(samples), dims_(dims) {
    const size_t x = dims.x > 1 ? 1 : 0, y = dims.y > 1 ? size_t(dims.x) : 0,
                 z = dims.z > 1 ? size_t(dims.x) * size_t(dims.y) : 0;
    for (size_t corner = 0; corner < 8; ++corner)
      offsets_[corner] = (corner & 1 ? x : 0) + (corner & 2 ? y : 0) + (corner & 4 ? z : 0);
  }

  /// Returns the values at points. Those beyond the grid's border are moved onto it.
  HWY_INLINE Float operator()(const Vector& points) const {
    const Axis x(points.x, dims_.x), y(points.y, dims_.y), z(points.z, dims_.z);
    alignas(64) float corners[8][kLanes];
    for (size_t lane = 0; lane < hn::Lanes(Tag()); ++lane) {
      const float* const at =
          samples_ + (size_t(z.cells[lane]) * size_t(dims_.y) + size_t(y.cells[lane])) * size_t(dims_.x) +
          size_t(x.cells[lane]);
      for (size_t corner = 0; corner < 8; ++corner) corners[corner][lane] = at[offsets_[corner]];
    }
    const auto between = [](Float low, Float high, Float t) {
      return hn::Add(low, hn::Mul(t, hn::Sub(high, low)));
    };
    const auto alongX = [&](size_t corner) {
      return between(hn::Load(Tag(), corners[corner]), hn::Load(Tag(), corners[corner + 1]), x.t);
    };
    return between(between(alongX(0), alongX(2), y.t), between(alongX(4), alongX(6), y.t), z.t);
  }

 private:
  /// The cells of the points along an axis, and the points' places in them.
  struct Axis {
    HWY_INLINE Axis(Float points, int samples) {
      const Float inGrid = hn::Min(hn::Max(points, hn::Zero(Tag())), all(float(samples - 1)));
      const Int cell =
          hn::Min(hn::ConvertTo(IntTag(), inGrid), hn::Set(IntTag(), samples > 2 ? samples - 2 : 0));
      hn::Store(cell, IntTag(), cells);
      t = hn::Sub(inGrid, hn::ConvertTo(Tag(), cell));
    }
    alignas(64) int32_t cells[kLanes];
    Float t;
  };

  const float* samples_;
  glm::ivec3 dims_;
  size_t offsets_[8];  // Offsets of the samples around a point: x in bit 0, y in bit 1, z in bit 2.
};

/// Returns 1 less the distance of a number from the nearest odd one.
HWY_INLINE Float wholenessOf(Float sum) {
  const Float one = all(1.0f), half = hn::Mul(all(0.5f), hn::Sub(sum, one));  // Whole where the sum is odd.
  return hn::Sub(one, hn::Mul(all(2.0f), hn::Abs(hn::Sub(half, hn::Round(half)))));
}

struct Sides {
  Float rise, wholeness;
};

/// Measures the field in front of faces and behind them, in the mean. A large face is cut into
/// triangles, and the field is read at their centres.
HWY_INLINE Sides sidesOf(const FieldReader& field, float farSides, const Vector& a, const Vector& b,
                         const Vector& c) {
  const Float zero = hn::Zero(Tag()), one = all(1.0f);
  const Vector ab = b - a, ac = c - a, across = cross(ab, ac);
  const Float doubleArea = hn::Sqrt(across.squaredLength());
  const Mask hasArea = hn::Gt(doubleArea, zero);
  const Vector step = across / doubleArea * hn::Max(one, hn::Mul(all(farSides), hn::Sqrt(doubleArea)));
  const Float longest =
      hn::Sqrt(hn::Max(hn::Max(ab.squaredLength(), ac.squaredLength()), (c - b).squaredLength()));
  const Float clamped = hn::Max(one, hn::Min(hn::Ceil(hn::Div(longest, all(kPartLength))), all(kMostParts)));
  const Float parts = hn::IfThenElse(hasArea, clamped, one);
  Sides sum{zero, zero};
  const auto lookAt = [&](int i, int j, float shift, Mask isPart) {
    const Float u = hn::Div(all(float(i) + shift), parts), v = hn::Div(all(float(j) + shift), parts);
    const Vector p = a + ab * u + ac * v;
    const Float before = field(p + step), behind = field(p - step);
    sum.rise = hn::Add(sum.rise, hn::IfThenElseZero(isPart, hn::Sub(before, behind)));
    sum.wholeness = hn::Add(sum.wholeness, hn::IfThenElseZero(isPart, wholenessOf(hn::Add(before, behind))));
  };
  const auto mostParts = int(hn::GetLane(hn::MaxOfLanes(Tag(), parts)));
  for (int i = 0; i < mostParts; ++i)
    for (int j = 0; i + j < mostParts; ++j) {
      lookAt(i, j, 1.0f / 3.0f, hn::Lt(all(float(i + j)), parts));
      if (i + j + 1 < mostParts) lookAt(i, j, 2.0f / 3.0f, hn::Lt(all(float(i + j + 1)), parts));
    }
  const auto mean = [&](Float total) {
    return hn::IfThenElseZero(hasArea, hn::Div(total, hn::Mul(parts, parts)));
  };
  return {mean(sum.rise), mean(sum.wholeness)};
}

/// Measures the faces [begin, end) that are taken, as many at once as there are lanes.
void measureFaces(const CellMesh& mesh, const Turns& turns, const Buffer<float>& field, float farSides,
                  size_t begin, size_t end, float* rises, float* wholeness) {
  const FieldReader reader(mesh.dims, field.data());
  alignas(64) float corners[9][kLanes] = {};
  size_t faces[kLanes], count = 0;
  const auto measureThem = [&] {
    const auto corner = [&](size_t c) {
      return Vector{hn::Load(Tag(), corners[3 * c]), hn::Load(Tag(), corners[3 * c + 1]),
                    hn::Load(Tag(), corners[3 * c + 2])};
    };
    const Sides sides = sidesOf(reader, farSides, corner(0), corner(1), corner(2));
    alignas(64) float results[kLanes] = {};
    hn::Store(sides.rise, Tag(), results);
    for (size_t lane = 0; lane < count; ++lane) rises[faces[lane]] = results[lane];
    hn::Store(sides.wholeness, Tag(), results);
    if (wholeness)
      for (size_t lane = 0; lane < count; ++lane) wholeness[faces[lane]] = results[lane];
    count = 0;
  };
  for (size_t f = begin; f < end; ++f) {
    if (!turns.empty() && turns[f] == kLeftOut) {
      rises[f] = 0.0f;
      if (wholeness) wholeness[f] = 0.0f;
      continue;
    }
    const glm::uvec3& t = mesh.triangles[f];
    for (size_t c = 0; c < 3; ++c) {
      const glm::vec3& p = mesh.vertices[t[int(c)]];
      corners[3 * c][count] = p.x;
      corners[3 * c + 1][count] = p.y;
      corners[3 * c + 2][count] = p.z;
    }
    faces[count++] = f;
    if (count == hn::Lanes(Tag())) measureThem();
  }
  measureThem();
}

}  // namespace
}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(measureFaces);

void measureSides(const CellMesh& mesh, const Turns& turns, const Buffer<float>& field, float farSides,
                  Progress& progress, Buffer<float>& rises, Buffer<float>* wholeness) {
  constexpr size_t kFacesPerTask = 1024;
  const size_t count = mesh.triangles.size();
  rises.resizeUninitialized(count);
  if (wholeness) wholeness->resizeUninitialized(count);
  parallelFor(count, kFacesPerTask, [&](size_t begin, size_t end) {
    progress.poll();
    HWY_DYNAMIC_DISPATCH(measureFaces)
    (mesh, turns, field, farSides, begin, end, rises.data(), wholeness ? wholeness->data() : nullptr);
  });
}

}  // namespace raymap::cpu
#endif
