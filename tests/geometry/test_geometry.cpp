// Compares arcs, tube crossings and covering directions with their definitions, by dense sampling.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include "catch.hpp"
#include "geometry/box.hpp"
#include "geometry/circle_arcs.hpp"
#include "geometry/covering_directions.hpp"
#include "geometry/float_spheres.hpp"
#include "geometry/line_torus.hpp"
#include "geometry/meeting_point.hpp"
#include "support/atom_sets.hpp"

namespace eses::detail::test {
namespace {

using eses::detail::SasSphere;

struct CircleCase {
  SasSphere sphere, partner;
  std::vector<SasSphere> others;  // their caps follow the partner's cap in `caps`
  ContactCircle circle;
  CapList caps;
};

CircleCase make_circle_case(Random& random) {
  CircleCase result;
  result.sphere = {random_point(random, 1), random.uniform(2, 4)};
  do {
    result.partner = {random_point(random, 3), random.uniform(2, 4)};
  } while (norm(result.partner.center - result.sphere.center) <=
           std::fabs(result.partner.radius - result.sphere.radius) + 0.1);
  result.circle = make_contact_circle(result.sphere, result.partner);
  result.caps.push_back(make_cap(result.sphere, result.partner));
  const std::size_t count = random.integer(0, 5);
  while (result.others.size() < count) {
    const SasSphere other{random_point(random, 4), random.uniform(1.5, 3)};
    const double distance = norm(other.center - result.sphere.center);
    if (distance >= other.radius + result.sphere.radius ||
        distance <= std::fabs(other.radius - result.sphere.radius))
      continue;
    result.others.push_back(other);
    result.caps.push_back(make_cap(result.sphere, other));
  }
  return result;
}

// Whether the direction at `angle` about the axis, counted from the arc's start, is on the arc.
bool is_on_arc(const CircleArc& arc, Vec3 axis, Vec3 direction) {
  if (arc.kind == ArcKind::full) return true;
  const auto angle_from_start = [&](Vec3 d) {
    const double angle = std::atan2(dot(axis, cross(arc.start, d)), dot(arc.start, d));
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
  };
  return angle_from_start(direction) <= angle_from_start(arc.end);
}

double depth_inside(const std::vector<SasSphere>& spheres, Vec3 point) {
  double depth = -1e9;
  for (const SasSphere& sphere : spheres)
    depth = std::max(depth, sphere.radius - norm(point - sphere.center));
  return depth;
}

}  // namespace

TEST_CASE("accessible arcs are the parts of a circle outside all other spheres") {
  Random random(1);
  ArcScratch scratch;
  std::size_t partial = 0;
  for (int repetition = 0; repetition < 2000; ++repetition) {
    const CircleCase c = make_circle_case(random);
    std::vector<CircleArc> arcs;
    std::vector<CircleEnd> ends;
    accessible_arcs(c.circle, c.caps, 0, scratch, arcs, ends);
    const Vec3 e1 = any_perpendicular(c.circle.axis), e2 = cross(c.circle.axis, e1);
    constexpr int samples = 360;
    int open = 0;
    for (int s = 0; s < samples; ++s) {
      const double angle = 2 * std::numbers::pi * s / samples;
      const Vec3 direction = std::cos(angle) * e1 + std::sin(angle) * e2;
      const double depth = depth_inside(c.others, c.circle.center + c.circle.radius * direction);
      if (std::fabs(depth) < 1e-6) continue;
      const bool on_arc = std::any_of(arcs.begin(), arcs.end(), [&](const CircleArc& arc) {
        return is_on_arc(arc, c.circle.axis, direction);
      });
      INFO("case " << repetition << " sample " << s << " depth " << depth);
      REQUIRE(on_arc == (depth < 0));
      open += on_arc;
    }
    partial += open > 0 && open < samples;
    for (const CircleEnd& end : ends) {
      const SasSphere& blocker = c.others[end.cap - 1];
      const auto ends_there = [&](const CircleArc& arc) {
        const Vec3 direction = end.side > 0 ? arc.start : arc.end;
        const Vec3 point = c.circle.center + c.circle.radius * direction;
        return std::fabs(norm(point - blocker.center) - blocker.radius) < 1e-8;
      };
      CHECK(std::any_of(arcs.begin(), arcs.end(), ends_there));
    }
  }
  CHECK(partial > 300);
}

// On a lattice, circles have equal ends, and rims that touch them.
TEST_CASE("sectors change no accessible arc") {
  Random random(12);
  ArcScratch scratch;
  std::size_t arc_count = 0, end_count = 0;
  for (int repetition = 0; repetition < 20'000; ++repetition) {
    const bool is_lattice = repetition % 2 == 0;
    const auto coordinate = [&] {
      const double value = random.uniform(-3, 3);
      return is_lattice ? std::round(value) : value;
    };
    const double radius = is_lattice ? 2.0 + (repetition & 2) : random.uniform(1.5, 4);
    const SasSphere sphere{{}, radius};
    CapList caps;
    const std::size_t count = random.integer(1, 14);
    while (caps.size() < count) {
      const SasSphere other{{coordinate(), coordinate(), coordinate()}, radius};
      const double distance = norm(other.center);
      if (distance < 0.5 || distance > 2 * radius - 1e-3) continue;
      caps.push_back(make_cap(sphere, other));
    }
    set_float_caps(caps, radius, scratch);
    const Cap own = caps[0];
    const ContactCircle circle =
        make_contact_circle(sphere, {2 * own.height * own.axis, radius}, own);
    std::vector<CircleArc> arcs, expected;
    std::vector<CircleEnd> ends, expected_ends;
    accessible_arcs(circle, caps, 0, scratch, expected, expected_ends);
    accessible_arcs_by_sectors(circle, caps, 0, scratch, arcs, ends);
    INFO("repetition " << repetition);
    REQUIRE(arcs.size() == expected.size());
    for (std::size_t k = 0; k < arcs.size(); ++k)
      REQUIRE((arcs[k].kind == expected[k].kind && arcs[k].start == expected[k].start &&
               arcs[k].end == expected[k].end));
    REQUIRE(ends.size() == expected_ends.size());
    for (std::size_t k = 0; k < ends.size(); ++k)
      REQUIRE((ends[k].cap == expected_ends[k].cap && ends[k].side == expected_ends[k].side &&
               ends[k].is_uncertain == expected_ends[k].is_uncertain));
    arc_count += arcs.size();
    end_count += ends.size();
  }
  CHECK(arc_count > 5000);
  CHECK(end_count > 5000);
}

TEST_CASE("caps of many spheres are the caps of those that meet the sphere") {
  Random random(11);
  for (int round = 0; round < 200; ++round) {
    const SasSphere sphere{random_point(random, 2), random.uniform(1, 4)};
    SphereList spheres;
    std::vector<SasSphere> others{sphere};
    const std::size_t count = random.integer(0, 70);
    while (others.size() <= count)
      others.push_back({random_point(random, 6), random.uniform(1, 4)});
    // This sphere touches but does not meet the other.
    others.push_back({sphere.center + Vec3{sphere.radius + 2, 0, 0}, 2});
    for (const SasSphere& other : others) spheres.push_back(other);
    std::vector<std::int64_t> expected;
    for (std::size_t k = 1; k + 1 < others.size(); ++k)
      if (norm(others[k].center - sphere.center) < sphere.radius + others[k].radius - 1e-9)
        expected.push_back(static_cast<std::int64_t>(k));
    std::vector<std::int32_t> all(others.size() + vector_padding);
    std::iota(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(others.size()), 0);
    SpherePositions positions;
    CapList caps;
    make_caps(sphere, spheres, all, others.size(), 1e-9, positions, caps);
    REQUIRE(std::vector(positions.at.begin(),
                        positions.at.begin() + static_cast<std::ptrdiff_t>(positions.count)) ==
            expected);
    REQUIRE(caps.size() == expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const Cap cap = make_cap(sphere, others[static_cast<std::size_t>(expected[k])]);
      CHECK(caps[k].axis == cap.axis);
      CHECK(caps[k].height == cap.height);
      CHECK(caps[k].blocking_height == cap.blocking_height);
    }
  }
}

TEST_CASE("spheres near a box are exactly those within the distance") {
  Random random(12);
  std::size_t chosen_count = 0;
  for (int round = 0; round < 200; ++round) {
    Box box{random_point(random, 3), {}};
    box.high = box.low + Vec3{random.uniform(0, 4), random.uniform(0, 4), random.uniform(0, 4)};
    const double distance = random.uniform(0, 3);
    SphereList spheres, expected, chosen;
    const std::size_t count = random.integer(0, 70);
    while (spheres.count < count) {
      const SasSphere sphere{random_point(random, 12), random.uniform(1, 4)};
      spheres.push_back(sphere);
      if (std::sqrt(squared_distance(box, sphere.center)) < distance + sphere.radius)
        expected.push_back(sphere);
    }
    SpherePositions positions;
    find_near_box(box, distance, spheres, positions);
    choose_spheres(spheres, positions, chosen);
    REQUIRE(chosen.count == expected.count);
    for (std::size_t k = 0; k < chosen.count; ++k) {
      CHECK(chosen.x[k] == expected.x[k]);
      CHECK(chosen.y[k] == expected.y[k]);
      CHECK(chosen.z[k] == expected.z[k]);
      CHECK(chosen.radius[k] == expected.radius[k]);
    }
    chosen_count += chosen.count;
  }
  CHECK(chosen_count > 300);
}

// Spheres of which some just reach a distance or just miss it, far from the origin.
TEST_CASE("single precision misses no sphere near a box or a sphere") {
  Random random(13);
  std::size_t near_box = 0, near_sphere = 0, left_out = 0;
  for (int round = 0; round < 400; ++round) {
    const double size = std::pow(10, random.uniform(-1, 4));
    const Vec3 middle = 100 * size * random_point(random, 1);
    const Box box{middle - size * Vec3{0.1, 0.2, 0.3}, middle + size * Vec3{0.3, 0.2, 0.1}};
    const double distance = size * random.uniform(0, 1);
    const SasSphere sphere{box.high, size * random.uniform(0.1, 1)};
    SphereList spheres;
    const std::size_t count = random.integer(0, 70);
    while (spheres.count < count) {
      const double radius = size * random.uniform(0, 1);
      const double gap = std::pow(10, random.uniform(-12, 0)) * random.uniform(-1, 1);
      const bool touches_box = random.integer(0, 1) == 0;
      const Vec3 from = touches_box ? box.low : sphere.center;
      const double reach = touches_box ? distance : sphere.radius;
      spheres.push_back({from + (reach + radius) * (1 + gap) * random_direction(random), radius});
    }
    FloatSpheres all, chosen;
    all.assign(spheres, box);
    choose_near_box(box, distance, all, chosen);
    std::vector<std::int32_t> found;
    const std::size_t found_count = find_near_sphere(sphere, all, found);
    const std::vector<std::int32_t> in_box(
        chosen.position.begin(),
        chosen.position.begin() + static_cast<std::ptrdiff_t>(chosen.count));
    found.resize(found_count);
    for (std::size_t k = 0; k < spheres.count; ++k) {
      const Vec3 center{spheres.x[k], spheres.y[k], spheres.z[k]};
      const auto position = static_cast<std::int32_t>(k);
      const auto is_in = [&](const std::vector<std::int32_t>& list) {
        return std::binary_search(list.begin(), list.end(), position);
      };
      INFO(round << " " << k);
      const double beyond_box =
          std::sqrt(squared_distance(box, center)) - distance - spheres.radius[k];
      const double beyond_sphere = norm(center - sphere.center) - sphere.radius - spheres.radius[k];
      if (beyond_box < 0) REQUIRE(is_in(in_box));
      if (beyond_sphere < 0) REQUIRE(is_in(found));
      if (beyond_box > 1e-4 * size) REQUIRE(!is_in(in_box));
      if (beyond_sphere > 1e-4 * size) REQUIRE(!is_in(found));
      near_box += is_in(in_box) ? 1 : 0;
      near_sphere += is_in(found) ? 1 : 0;
      left_out += is_in(in_box) && is_in(found) ? 0 : 1;
    }
  }
  CHECK(near_box > 3000);
  CHECK(near_sphere > 3000);
  CHECK(left_out > 3000);
}

TEST_CASE("a point that two spheres leave just open stays accessible") {
  // Four equal spheres are at the corners of a square. Every circle of neighbours is open except at
  // its two probes, where each circle of a diagonal has a single point.
  const double side = 2, radius = 2;
  const std::vector<SasSphere> corners{{{0, 0, 0}, radius},
                                       {{side, 0, 0}, radius},
                                       {{side, side, 0}, radius},
                                       {{0, side, 0}, radius}};
  CapList caps;
  for (std::size_t k = 1; k < 4; ++k) caps.push_back(make_cap(corners[0], corners[k]));
  ArcScratch scratch;
  std::vector<CircleArc> arcs;
  std::vector<CircleEnd> ends;
  accessible_arcs(make_contact_circle(corners[0], corners[2]), caps, 1, scratch, arcs, ends);
  CHECK(arcs.empty());
  // At both points one of the two corners is named.
  REQUIRE(ends.size() == 2);
  for (const CircleEnd& end : ends) CHECK(end.is_uncertain);
  const auto half = [](const CircleEnd& end) { return (end.cap == 0) == (end.side > 0); };
  CHECK(half(ends[0]) != half(ends[1]));
}

TEST_CASE("tube exits are where the distance to the circle rises through the tube radius") {
  Random random(2);
  std::size_t found = 0, spindles = 0;
  for (int repetition = 0; repetition < 3000; ++repetition) {
    const double circle_radius = random.uniform(0.2, 4), tube_radius = random.uniform(0.7, 2);
    const Vec3 axis = normalized(random_point(random, 1));
    const Vec3 start = random_point(random, 4), step = random_point(random, 3);
    const auto distance = [&](double t) {
      const Vec3 w = start + t * step;
      const double z = dot(w, axis);
      return std::hypot(std::sqrt(std::max(0.0, squared_norm(w) - z * z)) - circle_radius, z);
    };
    const TubeExits exits = tube_exits(start, step, axis, circle_radius, tube_radius, 0, 1);
    std::vector<double> expected;
    constexpr int samples = 4000;
    bool is_clear = true;  // sampling cannot decide grazing
    for (int s = 0; s < samples; ++s) {
      const double t0 = static_cast<double>(s) / samples, t1 = (s + 1.0) / samples;
      const double d0 = distance(t0) - tube_radius, d1 = distance(t1) - tube_radius;
      if (d0 < 0 && d1 >= 0) expected.push_back(t0 + (t1 - t0) * d0 / (d0 - d1));
      const double slope = std::fabs(d1 - d0) * samples;
      if (std::fabs(d0) < 2e-3 && slope < 0.05 * norm(step)) is_clear = false;
    }
    if (!is_clear) continue;
    INFO("case " << repetition);
    REQUIRE(static_cast<std::size_t>(exits.count) == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CHECK(exits.parameters[i] == Catch::Approx(expected[i]).margin(1e-5));
      CHECK(distance(exits.parameters[i]) == Catch::Approx(tube_radius).epsilon(1e-10));
    }
    found += expected.size();
    spindles += circle_radius < tube_radius && !expected.empty();
  }
  CHECK(found > 400);
  CHECK(spindles > 60);
}

TEST_CASE("every direction is within the covering radius of one of the set") {
  for (const int frequency : {1, 2, 5}) {
    const CoveringDirections covering = make_covering_directions(frequency);
    CHECK(covering.directions.size() == static_cast<std::size_t>(10 * frequency * frequency + 2));
    Random random(3);
    double farthest = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 p = random_point(random, 1);
      if (squared_norm(p) > 1 || squared_norm(p) < 1e-4) continue;
      double nearest = 4;
      for (const Vec3 d : covering.directions)
        nearest = std::min(nearest, std::acos(std::min(1.0, dot(d, normalized(p)))));
      farthest = std::max(farthest, nearest);
    }
    CHECK(farthest <= covering.radius);
    CHECK(farthest > 0.9 * covering.radius);
  }
}

TEST_CASE("the point in which three spheres meet has digits beyond its coordinates") {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    // Powers of 2 make the sum of the point and an offset exact.
    Vec3 point, offset;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      point[axis] = std::floor(random.uniform(-1, 1) * 0x1p20) * 0x1p-17;
      offset[axis] = std::floor(random.uniform(-1, 1) * 0x1p10) * 0x1p-45;
    }
    std::array<SasSphere, 3> spheres;
    for (SasSphere& sphere : spheres) {
      sphere.center = point + 3 * random_direction(random);
      sphere.radius = norm(sphere.center - point);
    }
    const auto from_point = vector_to_meeting_point(spheres, point);
    const auto from_other = vector_to_meeting_point(spheres, point + offset);
    const Vec3 a = spheres[0].center - point, b = spheres[1].center - point;
    if (std::fabs(dot(a, cross(b, spheres[2].center - point))) < 0.1) continue;
    INFO("set " << k);
    REQUIRE((from_point && from_other));
    CHECK(norm(*from_point) < 1e-12);
    CHECK(norm(*from_point - *from_other - offset) < 1e-11 * norm(offset));
  }
  // Two spheres that touch in the middle between their centres do not meet the third one in a
  // point.
  CHECK_FALSE(vector_to_meeting_point({{{{-1, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0, 1, 0}, 1}}}, {}));
}

}  // namespace eses::detail::test
