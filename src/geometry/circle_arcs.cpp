#include "geometry/circle_arcs.hpp"

#include <cmath>

namespace eses {
namespace {

// Angles are measured in [0, 4) along the diamond |x| + |y| = 1: monotone in the true angle, half a
// turn is 2, and no trigonometry is needed.
constexpr double full_turn = 4;
constexpr double half_turn = 2;

double diamond_angle(double x, double y) {
  const double r = std::fabs(x) + std::fabs(y);
  return y >= 0 ? (x >= 0 ? y / r : 1 - x / r) : (x < 0 ? 2 - y / r : 3 + x / r);
}

// Of a difference of two angles in [0, 4).
double wrap(double angle) { return angle < 0 ? angle + full_turn : angle; }

double wrap_any(double angle) { return angle - full_turn * std::floor(angle / full_turn); }

// Square angstrom, and relative to the squares compared: far above rounding, far below what leaves
// an arc.
constexpr double clear_margin = 1e-9;
constexpr double relative_clear_margin = 1e-14;

// Angstrom: a sphere meets the circle if it reaches it up to rounding.
constexpr double meeting_margin = 1e-12;

// Angle on the diamond: an end this far outside an open interval is still tested.
constexpr double interval_margin = 1e-6;

struct Direction {
  double x, y;
};

struct CircleFrame {
  Vec3 e1, e2;
};

// The blocked interval of one cap is centred on `toward` and reaches to both sides.
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

double exact_clearance(const ContactCircle& circle, const Cap& cap) {
  return cap.height - circle.first_height * dot(circle.axis, cap.axis);
}

Direction turned(Direction d, double cosine, double sine) {
  return {d.x * cosine - d.y * sine, d.y * cosine + d.x * sine};
}

double sine_of(double cosine) { return std::sqrt((1 - cosine) * (1 + cosine)); }

// The direction in which `cap` of full size begins (side -1) or ceases (side +1) to block.
Direction exact_end(const ContactCircle& circle, const CircleFrame& frame, const Cap& cap,
                    double side) {
  const Blocked blocked = blocked_by(circle, frame, cap);
  const double cosine =
      blocked.reach > 0 ? std::clamp(exact_clearance(circle, cap) / blocked.reach, -1.0, 1.0) : 1.0;
  return turned(blocked.toward, cosine, side * sine_of(cosine));
}

Vec3 in_space(const CircleFrame& frame, Direction d) { return d.x * frame.e1 + d.y * frame.e2; }

// Whether the rim of the cap meets the circle in points. If it varies by less than the tolerance
// along the circle, the circle as a whole is on one side of it.
bool ends_on_circle(const ContactCircle& circle, const CircleFrame& frame, const Cap& cap) {
  const double reach = blocked_by(circle, frame, cap).reach;
  return reach > tolerance::accessible &&
         std::fabs(exact_clearance(circle, cap)) <= reach + meeting_margin;
}

// From `from` counter-clockwise to `to`. A cap's end turns by half a turn at most between its two
// sizes: what seems to be more is rounding of no turn at all.
double turn_between(double from, double to) {
  const double turn = wrap_any(to - from);
  return turn > half_turn + interval_margin ? 0 : turn;
}

void subtract(double from, double to, std::uint32_t cap, ArcScratch& scratch) {
  scratch.next.clear();
  for (const auto& open : scratch.open) {
    if (to <= open.low || from >= open.high) {
      scratch.next.push_back(open);
      continue;
    }
    if (from > open.low) scratch.next.push_back({open.low, from, open.low_cap, cap});
    if (to < open.high) scratch.next.push_back({to, open.high, cap, open.high_cap});
  }
  scratch.open.swap(scratch.next);
}

// Whether a point of the circle is accessible for all caps but the two whose rims meet there.
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

// Adds the accessible ends in an open interval, each tested by itself: where the exact caps leave
// hardly anything of what the slackened ones leave, the ends of the interval need not be
// accessible, and others between them may be. Of ends at the same place there is one;
// `scratch.places` has those that are known.
void add_doubtful_ends(const ContactCircle& circle, const CircleFrame& frame,
                       const CapList& caps, std::uint32_t own, double origin,
                       const ArcScratch::Interval& open, ArcScratch& scratch,
                       std::vector<CircleEnd>& ends) {
  const auto is_known = [&](Vec3 direction) {
    return std::any_of(scratch.places.begin(), scratch.places.end(), [&](Vec3 place) {
      return circle.radius * norm(place - direction) < tolerance::same_placement;
    });
  };
  for (std::uint32_t k = 0; k < caps.size(); ++k) {
    if (k == own || !ends_on_circle(circle, frame, caps[k])) continue;
    for (const int side : {+1, -1}) {
      const Direction end = exact_end(circle, frame, caps[k], side);
      const double from_low = wrap_any(diamond_angle(end.x, end.y) - origin - open.low);
      const bool is_within = from_low <= open.high - open.low + interval_margin ||
                             from_low >= full_turn - interval_margin;
      if (!is_within) continue;
      const Vec3 direction = in_space(frame, end);
      if (is_known(direction) || !is_accessible(circle, caps, own, k, direction)) continue;
      scratch.places.push_back(direction);
      ends.push_back({k, static_cast<std::int8_t>(side), true});
    }
  }
}

// An interval that the slackened caps leave open: its arc between the exact caps, and its ends.
void add_open_interval(const ContactCircle& circle, const CircleFrame& frame,
                       const CapList& caps, std::uint32_t own, double origin,
                       const ArcScratch::Interval& open, ArcScratch& scratch,
                       std::vector<CircleArc>& arcs, std::vector<CircleEnd>& ends) {
  const Direction start = exact_end(circle, frame, caps[open.low_cap], 1);
  const Direction end = exact_end(circle, frame, caps[open.high_cap], -1);
  // The exact caps block more than the slackened ones: both ends move inwards, and may pass each
  // other.
  const double start_turn = turn_between(open.low, diamond_angle(start.x, start.y) - origin);
  const double end_turn = turn_between(diamond_angle(end.x, end.y) - origin, open.high);
  const double span = (open.high - open.low) - start_turn - end_turn;
  const bool is_kept = span * circle.radius >= tolerance::arc_length;
  const bool is_doubtful =
      !is_kept || std::max(start_turn, end_turn) * circle.radius > tolerance::end_shift;
  scratch.places.clear();
  if (is_kept) {
    scratch.places.assign({in_space(frame, start), in_space(frame, end)});
    arcs.push_back({span <= half_turn ? ArcKind::minor : ArcKind::major, scratch.places[0],
                    scratch.places[1]});
    ends.push_back({open.low_cap, +1, is_doubtful});
    ends.push_back({open.high_cap, -1, is_doubtful});
  }
  if (is_doubtful) add_doubtful_ends(circle, frame, caps, own, origin, open, scratch, ends);
}

}  // namespace

void accessible_arcs(const ContactCircle& circle, const CapList& caps, std::uint32_t own,
                     ArcScratch& scratch, std::vector<CircleArc>& arcs,
                     std::vector<CircleEnd>& ends) {
  const Vec3 e1 = any_perpendicular(circle.axis);
  const CircleFrame frame{e1, cross(circle.axis, e1)};
  bool whole = true;
  double origin = 0;
  scratch.open.clear();
  for (std::uint32_t k = 0; k < caps.size(); ++k) {
    if (k == own) continue;
    const double along = dot(circle.axis, caps[k].axis);
    const double height = caps.blocking_height[k] - circle.first_height * along;
    // Most caps block all or nothing; that is told without a root where it is told clearly.
    const double squared_reach = circle.radius * circle.radius * (1 - along) * (1 + along);
    const double squared_height = height * height;
    if (squared_height * (1 - relative_clear_margin) > squared_reach + clear_margin) {
      if (height > 0) continue;
      return;
    }
    const Blocked blocked = blocked_by(circle, frame, caps[k]);
    if (height >= blocked.reach) continue;
    const double cosine = blocked.reach > 0 ? height / blocked.reach : -1;
    if (cosine >= 1) continue;
    if (cosine <= -1) return;
    const double sine = sine_of(cosine);
    const Direction first = turned(blocked.toward, cosine, -sine);
    const Direction last = turned(blocked.toward, cosine, sine);
    const double from = diamond_angle(first.x, first.y), to = diamond_angle(last.x, last.y);
    if (whole) {
      whole = false;
      origin = to;
      scratch.open.push_back({0, wrap(from - origin), k, k});
      continue;
    }
    const double from_origin = wrap(from - origin), to_origin = wrap(to - origin);
    if (from_origin < to_origin) {
      subtract(from_origin, to_origin, k, scratch);
    } else {
      subtract(-1, to_origin, k, scratch);
      subtract(from_origin, full_turn + 1, k, scratch);
    }
    if (scratch.open.empty()) return;
  }
  if (whole) {
    arcs.push_back({});
    return;
  }
  for (const auto& open : scratch.open)
    add_open_interval(circle, frame, caps, own, origin, open, scratch, arcs, ends);
}

}  // namespace eses
