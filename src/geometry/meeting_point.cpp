#include "geometry/meeting_point.hpp"

#include <cmath>

namespace eses::detail {
namespace {

// Number of steps of Newton's method, each of which doubles the number of digits.
constexpr int step_count = 5;

// The last step changes the result by less than this fraction.
constexpr double max_last_step = 1e-6;

// A sum of two doubles, of which the second one is the rounding error of the first one.
struct ExactSum {
  double sum, error;
};

// Adds two numbers exactly (Knuth, The Art of Computer Programming, vol. 2, 4.2.2, theorem B).
ExactSum add_exactly(double a, double b) {
  const double sum = a + b, b_part = sum - a, a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}

// Adds the product of two numbers to a sum. Only the error of the error is rounded.
void add_product(ExactSum& sum, double a, double b) {
  const double product = a * b;
  const ExactSum next = add_exactly(sum.sum, product);
  sum = {next.sum, sum.error + (next.error + std::fma(a, b, -product))};
}

// Returns the square of the radius less that of the distance from the centre. The error is that of
// twice as many digits as a double has.
double excess_of_square(const SasSphere& sphere, Vec3 point) {
  ExactSum sum{0, 0};
  add_product(sum, sphere.radius, sphere.radius);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const ExactSum difference = add_exactly(point[axis], -sphere.center[axis]);
    add_product(sum, -difference.sum, difference.sum);
    sum.error -= 2 * difference.sum * difference.error;
  }
  return sum.sum + sum.error;
}

}  // namespace

// The vector x from the point c to that with |c + x - a_q| = R_q satisfies 2 x . (c - a_q) + |x|^2
// = R_q^2 - |c - a_q|^2. A step of Newton's method from x solves 2 y . (c + x - a_q) = R_q^2 - |c -
// a_q|^2 + |x|^2 for y.
std::optional<Vec3> vector_to_meeting_point(const std::array<SasSphere, 3>& spheres, Vec3 rounded) {
  std::array<double, 3> excess{};
  for (std::size_t q = 0; q < 3; ++q) excess[q] = excess_of_square(spheres[q], rounded);
  Vec3 vector;
  double last_step = 0;
  for (int step = 0; step < step_count; ++step) {
    std::array<Vec3, 3> from;
    for (std::size_t q = 0; q < 3; ++q) from[q] = (rounded - spheres[q].center) + vector;
    const double volume = 2 * dot(from[0], cross(from[1], from[2]));
    if (volume == 0) return std::nullopt;
    Vec3 next;
    for (std::size_t q = 0; q < 3; ++q)
      next = next + ((excess[q] + squared_norm(vector)) / volume) *
                        cross(from[(q + 1) % 3], from[(q + 2) % 3]);
    last_step = norm(next - vector);
    vector = next;
  }
  if (!(last_step <= max_last_step * norm(vector))) return std::nullopt;
  return vector;
}

}  // namespace eses::detail
