#include "surface/sphere_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace eses::detail {
namespace {

using std::numbers::pi;

// Numbers of points that are tried, if a great circle touches a cap or passes the end of an arc.
constexpr int max_attempts = 12;

// A great circle that is nearer than this to touching a cap, or to the end of an arc, is not used
// (radians).
constexpr double margin = 1e-7;

// The rims of nearly equal atoms are this close to each other, and the tolerance of the
// accessibility exposes arcs of both (radians).
constexpr double same_rim = 1e-6;

// A point in which a great circle crosses an arc.
struct ArcCrossing {
  double angle;     // along the great circle, in [0, 2 pi)
  bool leaves_cap;  // whether the circle runs into a face
  std::size_t arc;  // its position in the list of arcs
};

// A great circle in ascending direction from `start`. `side` is perpendicular to it.
struct GreatCircle {
  Vec3 start, side;
};

double positive_angle(double angle) { return angle < 0 ? angle + 2 * pi : angle; }

// Returns the radial unit vector at a fraction of an arc.
Vec3 radial_at(const SphereArc& on, double fraction) {
  const double angle = fraction * on.arc.angle;
  return std::cos(angle) * on.arc.start + std::sin(angle) * cross(on.cap.axis, on.arc.start);
}

Vec3 point_at(const SphereArc& on, double fraction) {
  const double c = on.cap.cosine, s = std::sqrt(std::max(0.0, (1 - c) * (1 + c)));
  return c * on.cap.axis + s * radial_at(on, fraction);
}

// Returns nothing if the points are almost equal or opposite.
std::optional<GreatCircle> circle_through(Vec3 start, Vec3 other) {
  const Vec3 across = other - dot(start, other) * start;
  const double length = norm(across);
  if (length < 1e-3) return std::nullopt;
  return GreatCircle{start, (1 / length) * across};
}

// Appends the crossings of a great circle with an arc. Returns whether the circle keeps the margin.
bool add_crossings(const GreatCircle& circle, std::span<const SphereArc> arcs, std::size_t arc,
                   std::vector<ArcCrossing>& crossings) {
  const SphereArc& on = arcs[arc];
  const double c = on.cap.cosine;
  const double along = dot(circle.start, on.cap.axis), across = dot(circle.side, on.cap.axis);
  const double reach = std::hypot(along, across);
  if (std::fabs(reach - std::fabs(c)) < margin * margin) return false;
  if (reach < std::fabs(c)) return true;
  const double middle = std::atan2(across, along), half = std::acos(std::clamp(c / reach, -1., 1.));
  for (const double sign : {-1., 1.}) {
    const double angle = middle + sign * half;
    const Vec3 point = std::cos(angle) * circle.start + std::sin(angle) * circle.side;
    const Vec3 radial = point - c * on.cap.axis;
    if (on.arc.angle < 2 * pi) {
      const double from_start = angle_about(on.cap.axis, on.arc.start, radial);
      const double beyond = from_start - on.arc.angle;
      if (std::min({from_start, std::fabs(beyond), 2 * pi - from_start}) < margin) return false;
      if (beyond > 0) continue;
    }
    crossings.push_back({positive_angle(std::remainder(angle, 2 * pi)), sign > 0, arc});
  }
  return true;
}

// Where several caps start or end at the same rim, the outermost crossing bounds a face. Removes
// the other ones, and calls `unite` for their arcs.
template <class Unite>
void keep_outermost(std::vector<ArcCrossing>& crossings, Unite&& unite) {
  std::vector<ArcCrossing> kept;
  for (const ArcCrossing& crossing : crossings) {
    if (kept.empty() || kept.back().leaves_cap != crossing.leaves_cap ||
        crossing.angle - kept.back().angle > same_rim) {
      kept.push_back(crossing);
      continue;
    }
    unite(kept.back().arc, crossing.arc);
    if (crossing.leaves_cap) kept.back() = crossing;
  }
  crossings.swap(kept);
}

// Replaces `crossings` by all crossings of a great circle, in the order of their angles. Returns
// whether the circle keeps the margin, and faces and caps alternate. Calls `unite` for arcs at
// the same rim.
template <class Unite>
bool find_crossings(const GreatCircle& circle, std::span<const SphereArc> arcs,
                    std::vector<ArcCrossing>& crossings, Unite&& unite) {
  crossings.clear();
  for (std::size_t k = 0; k < arcs.size(); ++k)
    if (!add_crossings(circle, arcs, k, crossings)) return false;
  std::sort(crossings.begin(), crossings.end(),
            [](const ArcCrossing& a, const ArcCrossing& b) { return a.angle < b.angle; });
  const auto alternate = [&] {
    return std::adjacent_find(crossings.begin(), crossings.end(),
                              [](const ArcCrossing& a, const ArcCrossing& b) {
                                return a.leaves_cap == b.leaves_cap;
                              }) == crossings.end();
  };
  if (!alternate()) keep_outermost(crossings, unite);
  for (std::size_t k = 0; k < crossings.size(); ++k)
    if (crossings[k].leaves_cap == crossings[(k + 1) % crossings.size()].leaves_cap) return false;
  return true;
}

// Points without symmetry: the golden ratio spreads them over the sphere.
Vec3 trial_point(int attempt) {
  const double height = 1 - 2 * (attempt + 0.437) / max_attempts;
  const double turn = 2.399963229728653 * attempt + 0.712;
  const double ring = std::sqrt(1 - height * height);
  return {ring * std::cos(turn), ring * std::sin(turn), height};
}

double trial_fraction(int attempt) { return 0.5 + 0.37 * std::sin(2.1 * attempt); }

}  // namespace

SweptArc sweep(const Arc& arc, Vec3 axis) {
  if (arc.kind == ArcKind::full) return {2 * pi, {}};
  double angle = angle_about(axis, arc.start, arc.end);
  // Rounding may exchange an angle of almost 0 and one of almost 2 pi.
  if (arc.kind == ArcKind::minor && angle > 1.5 * pi) angle = 0;
  return {angle, cross(arc.end - arc.start, axis)};
}

SphereArc on_first_sphere(const Arc& arc, const ContactCircle& circle, const SasSphere& first) {
  const bool is_full = arc.kind == ArcKind::full;
  const Vec3 any = is_full ? any_perpendicular(circle.axis) : Vec3();
  return {{circle.axis, circle.first_height / first.radius},
          {0, sweep(arc, circle.axis).angle, is_full ? any : arc.start, is_full ? any : arc.end}};
}

SphereArc on_second_sphere(const Arc& arc, const ContactCircle& circle, const SasSphere& second) {
  SphereArc other = on_first_sphere(arc, circle, second);
  other.cap = {-circle.axis, circle.second_height / second.radius};
  std::swap(other.arc.start, other.arc.end);
  return other;
}

void connect_faces(const LabelledArcs<DisjointSets::Element>& labelled,
                   const std::function<void(DisjointSets::Element, DisjointSets::Element)>& unite) {
  const std::vector<SphereArc>& arcs = labelled.arcs;
  const std::vector<DisjointSets::Element>& labels = labelled.labels;
  const auto unite_arcs = [&](std::size_t a, std::size_t b) { unite(labels[a], labels[b]); };
  std::vector<ArcCrossing> crossings;
  std::vector<DisjointSets::Element> seen;
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    bool is_certain = true;
    std::optional<std::size_t> around_point;  // the face in which all circles start
    seen.clear();
    for (std::size_t k = 0; k < arcs.size(); ++k) {
      if (std::find(seen.begin(), seen.end(), labels[k]) != seen.end()) continue;
      seen.push_back(labels[k]);
      const auto circle =
          circle_through(trial_point(attempt), point_at(arcs[k], trial_fraction(attempt)));
      if (!circle || !find_crossings(*circle, arcs, crossings, unite_arcs)) {
        is_certain = false;
        continue;
      }
      for (std::size_t c = 0; c < crossings.size(); ++c)
        if (crossings[c].leaves_cap)
          unite_arcs(crossings[c].arc, crossings[(c + 1) % crossings.size()].arc);
      if (crossings.empty() || crossings.front().leaves_cap) continue;
      if (around_point) unite_arcs(*around_point, crossings.front().arc);
      around_point = crossings.front().arc;
    }
    if (is_certain) return;
  }
}

std::optional<std::size_t> find_arc_of_face(std::span<const SphereArc> arcs, Vec3 direction) {
  std::vector<ArcCrossing> crossings;
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    const SphereArc& arc = arcs[static_cast<std::size_t>(attempt) % arcs.size()];
    const auto circle = circle_through(direction, point_at(arc, trial_fraction(attempt)));
    if (!circle || !find_crossings(*circle, arcs, crossings, [](auto, auto) {}) ||
        crossings.empty())
      continue;
    if (crossings.front().leaves_cap) return std::nullopt;
    return crossings.front().arc;
  }
  return std::nullopt;
}

std::size_t find_nearest_arc(std::span<const SphereArc> arcs, Vec3 direction) {
  double max_cosine = -std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  const auto visit = [&](std::size_t arc, Vec3 point) {
    const double cosine = dot(point, direction);
    if (cosine <= max_cosine) return;
    max_cosine = cosine;
    nearest = arc;
  };
  for (std::size_t k = 0; k < arcs.size(); ++k) {
    const SphereArc& on = arcs[k];
    const Vec3 across = direction - dot(direction, on.cap.axis) * on.cap.axis;
    const double length = norm(across);
    const Vec3 radial = length > 0 ? (1 / length) * across : on.arc.start;
    if (angle_about(on.cap.axis, on.arc.start, radial) <= on.arc.angle) {
      const double c = on.cap.cosine, s = std::sqrt(std::max(0.0, (1 - c) * (1 + c)));
      visit(k, c * on.cap.axis + s * radial);
    } else {
      visit(k, point_at(on, 0));
      visit(k, point_at(on, 1));
    }
  }
  return nearest;
}

Vec3 middle_of(const SphereArc& arc) { return point_at(arc, 0.5); }

}  // namespace eses::detail
