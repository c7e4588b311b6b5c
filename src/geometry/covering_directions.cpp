#include "geometry/covering_directions.hpp"

#include <algorithm>
#include <cmath>

namespace eses::detail {
namespace {

constexpr double golden = 1.6180339887498949;

// The vertices of an icosahedron with edges of length 2.
constexpr std::array<Vec3, 12> icosahedron{{{-1, golden, 0},
                                            {1, golden, 0},
                                            {-1, -golden, 0},
                                            {1, -golden, 0},
                                            {0, -1, golden},
                                            {0, 1, golden},
                                            {0, -1, -golden},
                                            {0, 1, -golden},
                                            {golden, 0, -1},
                                            {golden, 0, 1},
                                            {-golden, 0, -1},
                                            {-golden, 0, 1}}};

// Returns the angular radius of the circle through three directions.
double circumradius(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 pole = normalized(cross(b - a, c - a));
  return std::acos(std::min(1.0, std::fabs(dot(pole, a))));
}

void add_unless_known(std::vector<Vec3>& directions, Vec3 direction) {
  const bool known = std::any_of(directions.begin(), directions.end(),
                                 [&](Vec3 d) { return squared_norm(d - direction) < 1e-12; });
  if (!known) directions.push_back(direction);
}

}  // namespace

std::vector<std::array<Vec3, 3>> icosahedron_triangles() {
  constexpr double edge = 2;
  const auto are_neighbours = [&](Vec3 a, Vec3 b) { return std::fabs(norm(a - b) - edge) < 1e-9; };
  std::vector<std::array<Vec3, 3>> triangles;
  for (std::size_t a = 0; a < icosahedron.size(); ++a)
    for (std::size_t b = a + 1; b < icosahedron.size(); ++b)
      for (std::size_t c = b + 1; c < icosahedron.size(); ++c) {
        const std::array<Vec3, 3> corners{icosahedron[a], icosahedron[b], icosahedron[c]};
        if (are_neighbours(corners[0], corners[1]) && are_neighbours(corners[1], corners[2]) &&
            are_neighbours(corners[0], corners[2]))
          triangles.push_back(corners);
      }
  return triangles;
}

CoveringDirections make_covering_directions(int frequency) {
  CoveringDirections covering;
  for (const auto& corners : icosahedron_triangles()) {
    const auto point = [&](int i, int j) {
      const auto& [a, b, c] = corners;
      const double u = static_cast<double>(i) / frequency;
      const double v = static_cast<double>(j) / frequency;
      return normalized((1 - u - v) * a + u * b + v * c);
    };
    for (int i = 0; i <= frequency; ++i)
      for (int j = 0; i + j <= frequency; ++j) {
        add_unless_known(covering.directions, point(i, j));
        if (i + j < frequency)
          covering.radius = std::max(covering.radius,
                                     circumradius(point(i, j), point(i + 1, j), point(i, j + 1)));
        if (i + j + 2 <= frequency)
          covering.radius = std::max(
              covering.radius, circumradius(point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)));
      }
  }
  return covering;
}

}  // namespace eses::detail
