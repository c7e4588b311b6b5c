#include "verify/definition.hpp"

#include <algorithm>
#include <cmath>

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

// The SAS balls within reach, those that hold x deepest first.
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
  return is_covered ? Surroundings::covered : Surroundings::mixed;
}

// Powers differ by a linear function of the place. Where that keeps its sign within reach, the ball
// of lower power covers what the other does, which then has no say.
void CentreSearch::drop_covered_balls() {
  std::sort(balls_.begin(), balls_.end(),
            [](const Ball& a, const Ball& b) { return a.power < b.power; });
  std::size_t kept = 0;
  for (const Ball& ball : balls_) {
    const auto covers = [&](const Ball& other) {
      const double difference = ball.power - other.power;
      return difference * difference >=
             4 * reach_ * reach_ * squared_norm(ball.center - other.center);
    };
    const auto end = balls_.begin() + static_cast<std::ptrdiff_t>(kept);
    if (std::none_of(balls_.begin(), end, covers)) balls_[kept++] = ball;
  }
  balls_.resize(kept);
}

bool CentreSearch::is_accessible(Vec3 c) const {
  return std::none_of(balls_.begin(), balls_.end(), [c](const Ball& ball) {
    return squared_norm(c - ball.center) < ball.least_square;
  });
}

// Visits `c` if it is near enough and accessible. The search goes on while this is true.
template <class Visit>
bool CentreSearch::offer(Vec3 c, Visit& visit) {
  if (squared_norm(c) >= reach_ * reach_ || !is_accessible(c)) return true;
  return visit(c);
}

// The circle's point nearest to x, and those that lie on a later sphere.
template <class Visit>
bool CentreSearch::visit_circle(std::size_t j, const Circle& circle, Visit& visit) {
  const double height = dot(circle.center, circle.axis), rho = circle.radius;
  const Vec3 inward = height * circle.axis - circle.center;  // to x, as the circle's plane sees it
  const double aside = norm(inward);
  const double gap = rho - aside;
  if (height * height + gap * gap >= reach_ * reach_) return true;
  const Vec3 e = aside > no_direction ? (1 / aside) * inward : any_perpendicular(circle.axis);
  const Vec3 f = cross(circle.axis, e);
  // Within reach is the arc of the angles t with cos t > least_cosine; t = 0 is nearest.
  const double least_cosine =
      std::clamp((height * height + rho * rho + aside * aside - reach_ * reach_) /
                     (2 * rho * std::max(aside, no_direction)),
                 -1.0, 1.0);
  const double largest_sine = std::sqrt((1 - least_cosine) * (1 + least_cosine));
  meeting_.clear();
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    // At the angle t, the squared distance from the ball's centre is w^2 + rho^2 + 2 rho (a cos t +
    // b sin t).
    const Ball& ball = balls_[k];
    const Vec3 w = circle.center - ball.center;
    const double a = dot(w, e), b = dot(w, f), amplitude = std::sqrt(a * a + b * b);
    const double at_ends = a * least_cosine, between_ends = std::fabs(b) * largest_sine;
    const double most = a >= least_cosine * amplitude ? amplitude : at_ends + between_ends;
    const double square = squared_norm(w) + rho * rho;
    if (square + 2 * rho * most < ball.least_square) return true;
    if (k <= j || amplitude < no_direction) continue;
    const double least = -a >= least_cosine * amplitude ? -amplitude : at_ends - between_ends;
    const double cosine = (ball.radius * ball.radius - square) / (2 * rho * amplitude);
    if (cosine * amplitude < least - touching || std::fabs(cosine) > 1 + touching) continue;
    meeting_.push_back({a / amplitude, b / amplitude, std::clamp(cosine, -1.0, 1.0)});
  }
  if (!offer(circle.center + rho * e, visit)) return false;
  for (const auto& [u, v, cosine] : meeting_) {
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    for (const double side : {sine, -sine}) {
      const double x = cosine * u - side * v, y = cosine * v + side * u;
      if (x >= least_cosine - touching &&
          !offer(circle.center + (rho * x) * e + (rho * y) * f, visit))
        return false;
    }
  }
  return true;
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
  drop_covered_balls();
  for (const Ball& ball : balls_) {
    const double distance = norm(ball.center);
    const Vec3 outward = distance > no_direction ? (-1 / distance) * ball.center : Vec3{1, 0, 0};
    if (!offer(ball.center + ball.radius * outward, visit)) return;
  }
  for (std::size_t i = 0; i < balls_.size(); ++i)
    for (std::size_t j = i + 1; j < balls_.size(); ++j) {
      const Vec3 between = balls_[j].center - balls_[i].center;
      const double square = squared_norm(between);
      const double difference = balls_[j].power - balls_[i].power;
      // The plane of the circle is out of reach, or there is none.
      if (difference * difference >= 4 * reach_ * reach_ * square ||
          square < no_direction * no_direction)
        continue;
      const double distance = std::sqrt(square);
      const double a = balls_[i].radius, b = balls_[j].radius;
      const double along = (square + (a - b) * (a + b)) / (2 * distance);
      const double radius_square = (a - along) * (a + along);
      if (radius_square <= 0) continue;
      const Vec3 axis = (1 / distance) * between;
      const Circle circle{balls_[i].center + along * axis, axis, std::sqrt(radius_square)};
      if (!visit_circle(j, circle, visit)) return;
    }
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
