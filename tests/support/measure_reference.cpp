#include "support/measure_reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace eses::detail::test {
namespace {

using Real = long double;
constexpr Real pi = std::numbers::pi_v<Real>;

struct Point {
  Real x = 0, y = 0, z = 0;

  friend Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Point operator*(Real s, Point a) { return {s * a.x, s * a.y, s * a.z}; }
};

Real dot(Point a, Point b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Point cross(Point a, Point b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real length(Point a) { return std::sqrt(dot(a, a)); }

struct Ball {
  Point center;
  Real radius, sas_radius;
};

// The directions n with n . axis > cosine.
struct Hidden {
  Point axis;
  Real cosine;
};

// A circle of a sphere, and its points at the angles from `begin` to `end`.
struct Piece {
  std::size_t cap;
  Real begin, end;
  Point e, f;  // the point at the angle t is in the direction cos t e + sin t f from the axis
  Point along(Real angle) const { return std::cos(angle) * e + std::sin(angle) * f; }
};

struct Region {
  Real area = 0;
  Point vector;
  std::vector<Piece> boundary;
};

Piece whole_circle(std::size_t cap, Point axis) {
  const Point some = std::fabs(axis.x) < 0.6L ? Point{1, 0, 0} : Point{0, 1, 0};
  const Point across = cross(axis, some);
  const Point e = (1 / length(across)) * across;
  return {cap, 0, 2 * pi, e, cross(axis, e)};
}

// Returns the parts of the circle of a cap that no other cap hides.
std::vector<Piece> visible_pieces(const std::vector<Hidden>& caps, std::size_t k) {
  const Piece circle = whole_circle(k, caps[k].axis);
  const Real c = caps[k].cosine, s = std::sqrt((1 - c) * (1 + c));
  std::vector<std::array<Real, 2>> hidden;
  for (std::size_t l = 0; l < caps.size(); ++l) {
    if (l == k) continue;
    const Real x = s * dot(circle.e, caps[l].axis), y = s * dot(circle.f, caps[l].axis);
    const Real clearance = caps[l].cosine - c * dot(caps[k].axis, caps[l].axis);
    const Real reach = std::hypot(x, y);
    if (clearance >= reach) continue;
    if (clearance <= -reach) return {};
    const Real middle = std::atan2(y, x), half = std::acos(clearance / reach);
    const Real begin = middle - half - 2 * pi * std::floor((middle - half) / (2 * pi));
    hidden.push_back({begin, begin + 2 * half});
  }
  if (hidden.empty()) return {circle};
  std::sort(hidden.begin(), hidden.end());
  Real covered = 0;
  for (const auto& [begin, end] : hidden) covered = std::max(covered, end - 2 * pi);
  std::vector<Piece> pieces;
  const auto add = [&](Real begin, Real end) {
    Piece& piece = pieces.emplace_back(circle);
    piece.begin = begin, piece.end = end;
  };
  const Real first = hidden.front()[0] + 2 * pi;
  covered = std::max(covered, hidden.front()[1]);
  for (const auto& [begin, end] : hidden) {
    if (begin > covered) add(covered, begin);
    covered = std::max(covered, end);
  }
  if (covered < first) add(covered, first);
  return pieces;
}

Real triangle(Point a, Point b, Point c) {
  return 2 * std::atan2(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

// Returns the part of the unit sphere outside of all caps. Each piece of the boundary sweeps an
// area as seen from a point, which is opposite to the axis of the largest cap.
Region outside_of(const std::vector<Hidden>& all) {
  Region region;
  std::vector<Hidden> caps;
  std::vector<std::size_t> index;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].cosine <= -1) return region;
    if (all[k].cosine >= 1) continue;
    caps.push_back(all[k]);
    index.push_back(k);
  }
  if (caps.empty()) {
    region.area = 4 * pi;
    return region;
  }
  const Point axis = std::min_element(caps.begin(), caps.end(), [](const auto& a, const auto& b) {
                       return a.cosine < b.cosine;
                     })->axis;
  const Point turned = whole_circle(0, axis).along(0.3L);
  const Point from = -1 * (std::cos(0.01L) * axis + std::sin(0.01L) * turned);
  for (std::size_t k = 0; k < caps.size(); ++k)
    for (Piece piece : visible_pieces(caps, k)) {
      const Point u = caps[k].axis;
      const Real c = caps[k].cosine, s = std::sqrt((1 - c) * (1 + c));
      const Real angle = piece.end - piece.begin;
      const int steps = 1 + static_cast<int>(angle);
      const auto at = [&](int step) {
        return c * u + s * piece.along(piece.begin + angle * step / steps);
      };
      for (int step = 0; step < steps; ++step) {
        const Point p = at(step), q = at(step + 1);
        region.area -= angle / steps * (1 - c) - triangle(u, p, q) + triangle(from, p, q);
      }
      const Point swept = cross(piece.along(piece.end) - piece.along(piece.begin), u);
      region.vector = region.vector + (0.5L * s * c) * swept - (0.5L * s * s * angle) * u;
      piece.cap = index[k];
      region.boundary.push_back(piece);
    }
  if (region.boundary.empty()) return region;
  region.area -= 4 * pi * std::floor(region.area / (4 * pi));
  // A part of almost nothing or almost the whole sphere: the opposite of all arcs decides.
  if (region.area > 4 * pi - 1e-5L &&
      std::any_of(caps.begin(), caps.end(), [&](const Hidden& cap) { return cap.cosine < 0.9L; }))
    region.area -= 4 * pi;
  return region;
}

Point point_of(Vec3 v) { return {v.x, v.y, v.z}; }

struct Placement {
  std::array<std::size_t, 3> atoms;
  int side;
  Point center;
};

struct Sums {
  Real convex = 0, saddle = 0, concave = 0, volume = 0, sas_area = 0, sas_volume = 0;
};

// Adds the saddle patch of an arc. With the angle t at the probe's centre, from the direction to
// the axis towards the second atom, its points are m + (rho - p cos t) e + p sin t u.
void add_saddle(Point m, Point u, Real rho, Real p, Real low, Real high, Real angle, Point radial,
                Sums& sums) {
  std::vector<std::array<Real, 2>> ranges{{low, high}};
  if (rho < p) {
    const Real cusp = std::acos(rho / p);
    ranges = {{low, std::min(high, -cusp)}, {std::max(low, cusp), high}};
  }
  for (const auto& [x, y] : ranges) {
    if (y <= x) continue;
    const Real one = y - x, cosine = std::sin(y) - std::sin(x), sine = std::cos(x) - std::cos(y);
    const Real cosine_2 = (one + (std::sin(2 * y) - std::sin(2 * x)) / 2) / 2;
    const Real sine_cosine = (std::cos(2 * x) - std::cos(2 * y)) / 4;
    const Real weight = rho * one - p * cosine, weight_cosine = rho * cosine - p * cosine_2;
    const Real weight_sine = rho * sine - p * sine_cosine;
    sums.saddle += angle * p * weight;
    sums.volume += p / 3 *
                   (dot(m, radial) * weight_cosine - angle * dot(m, u) * weight_sine +
                    angle * (rho * weight_cosine - p * weight));
  }
}

void add_face(const std::vector<Ball>& balls, std::size_t i, Real p, Sums& sums,
              std::vector<Placement>& placements) {
  const Ball& ball = balls[i];
  const Real R = ball.sas_radius, r = ball.radius;
  std::vector<Hidden> caps;
  std::vector<std::size_t> of;
  for (std::size_t j = 0; j < balls.size(); ++j) {
    const Point to = balls[j].center - ball.center;
    const Real d = length(to), S = balls[j].sas_radius;
    if (j == i || d >= R + S || d <= R - S) continue;
    caps.push_back({(1 / d) * to, (d * d + (R - S) * (R + S)) / (2 * d * R)});
    of.push_back(j);
  }
  const Region face = outside_of(caps);
  sums.convex += r * r * face.area;
  sums.sas_area += R * R * face.area;
  const Real along = dot(ball.center, face.vector);
  sums.volume += r * r * (r * face.area + along) / 3;
  sums.sas_volume += R * R * (R * face.area + along) / 3;
  for (const Piece& piece : face.boundary) {
    const std::size_t j = of[piece.cap];
    if (j < i) continue;
    const auto [u, c] = caps[piece.cap];
    const Real h = R * c, rho = R * std::sqrt((1 - c) * (1 + c));
    const Real d = length(balls[j].center - ball.center);
    const Point radial = cross(piece.along(piece.end) - piece.along(piece.begin), u);
    add_saddle(ball.center + h * u, u, rho, p, -std::atan2(h, rho), std::atan2(d - h, rho),
               piece.end - piece.begin, radial, sums);
    if (piece.end - piece.begin >= 2 * pi) continue;
    for (const Real end : {piece.begin, piece.end}) {
      const Point center = ball.center + h * u + rho * piece.along(end);
      std::size_t third = i;  // its sphere is nearest to the end
      Real min_gap = 1;
      for (const std::size_t k : of) {
        if (k == j) continue;
        const Real gap = std::fabs(length(center - balls[k].center) - balls[k].sas_radius);
        if (gap < min_gap) min_gap = gap, third = k;
      }
      std::array<std::size_t, 3> atoms{i, j, third};
      std::sort(atoms.begin(), atoms.end());
      const Point a = balls[atoms[0]].center;
      const Real height =
          dot(center - a, cross(balls[atoms[1]].center - a, balls[atoms[2]].center - a));
      placements.push_back({atoms, height > 0 ? 1 : -1, center});
    }
  }
}

void add_concave_patch(const std::vector<Ball>& balls, const std::vector<Placement>& placements,
                       std::size_t number, Real p, Sums& sums) {
  const Placement& placement = placements[number];
  std::array<Point, 3> to;
  for (std::size_t q = 0; q < 3; ++q) to[q] = balls[placement.atoms[q]].center - placement.center;
  const Real sign = dot(to[0], cross(to[1], to[2])) < 0 ? 1 : -1;
  std::vector<Hidden> caps;
  for (std::size_t q = 0; q < 3; ++q) {
    const Point normal = cross(to[q], to[(q + 1) % 3]);
    caps.push_back({(sign / length(normal)) * normal, 0});
  }
  for (std::size_t k = 0; k < placements.size(); ++k) {
    const Point other = placements[k].center - placement.center;
    const Real distance = length(other);
    if (k != number && distance < 2 * p)
      caps.push_back({(1 / distance) * other, distance / (2 * p)});
  }
  const Region patch = outside_of(caps);
  sums.concave += p * p * patch.area;
  sums.volume -= p * p * (dot(placement.center, patch.vector) + p * patch.area) / 3;
}

}  // namespace

Measures measure_by_definition(const std::vector<Atom>& atoms, double probe_radius) {
  const Real p = probe_radius;
  std::vector<Ball> balls;
  for (const Atom& atom : atoms) {
    const Real r = atom.radius;
    const Point center = point_of(atom.center);
    const auto contains = [&](const Ball& outer, const Ball& inner) {
      return length(outer.center - inner.center) <= outer.radius - inner.radius;
    };
    const Ball ball{center, r, r + p};
    if (std::any_of(balls.begin(), balls.end(), [&](const Ball& b) { return contains(b, ball); }))
      continue;
    std::erase_if(balls, [&](const Ball& b) { return contains(ball, b); });
    balls.push_back(ball);
  }
  Sums sums;
  std::vector<Placement> placements;
  for (std::size_t i = 0; i < balls.size(); ++i) add_face(balls, i, p, sums, placements);
  const auto key = [](const Placement& a) { return std::pair(a.atoms, a.side); };
  std::sort(placements.begin(), placements.end(),
            [&](const Placement& a, const Placement& b) { return key(a) < key(b); });
  placements.erase(
      std::unique(placements.begin(), placements.end(),
                  [&](const Placement& a, const Placement& b) { return key(a) == key(b); }),
      placements.end());
  for (std::size_t k = 0; k < placements.size(); ++k)
    add_concave_patch(balls, placements, k, p, sums);
  Measures measures;
  measures.ses_areas = {static_cast<double>(sums.convex), static_cast<double>(sums.saddle),
                        static_cast<double>(sums.concave)};
  measures.ses_area = static_cast<double>(sums.convex + sums.saddle + sums.concave);
  measures.ses_volume = static_cast<double>(sums.volume);
  measures.sas_area = static_cast<double>(sums.sas_area);
  measures.sas_volume = static_cast<double>(sums.sas_volume);
  return measures;
}

}  // namespace eses::detail::test
