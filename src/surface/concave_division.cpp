#include "surface/concave_division.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace eses::detail {
namespace {

using std::numbers::pi;

// Decisions by less than this are left to part_of_atom (angstrom, or radians). Rounding errors are
// below 1e-12.
constexpr double decision_margin = 1e-9;

// Points nearer than this are the same end of two arcs.
constexpr double same_end = 1e-7;

// Shorter arcs are points (radians). The rims of placements on one contact circle meet in the
// points where the axis of the circle meets the sphere. Rounding leaves such arcs there.
constexpr double max_point = 1e-9;

// A rim whose sine is smaller is left to part_of_atom: its radial directions lose digits.
constexpr double min_sine = 1e-3;

// The smallest squared absolute value of a factor, see Part.
constexpr double min_squared_factor = 1e-6;

// The most arcs of a patch: they are compared with each other.
constexpr std::size_t max_arcs = 32;

// How often an arc of the boundary is halved to find its owners.
constexpr int max_depth = 3;

using Owner = std::uint32_t;  // index into `touched`

// The circle around a cap. It turns counter-clockwise about the axis.
struct Rim {
  Vec3 axis;
  double cosine = 0, sine = 1;

  explicit Rim(const SphericalCap& cap)
      : axis(cap.axis),
        cosine(cap.cosine),
        sine(std::sqrt(std::max(0.0, (1 - cap.cosine) * (1 + cap.cosine)))) {}
  Vec3 point(Vec3 radial) const { return cosine * axis + sine * radial; }
  Vec3 radial(Vec3 point) const { return (1 / sine) * (point - cosine * axis); }
  Rim opposite() const {
    Rim other = *this;
    other.axis = -axis;
    other.cosine = -cosine;
    return other;
  }
};

// An arc of a rim that bounds a region outside of the cap, counter-clockwise from `start` to `end`.
struct DirectedArc {
  Rim rim;
  Vec3 start, end;  // unit vectors from the centre of the rim
  double angle = 0;
  Vec3 side = cross(rim.axis, start);  // a quarter turn after the start
};

// The sums over the arcs of a region, see BoundaryFunction in sphere_union.cpp. The solid angle is
// -turn - 2 arg(factor) modulo 4 pi.
struct Part {
  double turn = 0;
  std::complex<double> factor = 1;
  bool has_arcs = false;
};

// A place where the border of two atoms meets the boundary of the patch, whose arc turns from the
// first one into the second one.
struct BorderEnd {
  Owner first = 0, second = 0;
  Vec3 point;
};

class Division {
 public:
  Division(const SurfaceModel& surface, Vec3 center, const ConcavePatch& patch) : patch_(patch) {
    for (std::size_t a = 0; a < 3; ++a) {
      const Atom& atom = surface.atoms[patch.touched[a]];
      toward_[a] = atom.center - center;
      radius_[a] = atom.radius;
    }
    const Vec3 sum = patch.toward[0] + patch.toward[1] + patch.toward[2];
    reference_ = normalized(sum);
    is_certain_ = squared_norm(sum) > 0.01;
  }

  // Adds an arc whose ends are the same.
  void add_point(const DirectedArc& arc) { add(owner_of(arc.rim.point(arc.start)), arc); }

  // Divides the patch that these closed curves bound. Each of them is the boundary of one of its
  // pieces, which have no holes.
  std::optional<std::array<double, 3>> divide(std::span<const std::span<const DirectedArc>> loops) {
    find_shared_point();
    for (const std::span<const DirectedArc> loop : loops) {
      end_count_ = 0;
      for (const DirectedArc& arc : loop)
        if (!is_certain_ || !add_arc(arc)) return std::nullopt;
      if (!is_certain_ || !add_borders()) return std::nullopt;
    }
    if (shared_) return std::nullopt;
    return solid_angles();
  }

 private:
  // The direction n belongs to the atom with the smallest value.
  double value(Owner a, Vec3 n) const { return radius_[a] - dot(n, toward_[a]); }

  Owner owner_of(Vec3 n) {
    std::array<double, 3> values{value(0, n), value(1, n), value(2, n)};
    const auto smallest = std::min_element(values.begin(), values.end());
    const auto owner = static_cast<Owner>(smallest - values.begin());
    for (Owner a = 0; a < 3; ++a)
      if (a != owner && values[a] < *smallest + decision_margin) is_certain_ = false;
    return owner;
  }

  // The value of atom `a` less that of atom `b` along an arc: constant + along cos(t) + across
  // sin(t), where t is the angle from the start.
  struct Difference {
    double constant, along, across;

    double slope(double cosine, double sine) const { return across * cosine - along * sine; }
    double reach() const { return std::sqrt(along * along + across * across); }
  };
  Difference difference(Owner a, Owner b, const DirectedArc& arc) const {
    const Vec3 d = toward_[b] - toward_[a];
    return {radius_[a] - radius_[b] + arc.rim.cosine * dot(arc.rim.axis, d),
            arc.rim.sine * dot(arc.start, d), arc.rim.sine * dot(arc.side, d)};
  }

  // Returns whether atom `a` precedes atom `b` everywhere on an arc of at most half a turn at whose
  // ends it does: the difference has one maximum, which is not between the ends, or is negative.
  bool precedes_along(Owner a, Owner b, const DirectedArc& arc) const {
    const Difference of = difference(a, b, arc);
    const double cosine = dot(arc.start, arc.end);
    const double sine = dot(arc.side, arc.end);
    return of.slope(1, 0) <= 0 || of.slope(cosine, sine) >= 0 ||
           of.constant + of.reach() < -decision_margin;
  }

  // Adds an arc of the boundary to its owners. Returns false in doubt.
  bool add_arc(const DirectedArc& arc, int depth = 0) {
    if (arc.rim.sine < min_sine || depth > max_depth) return false;
    if (arc.angle > pi - decision_margin)
      return add_halves(arc, std::cos(arc.angle / 2), std::sin(arc.angle / 2), depth);
    const Owner first = owner_of(arc.rim.point(arc.start));
    const Owner second = owner_of(arc.rim.point(arc.end));
    if (first != second) return add_crossed_arc(arc, first, second, depth);
    for (Owner other = 0; other < 3; ++other) {
      if (other == first || precedes_along(first, other, arc)) continue;
      return add_around_maximum(first, other, arc, depth);
    }
    add(first, arc);
    return true;
  }

  // Adds an arc within which the value of atom `a` less that of atom `b` has its maximum.
  bool add_around_maximum(Owner a, Owner b, const DirectedArc& arc, int depth) {
    const Difference of = difference(a, b, arc);
    const double inverse = 1 / of.reach();
    return add_halves(arc, inverse * of.along, inverse * of.across, depth);
  }

  // Adds the parts of an arc on both sides of the point at this angle.
  bool add_halves(const DirectedArc& arc, double cosine, double sine, int depth) {
    const auto& [low, high] = halves(arc, cosine, sine);
    return low.angle >= 0 && high.angle >= 0 && add_arc(low, depth + 1) && add_arc(high, depth + 1);
  }
  static std::pair<DirectedArc, DirectedArc> halves(const DirectedArc& arc, double cosine,
                                                    double sine) {
    DirectedArc low = arc, high = arc;
    low.end = high.start = cosine * arc.start + sine * arc.side;
    high.side = cosine * arc.side - sine * arc.start;
    if (arc.rim.cosine != 0) {
      low.angle = std::atan2(sine, cosine);
      high.angle = arc.angle - low.angle;
    }
    return {low, high};
  }

  // Adds an arc with two owners at its ends. They have the same value in one point of it. If that
  // belongs to the third atom, the arc has three owners.
  bool add_crossed_arc(const DirectedArc& arc, Owner first, Owner second, int depth) {
    const Difference of = difference(first, second, arc);
    const double squared = of.along * of.along + of.across * of.across;
    const double chord = std::sqrt(std::max(0.0, squared - of.constant * of.constant));
    const double cosine = (of.across * chord - of.along * of.constant) / squared;
    const double sine = -(of.along * chord + of.across * of.constant) / squared;
    const auto& [low, high] = halves(arc, cosine, sine);
    const Vec3 point = arc.rim.point(low.end);
    const Owner third = 3 - first - second;
    const double lead = value(third, point) - value(first, point);
    if (lead < -decision_margin) return add_halves(arc, cosine, sine, depth);
    if (!(lead > decision_margin) || low.angle < 0 || high.angle < 0) return false;
    if (!precedes_along(first, third, low)) return add_around_maximum(first, third, arc, depth);
    if (!precedes_along(second, third, high)) return add_around_maximum(second, third, arc, depth);
    if (end_count_ == ends_.size()) return false;
    add(first, low);
    add(second, high);
    ends_[end_count_++] = {first, second, point};
    return true;
  }

  // The factor of an arc of a great circle is that of the triangle of its chord and the reference.
  void add(Owner owner, const DirectedArc& arc) {
    const Rim& rim = arc.rim;
    std::complex<double> factor;
    if (rim.cosine == 0) {
      factor = {1 + dot(arc.start, arc.end) + dot(reference_, arc.start + arc.end),
                dot(reference_, cross(arc.start, arc.end))};
    } else {
      const double slope = rim.sine / (1 + rim.cosine);
      const auto function = [&](Vec3 radial) {
        return std::complex<double>(1 + dot(reference_, rim.axis) + slope * dot(reference_, radial),
                                    -slope * dot(reference_, cross(rim.axis, radial)));
      };
      factor = function(arc.start) * std::conj(function(arc.end));
      parts_[owner].turn += arc.angle * (1 - rim.cosine);
    }
    if (!(std::norm(factor) > min_squared_factor)) is_certain_ = false;
    parts_[owner].factor *= factor;
    parts_[owner].has_arcs = true;
  }

  // Adds the part of the border of two atoms from `start` to `end` to both. It is counter-clockwise
  // about the direction from the first to the second one.
  bool add_border(Owner first, Owner second, Vec3 start, Vec3 end) {
    const Vec3 d = toward_[second] - toward_[first];
    const double length = norm(d);
    if (length < decision_margin) return false;
    const double cosine = (radius_[second] - radius_[first]) / length;
    const Rim rim({(1 / length) * d, std::clamp(cosine, -1.0, 1.0)});
    if (rim.sine < min_sine || squared_norm(end - start) < same_end * same_end) return false;
    DirectedArc arc{rim, rim.radial(start), rim.radial(end), 0};
    const double sine = dot(rim.axis, cross(arc.start, arc.end));
    if (rim.cosine != 0)
      arc.angle = angle_about(rim.axis, arc.start, arc.end);
    else if (sine < decision_margin)
      return false;
    add(first, arc);
    std::swap(arc.start, arc.end);
    arc.rim = rim.opposite();
    add(second, arc);
    return true;
  }

  // Adds the borders in a piece of the patch. If each has one end, all lead from there to the point
  // that the atoms share. Otherwise each connects its two ends.
  bool add_borders() {
    std::array<std::array<const BorderEnd*, 2>, 3> ends{};  // by the third atom
    std::array<std::size_t, 3> counts{};
    for (std::size_t k = 0; k < end_count_; ++k) {
      const Owner third = 3 - ends_[k].first - ends_[k].second;
      if (counts[third] == ends[third].size()) return false;
      ends[third][counts[third]++] = &ends_[k];
    }
    const bool is_shared = counts == std::array<std::size_t, 3>{1, 1, 1};
    const std::optional<Vec3> shared =
        is_shared ? std::exchange(shared_, std::nullopt) : std::nullopt;
    for (Owner third = 0; third < 3; ++third) {
      if (counts[third] == 0) continue;
      if (counts[third] != (shared ? 1U : 2U)) return false;
      const BorderEnd& from = *ends[third][0];
      if (!shared && ends[third][1]->first == from.first) return false;
      if (!add_border(from.first, from.second, from.point,
                      shared ? *shared : ends[third][1]->point))
        return false;
    }
    return true;
  }

  // Finds the point of the patch that has the same value for all three atoms. There are at most two
  // on the sphere. If both are in the patch, the division is not certain.
  void find_shared_point() {
    const Vec3 u = toward_[1] - toward_[0], v = toward_[2] - toward_[0], w = cross(u, v);
    const double c = radius_[1] - radius_[0], d = radius_[2] - radius_[0];
    const double squared = squared_norm(w);
    if (!(squared > decision_margin)) is_certain_ = false;
    const Vec3 foot = (1 / squared) * (c * cross(v, w) + d * cross(w, u));
    const double rest = 1 - squared_norm(foot);
    if (std::fabs(rest) < decision_margin) is_certain_ = false;
    if (!is_certain_ || rest < 0) return;
    const Vec3 offset = std::sqrt(rest / squared) * w;
    const bool has_low = contains(foot - offset), has_high = contains(foot + offset);
    if (has_low && has_high) is_certain_ = false;
    if (has_low || has_high) shared_ = has_low ? foot - offset : foot + offset;
  }

  bool contains(Vec3 n) {
    double min_room = 2;
    for (const SphericalCap& cap : patch_.caps)
      min_room = std::min(min_room, cap.cosine - dot(n, cap.axis));
    if (std::fabs(min_room) < decision_margin) is_certain_ = false;
    return min_room > 0;
  }

  // The last of the atoms that have a part gets the rest.
  std::optional<std::array<double, 3>> solid_angles() const {
    std::array<double, 3> result{};
    if (!is_certain_) return std::nullopt;
    double rest = patch_.part.solid_angle;
    Owner last = 0;
    for (Owner a = 0; a < 3; ++a)
      if (parts_[a].has_arcs) last = a;
    for (Owner a = 0; a < last; ++a) {
      if (!parts_[a].has_arcs) continue;
      const double turns = (-parts_[a].turn - 2 * std::arg(parts_[a].factor)) / (4 * pi);
      double angle = 4 * pi * (turns - std::floor(turns));
      if (angle > 4 * pi - decision_margin) angle = 0;
      if (angle > rest + decision_margin) return std::nullopt;
      result[a] = std::min(angle, rest);
      rest -= result[a];
    }
    result[last] = rest;
    return result;
  }

  const ConcavePatch& patch_;
  std::array<Vec3, 3> toward_;  // from the probe's centre to the atoms
  std::array<double, 3> radius_{};
  Vec3 reference_;
  std::array<Part, 3> parts_;
  std::array<BorderEnd, 6> ends_;
  std::size_t end_count_ = 0;
  std::optional<Vec3> shared_;  // the point that all atoms share, until a piece has it
  bool is_certain_ = true;
};

// Returns an edge of a triangle. Its sides are bounded by the caps in the order of its corners.
DirectedArc edge(const ConcavePatch& patch, std::size_t k) {
  const Rim rim(patch.caps[k]);
  Vec3 start = patch.toward[k], end = patch.toward[(k + 1) % 3];
  if (dot(rim.axis, cross(start, end)) < 0) std::swap(start, end);
  return {rim, start, end, 0};
}

// Sorts the arcs, so that those of each closed curve follow each other. Returns the curves, or
// nothing in doubt.
std::vector<std::span<const DirectedArc>> sort_into_loops(std::span<DirectedArc> arcs) {
  std::vector<std::span<const DirectedArc>> loops;
  std::size_t begin = 0;
  for (std::size_t at = 0; at < arcs.size(); ++at) {
    const Vec3 point = arcs[at].rim.point(arcs[at].end);
    std::size_t next = arcs.size(), found = 0;
    for (std::size_t k = 0; k < arcs.size(); ++k) {
      if (squared_norm(arcs[k].rim.point(arcs[k].start) - point) > same_end * same_end) continue;
      next = k;
      ++found;
    }
    if (found != 1 || (next <= at && next != begin)) return {};
    if (next == begin) {
      loops.push_back(arcs.subspan(begin, at + 1 - begin));
      begin = at + 1;
    } else {
      std::swap(arcs[at + 1], arcs[next]);
    }
  }
  return begin == arcs.size() ? loops : std::vector<std::span<const DirectedArc>>();
}

// Returns whether each of several curves has a part of an edge of the triangle. None of them then
// bounds a hole: a hole that reaches an edge is a part of the outside.
bool are_without_holes(std::span<const std::span<const DirectedArc>> loops) {
  return loops.size() == 1 || std::all_of(loops.begin(), loops.end(), [](const auto& loop) {
           return std::any_of(loop.begin(), loop.end(),
                              [](const DirectedArc& arc) { return arc.rim.cosine == 0; });
         });
}

}  // namespace

std::optional<std::array<double, 3>> divide_among_three(const SurfaceModel& surface, Vec3 center,
                                                        const ConcavePatch& patch,
                                                        std::span<const RimArc> arcs) {
  Division division(surface, center, patch);
  if (patch.cutters.empty()) {
    const std::array<DirectedArc, 3> edges{edge(patch, 0), edge(patch, 1), edge(patch, 2)};
    const std::span<const DirectedArc> loop(edges);
    return division.divide({&loop, 1});
  }
  if (arcs.size() > max_arcs) return std::nullopt;
  std::vector<DirectedArc> directed;
  for (const RimArc& arc : arcs) {
    const Rim rim(patch.caps[arc.cap]);
    const DirectedArc added{rim, arc.start, arc.end, arc.angle};
    if (arc.angle * rim.sine < max_point)
      division.add_point(added);
    else
      directed.push_back(added);
  }
  const auto loops = sort_into_loops(directed);
  if (loops.empty() || !are_without_holes(loops)) return std::nullopt;
  return division.divide(loops);
}

}  // namespace eses::detail
