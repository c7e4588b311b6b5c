// Compares the sums over several crossings of a patch at a time with those of one crossing after
// the other.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/test_patch_tally.cpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <vector>

#include "solve/patch_tally-inl.hpp"
#include "support/atom_sets.hpp"
#include "support/instruction_sets.hpp"

// The type that the versions and the tests share, defined once for all instruction sets.
#ifndef ESES_TEST_PATCH_TALLY_SHARED_
#define ESES_TEST_PATCH_TALLY_SHARED_
namespace eses::detail::test {

// Edges with the coordinates and normals of their crossings. The patch has the first atoms.
struct CrossedEdges {
  EdgeBatch edges;
  std::array<double, EdgeBatch::capacity + vector_padding> coordinates{}, x{}, y{}, z{};
  std::size_t atom_count = 1;
};

}  // namespace eses::detail::test
#endif  // ESES_TEST_PATCH_TALLY_SHARED_

HWY_BEFORE_NAMESPACE();
namespace eses::detail::test::HWY_NAMESPACE {
namespace kernel = eses::detail::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

template <std::size_t count>
void add_edges(const SurfaceModel& surface, const CrossedEdges& crossed, double inverse_spacing,
               Tally& tally) {
  std::array<AtomIndex, count> atoms;
  for (AtomIndex i = 0; i < count; ++i) atoms[i] = i;
  const kernel::Doubles doubles;
  kernel::PatchTally<count> sums(surface, atoms, inverse_spacing, tally);
  for (std::size_t k = 0; k < crossed.edges.count; k += hn::Lanes(doubles)) {
    const kernel::LaneEdges edges(crossed.edges, k, Vec3{});
    const kernel::Points normals{kernel::load(&crossed.x[k]), kernel::load(&crossed.y[k]),
                                 kernel::load(&crossed.z[k])};
    sums(edges, kernel::load(&crossed.coordinates[k]), normals,
         hn::FirstN(doubles, crossed.edges.count - k));
  }
  sums.flush();
}

void tally_edges(const SurfaceModel& surface, const CrossedEdges& crossed, double inverse_spacing,
                 Tally& tally) {
  if (crossed.atom_count == 1) add_edges<1>(surface, crossed, inverse_spacing, tally);
  if (crossed.atom_count == 2) add_edges<2>(surface, crossed, inverse_spacing, tally);
  if (crossed.atom_count == 3) add_edges<3>(surface, crossed, inverse_spacing, tally);
}

}  // namespace eses::detail::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail::test {
namespace {

using TallyEdges = void (*)(const SurfaceModel&, const CrossedEdges&, double, Tally&);

constexpr double spacing = 0.4;

// Makes crossed edges, some of which end on a sphere, and adds them one after the other.
CrossedEdges make_edges(const SurfaceModel& surface, Random& random, Tally& tally) {
  CrossedEdges crossed;
  crossed.atom_count = random.integer(1, 3);
  crossed.edges.count = random.integer(0, EdgeBatch::capacity);
  for (std::size_t n = 0; n < crossed.edges.count; ++n) {
    BlockCrossing crossing;
    crossing.axis = static_cast<std::uint8_t>(random.integer(0, 2));
    crossing.atom_count = static_cast<std::uint8_t>(crossed.atom_count & 3);
    crossing.atoms = {0, 1, 2};
    crossing.lower_is_inside = random.chance(0.5);
    crossing.normal = random_direction(random);
    Vec3 lower = random_point(random, 4);
    if (random.chance(0.1)) {
      lower = surface.atoms[0].center;
      lower[(crossing.axis + 1U) % 3] += surface.atoms[0].radius;
    }
    const double upper = lower[crossing.axis] + spacing;
    crossing.coordinate = lower[crossing.axis] + random.uniform(0, 1) * spacing;
    if (random.chance(0.1)) crossing.coordinate = lower[crossing.axis];
    tally.add_edge(surface, crossing, lower, 1 / spacing);
    Vec3 outside = lower;
    if (crossing.lower_is_inside) outside[crossing.axis] = upper;
    crossed.edges.x[n] = outside.x;
    crossed.edges.y[n] = outside.y;
    crossed.edges.z[n] = outside.z;
    crossed.edges.to[n] = crossing.lower_is_inside ? lower[crossing.axis] : upper;
    crossed.edges.axis[n] = crossing.axis;
    crossed.coordinates[n] = crossing.coordinate;
    crossed.x[n] = crossing.normal.x;
    crossed.y[n] = crossing.normal.y;
    crossed.z[n] = crossing.normal.z;
  }
  return crossed;
}

}  // namespace

TEST_CASE("sums over the crossings of a patch are those of single crossings, to the last bit") {
  for_each_version(ESES_VERSIONS(tally_edges), [](TallyEdges add) {
    Random random(45);
    for (int repetition = 0; repetition < 200; ++repetition) {
      std::vector<Atom> atoms;
      for (int i = 0; i < 3; ++i)
        atoms.push_back({random_point(random, 4), random.uniform(0.5, 2)});
      const SurfaceModel surface(atoms, 1.4);
      Tally expected, tally;
      const CrossedEdges crossed = make_edges(surface, random, expected);
      add(surface, crossed, 1 / spacing, tally);
      INFO("repetition " << repetition);
      CHECK(tally.totals.crossings == expected.totals.crossings);
      CHECK((tally.totals.kind_shares == expected.totals.kind_shares));
      CHECK((tally.totals.inside_lengths == expected.totals.inside_lengths));
      for (AtomIndex i = 0; i < 3; ++i) CHECK((tally.atom_shares[i] == expected.atom_shares[i]));
    }
  });
}

TEST_CASE("removing crossings restores the sums") {
  Random random(46);
  const std::vector<Atom> atoms{{{0, 0, 0}, 1}, {{2, 0, 0}, 1.5}, {{0, 2, 1}, 1.2}};
  const SurfaceModel surface(atoms, 1.4);
  Tally tally;
  static_cast<void>(make_edges(surface, random, tally));
  const Tally before = tally;
  std::array<BlockCrossing, 3> crossings;
  crossings[0].atom_count = 1;
  crossings[1].atom_count = 2;
  crossings[2].atom_count = 3;
  for (BlockCrossing& crossing : crossings) {
    crossing.coordinate = 1.1;
    crossing.normal = random_direction(random);
    crossing.atoms = {0, 1, 2};
    for (const int sign : {1, -1})
      tally.add_edge(surface, crossing, {1, 0.3, 0.2}, 1 / spacing, sign);
    CHECK(tally.totals.crossings == before.totals.crossings);
    CHECK((tally.totals.kind_shares == before.totals.kind_shares));
    CHECK((tally.totals.inside_lengths == before.totals.inside_lengths));
    for (AtomIndex i = 0; i < 3; ++i) CHECK((tally.atom_shares[i] == before.atom_shares[i]));
  }
}

}  // namespace eses::detail::test
#endif  // HWY_ONCE
