// Compares the kernels that intersect several lines at a time with spheres and tubes with plain
// formulas for one line.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/test_line_kernels.cpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "geometry/line_torus-inl.hpp"
#include "solve/edge_sphere-inl.hpp"
#include "support/atom_sets.hpp"
#include "support/instruction_sets.hpp"

// The types that the versions and the tests share, defined once for all instruction sets.
#ifndef ESES_TEST_LINE_KERNELS_SHARED_
#define ESES_TEST_LINE_KERNELS_SHARED_
namespace eses::detail::test {

struct Tube {
  Vec3 axis;
  double circle_radius = 0, tube_radius = 0;
};

// Lines along coordinate axes, relative to the circle's centre.
struct Lines {
  std::vector<double> axis, x, y, z, step;

  void add(std::size_t line_axis, Vec3 start, double along) {
    axis.push_back(static_cast<double>(line_axis));
    x.push_back(start.x);
    y.push_back(start.y);
    z.push_back(start.z);
    step.push_back(along);
  }
};

enum class Exits { none, one, maybe_several };

struct LineExits {
  std::vector<Exits> exits;
  std::vector<double> parameters;
};

// The part of a sphere where the offset d from the centre satisfies d . normal >= 0. Only lines
// through the box are searched, as in search_face() and search_placement().
struct HalfSphere {
  Vec3 center;
  double radius = 0;
  Box box;
  Vec3 normal;
};

struct LineHit {
  std::size_t axis = 0;
  std::int64_t row = 0, across = 0;  // indices of the line, along the higher and the lower axis
  int side = 0;
  double coordinate = 0;
  Vec3 direction;

  auto place() const { return std::tuple(axis, row, across, side); }
};

struct EdgeHit {
  std::uint64_t edge = 0;
  double coordinate = 0;
  Vec3 direction;
};

}  // namespace eses::detail::test
#endif  // ESES_TEST_LINE_KERNELS_SHARED_

HWY_BEFORE_NAMESPACE();
namespace eses::detail::test::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace kernel = eses::detail::HWY_NAMESPACE;

// The number of lines must be a multiple of the number of lanes.
void find_exits(const Tube& tube, const Lines& lines, double low, double high, LineExits& found) {
  found.exits.assign(lines.step.size(), Exits::none);
  found.parameters.assign(lines.step.size(), 0);
  const std::size_t lanes = hn::Lanes(kernel::Doubles());
  for (std::size_t i = 0; i < lines.step.size(); i += lanes) {
    const kernel::Points start{kernel::load(&lines.x[i]), kernel::load(&lines.y[i]),
                               kernel::load(&lines.z[i])};
    const auto exits = kernel::only_tube_exits(kernel::LaneAxes(kernel::load(&lines.axis[i])),
                                               start, kernel::load(&lines.step[i]), tube.axis,
                                               tube.circle_radius, tube.tube_radius, low, high);
    const kernel::LaneValues parameters(exits.parameters);
    for (std::size_t lane = 0; lane < lanes; ++lane) found.parameters[i + lane] = parameters[lane];
    kernel::for_each_lane(exits.is_one,
                          [&](std::size_t lane) { found.exits[i + lane] = Exits::one; });
    kernel::for_each_lane(exits.may_be_several,
                          [&](std::size_t lane) { found.exits[i + lane] = Exits::maybe_several; });
  }
}

template <std::size_t axis>
void meet_lines_along(const BlockGrid& grid, const HalfSphere& half, std::vector<LineHit>& hits) {
  const auto is_kept = [&](kernel::DoubleMask met, const kernel::Points& offset,
                           kernel::DoubleVector) {
    return hn::And(met, kernel::dot(half.normal, offset) >= kernel::broadcast(0));
  };
  for (const int side : {1, -1})
    kernel::meet_lines<axis>(
        grid, {half.center, half.radius, half.box}, side, is_kept,
        [&](const GridIndex& line, double coordinate, Vec3 direction) {
          constexpr std::size_t row = axis == 2 ? 1 : 2, across = axis == 0 ? 1 : 0;
          hits.push_back({axis, line[row], line[across], side, coordinate, direction});
        });
}

void meet_sphere(const HalfSphere& half, double side, EdgeBatch& edges,
                 std::vector<EdgeHit>& hits) {
  const auto is_kept = [&](kernel::DoubleMask met, const kernel::Points& offset,
                           kernel::DoubleVector) {
    return hn::And(met, kernel::dot(half.normal, offset) >= kernel::broadcast(0));
  };
  kernel::meet_sphere(
      {half.center, half.radius, half.box}, side, edges, is_kept,
      [&](std::uint64_t edge, double coordinate, Vec3 direction) {
        hits.push_back({edge, coordinate, direction});
        return false;
      },
      [](const auto&...) {});
}

void meet_lines(const BlockGrid& grid, const HalfSphere& half, std::vector<LineHit>& hits) {
  meet_lines_along<0>(grid, half, hits);
  meet_lines_along<1>(grid, half, hits);
  meet_lines_along<2>(grid, half, hits);
}

}  // namespace eses::detail::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail::test {
namespace {

using FindExits = void (*)(const Tube&, const Lines&, double, double, LineExits&);
using MeetLines = void (*)(const BlockGrid&, const HalfSphere&, std::vector<LineHit>&);
using MeetSphere = void (*)(const HalfSphere&, double, EdgeBatch&, std::vector<EdgeHit>&);

// --- tubes -------------------------------------------------------------------------------------

constexpr std::size_t lines_per_tube = 64;

double distance_to_circle(const Tube& tube, Vec3 w) {
  const double height = dot(w, tube.axis);
  return std::hypot(norm(w - height * tube.axis) - tube.circle_radius, height);
}

Tube random_tube(Random& random, bool is_along_axis) {
  const Vec3 axis = is_along_axis
                        ? (random.chance(0.5) ? 1 : -1) * unit_vector(random.integer(0, 2))
                        : random_direction(random);
  return {axis, random.uniform(0.05, 4), random.uniform(0.7, 3)};
}

// Returns a point of the tube whose normal is perpendicular to `along`, if there is one.
Vec3 tangent_point(const Tube& tube, Vec3 along, Random& random) {
  const Vec3 e1 = any_perpendicular(tube.axis), e2 = cross(tube.axis, e1);
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  const Vec3 out = std::cos(angle) * e1 + std::sin(angle) * e2;
  const double turn = std::atan2(-dot(out, along), dot(tube.axis, along));
  const double side = random.chance(0.5) ? 1 : -1;
  return tube.circle_radius * out +
         side * tube.tube_radius * (std::cos(turn) * out + std::sin(turn) * tube.axis);
}

enum class Place { near_surface, through_axis, tangent, lattice };

Vec3 line_start(const Tube& tube, Place place, double step, Vec3 along, Random& random) {
  const double before = random.uniform(-0.5, 1.5);
  switch (place) {
    case Place::through_axis:
      return random.uniform(-3, 3) * tube.axis - (before * step) * along;
    case Place::tangent:
      return tangent_point(tube, along, random) - (before * step) * along;
    case Place::lattice: {
      Vec3 start;
      for (std::size_t a = 0; a < 3; ++a)
        start[a] = 0.5 * static_cast<double>(random.integer(0, 24)) - 6;
      return start;
    }
    case Place::near_surface:
      break;
  }
  for (;;) {
    const Vec3 start = random_point(random, tube.circle_radius + tube.tube_radius + step);
    if (std::fabs(distance_to_circle(tube, start) - tube.tube_radius) < step) return start;
  }
}

struct ExitCounts {
  std::size_t lines = 0, one = 0, maybe_several = 0;
};

// The bounds of the parameter are those of meet_saddle().
void require_exits_of_tube_exits(FindExits find, const Tube& tube, const Lines& lines,
                                 ExitCounts& counts) {
  constexpr double low = -tolerance::edge_end, high = 1 + tolerance::edge_end;
  LineExits found;
  find(tube, lines, low, high, found);
  for (std::size_t i = 0; i < lines.step.size(); ++i) {
    ++counts.lines;
    if (found.exits[i] == Exits::maybe_several) {
      ++counts.maybe_several;
      continue;
    }
    const Vec3 start{lines.x[i], lines.y[i], lines.z[i]};
    const Vec3 step = lines.step[i] * unit_vector(static_cast<std::size_t>(lines.axis[i]));
    const TubeExits expected =
        tube_exits(start, step, tube.axis, tube.circle_radius, tube.tube_radius, low, high);
    const bool is_one = found.exits[i] == Exits::one;
    INFO("circle radius " << tube.circle_radius << ", tube radius " << tube.tube_radius << ", line "
                          << i);
    if (expected.count != is_one) REQUIRE(expected.count == is_one);
    if (!is_one) continue;
    ++counts.one;
    const double parameter = found.parameters[i];
    if (!(std::fabs(parameter - expected.parameters[0]) < 1e-9))
      REQUIRE(parameter == Catch::Approx(expected.parameters[0]).epsilon(0).margin(1e-9));
    const double distance = distance_to_circle(tube, start + parameter * step);
    // Values beyond the ends of the edge are clamped.
    if (!(std::fabs(distance - tube.tube_radius) < 1e-12) && parameter > low && parameter < high)
      REQUIRE(distance == Catch::Approx(tube.tube_radius).epsilon(0).margin(1e-12));
  }
}

ExitCounts compare_exits(FindExits find, Place place, double max_step) {
  ExitCounts counts;
  Random random(41);
  for (int repetition = 0; repetition < 600; ++repetition) {
    Tube tube = random_tube(random, place == Place::lattice || repetition % 4 == 0);
    if (place == Place::lattice) {
      tube.circle_radius = 0.5 * static_cast<double>(random.integer(1, 8));
      tube.tube_radius = 0.5 * static_cast<double>(random.integer(1, 6));
    }
    Lines lines;
    while (lines.step.size() < lines_per_tube) {
      const std::size_t axis = random.integer(0, 2);
      const double step = place == Place::lattice ? 0.5 : random.uniform(0.1, max_step);
      const double side = random.chance(0.5) ? 1 : -1;
      lines.add(axis, line_start(tube, place, step, side * unit_vector(axis), random), side * step);
    }
    require_exits_of_tube_exits(find, tube, lines, counts);
  }
  return counts;
}

}  // namespace

TEST_CASE("lines with one exit from a tube have the exit of tube_exits()") {
  for_each_version(ESES_VERSIONS(find_exits), [](FindExits find) {
    // These lines are as short as grid edges. Hardly any of them has several possible exits.
    const ExitCounts edges = compare_exits(find, Place::near_surface, 0.5);
    CHECK(edges.one > edges.lines / 10);
    CHECK(edges.maybe_several < edges.lines / 20);
    const ExitCounts lattice = compare_exits(find, Place::lattice, 0.5);
    CHECK(lattice.one > lattice.lines / 200);
    CHECK(lattice.maybe_several < lattice.lines / 20);
    // These are long lines, lines through the axis, and lines that graze.
    for (const Place place : {Place::near_surface, Place::through_axis, Place::tangent}) {
      const ExitCounts counts = compare_exits(find, place, 5);
      CHECK(counts.one > counts.lines / 100);
    }
  });
}

// --- spheres -----------------------------------------------------------------------------------

namespace {

BlockGrid make_block_grid(double spacing, const GridIndex& first, const GridIndex& points,
                          const GridIndex& owned) {
  Grid grid;
  grid.spacing = spacing;
  grid.origin = {-4, -3.7, -5.01};
  BlockGrid block;
  block.reset(grid, {first, points, owned});
  return block;
}

// The hits that are certain, and those that rounding may decide either way.
struct PlainHits {
  std::vector<LineHit> hits;
  std::vector<LineHit> uncertain;
};

bool is_uncertain(double value, double margin) { return std::fabs(value) < margin; }

// Solves |p - center| = radius for every line through owned points, and tests both roots.
PlainHits plain_hits(const BlockGrid& grid, const HalfSphere& half) {
  constexpr double tangent = -1e-12, rounding = 1e-12;
  const double near_range = 2e-6 * grid.grid.spacing;
  PlainHits plain;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t row = axis == 2 ? 1 : 2, across = axis == 0 ? 1 : 0;
    for (std::int64_t k = 0; k < grid.block.owned[row]; ++k)
      for (std::int64_t j = 0; j < grid.block.owned[across]; ++j) {
        Vec3 point;
        point[row] = grid.coordinates[row][static_cast<std::size_t>(k)];
        point[across] = grid.coordinates[across][static_cast<std::size_t>(j)];
        point[axis] = half.center[axis];
        const double discriminant = half.radius * half.radius - squared_norm(point - half.center);
        for (const int side : {1, -1}) {
          point[axis] = half.center[axis] + side * std::sqrt(std::max(0.0, discriminant));
          const Vec3 offset = point - half.center;
          const double kept = dot(half.normal, offset);
          double in_box = 1e9;
          bool is_near_range = false;
          for (std::size_t a = 0; a < 3; ++a) {
            const double depth = std::min(point[a] - half.box.low[a], half.box.high[a] - point[a]);
            in_box = std::min(in_box, depth);
            is_near_range = is_near_range || is_uncertain(depth, a == axis ? rounding : near_range);
          }
          const LineHit hit{axis, k, j, side, point[axis], (1 / norm(offset)) * offset};
          if (is_near_range || is_uncertain(kept, rounding) ||
              is_uncertain(discriminant - tangent, 0.01 * rounding)) {
            plain.uncertain.push_back(hit);
          } else if (discriminant >= tangent && kept >= 0 && in_box >= 0) {
            plain.hits.push_back(hit);
          }
        }
      }
  }
  return plain;
}

bool is_among(const std::vector<LineHit>& hits, const LineHit& hit) {
  return std::any_of(hits.begin(), hits.end(),
                     [&](const LineHit& other) { return other.place() == hit.place(); });
}

void require_plain_hits(MeetLines meet, const BlockGrid& grid, const HalfSphere& half,
                        const PlainHits& plain) {
  std::vector<LineHit> hits;
  meet(grid, half, hits);
  std::erase_if(hits, [&](const LineHit& hit) { return is_among(plain.uncertain, hit); });
  REQUIRE(hits.size() == plain.hits.size());
  const auto by_place = [](const LineHit& a, const LineHit& b) { return a.place() < b.place(); };
  std::sort(hits.begin(), hits.end(), by_place);
  std::vector<LineHit> expected = plain.hits;
  std::sort(expected.begin(), expected.end(), by_place);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    REQUIRE(hits[i].place() == expected[i].place());
    REQUIRE(hits[i].coordinate == Catch::Approx(expected[i].coordinate).epsilon(0).margin(1e-12));
    if (half.radius > 1e-6) REQUIRE(norm(hits[i].direction - expected[i].direction) < 1e-9);
  }
}

}  // namespace

TEST_CASE("grid lines meet a part of a sphere where the quadratic formula says so") {
  Random random(42);
  std::size_t found = 0, uncertain = 0;
  for (int repetition = 0; repetition < 300; ++repetition) {
    const double spacing = random.uniform(0.2, 1);
    const bool is_last = random.chance(0.5);
    GridIndex points{}, owned{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      points[axis] = static_cast<std::int64_t>(random.integer(2, 22));
      owned[axis] = is_last ? points[axis] : points[axis] - 1;
    }
    const BlockGrid grid = make_block_grid(spacing, {3, 0, 7}, points, owned);
    HalfSphere half;
    half.center = 0.5 * (grid.box.low + grid.box.high) + random_point(random, 4);
    half.radius = random.uniform(0.3, 4);
    half.box = grown(ball_box(half.center, half.radius), 1e-5);
    half.normal = random_direction(random);
    // The box cuts the part off, as it does for patches.
    if (random.chance(0.5)) half.box.low[random.integer(0, 2)] += random.uniform(0, half.radius);
    const PlainHits plain = plain_hits(grid, half);
    found += plain.hits.size();
    uncertain += plain.uncertain.size();
    INFO("repetition " << repetition);
    for_each_version(ESES_VERSIONS(meet_lines),
                     [&](MeetLines meet) { require_plain_hits(meet, grid, half, plain); });
  }
  CHECK(found > 10000);
  CHECK(uncertain < found / 1000);
}

TEST_CASE("grid lines meet a sphere through grid points, also where they touch it") {
  // Coordinates and distances are powers of two, and so exact: radius 0, and tangent lines.
  const double spacing = 0.25;
  Grid grid;
  grid.spacing = spacing;
  grid.origin = {-4, -4, -4};
  BlockGrid block;
  block.reset(grid, {{0, 0, 0}, {33, 33, 33}, {33, 33, 33}});
  // A line that misses the sphere by very little counts as meeting it.
  for (const double radius : {0.0, 1e-9, 0.25, 1.0, 1.25, 1 - 2e-13, 1 - 1e-11}) {
    for (const Vec3 center : {Vec3{0, 0, 0}, {0.25, -1, 2}, {-4, 4, 0}}) {
      const HalfSphere half{center, radius, grown(ball_box(center, radius), 1e-5), {0, 0, 0}};
      INFO("radius " << radius);
      // All lines within 1e-12 square angstrom of the ball meet it. Rounding decides nothing here.
      PlainHits plain;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::int64_t k = 0; k < 33; ++k)
          for (std::int64_t j = 0; j < 33; ++j) {
            const std::size_t row = axis == 2 ? 1 : 2, across = axis == 0 ? 1 : 0;
            Vec3 offset;
            offset[row] = block.coordinates[row][static_cast<std::size_t>(k)] - center[row];
            offset[across] =
                block.coordinates[across][static_cast<std::size_t>(j)] - center[across];
            const double squared = radius * radius - squared_norm(offset);
            if (squared < -1e-12) continue;
            for (const int side : {1, -1}) {
              offset[axis] = side * std::sqrt(std::max(0.0, squared));
              plain.hits.push_back(
                  {axis, k, j, side, center[axis] + offset[axis], (1 / norm(offset)) * offset});
            }
          }
      REQUIRE(plain.hits.size() >= 6);
      for_each_version(ESES_VERSIONS(meet_lines),
                       [&](MeetLines meet) { require_plain_hits(meet, block, half, plain); });
    }
  }
}

namespace {

// Makes edges near a sphere, or with an end on it.
EdgeBatch edges_near(const HalfSphere& half, std::size_t count, Random& random) {
  EdgeBatch edges;
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t axis = random.integer(0, 2);
    const double step = (random.chance(0.5) ? 1 : -1) * random.uniform(0.1, 1);
    Vec3 start = half.radius * random_direction(random);
    start[axis] -= (random.chance(0.1) ? 0 : random.uniform(-1, 2)) * step;
    const Vec3 outside = half.center + start;
    edges.x[n] = outside.x;
    edges.y[n] = outside.y;
    edges.z[n] = outside.z;
    edges.to[n] = outside[axis] + step;
    edges.axis[n] = static_cast<double>(axis);
    edges.key[n] = n;
  }
  edges.count = count;
  return edges;
}

// How clearly an edge meets the part of a sphere, and where. The depth is negative if it does not.
struct PlainMeeting {
  double depth = 0, coordinate = 0;
  Vec3 direction;
};

PlainMeeting plain_meeting(const HalfSphere& half, double side, const EdgeBatch& edges,
                           std::size_t n) {
  const auto axis = static_cast<std::size_t>(edges.axis[n]);
  const Vec3 outside{edges.x[n], edges.y[n], edges.z[n]};
  const double from = outside[axis];
  Vec3 offset = outside - half.center;
  offset[axis] = 0;
  const double squared = half.radius * half.radius - squared_norm(offset);
  if (squared < 0) return {squared, 0, {}};
  const double outwards = from > edges.to[n] ? side : -side;
  offset[axis] = outwards * std::sqrt(squared);
  const double coordinate = half.center[axis] + offset[axis];
  const auto [low, high] = std::minmax(from, edges.to[n]);
  const double depth =
      std::min({squared, coordinate - low, high - coordinate, coordinate - half.box.low[axis],
                half.box.high[axis] - coordinate, dot(half.normal, offset)});
  return {depth, coordinate, normalized(offset)};
}

// Checks that every certain meeting is found, and otherwise only possible ones. Returns the number
// of certain ones.
std::size_t require_plain_meetings(MeetSphere meet, const HalfSphere& half, double side,
                                   const EdgeBatch& edges) {
  constexpr double margin = 2e-6;  // edges may be met slightly beyond their ends
  EdgeBatch batch = edges;
  std::vector<EdgeHit> hits;
  meet(half, side, batch, hits);
  CHECK(batch.count == 0);
  std::vector<bool> is_met(edges.count);
  for (const EdgeHit& hit : hits) {
    REQUIRE(hit.edge < edges.count);
    const PlainMeeting plain = plain_meeting(half, side, edges, hit.edge);
    REQUIRE(plain.depth > -margin);
    REQUIRE(!is_met[hit.edge]);
    is_met[hit.edge] = true;
    if (plain.depth < margin) continue;
    REQUIRE(std::fabs(hit.coordinate - plain.coordinate) < 1e-9);
    REQUIRE(norm(hit.direction - plain.direction) < 1e-9);
  }
  std::size_t certain = 0;
  for (std::size_t n = 0; n < edges.count; ++n) {
    if (plain_meeting(half, side, edges, n).depth < margin) continue;
    ++certain;
    REQUIRE(is_met[n]);
  }
  return certain;
}

}  // namespace

TEST_CASE("edges meet a part of a sphere where they leave or enter it towards their outside ends") {
  for_each_version(ESES_VERSIONS(meet_sphere), [](MeetSphere meet) {
    Random random(44);
    std::size_t certain = 0;
    for (int repetition = 0; repetition < 500; ++repetition) {
      HalfSphere half;
      half.center = random_point(random, 10);
      half.radius = random.uniform(0.3, 4);
      half.box = grown(ball_box(half.center, half.radius), 1e-5);
      if (random.chance(0.5)) half.box.low[random.integer(0, 2)] += random.uniform(0, half.radius);
      half.normal = random_direction(random);
      INFO("repetition " << repetition);
      certain += require_plain_meetings(meet, half, random.chance(0.5) ? 1 : -1,
                                        edges_near(half, random.integer(1, 80), random));
    }
    CHECK(certain > 2000);
  });
}

}  // namespace eses::detail::test
#endif  // HWY_ONCE
