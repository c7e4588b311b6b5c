// Compares the kernel that intersects several edges at a time with a saddle with plain formulas for
// one edge.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/test_saddle_kernel.cpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "solve/edge_saddle-inl.hpp"
#include "support/atom_sets.hpp"
#include "support/instruction_sets.hpp"

// The type that the versions and the tests share, defined once for all instruction sets.
#ifndef ESES_TEST_SADDLE_KERNEL_SHARED_
#define ESES_TEST_SADDLE_KERNEL_SHARED_
namespace eses::detail::test {

struct SaddleHit {
  std::uint64_t place = 0;
  double coordinate = 0;
  Vec3 normal;
};

}  // namespace eses::detail::test
#endif  // ESES_TEST_SADDLE_KERNEL_SHARED_

HWY_BEFORE_NAMESPACE();
namespace eses::detail::test::HWY_NAMESPACE {
namespace kernel = eses::detail::HWY_NAMESPACE;

void meet_saddle(const ArcFeature& arc, double probe, double length, EdgeBatch& batch,
                 std::vector<SaddleHit>& hits) {
  kernel::meet_saddle(
      arc, probe, length, batch,
      [&](std::uint64_t place, double coordinate, Vec3 normal) {
        hits.push_back({place, coordinate, normal});
        return false;
      },
      [](const auto&...) {});
}

}  // namespace eses::detail::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail::test {
namespace {

using MeetSaddle = void (*)(const ArcFeature&, double, double, EdgeBatch&, std::vector<SaddleHit>&);

struct Saddle {
  ArcFeature arc;
  double probe = 0;
};

Saddle random_saddle(Random& random) {
  Saddle saddle;
  saddle.probe = random.uniform(0.7, 3);
  // SAS balls that hardly touch make spindle tori. Atoms of very different size make one-sided
  // saddles.
  const double first = random.uniform(0, 2) + saddle.probe;
  const double second = random.uniform(0, 2) + saddle.probe;
  const double distance = random.uniform(std::fabs(first - second) + 0.05, first + second - 0.01);
  const Vec3 direction =
      random.chance(0.3) ? unit_vector(random.integer(0, 2)) : random_direction(random);
  saddle.arc.atoms = {0, 1};
  saddle.arc.circle = make_contact_circle({{0, 0, 0}, first}, {distance * direction, second});
  const Vec3 axis = saddle.arc.circle.axis;
  const Vec3 e1 = any_perpendicular(axis), e2 = cross(axis, e1);
  const double from = random.uniform(0, 2 * std::numbers::pi);
  const std::size_t kind = random.integer(0, 2);
  const double turn = kind == 0   ? 0
                      : kind == 1 ? random.uniform(0.05, std::numbers::pi)
                                  : random.uniform(std::numbers::pi, 2 * std::numbers::pi - 0.05);
  const auto at = [&](double angle) { return std::cos(angle) * e1 + std::sin(angle) * e2; };
  saddle.arc.sector = make_arc_sector(axis,
                                      kind == 0   ? ArcKind::full
                                      : kind == 1 ? ArcKind::minor
                                                  : ArcKind::major,
                                      at(from), at(from + turn));
  return saddle;
}

// Angle counter-clockwise from the arc's start, in [0, 2 pi).
double angle_on_arc(const ArcFeature& arc, Vec3 offset) {
  const Vec3 start = arc.sector.start;
  const double angle = std::atan2(dot(cross(arc.circle.axis, start), offset), dot(start, offset));
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

// Returns how clearly a point on the tube lies on the saddle; negative if it does not.
double depth_in_saddle(const ArcFeature& arc, Vec3 offset) {
  const ContactCircle& circle = arc.circle;
  const double height = dot(offset, circle.axis);
  const Vec3 radial = offset - height * circle.axis;
  // Seen from the probe, in the half plane through the axis, the point lies between the atoms.
  const double inward = circle.radius - norm(radial);
  const double above_first = circle.radius * height + circle.first_height * inward;
  const double below_second = circle.second_height * inward - circle.radius * height;
  double depth = std::min(above_first, below_second);
  if (arc.sector.kind == ArcKind::full) return depth;
  // On the axis all angles are the same point.
  const double angle = angle_on_arc(arc, radial), end = angle_on_arc(arc, arc.sector.end);
  const double from_ends = std::min({std::fabs(end - angle), angle, 2 * std::numbers::pi - angle});
  const double along = norm(radial) * std::sin(std::min(from_ends, std::numbers::pi / 2));
  return std::min(depth, angle <= end ? along : -along);
}

// The places where an edge leaves the tube on the saddle, certainly or possibly.
struct PlainExit {
  double coordinate = 0, depth = 0;
  Vec3 normal;
  bool matched = false;
};

std::vector<PlainExit> plain_exits(const Saddle& saddle, const EdgeBatch& batch, std::size_t i) {
  const ContactCircle& circle = saddle.arc.circle;
  const Vec3 outside{batch.x[i], batch.y[i], batch.z[i]}, start = outside - circle.center;
  const auto axis = static_cast<std::size_t>(batch.axis[i]);
  const double from = outside[axis], length = batch.to[i] - from;
  const Vec3 step = length * unit_vector(axis);
  const TubeExits exits = tube_exits(start, step, circle.axis, circle.radius, saddle.probe,
                                     -tolerance::edge_end, 1 + tolerance::edge_end);
  std::vector<PlainExit> result;
  for (int e = 0; e < exits.count; ++e) {
    const double share = std::clamp(exits.parameters[static_cast<std::size_t>(e)], 0.0, 1.0);
    const Vec3 point = start + share * step;
    const Vec3 radial = point - dot(point, circle.axis) * circle.axis;
    result.push_back({from + share * length, depth_in_saddle(saddle.arc, point),
                      normalized((circle.radius / norm(radial)) * radial - point)});
  }
  return result;
}

Vec3 random_saddle_point(const Saddle& saddle, Random& random) {
  const ContactCircle& circle = saddle.arc.circle;
  const ArcSector& sector = saddle.arc.sector;
  const double end =
      sector.kind == ArcKind::full ? 2 * std::numbers::pi : angle_on_arc(saddle.arc, sector.end);
  const double angle = random.uniform(0, end);
  const Vec3 out =
      std::cos(angle) * sector.start + std::sin(angle) * cross(circle.axis, sector.start);
  // The direction lies between those to the two atoms. Points beyond the axis are drawn again.
  const double first = std::atan2(-circle.first_height, circle.radius);
  const double second = std::atan2(circle.second_height, circle.radius);
  for (;;) {
    const double turn = random.uniform(first, second);
    const double from_axis = circle.radius - saddle.probe * std::cos(turn);
    if (from_axis > 0) return from_axis * out + (saddle.probe * std::sin(turn)) * circle.axis;
  }
}

// Makes edges of length `length` near the saddle, or with an end on it.
EdgeBatch edges_near(const Saddle& saddle, double length, std::size_t count, Random& random) {
  EdgeBatch batch;
  for (; batch.count < count; ++batch.count) {
    const std::size_t axis = random.integer(0, 2), n = batch.count;
    const double step = random.chance(0.5) ? length : -length;
    const std::size_t place = random.integer(0, 9);
    const double before = place == 0 ? 0 : place == 1 ? 1 : random.uniform(-1, 2);
    Vec3 start = random_saddle_point(saddle, random);
    start[axis] -= before * step;
    const Vec3 outside = saddle.arc.circle.center + start;
    batch.x[n] = outside.x;
    batch.y[n] = outside.y;
    batch.z[n] = outside.z;
    batch.to[n] = outside[axis] + step;
    batch.axis[n] = static_cast<double>(axis);
    batch.key[n] = n;
  }
  return batch;
}

struct SaddleCounts {
  std::size_t clear = 0, uncertain = 0;
};

// Checks that every certain exit is found, and otherwise only possible ones.
void require_plain_exits(MeetSaddle meet, const Saddle& saddle, double length,
                         const EdgeBatch& edges, SaddleCounts& counts) {
  constexpr double margin = 1e-7;  // angstrom, or square angstrom
  EdgeBatch batch = edges;
  std::vector<SaddleHit> hits;
  meet(saddle.arc, saddle.probe, length, batch, hits);
  std::vector<std::vector<PlainExit>> plain;
  for (std::size_t i = 0; i < edges.count; ++i) plain.push_back(plain_exits(saddle, edges, i));
  for (const SaddleHit& hit : hits) {
    REQUIRE(hit.place < plain.size());
    auto& exits = plain[hit.place];
    const auto match = std::find_if(exits.begin(), exits.end(), [&](const PlainExit& exit) {
      return !exit.matched && std::fabs(exit.coordinate - hit.coordinate) < 1e-8;
    });
    if (match == exits.end()) FAIL("no exit of edge " << hit.place << " at " << hit.coordinate);
    match->matched = true;
    if (match->depth < -margin) REQUIRE(match->depth >= -margin);
    if (match->depth < margin) continue;
    if (!(norm(match->normal - hit.normal) < 1e-6))
      REQUIRE(norm(match->normal - hit.normal) < 1e-6);
  }
  for (std::size_t i = 0; i < plain.size(); ++i)
    for (const PlainExit& exit : plain[i]) {
      counts.clear += exit.depth >= margin;
      counts.uncertain += std::fabs(exit.depth) < margin;
      if (exit.depth >= margin && !exit.matched) FAIL("missed an exit of edge " << i);
    }
}

}  // namespace

TEST_CASE("edges cross a saddle where they leave the tube between its atoms and on its arc") {
  for_each_version(ESES_VERSIONS(meet_saddle), [](MeetSaddle meet) {
    Random random(43);
    SaddleCounts counts;
    for (int repetition = 0; repetition < 500; ++repetition) {
      const Saddle saddle = random_saddle(random);
      const double length = random.uniform(0.1, repetition % 5 == 0 ? 4 : 0.6);
      const std::size_t count = random.integer(1, 80);
      INFO("repetition " << repetition);
      require_plain_exits(meet, saddle, length, edges_near(saddle, length, count, random), counts);
    }
    CHECK(counts.clear > 2000);
    CHECK(counts.uncertain < counts.clear / 100);
  });
}

}  // namespace eses::detail::test
#endif  // HWY_ONCE
