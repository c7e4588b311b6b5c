/// Tests of areas and volumes against an evaluation of the definitions in extended precision.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/measure.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"
#include "support/measure_reference.hpp"
#include "support/measured_sets.hpp"
#include "support/near_degenerate.hpp"

namespace eses::detail::test {
namespace {

/// Returns the largest error of an area or volume, relative to the SAS.
double error_of(const Measures& measures, const Measures& expected) {
  return std::max({std::fabs(measures.ses_area - expected.ses_area) / expected.sas_area,
                   std::fabs(measures.sas_area - expected.sas_area) / expected.sas_area,
                   std::fabs(measures.ses_volume - expected.ses_volume) / expected.sas_volume,
                   std::fabs(measures.sas_volume - expected.sas_volume) / expected.sas_volume});
}

double error_of(const std::vector<Atom>& atoms, double probe) {
  return error_of(measure(Surface(atoms), {.probe_radius = probe}),
                  measure_by_definition(atoms, probe));
}

std::vector<Atom> random_atoms(Random& random) {
  std::vector<Atom> atoms(random.integer(2, 16));
  const double half = random.uniform(1, 4.5);
  for (Atom& atom : atoms)
    atom = {{random.uniform(-half, half), random.uniform(-half, half), random.uniform(-half, half)},
            random.uniform(0.5, 2.3)};
  return atoms;
}

}  // namespace

// Two spheres r 1.7 at 3 and 6 angstrom, and r 1 at 1 angstrom with a probe of 1.5: see "closed
// forms" in test_measure.cpp.
TEST_CASE("measure: the reference has the closed forms") {
  const auto pair = [](double radius, double distance) {
    return std::vector<Atom>{{{0, 0, 0}, radius}, {{distance, 0, 0}, radius}};
  };
  const Measures near = measure_by_definition(rotated(pair(1.7, 3)), 1.4);
  CHECK(std::fabs(near.ses_area - 66.0779806211) < 1e-10);
  CHECK(std::fabs(near.ses_volume - 42.3467039769) < 1e-10);
  const Measures spindle = measure_by_definition(rotated(pair(1.7, 6)), 1.4);
  CHECK(std::fabs(spindle.ses_area - 72.7000761036) < 1e-10);
  CHECK(std::fabs(spindle.ses_volume - 41.1849134259) < 1e-10);
  const double height = 1.5 * std::numbers::sqrt3;
  const Measures triangle = measure_by_definition(
      rotated({{{0, 0, 0}, 1.7}, {{3, 0, 0}, 1.7}, {{1.5, height, 0}, 1.7}}), 1.4);
  CHECK(std::fabs(triangle.ses_area - 89.2489603685) < 1e-10);
  CHECK(std::fabs(triangle.ses_volume - 64.0743285935) < 1e-10);
}

// The edges of these cones are more than a right angle away from their mean. The first set is a
// part of PDB entry 1MQ6.
TEST_CASE("measure: placements cut a patch far from the mean of its edges") {
  const std::vector<Atom> protein{{{8.252, 14.733, 17.41}, 2},
                                  {{8.822, 13.58, 17.73}, 1.85},
                                  {{5.387, 13.333, 23.232}, 2.175},
                                  {{5.199, 12.07, 22.433}, 2},
                                  {{10.822, 12.537, 22.224}, 1.77}};
  const std::vector<Atom> six{{{-2.38, -0.86, 3.75}, 1.53}, {{3.24, -0.93, -2.62}, 1.27},
                              {{-1.45, 3.94, -1.00}, 1.31}, {{-1.71, -3.17, 3.13}, 1.29},
                              {{4.14, -0.41, 1.27}, 1.04},  {{0.61, -4.09, -1.31}, 1.04},
                              {{2.28, -5.30, -0.84}, 1.46}};
  const std::vector<Atom> one{{{2.44, -3.01, 1.99}, 1.36},  {{-3.70, -2.00, -0.54}, 1.24},
                              {{-0.54, 3.96, -2.11}, 1.52}, {{8.37, 3.30, -0.99}, 2.00},
                              {{4.82, 3.08, 0.73}, 1.24},   {{4.85, -1.16, -1.13}, 1.97},
                              {{2.98, 3.26, 2.84}, 1.71}};
  CHECK(std::fabs(measure_by_definition(protein, 1.4).ses_area - 186.68872908) < 1e-8);
  CHECK(error_of(protein, 1.4) < 1e-10);
  CHECK(error_of(six, 3) < 1e-10);
  CHECK(error_of(one, 3) < 1e-10);
}

// The third atom's circle passes near a direction that was once the same for all atoms.
TEST_CASE("measure: no direction of an arc is singular") {
  CHECK(error_of({{{0, 0, 0}, 0.43}, {{1.51, 0.78, 0.58}, 1.7}, {{-0.35, -3.56, 3.06}, 1.7}}, 1.4) <
        1e-10);
  // A small circle around each direction of a grid.
  for (const double x : {-1, 0, 1})
    for (const double y : {-1, 0, 1})
      for (const double z : {-1, 0, 1}) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Vec3 along = normalized(Vec3{x, y, z});
        const Vec3 across = any_perpendicular(along);
        CHECK(error_of({{{0, 0, 0}, 1.5},
                        {5.79 * along + 1e-3 * across, 1.5},
                        {2.0 * across - 1.0 * along, 1.1}},
                       1.4) < 1e-10);
      }
}

// The circle of two atoms has a radius of 0.004 angstrom in the first set. In the second one, the
// probe has 1e-8 angstrom of room between four atoms, and touches those opposite each other.
TEST_CASE("measure: short arcs on small circles, and almost equal caps") {
  const std::vector<Atom> lattice{
      {{3.099988004195573, 3.1000107180069811, -1.5560715349108816e-05}, 1.7},
      {{6.1999995518880748, 6.0954160299342957e-06, 6.5434343854763328e-06}, 1.7},
      {{9.2999836462661296, 3.1000030098609641, -1.4431539385241615e-05}, 1.7},
      {{6.1999794528963204, 3.1000146582155779, 3.1000030606788336}, 1.7},
      {{6.2000108786088628, 6.2000010442591051, 2.3564271512215109e-06}, 1.7}};
  const std::vector<Atom> tetrahedron{
      {{0.86602540688479701, 0.86602540540086781, 0.86602540731407585}, 1},
      {{0.86602540503946046, -0.86602540244339388, -0.86602540561021046}, 1},
      {{-0.86602540549977292, 0.86602540491858371, -0.86602540827130603}, 1},
      {{-0.86602540176201559, -0.86602540691296326, 0.86602540750554824}, 1}};
  CHECK(error_of(lattice, 1.4) < 1e-9);
  CHECK(error_of(tetrahedron, 0.5) < 1e-9);
}

// Four placements are within 2.4e-10 angstrom of each other, and cut the patches of four others by
// caps that differ by 1e-11.
TEST_CASE("measure: four placements of a square that a probe just fits into") {
  const std::vector<Atom> atoms{
      {{-1.3278157266220265, -1.112965660821579, -3.3652373587660196}, 0.78505081157948897},
      {{-0.0056618294369312526, -3.5929467966070496, 1.1905086758633308}, 0.78505081157948897},
      {{1.3278157266220265, 1.1129656608215786, 3.3652373587660196}, 0.78505081157948897},
      {{0.0056618294369314148, 3.5929467966070496, -1.1905086758633303}, 0.78505081157948897},
      {{-3.5445003860679325, 0.42267055900842465, 1.2587598097910961}, 0.78505081157948897}};
  CHECK(error_of(atoms, 3) < 1e-9);
}

// The probes almost touch more than three atoms, or just fit. A place in which a probe fits by the
// tolerance of 1e-9 angstrom is open. Placements of these sets are about as close to each other as
// the noise, which limits the digits of the definition.
TEST_CASE("measure: almost degenerate atoms have the values of the definition") {
  int count = 0, close_count = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const NearDegenerateSet set = make_near_degenerate_set(seed);
    if (set.atoms.size() > 30) continue;
    const Measures measures = measure(Surface(set.atoms), {.probe_radius = set.probe_radius});
    const double error = error_of(measures, measure_by_definition(set.atoms, set.probe_radius));
    const double error_if_open =
        error_of(measures, measure_by_definition(set.atoms, set.probe_radius - 1e-9));
    INFO(set.name << ", noise " << set.noise << ", seed " << seed);
    CHECK((set.noise < 1e-6 ? std::min(error, error_if_open) : error) < 1e-8 + 1e-18 / set.noise);
    ++(set.noise < 1e-6 ? close_count : count);
  }
  CHECK(count > 50);
  CHECK(close_count > 50);
}

TEST_CASE("measure: two molecules far apart add up") {
  Random random(7);
  for (int k = 0; k < 20; ++k) {
    const std::vector<Atom> first = random_atoms(random), second = random_atoms(random);
    const double probe = random.uniform(0.3, 3);
    std::vector<Atom> both = first;
    for (const Atom& atom : moved(second, {64, -32, 128})) both.push_back(atom);
    const auto measured = [&](const std::vector<Atom>& atoms) {
      return measure(Surface(atoms), {.probe_radius = probe});
    };
    const Measures one = measured(first), other = measured(second), sum = measured(both);
    CHECK(difference(sum.ses_area, one.ses_area + other.ses_area) < 1e-11);
    CHECK(difference(sum.ses_volume, one.ses_volume + other.ses_volume) < 1e-11);
    CHECK(difference(sum.sas_area, one.sas_area + other.sas_area) < 1e-11);
    CHECK(difference(sum.sas_volume, one.sas_volume + other.sas_volume) < 1e-11);
    CHECK(sum.euler_number == one.euler_number + other.euler_number);
  }
}

TEST_CASE("measure: areas and volumes scale with all lengths") {
  Random random(8);
  for (int k = 0; k < 20; ++k) {
    const std::vector<Atom> atoms = random_atoms(random);
    const double probe = random.uniform(0.3, 3), factor = random.uniform(0.5, 3);
    std::vector<Atom> scaled = atoms;
    for (Atom& atom : scaled) atom = {factor * atom.center, factor * atom.radius};
    const Measures one = measure(Surface(atoms), {.probe_radius = probe});
    const Measures other = measure(Surface(scaled), {.probe_radius = factor * probe});
    const double square = factor * factor, cube = square * factor;
    CHECK(difference(other.ses_area, square * one.ses_area) < 1e-11);
    CHECK(difference(other.sas_area, square * one.sas_area) < 1e-11);
    CHECK(difference(other.ses_volume, cube * one.ses_volume) < 1e-11);
    CHECK(difference(other.sas_volume, cube * one.sas_volume) < 1e-11);
  }
}

TEST_CASE("measure: random atoms have the values of the definition") {
  Random random(44);
  for (int k = 0; k < 150; ++k) {
    const std::vector<Atom> atoms = random_atoms(random);
    const double probe = random.uniform(0.3, 4);
    INFO("set " << k);
    CHECK(error_of(atoms, probe) < 1e-10);
  }
}

}  // namespace eses::detail::test
