#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/circle_sectors.cpp"
#include "geometry/circle_sectors.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"
#include "system/padding.hpp"

#ifndef ESES_GEOMETRY_CIRCLE_SECTORS_SHARED_
#define ESES_GEOMETRY_CIRCLE_SECTORS_SHARED_
namespace eses::detail {
namespace {

// Margins of the decisions in single precision, see doc/algorithm.md: of the square of half the
// chord that a cap cuts from the circle (in squared radii of the sphere), and of an end (in
// sectors).
constexpr float chord_margin = 4e-5F, end_margin = 0.03F;

}  // namespace
}  // namespace eses::detail
#endif  // ESES_GEOMETRY_CIRCLE_SECTORS_SHARED_

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

using Integers = hn::Repartition<std::int32_t, Floats>;

// Vectors of the frame of a circle, the same in all lanes.
struct FrameVector {
  FloatVector x, y, z;

  HWY_INLINE FrameVector(double scale, Vec3 a)
      : x(broadcast_float(scale * a.x)),
        y(broadcast_float(scale * a.y)),
        z(broadcast_float(scale * a.z)) {}
  HWY_INLINE FloatVector dot(FloatVector ax, FloatVector ay, FloatVector az) const {
    return hn::Add(hn::Add(hn::Mul(x, ax), hn::Mul(y, ay)), hn::Mul(z, az));
  }
};

// Returns the sector, with its fraction, of a direction in the circle's plane.
HWY_INLINE FloatVector sector_of(FloatVector x, FloatVector y) {
  const auto zero = hn::Zero(Floats());
  const auto is_right = hn::Ge(x, zero), is_upper = hn::Ge(y, zero);
  const auto share =
      hn::Div(hn::IfThenElse(hn::Xor(is_right, is_upper), x, y), hn::Add(hn::Abs(x), hn::Abs(y)));
  const auto upper = hn::IfThenElse(is_right, share, hn::Sub(broadcast_float(1), share));
  const auto lower = hn::IfThenElse(is_right, hn::Add(broadcast_float(3), share),
                                    hn::Sub(broadcast_float(2), share));
  return hn::Mul(broadcast_float(sectors_per_unit), hn::IfThenElse(is_upper, upper, lower));
}

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Sectors covered_by_vector(const CoveredSectors& covered, std::size_t k) {
  return covered.covered_by(k);
}
#else
using WideIntegers = hn::Repartition<std::int64_t, Floats>;
using WideSectors = hn::Repartition<std::uint64_t, Floats>;

// Returns `length` sectors from `first` on, in all lanes. Lengths are in [0, 64).
HWY_INLINE hn::Vec<WideSectors> run_of_sectors(hn::Vec<WideIntegers> first,
                                               hn::Vec<WideIntegers> length) {
  const WideSectors wide;
  const auto last = hn::Set(wide, std::uint64_t{sector_count - 1}), one = hn::Set(wide, 1);
  const auto from = hn::And(hn::BitCast(wide, first), last);
  const auto run = hn::Sub(hn::Shl(one, hn::BitCast(wide, length)), one);
  return hn::Or(hn::Shl(run, from), hn::Shr(hn::ShiftRight<1>(run), hn::Sub(last, from)));
}

HWY_INLINE hn::Vec<WideSectors> half_covered(const CoveredSectors& covered, std::size_t k) {
  const WideIntegers wide;
  const hn::Rebind<std::int32_t, WideIntegers> halves;
  const auto first = hn::PromoteTo(wide, hn::LoadU(halves, &covered.first[k]));
  const auto length = hn::PromoteTo(wide, hn::LoadU(halves, &covered.length[k]));
  const auto is_run =
      hn::And(hn::Gt(length, hn::Zero(wide)), hn::Lt(length, hn::Set(wide, sector_count)));
  return run_of_sectors(first, hn::IfThenElseZero(is_run, length));
}

// Returns the sectors that the caps of a vector from cap `k` on cover.
HWY_INLINE Sectors covered_by_vector(const CoveredSectors& covered, std::size_t k) {
  const WideSectors wide;
  std::array<Sectors, HWY_MAX_BYTES / sizeof(Sectors)> lanes;
  hn::StoreU(hn::Or(half_covered(covered, k), half_covered(covered, k + hn::Lanes(wide))), wide,
             lanes.data());
  Sectors all = 0;
  for (std::size_t lane = 0; lane < hn::Lanes(wide); ++lane) all |= lanes[lane];
  return all;
}
#endif

Sectors find_open(const CircleInFrame& circle, const FloatCaps& caps, CoveredSectors& covered) {
  const Floats floats;
  const Integers integers;
  const FrameVector center(circle.height, circle.axis), e1(circle.radius, circle.e1),
      e2(circle.radius, circle.e2);
  Sectors open = ~Sectors{0};
  for (std::size_t k = 0; k < caps.count; k += hn::Lanes(floats)) {
    const auto x = hn::LoadU(floats, &caps.x[k]), y = hn::LoadU(floats, &caps.y[k]),
               z = hn::LoadU(floats, &caps.z[k]);
    // The cap covers the points with along1 cos(psi) + along2 sin(psi) > height.
    const auto height = hn::Sub(hn::LoadU(floats, &caps.height[k]), center.dot(x, y, z));
    const auto along1 = e1.dot(x, y, z), along2 = e2.dot(x, y, z);
    const auto squared_chord =
        hn::Sub(hn::Add(hn::Mul(along1, along1), hn::Mul(along2, along2)), hn::Mul(height, height));
    const auto misses = hn::Lt(squared_chord, broadcast_float(-chord_margin));
    const auto is_below = hn::Lt(height, hn::Zero(floats));
    if (!hn::AllFalse(floats, hn::And(misses, is_below))) return 0;

    const auto chord = hn::Sqrt(hn::Max(squared_chord, hn::Zero(floats)));
    const auto a1 = hn::Mul(along1, height), a2 = hn::Mul(along2, height);
    const auto b1 = hn::Mul(along1, chord), b2 = hn::Mul(along2, chord);
    const auto from = sector_of(hn::Add(a1, b2), hn::Sub(a2, b1));
    auto to = sector_of(hn::Sub(a1, b2), hn::Add(a2, b1));
    to = hn::IfThenElse(hn::Lt(to, from), hn::Add(to, broadcast_float(sector_count)), to);
    const auto one = hn::Set(integers, 1);
    const auto first =
        hn::Add(hn::ConvertTo(integers, hn::Add(from, broadcast_float(end_margin))), one);
    const auto length =
        hn::Sub(hn::ConvertTo(integers, hn::Sub(to, broadcast_float(end_margin))), first);
    const auto cuts =
        hn::RebindMask(integers, hn::Gt(squared_chord, broadcast_float(chord_margin)));
    const auto otherwise =
        hn::IfThenElse(hn::RebindMask(integers, misses), hn::Set(integers, CoveredSectors::nothing),
                       hn::Set(integers, CoveredSectors::whole));
    hn::StoreU(first, integers, &covered.first[k]);
    hn::StoreU(hn::IfThenElse(cuts, length, otherwise), integers, &covered.length[k]);
    open &= ~covered_by_vector(covered, k);
    if (open == 0) return 0;
  }
  return open;
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {

void FloatCaps::assign(const CapList& caps, const std::vector<double>& heights, std::size_t begin,
                       std::size_t size, double radius) {
  count = size;
  const std::size_t padded = size + vector_padding;
  if (x.size() < padded)
    for (auto* values : {&x, &y, &z, &height}) values->resize(2 * padded);
  const double inverse = 1 / radius;
  for (std::size_t k = 0; k < size; ++k) {
    x[k] = static_cast<float>(caps.x[begin + k]);
    y[k] = static_cast<float>(caps.y[begin + k]);
    z[k] = static_cast<float>(caps.z[begin + k]);
    height[k] = static_cast<float>(inverse * heights[begin + k]);
  }
  // Empty caps fill the last vector.
  for (std::size_t k = size; k < padded; ++k) x[k] = height[k] = 2, y[k] = z[k] = 0;
}

Sectors find_open_sectors(const CircleInFrame& circle, const FloatCaps& caps,
                          CoveredSectors& covered) {
  if (covered.first.size() < caps.count + vector_padding)
    for (auto* values : {&covered.first, &covered.length}) values->resize(caps.x.size());
  return ESES_BEST_VERSION(find_open)(circle, caps, covered);
}

void list_touching(const CoveredSectors& covered, std::size_t count, Sectors sectors,
                   std::size_t own, std::vector<std::int64_t>& list) {
  list.resize(count + vector_padding);
  std::size_t found = 0;
  for (std::size_t k = 0; k < count; ++k) {
    list[found] = static_cast<std::int64_t>(k);
    found += (covered.touched_by(k) & sectors) != 0 && k != own ? 1 : 0;
  }
  std::fill_n(list.begin() + static_cast<std::ptrdiff_t>(found), vector_padding, 0);
  list.resize(found);
}

}  // namespace eses::detail
#endif  // HWY_ONCE
