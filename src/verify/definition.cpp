#include "verify/definition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace eses::detail::verify {
namespace {

/// Centres that are nearer to each other than this are the same, in angstrom.
constexpr double same_center = 1e-6;
constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// Upper bound of the rounding error of a candidate's distance from a ball's centre, relative to
/// the lengths involved.
constexpr double distance_rounding = 256 * epsilon;
/// Usual maximum of this rounding error, for ill-conditioned candidates that amplify it.
constexpr double usual_rounding = 16 * epsilon;
/// A cell is not halved if at most this many balls meet it.
constexpr std::size_t max_leaf_balls = 5;
/// A cell is not halved either if at most `max_tried_balls` meet it and the last `max_stalled`
/// halvings separated none of them. If more balls meet a cell of the minimum size, only those that
/// cover its centre most are used.
constexpr std::size_t max_tried_balls = 32;
constexpr int max_stalled = 3;

double sum_norm(Vec3 v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); }

double square_of(double length) { return length > 0 ? length * length : 0; }

double max_radius_of(std::span<const Atom> atoms) {
  double result = 0;
  for (const Atom& atom : atoms) result = std::max(result, atom.radius);
  return result;
}

}  // namespace

Definition::Definition(std::span<const Atom> all_atoms, double probe,
                       std::function<bool(Vec3)> in_filled_cavity)
    : atoms(all_atoms),
      probe_radius(probe),
      max_radius(max_radius_of(all_atoms)),
      cells(all_atoms, max_radius + 2 * probe),
      is_filled(std::move(in_filled_cavity)) {}

// Collects the SAS balls within reach of x.
CentreSearch::Surroundings CentreSearch::gather(Vec3 x) {
  balls_.clear();
  bool is_accessible_here = true, is_covered = false;
  const double probe = definition_.probe_radius;
  const double farthest = definition_.max_radius + probe + reach_;
  definition_.cells.for_each_near(x, farthest, [&](const Atom& atom) {
    Ball ball;
    ball.center = atom.center - x;
    ball.radius = atom.radius + probe - access_.shrinkage;
    const double square = squared_norm(ball.center), outer = ball.radius + reach_;
    if (outer <= 0 || square >= outer * outer) return;
    ball.power = square - ball.radius * ball.radius;
    const double limit =
        ball.radius - std::max(access_.tolerance, distance_rounding * (ball.radius + reach_));
    ball.min_square = square_of(limit);
    ball.uncertain_square = square_of(limit - access_.max_uncertainty);
    const double inner = limit - access_.max_uncertainty - reach_;
    if (inner >= 0 && square <= inner * inner) is_covered = true;
    if (square < ball.min_square) is_accessible_here = false;
    balls_.push_back(ball);
  });
  if (is_accessible_here) return Surroundings::accessible;
  if (is_covered) return Surroundings::covered;
  order_balls();
  return Surroundings::mixed;
}

// Returns whether `other` covers all points c that `ball` covers and for which
// |(c - center) . v| <= extent, with the vector v between the centres of the balls. This holds if
// the power of no such point is lower for `ball`. The rounding error is proportional to the
// differences of the balls, so equal balls dominate each other, and balls at any distance are
// distinguished.
bool CentreSearch::is_dominated(const Ball& ball, const Ball& other, Vec3 center, double extent) {
  const Vec3 between = ball.center - other.center;
  const Vec3 sum = (ball.center - center) + (other.center - center);
  const double difference = ball.radius - other.radius, radii = ball.radius + other.radius;
  const double ahead = dot(between, sum) - difference * radii - 2 * extent;
  if (ahead < 0) return false;
  const double apart = sum_norm(between);
  const double rounding =
      8 * epsilon * (apart * (sum_norm(sum) + apart) + std::fabs(difference) * radii);
  return ahead >= rounding;
}

// Orders the balls: first those with the lowest power at x, then some from all directions. One of
// them covers most of the cells that any ball covers. Drops the balls that the first one dominates
// within reach.
void CentreSearch::order_balls() {
  constexpr std::size_t deepest = 8, from_everywhere = 64;
  const std::size_t stride = balls_.size() / from_everywhere + 1;
  for (std::size_t i = 0; i * stride < balls_.size(); ++i) std::swap(balls_[i], balls_[i * stride]);
  const auto middle =
      balls_.begin() + static_cast<std::ptrdiff_t>(std::min(deepest, balls_.size()));
  std::partial_sort(balls_.begin(), middle, balls_.end(),
                    [](const Ball& a, const Ball& b) { return a.power < b.power; });
  const Ball first = balls_.front();
  balls_.erase(std::remove_if(balls_.begin() + 1, balls_.end(),
                              [&](const Ball& ball) {
                                return is_dominated(ball, first, {},
                                                    reach_ * norm(ball.center - first.center));
                              }),
               balls_.end());
}

// Returns the length by which cells overlap, so that rounding loses no centre between them.
double CentreSearch::margin() const {
  constexpr double share_of_reach = 1e-11, share_of_radius = 1e-14;
  return share_of_reach * reach_ +
         share_of_radius * (definition_.max_radius + definition_.probe_radius);
}

// Returns whether a ball covers the whole cell. The balls that meet the parent cell are the
// elements [begin, end) of `around_`. If no ball covers the cell, appends the balls that meet it
// and that no other ball dominates. Dropping dominated balls allows larger cells.
bool CentreSearch::is_covered_or_keep(const Cell& cell, std::size_t begin, std::size_t end) {
  const double half = cell.half + margin();
  for (std::size_t i = begin; i < end; ++i) {
    const Ball& ball = balls_[around_[i]];
    const Vec3 w = ball.center - cell.center;
    double nearest_square = 0, farthest_square = 0;
    for (std::size_t q = 0; q < 3; ++q) {
      const double along = std::fabs(w[q]), outside = std::max(0.0, along - half);
      nearest_square += outside * outside;
      farthest_square += (along + half) * (along + half);
    }
    if (farthest_square < ball.uncertain_square) return true;
    if (nearest_square <= ball.radius * ball.radius) around_.push_back(around_[i]);
  }
  drop_dominated(cell, end);
  return false;
}

// Drops the balls from `begin` on that a reference ball dominates in the cell. The reference is the
// ball with the lowest power. If two halvings separated no balls, further references are used, as
// each cluster of almost coincident balls needs its own.
void CentreSearch::drop_dominated(const Cell& cell, std::size_t begin) {
  const std::size_t max_references = cell.stalled > 1 ? 4 : 1;
  const double half = cell.half + margin();
  const auto power_at = [&](std::uint32_t i) {
    return squared_norm(balls_[i].center - cell.center) - balls_[i].radius * balls_[i].radius;
  };
  for (std::size_t r = begin; r < begin + max_references && around_.size() > r + 1; ++r) {
    if (r > begin && around_.size() - begin <= max_leaf_balls) return;
    std::size_t lowest = r;
    double lowest_power = power_at(around_[r]);
    for (std::size_t i = r + 1; i < around_.size(); ++i)
      if (const double power = power_at(around_[i]); power < lowest_power) {
        lowest_power = power;
        lowest = i;
      }
    std::swap(around_[r], around_[lowest]);
    const Ball& reference = balls_[around_[r]];
    const auto is_needless = [&](std::uint32_t i) {
      const Vec3 between = balls_[i].center - reference.center;
      return is_dominated(balls_[i], reference, cell.center, half * sum_norm(between));
    };
    const auto first = around_.begin() + static_cast<std::ptrdiff_t>(r + 1);
    around_.erase(std::remove_if(first, around_.end(), is_needless), around_.end());
  }
}

// Returns the maximum displacement of a centre by rounding. It is the rounding error of a distance,
// divided by the sine of the angle between the directions to the two centres, or by the determinant
// of the three directions.
double CentreSearch::uncertainty_of(Vec3 c, const Origin& origin) const {
  if (origin.count < 2) return 0;
  std::array<Vec3, 3> to_center{};
  double scale = reach_;
  for (int i = 0; i < origin.count; ++i) {
    const Ball& ball = *origin.balls[static_cast<std::size_t>(i)];
    to_center[static_cast<std::size_t>(i)] = (1 / ball.radius) * (ball.center - c);
    scale = std::max(scale, ball.radius);
  }
  const Vec3 normal = cross(to_center[0], to_center[1]);
  const double condition = origin.count == 2 ? norm(normal) : std::fabs(dot(normal, to_center[2]));
  const double moved = usual_rounding * scale;
  return moved < condition * access_.max_uncertainty ? moved / condition : access_.max_uncertainty;
}

bool CentreSearch::is_in(const Cell& cell, Vec3 c, double margin) {
  const double half = cell.half + margin;
  return std::fabs(c.x - cell.center.x) <= half && std::fabs(c.y - cell.center.y) <= half &&
         std::fabs(c.z - cell.center.z) <= half;
}

bool CentreSearch::is_accessible(Vec3 c, const Origin& origin, std::span<const Ball> balls) const {
  double uncertainty = -1;  // not known yet
  for (const Ball& ball : balls) {
    const double square = squared_norm(c - ball.center);
    if (square >= ball.min_square) continue;
    if (square < ball.uncertain_square) return false;
    if (uncertainty < 0) uncertainty = uncertainty_of(c, origin);
    if (square < square_of(std::sqrt(ball.min_square) - uncertainty)) return false;
  }
  return true;
}

// Tests a centre (relative to x) against all atoms in extended precision. The search has dropped
// balls that are covered by others up to rounding.
bool CentreSearch::is_certain(Vec3 x, Vec3 c) const {
  bool is_certain = true;
  const double probe = definition_.probe_radius;
  definition_.cells.for_each_near(x + c, definition_.max_radius + probe, [&](const Atom& atom) {
    const Vec3 center = atom.center - x;
    const long double dx = static_cast<long double>(c.x) - center.x;
    const long double dy = static_cast<long double>(c.y) - center.y;
    const long double dz = static_cast<long double>(c.z) - center.z;
    const double radius = atom.radius + probe;
    const auto depth = static_cast<double>(radius - std::sqrt(dx * dx + dy * dy + dz * dz));
    const double limit = std::max(access_.tolerance, distance_rounding * (radius + reach_));
    if (depth > access_.shrinkage + limit) is_certain = false;
  });
  return is_certain;
}

// Visits `c` if it is in the cell, within reach and accessible. Returns false if the search ends. A
// centre that rounding has moved out of its cell is tested against all balls.
template <class Visit>
bool CentreSearch::try_candidate(const Cell& cell, Vec3 c, const Origin& origin, Visit& visit) {
  const double stray = 1e-6 * reach_ + access_.max_uncertainty;
  if (!is_in(cell, c, stray) || squared_norm(c) >= reach_ * reach_) return true;
  if (!is_accessible(c, origin, near_)) return true;
  if (!is_in(cell, c, margin()) && !is_accessible(c, origin, balls_)) return true;
  return visit(c);
}

// Returns the circle in which two spheres meet, or nothing if they do not meet within reach.
std::optional<CentreSearch::Circle> CentreSearch::circle_of(const Ball& one,
                                                            const Ball& other) const {
  const Vec3 between = other.center - one.center;
  const double square = squared_norm(between), difference = other.power - one.power;
  if (difference * difference >= 4 * reach_ * reach_ * square ||
      square < no_direction * no_direction)
    return std::nullopt;
  const double distance = std::sqrt(square), a = one.radius, b = other.radius;
  const double along = (square + (a - b) * (a + b)) / (2 * distance);
  const double radius_square = (a - along) * (a + along);
  if (radius_square <= 0) return std::nullopt;
  const Vec3 axis = (1 / distance) * between;
  return Circle{one.center + along * axis, axis, std::sqrt(radius_square)};
}

// Tries the circle's point nearest to x, and its common points with the spheres of later balls.
template <class Visit>
bool CentreSearch::visit_circle(const Cell& cell, const Circle& circle, std::size_t one,
                                std::size_t other, Visit& visit) {
  const double height = dot(circle.center, circle.axis), rho = circle.radius;
  const Vec3 inward = height * circle.axis - circle.center;  // to x, projected onto the plane
  const double aside = norm(inward);
  const double gap = rho - aside;
  if (height * height + gap * gap >= reach_ * reach_) return true;
  Vec3 e = aside > no_direction ? (1 / aside) * inward : any_perpendicular(circle.axis);
  // Close to the axis, the component of `inward` along the axis is a rounding error that 1 / aside
  // amplifies.
  e = normalized(e - dot(e, circle.axis) * circle.axis);
  const Vec3 f = cross(circle.axis, e);
  Origin origin{{&near_[one], &near_[other], nullptr}, 2};
  if (!try_candidate(cell, circle.center + rho * e, origin, visit)) return false;
  origin.count = 3;
  for (std::size_t k = other + 1; k < std::min(near_.size(), max_tried_balls); ++k) {
    const Ball& ball = near_[k];
    origin.balls[2] = &ball;
    // At the angle t on the circle, the squared distance from the ball's centre is
    // square + 2 rho (a cos t + b sin t).
    const Vec3 w = circle.center - ball.center;
    const double square = squared_norm(w) + rho * rho, a = dot(w, e), b = dot(w, f);
    const double amplitude = std::sqrt(a * a + b * b);
    if (amplitude < no_direction) continue;
    const double span = 2 * rho * amplitude;
    const double sought = ball.radius * ball.radius - square;
    // If the circle misses the sphere by less than the tolerance, its nearest point is used.
    if (std::fabs(sought) - span > 2 * ball.radius * ball.radius - 2 * ball.min_square) continue;
    const double cosine = std::clamp(sought / span, -1.0, 1.0);
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    for (const double side : {sine, -sine}) {
      const double x = (cosine * a - side * b) / amplitude, y = (cosine * b + side * a) / amplitude;
      if (!try_candidate(cell, circle.center + (rho * x) * e + (rho * y) * f, origin, visit))
        return false;
    }
  }
  return true;
}

// Tries all candidates of the balls in `near_`.
template <class Visit>
bool CentreSearch::visit_all_of(const Cell& cell, Visit& visit) {
  const std::size_t count = std::min(near_.size(), max_tried_balls);
  for (std::size_t i = 0; i < count; ++i) {
    const Ball& ball = near_[i];
    const double distance = norm(ball.center);
    const Vec3 outward = distance > no_direction ? (-1 / distance) * ball.center : Vec3{1, 0, 0};
    if (!try_candidate(cell, ball.center + ball.radius * outward, {{&ball, nullptr, nullptr}, 1},
                       visit))
      return false;
  }
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      const std::optional<Circle> circle = circle_of(near_[i], near_[j]);
      if (circle && !visit_circle(cell, *circle, i, j, visit)) return false;
    }
  return true;
}

// Tries the candidates of a cell that is not halved. Its balls are the elements from `begin` on.
template <class Visit>
bool CentreSearch::visit_leaf(const Cell& cell, std::size_t begin, Visit& visit) {
  near_.clear();
  for (std::size_t i = begin; i < around_.size(); ++i) near_.push_back(balls_[around_[i]]);
  if (near_.size() <= max_tried_balls) return visit_all_of(cell, visit);
  const auto power_at = [&](const Ball& ball) {
    return squared_norm(ball.center - cell.center) - ball.radius * ball.radius;
  };
  std::partial_sort(near_.begin(), near_.begin() + max_tried_balls, near_.end(),
                    [&](const Ball& a, const Ball& b) { return power_at(a) < power_at(b); });
  // The cell is so small that its centre represents all candidates.
  return try_candidate(cell, cell.center, {}, visit) && visit_all_of(cell, visit);
}

// Visits the eighths of a cell, starting with the one nearest to x.
template <class Visit>
bool CentreSearch::visit_parts(const Cell& cell, std::size_t begin, std::size_t end, Visit& visit) {
  const double half = 0.5 * cell.half;
  for (unsigned eighth = 0; eighth < 8; ++eighth) {
    Cell part{cell.center, half, cell.stalled};
    for (std::size_t q = 0; q < 3; ++q) {
      const bool is_far = (eighth >> q & 1) != 0, is_upper = cell.center[q] >= 0;
      part.center[q] += is_far == is_upper ? half : -half;
    }
    if (!visit_cell(part, begin, end, visit)) return false;
  }
  return true;
}

// Visits the centres in a cell. The balls of the parent cell are the elements [begin, end) of
// `around_`.
template <class Visit>
bool CentreSearch::visit_cell(const Cell& cell, std::size_t begin, std::size_t end, Visit& visit) {
  constexpr double min_margins = 16;  // minimum of half a cell's side, in units of the margin
  double square = 0;
  for (std::size_t q = 0; q < 3; ++q) {
    const double outside = std::max(0.0, std::fabs(cell.center[q]) - cell.half - margin());
    square += outside * outside;
  }
  if (square >= reach_ * reach_) return true;
  bool continues = true;
  if (!is_covered_or_keep(cell, begin, end)) {
    const std::size_t count = around_.size() - end;
    Cell part = cell;
    part.stalled = count == end - begin ? cell.stalled + 1 : 0;
    const bool is_leaf = count <= max_leaf_balls ||
                         (count <= max_tried_balls && part.stalled >= max_stalled) ||
                         cell.half <= min_margins * margin();
    continues = is_leaf ? visit_leaf(cell, end, visit) : visit_parts(part, end, end + count, visit);
  }
  around_.resize(end);
  return continues;
}

// Calls `visit(c)` for accessible centres within reach, including the nearest one, until it returns
// false. `c` is relative to x. `visit` may reduce the reach.
template <class Visit>
void CentreSearch::visit_centres(Vec3 x, double reach, const Access& access, Visit&& visit) {
  if (reach <= 0) return;
  reach_ = reach;
  access_ = access;
  const Surroundings surroundings = gather(x);
  if (surroundings == Surroundings::covered) return;
  const auto is_filled = [&](Vec3 c) {
    return definition_.is_filled && definition_.is_filled(x + c);
  };
  if (surroundings == Surroundings::accessible && !is_filled({})) {
    visit(Vec3{});
    return;
  }
  around_.resize(balls_.size());
  std::iota(around_.begin(), around_.end(), std::uint32_t{0});
  const auto visit_certain = [&](Vec3 c) {
    if (access_.max_uncertainty == 0 && !is_certain(x, c)) return true;
    return is_filled(c) || visit(c);
  };
  visit_cell({{}, reach}, 0, around_.size(), visit_certain);
}

std::optional<Vec3> CentreSearch::nearest(Vec3 x, double reach, const Access& access) {
  std::optional<Vec3> found;
  visit_centres(x, reach, access, [&](Vec3 c) {
    reach_ = norm(c);
    found = x + c;
    return reach_ > 0;
  });
  return found;
}

bool CentreSearch::is_any(Vec3 x, double reach, const Access& access) {
  bool found = false;
  visit_centres(x, reach, access, [&](Vec3) {
    found = true;
    return false;
  });
  return found;
}

double CentreSearch::distance_to_seam(Vec3 x, Vec3 center, double reach, const Access& access) {
  double min_distance = reach;
  const Vec3 own = center - x;
  visit_centres(x, reach, access, [&](Vec3 c) {
    const double apart = norm(c - own);
    if (apart <= same_center) return true;
    min_distance =
        std::min(min_distance, std::fabs(squared_norm(c) - squared_norm(own)) / (2 * apart));
    // The planes of more distant centres are more distant as well.
    reach_ = std::min(reach_, norm(own) + 2 * min_distance);
    return true;
  });
  return min_distance;
}

}  // namespace eses::detail::verify
