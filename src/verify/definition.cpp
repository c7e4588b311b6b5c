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

// Within reach is a cap of a sphere around the point straight out from x. A ball that covers all of
// it leaves no place for a centre there.
void CentreSearch::find_exposed_spheres() {
  exposed_.clear();
  for (const Ball& ball : balls_) {
    const double radius = ball.radius, distance = norm(ball.center);
    const double least_cosine =
        std::clamp((radius * radius + distance * distance - reach_ * reach_) /
                       (2 * radius * std::max(distance, no_direction)),
                   -1.0, 1.0);
    const double largest_sine = std::sqrt((1 - least_cosine) * (1 + least_cosine));
    const Vec3 outward = -(1 / std::max(distance, no_direction)) * ball.center;
    const auto covers_cap = [&](const Ball& other) {
      const Vec3 w = ball.center - other.center;
      const double square = squared_norm(w), along = dot(outward, w);
      // The largest projection of w onto a direction of the cap.
      const double most = along >= least_cosine * std::sqrt(square)
                              ? std::sqrt(square)
                              : along * least_cosine +
                                    std::sqrt(std::max(0.0, square - along * along)) * largest_sine;
      return square + radius * radius + 2 * radius * most < other.least_square;
    };
    if (std::none_of(balls_.begin(), balls_.end(), covers_cap)) exposed_.push_back(ball);
  }
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
bool CentreSearch::visit_circle(const Circle& circle, std::span<const Ball> further, Visit& visit) {
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
  // At the angle t, the squared distance from a ball's centre is square + 2 rho (a cos t + b sin
  // t).
  struct Profile {
    double square, a, b, amplitude;
  };
  const auto profile_of = [&](const Ball& ball) -> Profile {
    const Vec3 w = circle.center - ball.center;
    const double a = dot(w, e), b = dot(w, f);
    return {squared_norm(w) + rho * rho, a, b, std::sqrt(a * a + b * b)};
  };
  const auto covers_arc = [&](const Ball& ball) {
    const auto [square, a, b, amplitude] = profile_of(ball);
    const double most =
        a >= least_cosine * amplitude ? amplitude : a * least_cosine + std::fabs(b) * largest_sine;
    return square + 2 * rho * most < ball.least_square;
  };
  if (std::any_of(balls_.begin(), balls_.end(), covers_arc)) return true;
  if (!offer(circle.center + rho * e, visit)) return false;
  for (const Ball& ball : further) {
    const auto [square, a, b, amplitude] = profile_of(ball);
    if (amplitude < no_direction) continue;
    double cosine = (ball.radius * ball.radius - square) / (2 * rho * amplitude);
    if (std::fabs(cosine) > 1 + touching) continue;
    cosine = std::clamp(cosine, -1.0, 1.0);
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    for (const double side : {sine, -sine}) {
      const double x = (cosine * a - side * b) / amplitude, y = (cosine * b + side * a) / amplitude;
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
  find_exposed_spheres();
  for (const Ball& ball : exposed_) {
    const double distance = norm(ball.center);
    const Vec3 outward = distance > no_direction ? (-1 / distance) * ball.center : Vec3{1, 0, 0};
    if (!offer(ball.center + ball.radius * outward, visit)) return;
  }
  const std::span<const Ball> spheres(exposed_);
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (std::size_t j = i + 1; j < spheres.size(); ++j) {
      const std::optional<Circle> circle = circle_of(spheres[i], spheres[j]);
      if (circle && !visit_circle(*circle, spheres.subspan(j + 1), visit)) return;
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
