#include "verify/definition.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace eses::verify {
namespace {

/// Lengths, in angstrom, below which a direction is lost in rounding.
constexpr double no_direction = 1e-12;
/// By how much a cosine may exceed 1 where a circle touches a sphere.
constexpr double touching = 1e-10;
/// Centres that are nearer to each other than this are one. Angstrom.
constexpr double same_center = 1e-6;

double largest_radius_of(std::span<const Atom> atoms) {
  double largest = 0;
  for (const Atom& atom : atoms) largest = std::max(largest, atom.radius);
  return largest;
}

}  // namespace

Definition::Definition(std::span<const Atom> all_atoms, double probe)
    : atoms(all_atoms),
      probe_radius(probe),
      largest_radius(largest_radius_of(all_atoms)),
      cells(all_atoms, largest_radius + 2 * probe) {}

// The SAS balls within reach.
CentreSearch::Surroundings CentreSearch::gather(Vec3 x) {
  balls_.clear();
  bool is_accessible_here = true, is_covered = false;
  const double probe = definition_.probe_radius;
  const double farthest = definition_.largest_radius + probe + reach_;
  definition_.cells.for_each_near(x, farthest, [&](const Atom& atom) {
    Ball ball{atom.center - x, atom.radius + probe, 0, 0};
    const double square = squared_norm(ball.center);
    const double outer = ball.radius + reach_;
    if (square >= outer * outer) return;
    const double inner = ball.radius - slack_ - reach_;
    if (inner >= 0 && square <= inner * inner) is_covered = true;
    ball.power = square - ball.radius * ball.radius;
    ball.least_square = (ball.radius - slack_) * (ball.radius - slack_);
    if (square < ball.least_square) is_accessible_here = false;
    balls_.push_back(ball);
  });
  if (is_accessible_here) return Surroundings::accessible;
  if (is_covered) return Surroundings::covered;
  order_balls();
  return Surroundings::mixed;
}

// The order in which they are tried: first a few that hold x deepest and some from everywhere, one
// of which covers most cells that are covered at all. What the deepest one covers within reach
// needs no other.
void CentreSearch::order_balls() {
  constexpr std::size_t deepest = 8, from_everywhere = 64;
  const std::size_t stride = balls_.size() / from_everywhere + 1;
  for (std::size_t i = 0; i * stride < balls_.size(); ++i) std::swap(balls_[i], balls_[i * stride]);
  const auto middle =
      balls_.begin() + static_cast<std::ptrdiff_t>(std::min(deepest, balls_.size()));
  std::partial_sort(balls_.begin(), middle, balls_.end(),
                    [](const Ball& a, const Ball& b) { return a.power < b.power; });
  std::erase_if(balls_, [&, first = balls_.front()](const Ball& ball) {
    return ball.power - first.power > 2 * reach_ * norm(ball.center - first.center) + enough();
  });
}

// By how much cells are larger than they seem, so that no centre is lost between them to rounding.
double CentreSearch::margin() const {
  constexpr double share = 1e-6;
  return share * (definition_.largest_radius + definition_.probe_radius);
}

// Whether one of the balls, those from `begin` to `end` around a larger cell, covers all of the
// cell. If not, those that matter in it follow behind `around_`: they reach into it, and there is
// none that covers what they cover of it. Powers differ by a linear function of the place, so that
// the corners of the cell tell. As all but the outermost of many balls go, cells can stay large.
bool CentreSearch::is_covered_or_keep(const Cell& cell, std::size_t begin, std::size_t end) {
  const double half = cell.half + margin();
  std::uint32_t lowest = around_[begin];
  double lowest_power = std::numeric_limits<double>::infinity();
  for (std::size_t i = begin; i < end; ++i) {
    const Ball& ball = balls_[around_[i]];
    const Vec3 w = ball.center - cell.center;
    double nearest_square = 0, farthest_square = 0;
    for (std::size_t q = 0; q < 3; ++q) {
      const double along = std::fabs(w[q]), outside = std::max(0.0, along - half);
      nearest_square += outside * outside;
      farthest_square += (along + half) * (along + half);
    }
    if (farthest_square < ball.least_square) return true;
    const double square = ball.radius * ball.radius, power = squared_norm(w) - square;
    if (power < lowest_power) {
      lowest_power = power;
      lowest = around_[i];
    }
    if (nearest_square <= square) around_.push_back(around_[i]);
  }
  drop_covered(cell, balls_[lowest], end);
  return false;
}

// How much lower a ball's power must be for it to cover what another one does, whatever the slack.
double CentreSearch::enough() const {
  return 4 * slack_ * (definition_.largest_radius + definition_.probe_radius) + margin() * margin();
}

// Drops of the balls from `begin` on those that `other` covers in the cell, by more than the slack.
void CentreSearch::drop_covered(const Cell& cell, const Ball& other, std::size_t begin) {
  const double half = cell.half + margin();
  const auto is_covered = [&](std::uint32_t i) {
    const Vec3 between = balls_[i].center - other.center;
    const double spread = std::fabs(between.x) + std::fabs(between.y) + std::fabs(between.z);
    return balls_[i].power - other.power >
           2 * dot(cell.center, between) + 2 * half * spread + enough();
  };
  const auto first = around_.begin() + static_cast<std::ptrdiff_t>(begin);
  around_.erase(std::remove_if(first, around_.end(), is_covered), around_.end());
}

bool CentreSearch::is_accessible(Vec3 c) const {
  return std::none_of(near_.begin(), near_.end(), [c](const Ball& ball) {
    return squared_norm(c - ball.center) < ball.least_square;
  });
}

// Visits `c` if it is in the cell, near enough and accessible. The search goes on while this is
// true.
template <class Visit>
bool CentreSearch::offer(const Cell& cell, Vec3 c, Visit& visit) {
  const double half = cell.half + margin();
  for (std::size_t q = 0; q < 3; ++q)
    if (std::fabs(c[q] - cell.center[q]) > half) return true;
  if (squared_norm(c) >= reach_ * reach_ || !is_accessible(c)) return true;
  return visit(c);
}

// Nothing if they do not meet, or meet out of reach.
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

// The circle's point nearest to x, and those that lie on one of the spheres `further`.
template <class Visit>
bool CentreSearch::visit_circle(const Cell& cell, const Circle& circle,
                                std::span<const Ball> further, Visit& visit) {
  const double height = dot(circle.center, circle.axis), rho = circle.radius;
  const Vec3 inward = height * circle.axis - circle.center;  // to x, as the circle's plane sees it
  const double aside = norm(inward);
  const double gap = rho - aside;
  if (height * height + gap * gap >= reach_ * reach_) return true;
  const Vec3 e = aside > no_direction ? (1 / aside) * inward : any_perpendicular(circle.axis);
  const Vec3 f = cross(circle.axis, e);
  if (!offer(cell, circle.center + rho * e, visit)) return false;
  for (const Ball& ball : further) {
    // At the angle t, the squared distance from the ball's centre is square + 2 rho (a cos t + b
    // sin t).
    const Vec3 w = circle.center - ball.center;
    const double square = squared_norm(w) + rho * rho, a = dot(w, e), b = dot(w, f);
    const double amplitude = std::sqrt(a * a + b * b);
    if (amplitude < no_direction) continue;
    double cosine = (ball.radius * ball.radius - square) / (2 * rho * amplitude);
    if (std::fabs(cosine) > 1 + touching) continue;
    cosine = std::clamp(cosine, -1.0, 1.0);
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    for (const double side : {sine, -sine}) {
      const double x = (cosine * a - side * b) / amplitude, y = (cosine * b + side * a) / amplitude;
      if (!offer(cell, circle.center + (rho * x) * e + (rho * y) * f, visit)) return false;
    }
  }
  return true;
}

// What all of `near_` give.
template <class Visit>
bool CentreSearch::visit_all_of(const Cell& cell, Visit& visit) {
  for (const Ball& ball : near_) {
    const double distance = norm(ball.center);
    const Vec3 outward = distance > no_direction ? (-1 / distance) * ball.center : Vec3{1, 0, 0};
    if (!offer(cell, ball.center + ball.radius * outward, visit)) return false;
  }
  const std::span<const Ball> spheres(near_);
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (std::size_t j = i + 1; j < spheres.size(); ++j) {
      const std::optional<Circle> circle = circle_of(spheres[i], spheres[j]);
      if (circle && !visit_circle(cell, *circle, spheres.subspan(j + 1), visit)) return false;
    }
  return true;
}

// The centres in a cell; from `begin` to `end` of `around_` are the balls around a larger one.
template <class Visit>
bool CentreSearch::visit_cell(const Cell& cell, std::size_t begin, std::size_t end, Visit& visit) {
  constexpr std::size_t few = 5;
  constexpr double smallest = 16;  // of margins
  double square = 0;
  for (std::size_t q = 0; q < 3; ++q) {
    const double outside = std::max(0.0, std::fabs(cell.center[q]) - cell.half - margin());
    square += outside * outside;
  }
  if (square >= reach_ * reach_) return true;
  bool goes_on = true;
  if (!is_covered_or_keep(cell, begin, end)) {
    const std::size_t count = around_.size() - end;
    if (count <= few || cell.half <= smallest * margin()) {
      near_.clear();
      for (std::size_t i = end; i < end + count; ++i) near_.push_back(balls_[around_[i]]);
      goes_on = visit_all_of(cell, visit);
    } else {
      const double half = 0.5 * cell.half;
      // From the eighth that is nearest to x on.
      for (unsigned eighth = 0; eighth < 8 && goes_on; ++eighth) {
        Cell part{cell.center, half};
        for (std::size_t q = 0; q < 3; ++q) {
          const bool is_far = (eighth >> q & 1) != 0, is_upper = cell.center[q] >= 0;
          part.center[q] += is_far == is_upper ? half : -half;
        }
        goes_on = visit_cell(part, end, end + count, visit);
      }
    }
  }
  around_.resize(end);
  return goes_on;
}

// Calls `visit(c)`, c being seen from x, with accessible centres within reach, among them the
// nearest, until it returns false. It may lower the reach.
template <class Visit>
void CentreSearch::visit_centres(Vec3 x, double reach, double slack, Visit&& visit) {
  reach_ = reach;
  slack_ = slack;
  const Surroundings surroundings = gather(x);
  if (surroundings == Surroundings::covered) return;
  if (surroundings == Surroundings::accessible) {
    visit(Vec3{});
    return;
  }
  around_.resize(balls_.size());
  std::iota(around_.begin(), around_.end(), std::uint32_t{0});
  visit_cell({{}, reach}, 0, around_.size(), visit);
}

std::optional<Vec3> CentreSearch::nearest(Vec3 x, double reach, double slack) {
  std::optional<Vec3> found;
  visit_centres(x, reach, slack, [&](Vec3 c) {
    reach_ = norm(c);
    found = x + c;
    return reach_ > 0;
  });
  return found;
}

bool CentreSearch::is_any(Vec3 x, double reach, double slack) {
  bool found = false;
  visit_centres(x, reach, slack, [&](Vec3) {
    found = true;
    return false;
  });
  return found;
}

double CentreSearch::distance_to_seam(Vec3 x, Vec3 center, double reach, double slack) {
  double least = reach;
  const Vec3 own = center - x;
  visit_centres(x, reach, slack, [&](Vec3 c) {
    const double apart = norm(c - own);
    if (apart <= same_center) return true;
    least = std::min(least, std::fabs(squared_norm(c) - squared_norm(own)) / (2 * apart));
    // Centres farther away than this have their plane farther away, too.
    reach_ = std::min(reach_, norm(own) + 2 * least);
    return true;
  });
  return least;
}

}  // namespace eses::verify
