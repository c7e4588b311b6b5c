/// Vectors of points in space, one point in each lane. Highway includes this file once for each
/// instruction set.

#include <cstddef>

#include "eses/vec3.hpp"
#include "system/lanes-inl.hpp"

#if defined(ESES_SIMD_POINTS_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SIMD_POINTS_INL_
#undef ESES_SIMD_POINTS_INL_
#else
#define ESES_SIMD_POINTS_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// One point in each lane.
struct Points {
  DoubleVector x, y, z;
};

/// Returns the coordinates along an axis.
template <std::size_t axis>
HWY_INLINE DoubleVector& along(Points& points) {
  return axis == 0 ? points.x : axis == 1 ? points.y : points.z;
}

HWY_INLINE Points operator-(const Points& a, const Points& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Points operator*(DoubleVector s, const Points& a) { return {s * a.x, s * a.y, s * a.z}; }
HWY_INLINE Points operator*(DoubleVector s, Vec3 a) {
  return {s * broadcast(a.x), s * broadcast(a.y), s * broadcast(a.z)};
}

HWY_INLINE DoubleVector dot(Vec3 a, const Points& b) {
  return broadcast(a.x) * b.x + broadcast(a.y) * b.y + broadcast(a.z) * b.z;
}

HWY_INLINE DoubleVector squared_norm(const Points& a) { return a.x * a.x + a.y * a.y + a.z * a.z; }

/// Axes of the coordinate system, one in each lane, given as the numbers 0, 1 and 2.
class LaneAxes {
 public:
  HWY_INLINE explicit LaneAxes(DoubleVector axis)
      : is_x_(hn::Eq(axis, broadcast(0))), is_y_(hn::Eq(axis, broadcast(1))) {}

  /// Returns the coordinate of each point along the axis of its lane.
  HWY_INLINE DoubleVector of(const Points& points) const {
    return hn::IfThenElse(is_x_, points.x, hn::IfThenElse(is_y_, points.y, points.z));
  }
  HWY_INLINE DoubleVector of(Vec3 a) const {
    return of(Points{broadcast(a.x), broadcast(a.y), broadcast(a.z)});
  }
  /// Returns the points with these coordinates along the axes.
  HWY_INLINE Points with(const Points& points, DoubleVector coordinates) const {
    return {hn::IfThenElse(is_x_, coordinates, points.x),
            hn::IfThenElse(is_y_, coordinates, points.y),
            hn::IfThenElse(hn::Or(is_x_, is_y_), points.z, coordinates)};
  }
  /// Returns the points moved along the axes.
  HWY_INLINE Points moved(const Points& points, DoubleVector steps) const {
    return with(points, of(points) + steps);
  }

 private:
  DoubleMask is_x_, is_y_;
};

/// The points of the lanes, for access by index.
struct LanePoints {
  LaneValues x, y, z;

  HWY_INLINE explicit LanePoints(const Points& points) : x(points.x), y(points.y), z(points.z) {}
  HWY_INLINE Points points() const {
    return {load(x.values.data()), load(y.values.data()), load(z.values.data())};
  }
  Vec3 operator[](std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
  void set(std::size_t lane, Vec3 point) {
    x.values[lane] = point.x;
    y.values[lane] = point.y;
    z.values[lane] = point.z;
  }
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
