// Compares the blocks of the kernels with a plain computation, which compares all points and edges
// with all patches one by one, without boxes, index and vector instructions.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/test_blocks.cpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "geometry/line_torus.hpp"
#include "geometry/make_grid.hpp"
#include "solve/accessibility.hpp"
#include "solve/classify.hpp"
#include "solve/intersect.hpp"
#include "support/all_patches.hpp"
#include "support/atom_sets.hpp"
#include "support/instruction_sets.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {
void classify(const BlockGrid& grid, const BlockFeatures& features, ClassifyScratch& scratch,
              PointBits& inside);
void intersect(const SurfaceModel& surface, const BlockGrid& grid, const BlockFeatures& features,
               const PointBits& inside, IntersectScratch& scratch, Tally& tally,
               std::vector<BlockCrossing>& crossings, std::vector<std::uint32_t>& row_begin);
}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail::test {
namespace {

using eses::detail::BlockCrossing;
using Classify = void (*)(const BlockGrid&, const BlockFeatures&, ClassifyScratch&, PointBits&);
using Intersect = void (*)(const SurfaceModel&, const BlockGrid&, const BlockFeatures&,
                           const PointBits&, IntersectScratch&, Tally&, std::vector<BlockCrossing>&,
                           std::vector<std::uint32_t>&);

// --- the nearest accessible probe centre -------------------------------------------------------

bool is_on_arc(const ArcFeature& arc, Vec3 radial) {
  if (arc.sector.kind == ArcKind::full) return true;
  const Vec3 start = arc.sector.start;
  const auto angle = [&](Vec3 v) {
    const double a = std::atan2(dot(cross(arc.circle.axis, start), v), dot(start, v));
    return a < 0 ? a + 2 * std::numbers::pi : a;
  };
  return angle(radial) <= angle(arc.sector.end);
}

double distance_to_arc(const ArcFeature& arc, Vec3 point) {
  const ContactCircle& circle = arc.circle;
  const Vec3 offset = point - circle.center;
  const double height = dot(offset, circle.axis);
  const Vec3 radial = offset - height * circle.axis;
  if (is_on_arc(arc, radial)) return std::hypot(circle.radius - norm(radial), height);
  return std::min(norm(offset - circle.radius * arc.sector.start),
                  norm(offset - circle.radius * arc.sector.end));
}

// The test uses all atoms, because a probe that reaches into the block may be centred outside it.
bool is_accessible(const SurfaceModel& surface, Vec3 center) {
  return std::none_of(surface.atoms.begin(), surface.atoms.end(), [&](const Atom& atom) {
    const double sas_radius = atom.radius + surface.probe_radius;
    return norm(center - atom.center) < sas_radius - tolerance::accessible;
  });
}

double plain_probe_distance(const SurfaceModel& surface, const BlockFeatures& features,
                            Vec3 point) {
  double nearest = std::numeric_limits<double>::max();
  const auto offer = [&](double distance) { nearest = std::min(nearest, distance); };
  for (const PlacementFeature& placement : features.placements)
    offer(norm(point - placement.center));
  for (const ArcFeature& arc : features.arcs) offer(distance_to_arc(arc, point));
  for (const FaceFeature& face : features.faces) {
    const Vec3 offset = point - face.center;
    const double length = norm(offset);
    if (length == 0) continue;
    if (is_accessible(surface, face.center + (face.sas_radius / length) * offset))
      offer(std::fabs(face.sas_radius - length));
  }
  return nearest;
}

enum class Shell { inside_atom, outside_all, between };

Shell shell_of(const BlockFeatures& features, Vec3 point) {
  Shell shell = Shell::outside_all;
  for (const BallFeature& ball : features.balls) {
    const double distance = norm(point - ball.center);
    if (distance <= ball.radius) return Shell::inside_atom;
    if (distance < ball.sas_radius) shell = Shell::between;
  }
  return shell;
}

Vec3 random_point_in(const Box& box, Random& random) {
  return {random.uniform(box.low.x, box.high.x), random.uniform(box.low.y, box.high.y),
          random.uniform(box.low.z, box.high.z)};
}

Box bounding_box(std::span<const Atom> atoms) {
  Box box{atoms[0].center, atoms[0].center};
  for (const Atom& atom : atoms) {
    const Box ball = ball_box(atom.center, atom.radius);
    box.include(ball.low);
    box.include(ball.high);
  }
  return box;
}

void require_probe(const SurfaceModel& surface, const PatchIndex& patches, Vec3 point,
                   double expected) {
  constexpr double rounding = 1e-8;
  const double probe = surface.probe_radius;
  const NearestProbe found = nearest_probe(patches, point, probe);
  REQUIRE(found.distance == Catch::Approx(std::min(expected, probe)).epsilon(0).margin(rounding));
  if (std::fabs(expected - probe) < rounding) return;
  REQUIRE((found.atom_count > 0) == (expected < probe));
  // The search may stop early only if the answer is then certain.
  const double enough = 0.8 * probe;
  if (std::fabs(expected - enough) > rounding) {
    REQUIRE((nearest_probe(patches, point, probe, enough).distance < enough) ==
            (expected < enough));
    REQUIRE(is_probe_nearer(patches, point, enough) == (expected < enough));
  }
  if (found.atom_count == 0) return;
  REQUIRE(norm(found.center - point) == Catch::Approx(found.distance).epsilon(0).margin(rounding));
  for (std::size_t a = 0; a < found.atom_count; ++a) {
    const SasSphere sphere = surface.sas_sphere(found.atoms[a]);
    REQUIRE(norm(found.center - sphere.center) ==
            Catch::Approx(sphere.radius).epsilon(0).margin(1e-6));
    if (a > 0) REQUIRE(found.atoms[a - 1] < found.atoms[a]);
  }
}

}  // namespace

TEST_CASE("the patch index finds the nearest probe of all patches") {
  std::size_t near = 0, none = 0;
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const double probe = designed_probe_radius(seed);
      const AllPatches all(atoms, probe);
      const SurfaceModel& surface = all.surface;
      const Box molecule = grown(bounding_box(atoms), probe);
      Random random(seed);
      INFO(kind_name(kind) << " " << seed);
      for (int repetition = 0; repetition < 10; ++repetition) {
        // The boxes range from small ones to boxes around the whole molecule, which the index cuts
        // into cells.
        const double side = repetition == 0 ? 1e3 : random.uniform(0.5, 12);
        const Vec3 low = random_point_in(molecule, random);
        Box box = repetition == 0 ? molecule : Box{low, low + Vec3{side, side, 0.7 * side}};
        BlockFeatures features;
        collect_features(all.patches, box, features);
        PatchIndex patches;
        patches.reset(features, box);
        for (int i = 0; i < 200; ++i) {
          Vec3 point = random_point_in(box, random);
          // Some points are on the faces of the box and on boundaries of cells.
          const std::size_t axis = random.integer(0, 2);
          const double place = box.low[axis] + 4 * static_cast<double>(random.integer(0, 3));
          if (random.chance(0.2)) point[axis] = std::min(place, box.high[axis]);
          if (shell_of(features, point) != Shell::between) continue;
          const double expected = plain_probe_distance(surface, features, point);
          require_probe(surface, patches, point, expected);
          ++(expected < probe ? near : none);
        }
      }
    }
  CHECK(near > 3000);
  CHECK(none > 500);
}

TEST_CASE("points on a probe's sphere find this probe however they are rounded") {
  // The poles of the sphere are at cell boundaries, to the last bits.
  Random random(51);
  for (int repetition = 0; repetition < 20000; ++repetition) {
    BlockFeatures features;
    features.probe_radius = random.uniform(0.7, 3);
    const double low = random.uniform(-20, 20), boundary = low + 4, elsewhere = low + 2.5;
    const Box box{{low, low, low}, {low + 12, low + 12, low + 12}};
    const std::size_t axis = random.integer(0, 2);
    const double side = random.chance(0.5) ? 1 : -1;
    PlacementFeature placement;
    placement.center = {elsewhere, elsewhere, elsewhere};
    placement.center[axis] =
        boundary - side * features.probe_radius + random.uniform(-1, 1) * 1e-14;
    features.placements.push_back(placement);
    PatchIndex patches;
    patches.reset(features, box);
    Vec3 point = placement.center;
    point[axis] += side * (features.probe_radius + 2e-14);
    REQUIRE(nearest_probe(patches, point, std::numeric_limits<double>::max()).atom_count == 3);
  }
}

// --- whole blocks ------------------------------------------------------------------------------

namespace {

struct SolvedBlock {
  BlockGrid grid;
  BlockFeatures features;
  PointBits inside;
};

struct Case {
  std::vector<Atom> atoms;
  double probe = 1.4, spacing = 0.5;
  std::int64_t block_size = 64;
};

// Calls `action(surface, block)` for all blocks of a molecule that have atoms nearby.
template <class Action>
void for_each_block(const Case& molecule, Action&& action) {
  const AllPatches all(molecule.atoms, molecule.probe);
  const Grid grid = make_grid(molecule.atoms, molecule.spacing, 2 * molecule.spacing);
  const BlockTiling tiling = make_tiling(grid, molecule.block_size);
  for (std::int64_t bz = 0; bz < tiling.blocks[2]; ++bz)
    for (std::int64_t by = 0; by < tiling.blocks[1]; ++by)
      for (std::int64_t bx = 0; bx < tiling.blocks[0]; ++bx) {
        SolvedBlock block;
        block.grid.reset(grid, tiling.block(bx, by, bz));
        collect_features(all.patches, block.grid.box, block.features);
        if (block.features.balls.empty()) continue;
        INFO("block " << bx << " " << by << " " << bz);
        action(all.surface, block);
      }
}

PointBits classified(Classify classify, const SolvedBlock& block) {
  ClassifyScratch scratch;
  PointBits inside;
  inside.reset(block.grid.block.points);
  scratch.undecided.reset(block.grid.block.points);
  scratch.batch.make_room();
  classify(block.grid, block.features, scratch, inside);
  return inside;
}

Vec3 grid_point(const BlockGrid& grid, const GridIndex& p) {
  return {grid.coordinates[0][static_cast<std::size_t>(p[0])],
          grid.coordinates[1][static_cast<std::size_t>(p[1])],
          grid.coordinates[2][static_cast<std::size_t>(p[2])]};
}

bool bit_at(const PointBits& bits, std::int64_t column, const GridIndex& p) {
  return (bits.words[bits.word_index(column, p[1], p[2])] >>
              (p[0] - column * PointBits::column_step) &
          1) != 0;
}

bool is_inside(const PointBits& bits, const GridIndex& p) {
  return bit_at(bits, std::min(p[0] / PointBits::column_step, bits.columns - 1), p);
}

template <class Action>
void for_each_index(const GridIndex& size, Action&& action) {
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x) action(GridIndex{x, y, z});
}

// Returns how far the point must move to be classified otherwise, in angstrom; positive inside.
double plain_depth(const SurfaceModel& surface, const BlockFeatures& features, Vec3 point) {
  double in_atom = -1e9, in_sas_ball = -1e9;
  for (const BallFeature& ball : features.balls) {
    const double distance = norm(point - ball.center);
    in_atom = std::max(in_atom, ball.radius - distance);
    in_sas_ball = std::max(in_sas_ball, ball.sas_radius - distance);
  }
  if (in_atom > -1e-9) return in_atom;
  if (in_sas_ball < 1e-9) return -features.probe_radius;
  return plain_probe_distance(surface, features, point) - features.probe_radius;
}

void require_plain_points(const SurfaceModel& surface, const SolvedBlock& block) {
  const PointBits& inside = block.inside;
  for_each_index(block.grid.block.points, [&](const GridIndex& p) {
    const double depth = plain_depth(surface, block.features, grid_point(block.grid, p));
    if (std::fabs(depth) > 1e-7 && is_inside(inside, p) != (depth > 0)) {
      INFO("point " << p[0] << " " << p[1] << " " << p[2] << ", depth " << depth);
      REQUIRE(is_inside(inside, p) == (depth > 0));
    }
  });
  // Points that two columns share are equal in both, and there are no bits after the last point.
  for (std::int64_t column = 0; column + 1 < inside.columns; ++column)
    for_each_index({1, inside.size[1], inside.size[2]}, [&](GridIndex p) {
      p[0] = (column + 1) * PointBits::column_step;
      REQUIRE(bit_at(inside, column, p) == bit_at(inside, column + 1, p));
    });
  for (std::int64_t column = 0; column < inside.columns; ++column)
    for_each_index({1, inside.size[1], inside.size[2]}, [&](const GridIndex& p) {
      const std::uint64_t word = inside.words[inside.word_index(column, p[1], p[2])];
      REQUIRE((word & ~low_bits(inside.size[0] - column * PointBits::column_step)) == 0);
    });
}

// --- candidates by the formulas of the patches -----------------------------------------------

struct Candidates {
  const BlockFeatures& features;
  CrossedEdge edge;
  std::vector<BlockCrossing> found;

  double low() const { return edge.lower[edge.axis]; }

  void add(double coordinate, Vec3 normal, std::array<AtomIndex, 3> atoms, int count) {
    BlockCrossing crossing;
    crossing.coordinate = std::clamp(coordinate, low(), edge.upper);
    crossing.normal = normal;
    crossing.atoms = atoms;
    crossing.axis = static_cast<std::uint8_t>(edge.axis);
    crossing.atom_count = static_cast<std::uint8_t>(count & 3);
    crossing.lower_is_inside = edge.lower_is_inside;
    found.push_back(crossing);
  }

  // Calls action(coordinate, offset from the centre) where the edge enters or leaves the ball,
  // within the slack at its ends. The edge goes from its outside end to its inside end.
  template <class Action>
  void meet_sphere(Vec3 center, double radius, bool enters_ball, Action&& action) const {
    Vec3 offset = edge.lower - center;
    offset[edge.axis] = 0;
    const double discriminant = radius * radius - squared_norm(offset);
    if (discriminant < -1e-12) return;
    const double side = (edge.inward() < 0) == enters_ball ? 1 : -1;
    offset[edge.axis] = side * std::sqrt(std::max(0.0, discriminant));
    const double coordinate = center[edge.axis] + offset[edge.axis];
    const double slack = tolerance::edge_end * (edge.upper - low());
    if (coordinate >= low() - slack && coordinate <= edge.upper + slack) action(coordinate, offset);
  }

  void add_face(const FaceFeature& face) {
    meet_sphere(face.center, face.radius, true, [&](double coordinate, Vec3 offset) {
      Vec3 direction;
      if (is_point_atom(face)) {
        direction[edge.axis] = -edge.inward();
      } else {
        direction = normalized(offset);
      }
      // The probe that touches the atom there is in no other SAS ball.
      const Vec3 probe = face.center + face.sas_radius * direction;
      for (const CapCone& cone : features.cones_of(face))
        if (dot(cone.axis, probe - face.center) >
            cone.cosine * face.sas_radius + tolerance::seam * face.sas_radius)
          return;
      add(coordinate, direction, {face.atom}, 1);
    });
  }

  void add_placement(const PlacementFeature& placement) {
    meet_sphere(placement.center, features.probe_radius, false,
                [&](double coordinate, Vec3 offset) {
                  const Vec3 direction = normalized(offset);
                  for (const Vec3& plane : placement.cone)
                    if (placement.is_regular && dot(plane, direction) < -tolerance::seam) return;
                  add(coordinate, -direction, placement.atoms, 3);
                });
  }

  void add_saddle(const ArcFeature& arc) {
    const ContactCircle& circle = arc.circle;
    const double probe = features.probe_radius;
    Vec3 start = edge.lower - circle.center, step;
    if (edge.lower_is_inside) start[edge.axis] = edge.upper - circle.center[edge.axis];
    step[edge.axis] = edge.inward() * (edge.upper - low());
    const TubeExits exits = tube_exits(start, step, circle.axis, circle.radius, probe,
                                       -tolerance::edge_end, 1 + tolerance::edge_end);
    for (int e = 0; e < exits.count; ++e) {
      const double share = std::clamp(exits.parameters[static_cast<std::size_t>(e)], 0.0, 1.0);
      const Vec3 point = start + share * step;
      const auto [height, inward] = meridian_point(circle, point);
      const double slack = -tolerance::seam * circle.radius;
      if (circle.radius * height + circle.first_height * inward < slack ||
          circle.second_height * inward - circle.radius * height < slack ||
          !projects_onto_arc(arc.sector, point))
        continue;
      const Vec3 center = circle.radius * nearest_on_arc(arc, point);
      add(point[edge.axis] + circle.center[edge.axis], normalized(center - point),
          {arc.atoms[0], arc.atoms[1]}, 2);
    }
  }
};

std::vector<BlockCrossing> plain_candidates(const BlockFeatures& features,
                                            const CrossedEdge& edge) {
  Candidates candidates{features, edge, {}};
  for (const FaceFeature& face : features.faces) candidates.add_face(face);
  for (const PlacementFeature& placement : features.placements) candidates.add_placement(placement);
  for (const ArcFeature& arc : features.arcs) candidates.add_saddle(arc);
  return candidates.found;
}

struct PlainEdge {
  CrossedEdge edge;
  std::int64_t x = 0;
  BlockCrossing decided;
  std::vector<BlockCrossing> candidates;
};

struct PlainEdges {
  std::vector<PlainEdge> edges;  // canonical order
  std::vector<std::uint32_t> row_begin;
};

PlainEdges plain_edges(const SolvedBlock& block) {
  const BlockGrid& grid = block.grid;
  PatchIndex patches;
  patches.reset(block.features, grid.box);
  PlainEdges plain;
  for_each_index(grid.block.owned, [&](const GridIndex& p) {
    if (p[0] == 0) plain.row_begin.push_back(static_cast<std::uint32_t>(plain.edges.size()));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      GridIndex next = p;
      ++next[axis];
      const bool lower_is_inside = is_inside(block.inside, p);
      if (next[axis] == grid.block.points[axis] || is_inside(block.inside, next) == lower_is_inside)
        continue;
      PlainEdge edge;
      edge.edge = make_crossed_edge(grid, axis, p, lower_is_inside);
      edge.x = p[0];
      edge.candidates = plain_candidates(block.features, edge.edge);
      edge.decided = decide_crossing(patches, edge.edge, edge.candidates);
      plain.edges.push_back(edge);
    }
  });
  plain.row_begin.push_back(static_cast<std::uint32_t>(plain.edges.size()));
  return plain;
}

bool is_same_contact(const BlockCrossing& a, const BlockCrossing& b) {
  return a.atom_count == b.atom_count && a.atoms == b.atoms && norm(a.normal - b.normal) < 1e-5 &&
         std::fabs(a.coordinate - b.coordinate) < 1e-8;
}

void require_plain_crossing(const BlockCrossing& crossing, const PlainEdge& plain) {
  const CrossedEdge& edge = plain.edge;
  REQUIRE(crossing.axis == edge.axis);
  REQUIRE(crossing.x == plain.x);
  REQUIRE(crossing.lower_is_inside == edge.lower_is_inside);
  INFO("axis " << edge.axis << " at " << edge.lower.x << " " << edge.lower.y << " " << edge.lower.z
               << ", " << plain.candidates.size() << " candidates: " << crossing.coordinate
               << " with " << static_cast<int>(crossing.atom_count) << " atoms instead of "
               << plain.decided.coordinate << " with "
               << static_cast<int>(plain.decided.atom_count));
  if (is_same_contact(crossing, plain.decided)) return;
  // Where patches meet at one point, rounding decides which patch is named.
  REQUIRE(std::fabs(crossing.coordinate - plain.decided.coordinate) < 2 * tolerance::same_crossing);
  REQUIRE(
      std::any_of(plain.candidates.begin(), plain.candidates.end(),
                  [&](const BlockCrossing& other) { return is_same_contact(crossing, other); }));
}

struct EdgeCounts {
  std::size_t edges = 0, several = 0, none = 0;
  std::array<std::size_t, 3> by_atoms{};

  void add(const EdgeCounts& other) {
    edges += other.edges;
    several += other.several;
    none += other.none;
    for (std::size_t i = 0; i < 3; ++i) by_atoms[i] += other.by_atoms[i];
  }
};

// Checks that a tally has the sums of all crossings of a block.
void require_plain_tally(const SurfaceModel& surface, const BlockGrid& grid,
                         const std::vector<BlockCrossing>& crossings,
                         const std::vector<std::uint32_t>& row_begin, const Tally& tally) {
  Tally plain;
  const auto rows_y = static_cast<std::size_t>(grid.block.owned[1]);
  for (std::size_t row = 0; row + 1 < row_begin.size(); ++row)
    for (std::uint32_t c = row_begin[row]; c < row_begin[row + 1]; ++c)
      plain.add_edge(surface, crossings[c],
                     {grid.coordinates[0][crossings[c].x], grid.coordinates[1][row % rows_y],
                      grid.coordinates[2][row / rows_y]},
                     grid.inverse_spacing);
  REQUIRE(tally.totals.crossings == plain.totals.crossings);
  REQUIRE((tally.totals.kind_shares == plain.totals.kind_shares));
  REQUIRE((tally.totals.inside_lengths == plain.totals.inside_lengths));
  for (AtomIndex i = 0; i < surface.atoms.size(); ++i)
    REQUIRE((tally.atom_shares[i] == plain.atom_shares[i]));
}

EdgeCounts require_plain_edges(const SurfaceModel& surface, const SolvedBlock& block) {
  const PlainEdges plain = plain_edges(block);
  EdgeCounts counts;
  for (const PlainEdge& edge : plain.edges) {
    ++counts.edges;
    counts.several += edge.candidates.size() > 1;
    counts.none += edge.candidates.empty();
    ++counts.by_atoms[edge.decided.atom_count - 1U];
  }
  for_each_version(ESES_VERSIONS(intersect), [&](Intersect intersect) {
    IntersectScratch scratch;
    std::vector<BlockCrossing> crossings;
    std::vector<std::uint32_t> row_begin;
    Tally tally;
    intersect(surface, block.grid, block.features, block.inside, scratch, tally, crossings,
              row_begin);
    require_plain_tally(surface, block.grid, crossings, row_begin, tally);
    REQUIRE(crossings.size() == plain.edges.size());
    REQUIRE((row_begin == plain.row_begin));
    for (std::size_t i = 0; i < crossings.size(); ++i)
      require_plain_crossing(crossings[i], plain.edges[i]);
  });
  return counts;
}

EdgeCounts require_plain_blocks(const Case& molecule) {
  EdgeCounts counts;
  for_each_block(molecule, [&](const SurfaceModel& surface, SolvedBlock& block) {
    block.inside = classified(ESES_VERSIONS(classify).baseline, block);
    require_plain_points(surface, block);
    for_each_version(ESES_VERSIONS(classify), [&](Classify classify) {
      REQUIRE((classified(classify, block).words == block.inside.words));
    });
    counts.add(require_plain_edges(surface, block));
  });
  return counts;
}

}  // namespace

TEST_CASE("blocks have the points and crossings of a plain computation") {
  EdgeCounts counts;
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      Case molecule{make_atom_set(kind, seed), designed_probe_radius(seed), 0.5, 64};
      // Coarse grids and odd block sizes are included.
      if (seed == 2) {
        molecule.spacing = 0.83;
        molecule.block_size = 11;
      }
      INFO(kind_name(kind) << " " << seed);
      counts.add(require_plain_blocks(molecule));
    }
  for (const std::size_t count : counts.by_atoms) CHECK(count > 2000);
  CHECK(counts.several > 200);
  // Bisection is only needed where rounding has removed all candidates.
  CHECK(counts.none < counts.edges / 1000);
}

TEST_CASE("a block of several columns has the crossings of a plain computation") {
  Case molecule{make_chain(40, 6), 1.4, 0.21, 150};
  const EdgeCounts counts = require_plain_blocks(molecule);
  CHECK(counts.edges > 5000);
  CHECK(counts.none == 0);
}

TEST_CASE("an atom of radius 0 on a grid point has crossings outward along each edge") {
  // The other atom is far away, so that the point itself is the surface.
  for (const double radius : {0.0, 0.5}) {
    const Case molecule{{{{0, 0, 0}, radius}, {{8, 8, 8}, 1}}, 1.4, 0.25, 20};
    const Grid grid = make_grid(molecule.atoms, molecule.spacing, 2 * molecule.spacing);
    const AllPatches all(molecule.atoms, molecule.probe);
    SolvedBlock block;
    block.grid.reset(grid, make_tiling(grid, molecule.block_size).block(0, 0, 0));
    collect_features(all.patches, block.grid.box, block.features);
    block.inside = classified(ESES_VERSIONS(classify).baseline, block);
    INFO("radius " << radius);
    for_each_version(ESES_VERSIONS(intersect), [&](Intersect intersect) {
      IntersectScratch scratch;
      std::vector<BlockCrossing> crossings;
      std::vector<std::uint32_t> row_begin;
      Tally tally;
      intersect(all.surface, block.grid, block.features, block.inside, scratch, tally, crossings,
                row_begin);
      // Edges that end at a pole of the sphere, which is a grid point, count as crossed there.
      std::size_t poles = 0;
      for (const BlockCrossing& crossing : crossings) {
        const double outward = crossing.lower_is_inside ? 1 : -1;
        CHECK(crossing.atom_count == 1);
        CHECK(crossing.atoms[0] == 0);
        CHECK(norm(crossing.normal) == Catch::Approx(1).epsilon(0).margin(1e-12));
        CHECK(crossing.normal[crossing.axis] * outward >= 0);
        if (std::fabs(crossing.normal[crossing.axis]) < 1 - 1e-12) continue;
        CHECK(crossing.coordinate == outward * radius);
        ++poles;
      }
      CHECK(poles == 6);
      if (radius == 0) CHECK(crossings.size() == 6);
    });
    require_plain_blocks(molecule);
  }
}

}  // namespace eses::detail::test
#endif  // HWY_ONCE
