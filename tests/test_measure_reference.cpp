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
