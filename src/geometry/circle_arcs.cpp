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

double wrap(double angle) { return angle < 0 ? angle + full_turn : angle; }

// Square angstrom: far above rounding, far below what leaves an arc.
constexpr double clear_margin = 1e-9;

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

// One end of an arc: the direction in which `cap` of full size begins (side -1) or ceases
// (side +1) to block.
Direction exact_end(const ContactCircle& circle, const CircleFrame& frame, const Cap& cap,
                    double side) {
  const Blocked blocked = blocked_by(circle, frame, cap);
  const double cosine =
      blocked.reach > 0 ? std::clamp(exact_clearance(circle, cap) / blocked.reach, -1.0, 1.0) : 1.0;
  return turned(blocked.toward, cosine, side * sine_of(cosine));
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

}  // namespace

void accessible_arcs(const ContactCircle& circle, std::span<const Cap> caps, std::uint32_t own,
                     ArcScratch& scratch, std::vector<CircleArc>& arcs) {
  const Vec3 e1 = any_perpendicular(circle.axis);
  const CircleFrame frame{e1, cross(circle.axis, e1)};
  bool whole = true;
  double origin = 0;
  scratch.open.clear();
  for (std::uint32_t k = 0; k < caps.size(); ++k) {
    if (k == own) continue;
    const double along = dot(circle.axis, caps[k].axis);
    const double height = caps[k].blocking_height - circle.first_height * along;
    // Most caps block all or nothing; that is told without a root where it is told clearly.
    const double squared_reach = circle.radius * circle.radius * (1 - along) * (1 + along);
    if (height * height > squared_reach + clear_margin) {
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
  for (const auto& open : scratch.open) {
    const Direction start = exact_end(circle, frame, caps[open.low_cap], 1);
    const Direction end = exact_end(circle, frame, caps[open.high_cap], -1);
    // The exact caps block more than the slackened ones: both ends move inwards, and may pass each
    // other where the arc is but a point.
    const auto shift = [&](double from, double to) {
      const double d = std::fabs(to - from);
      return std::min(d, full_turn - d);
    };
    const double low = wrap(diamond_angle(start.x, start.y) - origin);
    const double high = wrap(diamond_angle(end.x, end.y) - origin);
    const double span = (open.high - open.low) - shift(low, open.low) - shift(high, open.high);
    const ArcKind kind = span * circle.radius < tolerance::arc_length ? ArcKind::point
                         : span <= half_turn                          ? ArcKind::minor
                                                                      : ArcKind::major;
    arcs.push_back({kind, start.x * frame.e1 + start.y * frame.e2,
                    end.x * frame.e1 + end.y * frame.e2, open.low_cap, open.high_cap});
  }
}

}  // namespace eses
