#include "geometry/sphere_part.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/pseudo_angle.hpp"

namespace eses::detail {
namespace {

using std::numbers::pi;

// Longer arcs are divided. The ends of a piece must not be almost opposite.
constexpr double max_piece = 2.2;

// Caps whose rims are nearer to each other than this are the same cap (radians). The value is above
// the rounding errors of axes. The part changes by at most 2 pi times this. The points in which
// almost equal rims meet have large errors along these rims, but both rims have the same points, so
// that this changes the part by rounding errors only.
constexpr double same_cap = 1e-14;

// The meeting points of rims whose axes are nearer to one line than this are computed with more
// care (square of an angle in radians).
constexpr double almost_parallel = 1e-4;

// The argument of the product of complex numbers is the sum of their arguments.
struct Complex {
  double real, imaginary;
};

double argument_of_quotient(Complex a, Complex b) {
  return std::atan2(a.imaginary * b.real - a.real * b.imaginary,
                    a.real * b.real + a.imaginary * b.imaginary);
}

// Returns the solid angle between the arc from `p` to `q` and the point opposite to `covered`, up
// to a multiple of 4 pi: the segment between the arc and its great circle chord, and the triangle
// of the chord and this point. Half the solid angle of a triangle with the corners n, p and q is
// the argument of 1 + n . p + p . q + q . n + i n . (p x q) (Van Oosterom and Strackee). For n =
// -x, with u = p - x and w = q - x, this is u . w - i x . (u x w). It keeps its digits unless p or
// q is near x. If x is on the chord, the argument jumps by 2 pi, and the solid angle by 4 pi.
double swept(double cosine, double angle, double cos_angle, double sin_angle, Vec3 p, Vec3 q,
             Vec3 covered) {
  const double sector = angle * (1 - cosine);
  const Complex from_axis{(1 + cosine) + (1 - cosine) * cos_angle, (1 - cosine) * sin_angle};
  const Vec3 u = p - covered, w = q - covered;
  const Complex from_opposite{dot(u, w), -dot(covered, cross(u, w))};
  return sector + 2 * argument_of_quotient(from_opposite, from_axis);
}

double sine_of(double cosine) { return std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine))); }

}  // namespace

namespace sphere_part {

double reduced(double boundary_sum) {
  const double turns = boundary_sum / (4 * pi);
  return std::max(0.0, 4 * pi * (turns - std::floor(turns)));
}

std::span<const Vec3> test_directions() {
  static constexpr std::array<Vec3, 3> directions{{{0.57137215, 0.78640573, -0.23465291},
                                                   {-0.91327421, 0.11963758, 0.38938437},
                                                   {0.21390647, -0.74093818, -0.63659372}}};
  return directions;
}

}  // namespace sphere_part

double angle_about(Vec3 axis, Vec3 start, Vec3 end) {
  const double angle = std::atan2(dot(axis, cross(start, end)), dot(start, end));
  return angle < 0 ? angle + 2 * pi : angle;
}

SpherePart boundary_term(const SphericalCap& cap, const RimArc& arc, Vec3 covered) {
  const double c = cap.cosine, s = sine_of(c);
  if (arc.angle >= 2 * pi) return {-2 * pi * (1 - c), (-s * s * pi) * cap.axis};
  const Vec3 radial = cross(arc.end - arc.start, cap.axis);  // integral of the radial direction
  SpherePart term{0, (0.5 * s * c) * radial - (0.5 * s * s * arc.angle) * cap.axis};
  const Vec3 foot = c * cap.axis;
  if (arc.angle <= max_piece) {
    term.solid_angle =
        -swept(c, arc.angle, dot(arc.start, arc.end), dot(cap.axis, cross(arc.start, arc.end)),
               foot + s * arc.start, foot + s * arc.end, covered);
    return term;
  }
  const int pieces = static_cast<int>(std::ceil(arc.angle / max_piece));
  const double piece = arc.angle / pieces, cosine = std::cos(piece), sine = std::sin(piece);
  Vec3 from = arc.start;
  for (int k = 1; k <= pieces; ++k) {
    const Vec3 to = k == pieces ? arc.end : cosine * from + sine * cross(cap.axis, from);
    term.solid_angle -= swept(c, piece, cosine, sine, foot + s * from, foot + s * to, covered);
    from = to;
  }
  return term;
}

// n n^T less a third of the unit matrix is a spherical harmonic of degree 2, so its integral is
// -1/6 of that of its normal derivative m n^T + n m^T along the boundary, where m is the outward
// normal of the boundary. With the radial unit vector e, n = c u + s e and m = s u - c e.
Vec3 second_moment_term(const SphericalCap& cap, const RimArc& arc, Vec3 vector) {
  const Vec3 u = cap.axis;
  const double c = cap.cosine, s = sine_of(c), along = dot(u, vector);
  const bool is_full = arc.angle >= 2 * pi;
  const Vec3 radial = is_full ? Vec3() : cross(arc.end - arc.start, u);  // integral of e
  Vec3 squares = (0.5 * arc.angle) * (vector - along * u);  // integral of e (e . vector)
  const auto ends = [&](Vec3 e) {
    const Vec3 f = cross(u, e);
    return dot(f, vector) * e + dot(e, vector) * f;
  };
  if (!is_full) squares = squares - 0.25 * (ends(arc.end) - ends(arc.start));
  const Vec3 sum = (2 * s * c * arc.angle * along + (s - c) * (s + c) * dot(radial, vector)) * u +
                   ((s - c) * (s + c) * along) * radial - (2 * s * c) * squares;
  return (-s / 6) * sum;
}

SpherePart triangle_part(Vec3 a, Vec3 b, Vec3 c) {
  const double volume = dot(a, cross(b, c));
  const double sign = volume < 0 ? -1 : 1;
  SpherePart part;
  part.solid_angle = 2 * std::atan2(std::fabs(volume), 1 + dot(a, b) + dot(b, c) + dot(c, a));
  const auto add_edge = [&](Vec3 from, Vec3 to) {
    const Vec3 normal = cross(from, to);
    const double sine = norm(normal);
    if (sine > 0)
      part.vector_area =
          part.vector_area + (0.5 * sign * std::atan2(sine, dot(from, to)) / sine) * normal;
  };
  add_edge(a, b);
  add_edge(b, c);
  add_edge(c, a);
  return part;
}

// Does what meet() does, for small caps almost in the same place, or their complements. With the
// unit vectors u and v, s = u + v and q = v - u are at right angles. So n . s = c + d and
// n . q = d - c give the line n . u = c, n . v = d. Differences of 1 and a cosine keep the digits
// of small caps. If v is almost -u, the plane of the second rim is given by -v and -d instead.
SpherePartFinder::Meeting SpherePartFinder::meet_almost_parallel(const SphericalCap& first,
                                                                 const SphericalCap& second) {
  const Vec3 u = first.axis;
  const bool is_opposite = dot(u, second.axis) < 0;
  const double sign = is_opposite ? -1 : 1;
  const Vec3 v = sign * second.axis, s = u + v;
  const Vec3 q = (v - u) - (dot(v - u, s) / squared_norm(s)) * s;
  const double c = 1 - first.cosine, d = 1 - sign * second.cosine;
  const double squared = squared_norm(q), length = std::sqrt(4 - squared);
  if (squared > 0) {
    const double along = (c + d - squared / (2 + length)) / length;  // 1 less n along s
    const double across = (c - d) / std::sqrt(squared);
    const double rest = along * (2 - along) - across * across;
    if (rest > 0) {
      const Vec3 foot = ((1 - along) / length) * s + ((c - d) / squared) * q;
      const Vec3 offset = (sign / length * std::sqrt(rest / squared)) * cross(s, q);
      return {true, false, false, foot - offset, foot + offset};
    }
  }
  Meeting meeting;
  meeting.covers_first = sign * (d - c - 0.5 * first.cosine * squared) > 0;
  meeting.covers_second = c - d - 0.5 * sign * second.cosine * squared > 0;
  return meeting;
}

// With the unit vectors u and v, w = u x v and the cosines c and d, the line n . u = c, n . v = d
// is (c (v x w) + d (w x u)) / |w|^2 + t w.
SpherePartFinder::Meeting SpherePartFinder::meet(const SphericalCap& first,
                                                 const SphericalCap& second) {
  const Vec3 w = cross(first.axis, second.axis);
  const double squared = squared_norm(w);
  if (squared < almost_parallel) return meet_almost_parallel(first, second);
  const Vec3 foot =
      (1 / squared) * (first.cosine * cross(second.axis, w) + second.cosine * cross(w, first.axis));
  const double rest = 1 - squared_norm(foot);
  if (rest > 0) {
    const Vec3 offset = std::sqrt(rest / squared) * w;
    return {true, false, false, foot - offset, foot + offset};
  }
  return keep_apart(first, second);
}

// Rims that do not meet are each on one side of the other cap's plane.
SpherePartFinder::Meeting SpherePartFinder::keep_apart(const SphericalCap& first,
                                                       const SphericalCap& second) {
  const double along = dot(first.axis, second.axis);
  Meeting meeting;
  meeting.covers_first = first.cosine * along > second.cosine;
  meeting.covers_second = second.cosine * along > first.cosine;
  return meeting;
}

// Replaces what was computed from the caps, unless one of them was left out.
void SpherePartFinder::replace(const KnownMeeting& known) {
  const auto first = std::ranges::find(numbers_, known.first);
  const auto second = std::ranges::find(numbers_, known.second);
  if (first == numbers_.end() || second == numbers_.end()) return;
  const auto k = static_cast<std::size_t>(first - numbers_.begin());
  const auto l = static_cast<std::size_t>(second - numbers_.begin());
  Meeting& meeting = meetings_[k * numbers_.size() + l];
  if (!known.points) {
    meeting = keep_apart(caps_[k], caps_[l]);
    return;
  }
  auto [low, high] = *known.points;
  if (dot(high - low, cross(caps_[k].axis, caps_[l].axis)) < 0) std::swap(low, high);
  meeting = {true, false, false, low, high};
}

void SpherePartFinder::keep_distinct(std::span<const SphericalCap> caps) {
  caps_.clear();
  numbers_.clear();
  for (std::uint32_t k = 0; k < caps.size(); ++k) {
    if (caps[k].cosine >= 1) continue;
    const bool is_known = std::any_of(caps_.begin(), caps_.end(), [&](const SphericalCap& known) {
      return squared_norm(known.axis - caps[k].axis) < same_cap * same_cap &&
             std::fabs(known.cosine - caps[k].cosine) <=
                 same_cap * std::max(same_cap, sine_of(caps[k].cosine));
    });
    if (is_known) continue;
    caps_.push_back(caps[k]);
    numbers_.push_back(k);
  }
}

// Appends the arcs of a rim that no other cap covers.
void SpherePartFinder::find_arcs(std::uint32_t k) {
  const auto count = static_cast<std::uint32_t>(caps_.size());
  const SphericalCap& cap = caps_[k];
  const Vec3 e = any_perpendicular(cap.axis), f = cross(cap.axis, e);
  const double inverse_sine = 1 / sine_of(cap.cosine);
  cuts_.clear();
  for (std::uint32_t l = 0; l < count; ++l) {
    if (l == k) continue;
    const Meeting& meeting = k < l ? meetings_[k * count + l] : meetings_[l * count + k];
    if (k < l ? meeting.covers_first : meeting.covers_second) return;
    if (!meeting.is_cut) continue;
    const auto& [start, end] =
        k < l ? std::pair(meeting.low, meeting.high) : std::pair(meeting.high, meeting.low);
    const double from = diamond_angle(dot(start, e), dot(start, f));
    double to = diamond_angle(dot(end, e), dot(end, f));
    if (to < from) to += full_diamond;
    cuts_.push_back({from, to, start, end});
  }
  if (cuts_.empty()) {
    arcs_.push_back({numbers_[k], 2 * pi, e, e});
    return;
  }
  std::sort(cuts_.begin(), cuts_.end(), [](const Cut& a, const Cut& b) { return a.from < b.from; });
  const Cut* last = &*std::max_element(cuts_.begin(), cuts_.end(),
                                       [](const Cut& a, const Cut& b) { return a.to < b.to; });
  double covered_to = last->to - full_diamond;
  const auto radial = [&](Vec3 point) { return inverse_sine * (point - cap.cosine * cap.axis); };
  for (const Cut& cut : cuts_) {
    if (cut.from > covered_to) {
      const Vec3 start = radial(last->end), end = radial(cut.start);
      double angle = angle_about(cap.axis, start, end);
      // Rounding may exchange an angle of almost 0 and one of almost 2 pi. Pseudo-angles tell which
      // one it is.
      const bool is_short = cut.from - covered_to < half_diamond;
      if (is_short && angle > 1.5 * pi) angle = 0;
      if (!is_short && angle < 0.5 * pi) angle = 2 * pi;
      if (angle > 0) arcs_.push_back({numbers_[k], angle, start, end});
    }
    if (cut.to > covered_to) {
      covered_to = cut.to;
      last = &cut;
    }
  }
}

SpherePart SpherePartFinder::find(std::span<const SphericalCap> caps,
                                  std::span<const KnownMeeting> known) {
  arcs_.clear();
  if (std::any_of(caps.begin(), caps.end(),
                  [](const SphericalCap& cap) { return cap.cosine <= -1; }))
    return {};
  keep_distinct(caps);
  if (caps_.empty()) return {4 * pi, {}};
  const std::size_t count = caps_.size();
  if (meetings_.size() < count * count) meetings_.resize(count * count);
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t l = k + 1; l < count; ++l) meetings_[k * count + l] = meet(caps_[k], caps_[l]);
  for (const KnownMeeting& meeting : known) replace(meeting);
  for (std::uint32_t k = 0; k < count; ++k) find_arcs(k);
  if (arcs_.empty()) return {};
  const SphericalCap& largest = *std::min_element(
      caps_.begin(), caps_.end(),
      [](const SphericalCap& a, const SphericalCap& b) { return a.cosine < b.cosine; });
  SpherePart sum;
  for (const RimArc& arc : arcs_) sum += boundary_term(caps[arc.cap], arc, largest.axis);
  sum.solid_angle = solid_angle_of(sum.solid_angle, [&](Vec3 direction) {
    return std::none_of(caps_.begin(), caps_.end(), [&](const SphericalCap& cap) {
      return dot(direction, cap.axis) > cap.cosine;
    });
  });
  return sum;
}

}  // namespace eses::detail
