#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/circle_arcs.cpp"
#include "geometry/circle_arcs.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/pseudo_angle.hpp"
#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"
#include "system/padding.hpp"

#ifndef ESES_GEOMETRY_CIRCLE_ARCS_SHARED_
#define ESES_GEOMETRY_CIRCLE_ARCS_SHARED_
namespace eses::detail {
namespace {

// Margins of the comparison of squares, in square angstrom and relative. They are far above
// rounding errors, and far below the difference that leaves an arc of the minimum length.
constexpr double clear_margin = 1e-9;
constexpr double relative_clear_margin = 1e-14;

// Two perpendicular unit vectors in a circle's plane.
struct CircleFrame {
  Vec3 e1, e2;
};

}  // namespace
}  // namespace eses::detail
#endif  // ESES_GEOMETRY_CIRCLE_ARCS_SHARED_

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

HWY_INLINE DoubleVector dot_at(Vec3 a, const double* x, const double* y, const double* z) {
  return broadcast(a.x) * load(x) + broadcast(a.y) * load(y) + broadcast(a.z) * load(z);
}

// Returns the pseudo-angles of several vectors. See the scalar function of the same name.
HWY_INLINE DoubleVector diamond_angle(DoubleVector x, DoubleVector y) {
  const auto is_right = x >= broadcast(0), is_upper = y >= broadcast(0);
  const auto share = hn::IfThenElse(hn::Xor(is_right, is_upper), x, y) / (hn::Abs(x) + hn::Abs(y));
  return hn::IfThenElse(is_upper, hn::IfThenElse(is_right, share, broadcast(1) - share),
                        hn::IfThenElse(is_right, broadcast(3) + share, broadcast(2) - share));
}

// The caps that block the whole circle, and those that may block a part of it.
struct CapsOnCircle {
  DoubleMask block_all, meet;
};

// Classifies caps without a square root: most of them clearly block the whole circle or nothing of
// it. `height` is the height of the slackened cap's plane above the circle's centre, `along` the
// cosine between the two axes.
HWY_INLINE CapsOnCircle classify_caps(const ContactCircle& circle, DoubleVector along,
                                      DoubleVector height, DoubleMask is_other) {
  const auto squared_reach =
      broadcast(circle.radius * circle.radius) * (broadcast(1) - along) * (broadcast(1) + along);
  const auto is_clear = height * height * broadcast(1 - relative_clear_margin) >
                        squared_reach + broadcast(clear_margin);
  const auto blocks_all = hn::AndNot(height > broadcast(0), is_clear);
  return {hn::And(is_other, blocks_all), hn::AndNot(is_clear, is_other)};
}

// The angles between which caps block the circle, valid on the lanes of `block_part`.
struct BlockedAngles {
  DoubleVector from, to;
  DoubleMask block_all, block_part;
};

HWY_INLINE BlockedAngles blocked_angles(const ContactCircle& circle, DoubleVector height,
                                        DoubleVector along_e1, DoubleVector along_e2,
                                        DoubleMask meet) {
  const auto length = hn::Sqrt(along_e1 * along_e1 + along_e2 * along_e2);
  const auto is_parallel = length == broadcast(0);
  const auto x = hn::IfThenElse(is_parallel, broadcast(1), along_e1 / length);
  const auto y = hn::IfThenElse(is_parallel, broadcast(0), along_e2 / length);
  const auto reach = broadcast(circle.radius) * length;
  const auto cosine = hn::IfThenElse(reach > broadcast(0), height / reach, broadcast(-1));
  const auto block = hn::AndNot(hn::Or(height >= reach, cosine >= broadcast(1)), meet);
  const auto block_all = hn::And(block, cosine <= broadcast(-1));
  const auto sine = hn::Sqrt((broadcast(1) - cosine) * (broadcast(1) + cosine));
  return {diamond_angle(x * cosine + y * sine, y * cosine - x * sine),
          diamond_angle(x * cosine - y * sine, y * cosine + x * sine), block_all,
          hn::AndNot(block_all, block)};
}

// Finds the intervals of the circle that no slackened cap blocks. Returns false if there are none.
bool find_open(const ContactCircle& circle, const CircleFrame& frame, const CapList& caps,
               std::uint32_t own, OpenIntervals& open) {
  const Doubles doubles;
  const auto lanes = hn::Iota(doubles, 0);
  open.clear();
  for (std::size_t k = 0; k < caps.count; k += hn::Lanes(doubles)) {
    const auto along = [&](Vec3 direction) {
      return dot_at(direction, &caps.x[k], &caps.y[k], &caps.z[k]);
    };
    const auto along_axis = along(circle.axis);
    const auto height =
        load(&caps.blocking_height[k]) - broadcast(circle.first_height) * along_axis;
    const auto is_own = hn::Eq(lanes, broadcast(static_cast<double>(own) - static_cast<double>(k)));
    const auto is_other = hn::AndNot(is_own, hn::FirstN(doubles, caps.count - k));
    const auto [block_all, meet] = classify_caps(circle, along_axis, height, is_other);
    if (!hn::AllFalse(doubles, block_all)) return false;
    if (hn::AllFalse(doubles, meet)) continue;
    const BlockedAngles blocked =
        blocked_angles(circle, height, along(frame.e1), along(frame.e2), meet);
    if (!hn::AllFalse(doubles, blocked.block_all)) return false;
    const LaneValues from(blocked.from), to(blocked.to);
    for_each_lane(blocked.block_part, [&](std::size_t lane) {
      open.block(from[lane], to[lane], static_cast<std::uint32_t>(k + lane));
    });
    if (open.is_empty()) return false;
  }
  return true;
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {
namespace {

// Maps the difference of two angles in [0, 4) to [0, 4).
double wrap(double angle) { return angle < 0 ? angle + full_diamond : angle; }

// Maps any angle to [0, 4).
double wrap_any(double angle) { return angle - full_diamond * std::floor(angle / full_diamond); }

// Slack of the test whether a sphere meets the circle, above rounding errors (angstrom).
constexpr double meeting_margin = 1e-12;

// An end this far outside an open interval is tested as well (pseudo-angle).
constexpr double interval_margin = 1e-6;

// A unit vector in the frame of a circle.
struct Direction {
  double x, y;
};

// The direction of a cap's axis in the circle's plane, which is the middle of the blocked interval,
// and the circle's maximum height above its centre along the cap's axis (angstrom).
struct Blocked {
  Direction toward;
  double reach;
};

Blocked blocked_by(const ContactCircle& circle, const CircleFrame& frame, const Cap& cap) {
  const double x = dot(cap.axis, frame.e1), y = dot(cap.axis, frame.e2);
  const double length = std::sqrt(x * x + y * y);
  if (length == 0) return {{1, 0}, 0};
  return {{x / length, y / length}, circle.radius * length};
}

// Returns the height of the exact cap's plane above the circle's centre (angstrom).
double exact_clearance(const ContactCircle& circle, const Cap& cap) {
  return cap.height - circle.first_height * dot(circle.axis, cap.axis);
}

// Rotates a direction counter-clockwise.
Direction rotated(Direction d, double cosine, double sine) {
  return {d.x * cosine - d.y * sine, d.y * cosine + d.x * sine};
}

// Returns the direction in which the blocked interval of the exact cap starts (side -1) or ends
// (side +1).
Direction exact_end(const ContactCircle& circle, const CircleFrame& frame, const Cap& cap,
                    double side) {
  const Blocked blocked = blocked_by(circle, frame, cap);
  const double cosine =
      blocked.reach > 0 ? std::clamp(exact_clearance(circle, cap) / blocked.reach, -1.0, 1.0) : 1.0;
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  return rotated(blocked.toward, cosine, side * sine);
}

Vec3 in_space(const CircleFrame& frame, Direction d) { return d.x * frame.e1 + d.y * frame.e2; }

// Returns whether the rim of the cap meets the circle in points. If the height of the circle above
// the cap's plane varies by less than the tolerance, the whole circle is on one side of the plane.
bool ends_on_circle(const ContactCircle& circle, const CircleFrame& frame, const Cap& cap) {
  const double reach = blocked_by(circle, frame, cap).reach;
  return reach > tolerance::accessible &&
         std::fabs(exact_clearance(circle, cap)) <= reach + meeting_margin;
}

// Returns the angle from `from` counter-clockwise to `to`. The end of a cap moves by at most half a
// turn between its exact and its slackened size, so a larger angle is a rounding error of 0.
double angle_between(double from, double to) {
  const double turn = wrap_any(to - from);
  return turn > half_diamond + interval_margin ? 0 : turn;
}

// Returns whether no slackened cap blocks a point of the circle, except for the two caps whose rims
// meet there.
bool is_accessible(const ContactCircle& circle, const CapList& caps, std::uint32_t own,
                   std::uint32_t other, Vec3 direction) {
  for (std::uint32_t k = 0; k < caps.size(); ++k) {
    if (k == own || k == other) continue;
    const double height = circle.first_height * dot(circle.axis, caps[k].axis) +
                          circle.radius * dot(direction, caps[k].axis);
    if (height > caps.blocking_height[k]) return false;
  }
  return true;
}

// Adds all accessible ends in an open interval, after an individual test of each. If the exact caps
// leave much less of the interval than the slackened ones, its ends need not be accessible, and
// other ends within it may be. Ends at the same point are added once; `scratch.ends` has the
// known ones.
void add_uncertain_ends(const ContactCircle& circle, const CircleFrame& frame, const CapList& caps,
                        std::uint32_t own, double origin, const OpenIntervals::Interval& open,
                        ArcScratch& scratch, std::vector<CircleEnd>& ends) {
  const auto is_known = [&](Vec3 direction) {
    return std::any_of(scratch.ends.begin(), scratch.ends.end(), [&](Vec3 end) {
      return circle.radius * norm(end - direction) < tolerance::same_placement;
    });
  };
  for (std::uint32_t k = 0; k < caps.size(); ++k) {
    if (k == own || !ends_on_circle(circle, frame, caps[k])) continue;
    for (const int side : {+1, -1}) {
      const Direction end = exact_end(circle, frame, caps[k], side);
      const double from_low = wrap_any(diamond_angle(end.x, end.y) - origin - open.low);
      const bool is_within = from_low <= open.high - open.low + interval_margin ||
                             from_low >= full_diamond - interval_margin;
      if (!is_within) continue;
      const Vec3 direction = in_space(frame, end);
      if (is_known(direction) || !is_accessible(circle, caps, own, k, direction)) continue;
      scratch.ends.push_back(direction);
      ends.push_back({k, static_cast<std::int8_t>(side), true});
    }
  }
}

// Adds the arc of an interval that no slackened cap blocks, and its ends. The arc lies between the
// exact caps.
void add_open_interval(const ContactCircle& circle, const CircleFrame& frame, const CapList& caps,
                       std::uint32_t own, double origin, const OpenIntervals::Interval& open,
                       ArcScratch& scratch, std::vector<CircleArc>& arcs,
                       std::vector<CircleEnd>& ends) {
  const Direction start = exact_end(circle, frame, caps[open.low_cap], 1);
  const Direction end = exact_end(circle, frame, caps[open.high_cap], -1);
  // The exact caps block more than the slackened ones, so both ends move inwards. They may pass
  // each other.
  const double start_turn = angle_between(open.low, diamond_angle(start.x, start.y) - origin);
  const double end_turn = angle_between(diamond_angle(end.x, end.y) - origin, open.high);
  const double span = (open.high - open.low) - start_turn - end_turn;
  const bool is_kept = span * circle.radius >= scratch.min_length;
  const bool is_uncertain =
      !is_kept || std::max(start_turn, end_turn) * circle.radius > tolerance::end_shift;
  scratch.ends.clear();
  if (is_kept) {
    scratch.ends.assign({in_space(frame, start), in_space(frame, end)});
    arcs.push_back(
        {span <= half_diamond ? ArcKind::minor : ArcKind::major, scratch.ends[0], scratch.ends[1]});
    ends.push_back({open.low_cap, +1, is_uncertain});
    ends.push_back({open.high_cap, -1, is_uncertain});
  }
  if (is_uncertain) add_uncertain_ends(circle, frame, caps, own, origin, open, scratch, ends);
}

}  // namespace

void OpenIntervals::clear() {
  is_whole = true;
  origin = 0;
  intervals.clear();
}

void OpenIntervals::block(double from, double to, std::uint32_t cap) {
  if (is_whole) {
    is_whole = false;
    origin = to;
    intervals.push_back({0, wrap(from - origin), cap, cap});
    return;
  }
  const double from_origin = wrap(from - origin), to_origin = wrap(to - origin);
  if (from_origin < to_origin) {
    subtract(from_origin, to_origin, cap);
  } else {
    subtract(-1, to_origin, cap);
    subtract(from_origin, full_diamond + 1, cap);
  }
}

// Removes a part from all intervals. If the part splits an interval, it meets no other one.
void OpenIntervals::subtract(double from, double to, std::uint32_t cap) {
  auto kept = intervals.begin();
  for (auto interval = intervals.begin(); interval != intervals.end(); ++interval) {
    const auto [low, high, low_cap, high_cap] = *interval;
    if (to <= low || from >= high) {
      *kept++ = *interval;
      continue;
    }
    if (from > low && to < high) {
      *interval = {low, from, low_cap, cap};
      intervals.insert(interval + 1, {to, high, cap, high_cap});
      return;
    }
    if (from > low) *kept++ = {low, from, low_cap, cap};
    if (to < high) *kept++ = {to, high, cap, high_cap};
  }
  intervals.erase(kept, intervals.end());
}

namespace {

CircleFrame frame_of(const ContactCircle& circle) {
  const Vec3 e1 = any_perpendicular(circle.axis);
  return {e1, cross(circle.axis, e1)};
}

// Adds the arcs of the intervals in `scratch.open`.
void add_open_intervals(const ContactCircle& circle, const CircleFrame& frame, const CapList& caps,
                        std::uint32_t own, ArcScratch& scratch, std::vector<CircleArc>& arcs,
                        std::vector<CircleEnd>& ends) {
  if (scratch.open.is_whole) {
    arcs.push_back({});
    return;
  }
  for (const auto& open : scratch.open.intervals)
    add_open_interval(circle, frame, caps, own, scratch.open.origin, open, scratch, arcs, ends);
}

// Copies the caps that may cut an open sector. Angles are counted from the end of the first cap
// that cuts the circle, so this cap is one of them: the order of arcs remains that of all caps.
void choose_cutting_caps(const CapList& caps, Sectors open, std::uint32_t own,
                         ArcScratch& scratch) {
  list_touching(scratch.sectors, caps.size(), open, own, scratch.cutting);
  std::size_t at = 0;
  for (std::uint32_t k = 0; k < caps.size(); ++k) {
    const std::int32_t length = scratch.sectors.length[k];
    if (k == own || length == CoveredSectors::nothing) continue;
    const auto place = scratch.cutting.begin() + static_cast<std::ptrdiff_t>(at);
    if (place == scratch.cutting.end() || *place != k) scratch.cutting.insert(place, k);
    ++at;
    if (length != CoveredSectors::whole) break;
  }
  scratch.cutting_caps.make_room(scratch.cutting.size());
  scratch.cutting_caps.clear();
  for (const std::int64_t k : scratch.cutting)
    scratch.cutting_caps.set(scratch.cutting_caps.count++, caps[static_cast<std::size_t>(k)]);
}

// Removes the intervals that caps cover which cut no open sector. They cover all of an interval or
// nothing of it.
void keep_in_sectors(Sectors sectors, ArcScratch& scratch) {
  OpenIntervals& open = scratch.open;
  std::erase_if(open.intervals, [&](OpenIntervals::Interval& interval) {
    const int sector =
        static_cast<int>(sectors_per_unit * wrap_any(interval.low + open.origin)) % sector_count;
    interval.low_cap = static_cast<std::uint32_t>(scratch.cutting[interval.low_cap]);
    interval.high_cap = static_cast<std::uint32_t>(scratch.cutting[interval.high_cap]);
    return (sectors >> sector & 1) == 0;
  });
}

}  // namespace

void set_float_caps(const CapList& caps, double sphere_radius, ArcScratch& scratch) {
  scratch.floats.assign(caps, caps.blocking_height, 0, caps.size(), sphere_radius);
  scratch.sphere_radius = sphere_radius;
}

void accessible_arcs(const ContactCircle& circle, const CapList& caps, std::uint32_t own,
                     ArcScratch& scratch, std::vector<CircleArc>& arcs,
                     std::vector<CircleEnd>& ends) {
  const CircleFrame frame = frame_of(circle);
  if (ESES_BEST_VERSION(find_open)(circle, frame, caps, own, scratch.open))
    add_open_intervals(circle, frame, caps, own, scratch, arcs, ends);
}

void accessible_arcs_by_sectors(const ContactCircle& circle, const CapList& caps, std::uint32_t own,
                                ArcScratch& scratch, std::vector<CircleArc>& arcs,
                                std::vector<CircleEnd>& ends) {
  constexpr std::uint32_t no_cap = std::numeric_limits<std::uint32_t>::max();
  const CircleFrame frame = frame_of(circle);
  const double inverse = 1 / scratch.sphere_radius;
  const Sectors open = find_open_sectors(
      {circle.axis, frame.e1, frame.e2, inverse * circle.first_height, inverse * circle.radius},
      scratch.floats, scratch.sectors);
  if (open == 0) return;
  choose_cutting_caps(caps, open, own, scratch);
  if (!ESES_BEST_VERSION(find_open)(circle, frame, scratch.cutting_caps, no_cap, scratch.open))
    return;
  keep_in_sectors(open, scratch);
  add_open_intervals(circle, frame, caps, own, scratch, arcs, ends);
}

}  // namespace eses::detail
#endif  // HWY_ONCE
