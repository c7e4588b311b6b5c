#include "support/mesh_intersections.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

namespace eses::detail::test {
namespace {

/// An exact sum of doubles, as an expansion: J. R. Shewchuk, "Adaptive precision floating-point
/// arithmetic and fast robust geometric predicates", Discrete & Computational Geometry 18 (1997),
/// 305-363, doi:10.1007/PL00009321.
class ExactSum {
 public:
  void add(double value) {
    for (double& part : parts_) {
      const double sum = value + part, of_part = sum - value;
      part = (value - (sum - of_part)) + (part - of_part);
      value = sum;
    }
    std::erase(parts_, 0.0);
    if (value != 0) parts_.push_back(value);
  }
  void add_product(double x, double y) {
    const double high = x * y;
    add(std::fma(x, y, -high));
    add(high);
  }
  void add_product(double x, double y, double z) {
    const double high = x * y;
    add_product(std::fma(x, y, -high), z);
    add_product(high, z);
  }
  int sign() const { return parts_.empty() ? 0 : parts_.back() > 0 ? 1 : -1; }

 private:
  std::vector<double> parts_;  // do not overlap, ascending
};

void add_determinant(const Vec3& a, const Vec3& b, const Vec3& c, double sign, ExactSum& sum) {
  for (std::size_t x = 0; x < 3; ++x) {
    const std::size_t y = (x + 1) % 3, z = (x + 2) % 3;
    sum.add_product(sign * a[x], b[y], c[z]);
    sum.add_product(-sign * a[x], b[z], c[y]);
  }
}

/// Orientation of the projections of three points along `axis`.
int side_along(std::size_t axis, const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::size_t x = (axis + 1) % 3, y = (axis + 2) % 3;
  ExactSum sum;
  const auto add = [&](const Vec3& p, const Vec3& q) {
    sum.add_product(p[x], q[y]);
    sum.add_product(-p[y], q[x]);
  };
  add(a, b);
  add(b, c);
  add(c, a);
  return sum.sign();
}

using Points = std::array<Vec3, 3>;

/// Returns an axis along which the projection of a triangle has an area, or 3.
std::size_t axis_of(const Points& t) {
  std::size_t axis = 0;
  while (axis < 3 && side_along(axis, t[0], t[1], t[2]) == 0) ++axis;
  return axis;
}

bool is_between(double value, double one, double other) {
  return std::min(one, other) <= value && value <= std::max(one, other);
}

bool segments_meet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::size_t axis) {
  const int c_side = side_along(axis, a, b, c), d_side = side_along(axis, a, b, d);
  const int a_side = side_along(axis, c, d, a), b_side = side_along(axis, c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  const auto is_on = [](int side, const Vec3& p, const Vec3& from, const Vec3& to) {
    return side == 0 && is_between(p.x, from.x, to.x) && is_between(p.y, from.y, to.y) &&
           is_between(p.z, from.z, to.z);
  };
  return is_on(c_side, c, a, b) || is_on(d_side, d, a, b) || is_on(a_side, a, c, d) ||
         is_on(b_side, b, c, d);
}

bool meets_in_plane(const Vec3& from, const Vec3& to, const Points& t, std::size_t axis) {
  for (std::size_t i = 0; i < 3; ++i)
    if (segments_meet(from, to, t[i], t[(i + 1) % 3], axis)) return true;
  const int side = side_along(axis, t[0], t[1], from);
  return side != 0 && side_along(axis, t[1], t[2], from) == side &&
         side_along(axis, t[2], t[0], from) == side;
}

/// Whether a segment and a triangle have a common point.
bool meets(const Vec3& from, const Vec3& to, const Points& t) {
  const std::size_t axis = axis_of(t);
  if (axis == 3) return true;
  const int side_from = orientation(t[0], t[1], t[2], from),
            side_to = orientation(t[0], t[1], t[2], to);
  if (side_from * side_to > 0) return false;
  if (side_from == 0 && side_to == 0) return meets_in_plane(from, to, t, axis);
  const std::array<int, 3> sides{orientation(from, to, t[0], t[1]),
                                 orientation(from, to, t[1], t[2]),
                                 orientation(from, to, t[2], t[0])};
  return std::ranges::min(sides) >= 0 || std::ranges::max(sides) <= 0;
}

/// Whether two triangles with a common side overlap.
bool is_folded(const Vec3& a, const Vec3& b, const Vec3& one, const Vec3& other) {
  if (orientation(a, b, one, other) != 0) return false;
  const std::size_t axis = axis_of({a, b, one});
  return axis == 3 || side_along(axis, a, b, one) == side_along(axis, a, b, other);
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = a - d, v = b - d, w = c - d;
  const auto magnitude = [](double x) { return std::fabs(x); };
  const double xy = magnitude(u.x * v.y) + magnitude(u.y * v.x),
               yz = magnitude(u.y * v.z) + magnitude(u.z * v.y),
               zx = magnitude(u.z * v.x) + magnitude(u.x * v.z);
  const double determinant = dot(w, cross(u, v));
  // Shewchuk's bound for the first stage, rounded up.
  const double bound = 8 * std::numeric_limits<double>::epsilon() *
                       (magnitude(w.x) * yz + magnitude(w.y) * zx + magnitude(w.z) * xy);
  if (magnitude(determinant) > bound) return determinant < 0 ? 1 : -1;
  ExactSum sum;
  add_determinant(b, c, d, 1, sum);
  add_determinant(a, c, d, -1, sum);
  add_determinant(a, b, d, 1, sum);
  add_determinant(a, b, c, -1, sum);
  return sum.sign();
}

bool do_intersect(std::span<const Vec3> positions, const MeshTriangle& one,
                  const MeshTriangle& other) {
  const Points p{positions[one[0]], positions[one[1]], positions[one[2]]},
      q{positions[other[0]], positions[other[1]], positions[other[2]]};
  std::array<bool, 3> is_common_p{}, is_common_q{};
  int common = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (one[i] == other[j]) {
        ++common;
        is_common_p[i] = is_common_q[j] = true;
      }
  if (common == 3) return true;
  if (common == 2) {
    const auto i = static_cast<std::size_t>(std::ranges::find(is_common_p, false) -
                                            is_common_p.begin()),
               j = static_cast<std::size_t>(std::ranges::find(is_common_q, false) -
                                            is_common_q.begin());
    return is_folded(p[(i + 1) % 3], p[(i + 2) % 3], p[i], q[j]);
  }
  // Sides with a common corner meet the other triangle only if the opposite side does.
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    if (!is_common_p[i] && !is_common_p[next] && meets(p[i], p[next], q)) return true;
    if (!is_common_q[i] && !is_common_q[next] && meets(q[i], q[next], p)) return true;
  }
  return false;
}

std::vector<std::pair<std::size_t, std::size_t>> find_intersections(
    std::span<const Vec3> positions, std::span<const MeshTriangle> triangles) {
  struct Box {
    Vec3 low, high;
  };
  std::vector<Box> boxes;
  double size = 0;
  for (const MeshTriangle& t : triangles) {
    Box box{positions[t[0]], positions[t[0]]};
    for (const std::uint64_t vertex : t)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], positions[vertex][axis]);
        box.high[axis] = std::max(box.high[axis], positions[vertex][axis]);
        size = std::max(size, box.high[axis] - box.low[axis]);
      }
    boxes.push_back(box);
  }
  // Triangles by the cube of their lowest corner. Those that overlap are in neighbouring cubes.
  using Cube = std::array<std::int64_t, 3>;
  const auto cube_of = [&](const Vec3& p) {
    Cube cube{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      cube[axis] = static_cast<std::int64_t>(std::floor(p[axis] / (1.001 * size)));
    return cube;
  };
  std::map<Cube, std::vector<std::size_t>> cubes;
  for (std::size_t i = 0; i < boxes.size(); ++i) cubes[cube_of(boxes[i].low)].push_back(i);
  const auto overlap = [](const Box& a, const Box& b) {
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y &&
           b.low.y <= a.high.y && a.low.z <= b.high.z && b.low.z <= a.high.z;
  };
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [cube, members] : cubes)
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      const auto found = cubes.find({cube[0] + neighbour % 3 - 1, cube[1] + neighbour / 3 % 3 - 1,
                                     cube[2] + neighbour / 9 - 1});
      if (found == cubes.end()) continue;
      for (const std::size_t i : members)
        for (const std::size_t j : found->second)
          if (i < j && overlap(boxes[i], boxes[j]) &&
              do_intersect(positions, triangles[i], triangles[j]))
            pairs.emplace_back(i, j);
    }
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace eses::detail::test
