/// Tests of areas and volumes without a grid.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/compute.hpp"
#include "eses/measure.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"
#include "support/measured_sets.hpp"
#include "support/near_degenerate.hpp"

namespace eses::detail::test {
namespace {

using std::numbers::pi;

Measures measure_atoms(const std::vector<Atom>& atoms, double probe,
                       const MeasureOptions& options = {}) {
  MeasureOptions with_probe = options;
  with_probe.probe_radius = probe;
  return measure(Surface(atoms), with_probe);
}

std::vector<Atom> pair_of_atoms(double radius, double distance) {
  return rotated({{{0, 0, 0}, radius}, {{distance, 0, 0}, radius}});
}

void check_same(const Measures& a, const Measures& b, double relative) {
  CHECK(difference(a.ses_area, b.ses_area) < relative);
  CHECK(difference(a.ses_volume, b.ses_volume) < relative);
  CHECK(difference(a.sas_area, b.sas_area) < relative);
  CHECK(difference(a.sas_volume, b.sas_volume) < relative);
  CHECK(a.euler_number == b.euler_number);
}

void check_valid(const Measures& measures, double curvature_error) {
  const double error =
      std::fabs(measures.total_curvature - static_cast<double>(measures.euler_number));
  CHECK(error < curvature_error);
  CHECK(measures.euler_number % 2 == 0);
  for (const double value :
       {measures.ses_areas.convex, measures.ses_areas.saddle, measures.ses_areas.concave,
        measures.ses_volume, measures.sas_area, measures.sas_volume})
    CHECK(value >= 0);
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// The areas and volumes that have derivatives, in the order of `gradients_of`.
std::array<double, 4> values_of(const std::vector<Atom>& atoms, double probe) {
  const Measures measures = measure_atoms(atoms, probe);
  return {measures.ses_area, measures.ses_volume, measures.sas_area, measures.sas_volume};
}

std::array<const Gradient*, 4> gradients_of(const Measures& measures) {
  const Gradients& all = measures.gradients;
  return {&all.ses_area, &all.ses_volume, &all.sas_area, &all.sas_volume};
}

/// Returns the derivatives of a function of a displacement, which returns an array, by central
/// differences with Richardson's extrapolation.
template <class Function>
auto differentiate(Function&& function) {
  constexpr double step = 1e-5;
  const auto difference_at = [&](double h) {
    auto slope = function(h);
    const auto below = function(-h);
    for (std::size_t q = 0; q < slope.size(); ++q) slope[q] = (slope[q] - below[q]) / (2 * h);
    return slope;
  };
  const auto coarse = difference_at(step);
  auto slope = difference_at(step / 2);
  for (std::size_t q = 0; q < slope.size(); ++q) slope[q] = (4 * slope[q] - coarse[q]) / 3;
  return slope;
}

/// Returns the derivatives at 0 of a function of a positive displacement, which returns an array:
/// of the parabola through three points, with Richardson's extrapolation.
template <class Function>
auto differentiate_above(Function&& function) {
  constexpr double step = 1e-4;
  const auto difference_at = [&](double h) {
    auto slope = function(2 * h);
    const auto one = function(h), three = function(3 * h);
    for (std::size_t q = 0; q < slope.size(); ++q)
      slope[q] = (8 * slope[q] - 5 * one[q] - 3 * three[q]) / (2 * h);
    return slope;
  };
  const auto coarse = difference_at(step);
  auto slope = difference_at(step / 2);
  for (std::size_t q = 0; q < slope.size(); ++q) slope[q] = (4 * slope[q] - coarse[q]) / 3;
  return slope;
}

/// Weights of areas, of both signs and without symmetry.
std::vector<double> make_weights(std::size_t count) {
  Random random(7);
  std::vector<double> weights(count);
  for (double& weight : weights) weight = random.uniform(-1, 1.5);
  return weights;
}

/// Returns the atoms of data/1ubq.xyzr.
std::vector<Atom> ubiquitin() { return read_atom_list(std::string(ESES_DATA) + "/1ubq.xyzr"); }

}  // namespace

TEST_CASE("measure: closed forms") {
  struct Known {
    std::vector<Atom> atoms;
    double probe, area, volume;
  };
  const double height = 1.5 * std::numbers::sqrt3;
  const std::vector<Known> all{
      {pair_of_atoms(1.7, 3), 1.4, 66.0779806211, 42.3467039769},
      {pair_of_atoms(1.7, 6), 1.4, 72.7000761036, 41.1849134259},
      {rotated({{{0, 0, 0}, 1.7}, {{3, 0, 0}, 1.7}, {{1.5, height, 0}, 1.7}}), 1.4, 89.2489603685,
       64.0743285935},
      {pair_of_atoms(1, 1), 1.5, 18.7218343768, 7.1643746291},
      {{{{1, 2, 3}, 1.7}}, 1.4, 4 * pi * 1.7 * 1.7, 4 * pi / 3 * 1.7 * 1.7 * 1.7}};
  for (const Known& known : all) {
    const Measures measures = measure_atoms(known.atoms, known.probe);
    CHECK(difference(measures.ses_area, known.area) < 1e-11);
    CHECK(difference(measures.ses_volume, known.volume) < 1e-11);
    CHECK(measures.euler_number == 2);
    check_valid(measures, 1e-12);
  }
}

// The values are those of an independent evaluation in Python, which integrates the same patches
// with all pairs and triples of atoms.
TEST_CASE("measure: values of an independent evaluation in Python") {
  struct Known {
    Kind kind;
    std::uint64_t seed;
    double convex, saddle, concave, volume, sas_area, sas_volume;
  };
  const std::array<Known, 5> all{
      {{Kind::gas, 1, 269.67446392890855, 136.4736564520074, 42.01339611133055, 265.6503333580011,
        1006.3124501332735, 1312.4931421205101},
       {Kind::gas, 2, 230.58699593204707, 185.05768672640642, 185.58847154807293,
        502.98641257018215, 1231.4757581922418, 2358.106654958103},
       {Kind::chain, 0, 203.69779239557835, 71.48837629014547, 6.324199578738145, 209.5707722820886,
        426.41417621360836, 456.6309860851312},
       {Kind::chain, 3, 233.08588103034413, 359.5765244265577, 83.58436303560887, 547.6858276262576,
        2049.654338904583, 4582.5767032994145},
       {Kind::gas, 6, 315.7857114355689, 340.08319330941737, 347.6230848639477, 1179.8393579882295,
        1626.3607078578777, 3828.30843622098}}};
  for (const Known& known : all) {
    INFO(kind_name(known.kind) << " " << known.seed);
    const Measures measures =
        measure_atoms(make_atom_set(known.kind, known.seed), designed_probe_radius(known.seed));
    CHECK(difference(measures.ses_areas.convex, known.convex) < 1e-11);
    CHECK(difference(measures.ses_areas.saddle, known.saddle) < 1e-11);
    CHECK(difference(measures.ses_areas.concave, known.concave) < 1e-11);
    CHECK(difference(measures.ses_volume, known.volume) < 1e-11);
    CHECK(difference(measures.sas_area, known.sas_area) < 1e-11);
    CHECK(difference(measures.sas_volume, known.sas_volume) < 1e-11);
    CHECK(measures.ses_area == measures.ses_areas.total());
  }
}

// Federer, Trans. Am. Math. Soc. 93, 418, 1959, doi:10.1090/S0002-9947-1959-0110078-1: areas and
// volumes of parallel surfaces are polynomials of the distance. The integral of the mean curvature
// is eliminated.
TEST_CASE("measure: relation of SES and SAS where no patch is cut") {
  const double height = std::numbers::sqrt3;
  const std::vector<Atom> tetrahedron{
      {{0, 0, 0}, 1.7}, {{2, 0, 0}, 1.5}, {{1, height, 0}, 1.8}, {{1, height / 3, 1.6}, 1.6}};
  for (const double p : {0.1, 0.3, 0.6}) {
    const Measures measures = measure_atoms(rotated(tetrahedron), p);
    REQUIRE(measures.ses_areas.concave > 0);
    const auto euler = static_cast<double>(measures.euler_number);
    CHECK(difference(measures.sas_volume - measures.ses_volume,
                     p * (measures.sas_area + measures.ses_area) / 2 - pi / 3 * euler * p * p * p) <
          1e-12);
  }
}

// The derivative of the volume by the probe radius is the area. The integral over a range without
// events follows from Simpson's rule.
TEST_CASE("measure: the SAS area is the derivative of the volume") {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    const std::vector<Atom> atoms = make_atom_set(Kind::gas, seed);
    const double low = 1, step = 1e-5;
    const Measures first = measure_atoms(atoms, low), middle = measure_atoms(atoms, low + step),
                   last = measure_atoms(atoms, low + 2 * step);
    const double integral = step / 3 * (first.sas_area + 4 * middle.sas_area + last.sas_area);
    CHECK(difference(last.sas_volume - first.sas_volume, integral) < 1e-9);
  }
}

TEST_CASE("measure: total curvature is an even number, and nothing is negative") {
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const Kind kind : all_kinds) {
      INFO(kind_name(kind) << " " << seed);
      const Measures measures =
          measure_atoms(make_atom_set(kind, seed), designed_probe_radius(seed));
      check_valid(measures, kind == Kind::gas || kind == Kind::chain ? 1e-9 : 1e-6);
    }
}

TEST_CASE("measure: almost degenerate atoms have the measures of moved ones") {
  Random random(1);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const NearDegenerateSet set = make_near_degenerate_set(seed);
    INFO(set.name);
    const Measures measures = measure_atoms(set.atoms, set.probe_radius);
    check_valid(measures, 1e-6);
    std::vector<Atom> moved = set.atoms;
    for (Atom& atom : moved)
      for (std::size_t axis = 0; axis < 3; ++axis) atom.center[axis] += random.uniform(-1e-8, 1e-8);
    const Measures other = measure_atoms(moved, set.probe_radius);
    // Another number means that a place in which a probe just fits has opened or closed.
    if (other.euler_number == measures.euler_number) {
      CHECK(std::fabs(other.ses_area - measures.ses_area) < 1e-5);
      CHECK(std::fabs(other.ses_volume - measures.ses_volume) < 1e-5);
    }
  }
}

TEST_CASE("measure: rotation, translation and order do not matter") {
  std::vector<std::vector<Atom>> sets{make_chain(200, 1), make_cube(3, 2.8, 1.5),
                                      read_atom_list(std::string(ESES_DATA) + "/c60.xyzr")};
  for (std::vector<Atom>& atoms : sets) {
    // Multiples of 2^-20 can be moved by 2^17 without rounding.
    for (Atom& atom : atoms)
      for (std::size_t axis = 0; axis < 3; ++axis)
        atom.center[axis] = std::round(std::ldexp(atom.center[axis], 20)) / 1048576;
    const Measures reference = measure_atoms(atoms, 1.4);
    check_same(measure_atoms(rotated(atoms), 1.4), reference, 1e-9);
    check_same(measure_atoms(moved(atoms, {131072, -131072, 131072}), 1.4), reference, 1e-9);
    std::vector<Atom> reversed(atoms.rbegin(), atoms.rend());
    check_same(measure_atoms(reversed, 1.4), reference, 1e-9);
  }
}

TEST_CASE("measure: the number of threads does not matter") {
  const Surface surface(read_atom_list(std::string(ESES_DATA) + "/1a0q.xyzr"));
  const Measures one = measure(surface, {.by_atom = true, .gradients = true, .threads = 1});
  for (const int threads : {0, 2, 3, 8}) {
    const Measures many =
        measure(surface, {.by_atom = true, .gradients = true, .threads = threads});
    CHECK(many.ses_areas.convex == one.ses_areas.convex);
    CHECK(many.ses_areas.saddle == one.ses_areas.saddle);
    CHECK(many.ses_areas.concave == one.ses_areas.concave);
    CHECK(many.ses_volume == one.ses_volume);
    CHECK(many.sas_area == one.sas_area);
    CHECK(many.sas_volume == one.sas_volume);
    CHECK(many.total_curvature == one.total_curvature);
    CHECK(many.by_atom.sas == one.by_atom.sas);
    CHECK(many.by_atom.convex == one.by_atom.convex);
    CHECK(many.by_atom.saddle == one.by_atom.saddle);
    CHECK(many.by_atom.concave == one.by_atom.concave);
    for (std::size_t q = 0; q < 4; ++q) {
      const Gradient &of_many = *gradients_of(many)[q], &of_one = *gradients_of(one)[q];
      CHECK(of_many.centers == of_one.centers);
      CHECK(of_many.radii == of_one.radii);
      CHECK(of_many.probe == of_one.probe);
    }
  }
}

TEST_CASE("measure: sums over a grid converge to the areas and volumes, also by atom") {
  const Surface surface(ubiquitin());
  const Measures exact = measure(surface, {.by_atom = true});
  const double spacing = 0.2;
  const Grid grid = make_grid(surface, {.spacing = spacing});
  const Result result = compute(surface, grid);
  CHECK(difference(result.summary().area, exact.ses_area) < 1e-3);
  CHECK(difference(result.summary().volume, exact.ses_volume) < 1e-3);
  CHECK(difference(result.summary().convex_area, exact.ses_areas.convex) < 3e-3);
  CHECK(difference(result.summary().saddle_area, exact.ses_areas.saddle) < 3e-3);
  CHECK(difference(result.summary().concave_area, exact.ses_areas.concave) < 1e-2);

  const auto atoms = surface.atoms();
  std::vector<double> areas(atoms.size());
  for (const Crossing& crossing : result.crossings()) {
    const auto power = [&](AtomIndex i) {
      return squared_norm(crossing.position - atoms[i].center) - atoms[i].radius * atoms[i].radius;
    };
    const AtomIndex owner =
        *std::min_element(crossing.atoms.begin(), crossing.atoms.begin() + crossing.atom_count,
                          [&](AtomIndex a, AtomIndex b) { return power(a) < power(b); });
    areas[owner] += spacing * spacing * std::fabs(crossing.normal[crossing.axis]);
  }
  double misplaced = 0;
  for (std::size_t i = 0; i < atoms.size(); ++i)
    misplaced += std::fabs(areas[i] - exact.by_atom.convex[i] - exact.by_atom.saddle[i] -
                           exact.by_atom.concave[i]);
  CHECK(misplaced < 0.02 * exact.ses_area);
}

TEST_CASE("measure: areas of the atoms add up") {
  for (std::uint64_t seed = 0; seed < 5; ++seed)
    for (const Kind kind : all_kinds) {
      INFO(kind_name(kind) << " " << seed);
      const Measures all =
          measure_atoms(make_atom_set(kind, seed), designed_probe_radius(seed), {.by_atom = true});
      CHECK(difference(sum_of(all.by_atom.sas), all.sas_area) < 1e-12);
      CHECK(difference(sum_of(all.by_atom.convex), all.ses_areas.convex) < 1e-12);
      CHECK(difference(sum_of(all.by_atom.saddle), all.ses_areas.saddle) < 1e-12);
      CHECK(difference(sum_of(all.by_atom.concave), all.ses_areas.concave) < 1e-9);
    }
}

TEST_CASE("measure: equal atoms in equal places have equal areas") {
  const double height = 1.5 * std::numbers::sqrt3;
  const Measures three =
      measure_atoms(rotated({{{0, 0, 0}, 1.7}, {{3, 0, 0}, 1.7}, {{1.5, height, 0}, 1.7}}), 1.4,
                    {.by_atom = true});
  const Measures six = measure_atoms(octahedron(1.8, 1), 0.7, {.by_atom = true});
  for (const Measures* measures : {&three, &six}) {
    REQUIRE(measures->ses_areas.concave > 0);
    const auto count = static_cast<double>(measures->by_atom.sas.size());
    for (std::size_t i = 0; i < measures->by_atom.sas.size(); ++i) {
      CHECK(difference(measures->by_atom.sas[i], measures->sas_area / count) < 1e-11);
      CHECK(difference(measures->by_atom.saddle[i], measures->ses_areas.saddle / count) < 1e-11);
      CHECK(difference(measures->by_atom.concave[i], measures->ses_areas.concave / count) < 1e-11);
    }
  }
}

TEST_CASE("measure: a probe that just fits into a hole adds its whole sphere") {
  const double p = 0.7;
  const Measures with = measure_atoms(octahedron(1 + p, 1), p);
  const Measures without = measure_atoms(octahedron(1 + p - 1e-7, 1), p);
  CHECK(with.euler_number == without.euler_number + 2);
  CHECK(std::fabs(with.ses_area - without.ses_area - 4 * pi * p * p) < 1e-5);
  CHECK(std::fabs(without.ses_volume - with.ses_volume - 4 * pi / 3 * p * p * p) < 1e-5);
}

// Four SAS spheres touch in pairs above a fifth atom. If they overlap, the probe rests higher by z.
// Its patch is almost a hemisphere, whose projection is a disc.
TEST_CASE("measure: a probe between two pairs of touching spheres sinks like a square root") {
  const double p = 0.5, sas_radius = 2, radius = sas_radius - p;
  const auto at_distance = [&](double s) {
    return measure_atoms(rotated({{{s, 0, 0}, radius},
                                  {{-s, 0, 0}, radius},
                                  {{0, s, 0}, radius},
                                  {{0, -s, 0}, radius},
                                  {{0, 0, -sas_radius}, radius}}),
                         p);
  };
  const Measures touching = at_distance(sas_radius);
  check_valid(touching, 1e-6);
  for (const double overlap : {4e-8, 4e-6}) {
    const double s = sas_radius - overlap / 2, z = std::sqrt(sas_radius * sas_radius - s * s);
    const double expected = pi * p * p * z;
    const double change = at_distance(s).ses_volume - touching.ses_volume;
    CHECK(std::fabs(change - expected) < 0.03 * expected);
  }
}

// A probe at one end of an arc begins to cut the patch at the other end where the circle is as
// large as the probe. The second derivative is infinite there, so that the differences have errors
// of about the square root of their step.
TEST_CASE("measure: areas are smooth where a circle becomes smaller than the probe") {
  const double p = 1.4, r = 1.7, half = std::sqrt((r + p) * (r + p) - p * p);
  const auto at_distance = [&](double distance) {
    return rotated({{{-distance, 0, 0}, r}, {{distance, 0, 0}, r}, {{0, 2.5, 0.3}, r}});
  };
  for (const double offset : {-1e-6, -1e-8, -1e-10, 0.0, 1e-10, 1e-8, 1e-6}) {
    const double distance = half + offset, h = 1e-8;
    const std::array<double, 4> above = values_of(at_distance(distance + h), p),
                                below = values_of(at_distance(distance - h), p);
    const Measures measures = measure_atoms(at_distance(distance), p, {.gradients = true});
    const Vec3 x = at_distance(1)[1].center;
    for (std::size_t q = 0; q < 4; ++q) {
      const std::vector<Vec3>& centers = gradients_of(measures)[q]->centers;
      CHECK(difference(dot(centers[1] - centers[0], x), (above[q] - below[q]) / (2 * h)) < 1e-3);
    }
  }
}

TEST_CASE("measure: atoms inside an atom, equal atoms and atoms of radius 0 change nothing") {
  const std::vector<Atom> alone = make_atom_set(Kind::gas, 1);
  const Measures reference = measure_atoms(alone, 1.4);
  std::vector<Atom> more = alone;
  more.insert(more.end(), alone.begin(), alone.end());
  for (const Atom& atom : alone) {
    more.push_back({atom.center, 0});
    more.push_back({atom.center + Vec3{0.1, 0.05, 0}, 0.5 * atom.radius});
  }
  check_same(measure_atoms(more, 1.4), reference, 1e-12);
}

TEST_CASE("measure: a probe of radius 0 gives the van der Waals surface") {
  // Two balls of radius r whose centres are d apart.
  const double r = 1.7, d = 2;
  const double area = 4 * pi * r * (r + d / 2);
  const double volume = 8 * pi / 3 * r * r * r - pi / 12 * (4 * r + d) * (2 * r - d) * (2 * r - d);
  const Measures bare = measure_atoms(pair_of_atoms(r, d), 0, {.van_der_waals = true});
  CHECK(difference(bare.sas_area, area) < 1e-12);
  CHECK(difference(bare.sas_volume, volume) < 1e-12);
  CHECK(bare.ses_area == bare.sas_area);
  CHECK(difference(bare.ses_volume, volume) < 1e-12);
  CHECK(bare.vdw_area == bare.sas_area);
  const Measures probed = measure_atoms(pair_of_atoms(r, d), 1.4, {.van_der_waals = true});
  CHECK(probed.vdw_area == Approx(bare.vdw_area).epsilon(1e-14));
  CHECK(probed.vdw_volume == Approx(bare.vdw_volume).epsilon(1e-14));
  CHECK(measure_atoms(pair_of_atoms(r, d), 1.4).vdw_area == 0);
}

TEST_CASE("measure: atoms of radius 0 far apart have no surface") {
  const Measures measures = measure_atoms({{{0, 0, 0}, 0}, {{9, 0, 0}, 0}}, 1.4);
  CHECK(measures.ses_area == 0);
  CHECK(measures.ses_volume == 0);
  CHECK(measures.euler_number == 4);
}

// With a very large probe, the surface is almost the convex hull of the atoms.
TEST_CASE("measure: the largest probe leaves the convex hull") {
  const double a = 3, r = 1;
  const double hull = a * a * a + 6 * a * a * r + 3 * pi * r * r * a + 4 * pi / 3 * r * r * r;
  const Measures measures = measure_atoms(rotated(make_cube(2, a, r)), max_probe_radius);
  CHECK(difference(measures.ses_volume, hull) < 2e-3);
  const Measures chain = measure_atoms(make_chain(300, 3), max_probe_radius);
  check_valid(chain, 1e-6);
}

TEST_CASE("measure: derivatives agree with central differences") {
  for (const Kind kind : {Kind::gas, Kind::chain})
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      INFO(kind_name(kind) << " " << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const double probe = designed_probe_radius(seed);
      const Measures measures = measure_atoms(atoms, probe, {.gradients = true});
      CHECK(measures.gradients.are_smooth);
      const auto check_near = [&](const std::array<double, 4>& slopes, auto&& derivative) {
        for (std::size_t q = 0; q < slopes.size(); ++q)
          CHECK(difference(derivative(*gradients_of(measures)[q]), slopes[q]) < 1e-6);
      };
      for (std::size_t i = 0; i < atoms.size(); i += 5) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          check_near(differentiate([&](double h) {
                       std::vector<Atom> moved = atoms;
                       moved[i].center[axis] += h;
                       return values_of(moved, probe);
                     }),
                     [&](const Gradient& gradient) { return gradient.centers[i][axis]; });
        check_near(differentiate([&](double h) {
                     std::vector<Atom> grown = atoms;
                     grown[i].radius += h;
                     return values_of(grown, probe);
                   }),
                   [&](const Gradient& gradient) { return gradient.radii[i]; });
      }
      check_near(differentiate([&](double h) { return values_of(atoms, probe + h); }),
                 [](const Gradient& gradient) { return gradient.probe; });
    }
}

TEST_CASE("measure: derivatives of weighted areas agree with central differences") {
  for (const Kind kind : {Kind::gas, Kind::chain})
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      INFO(kind_name(kind) << " " << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const std::vector<double> weights = make_weights(atoms.size());
      const double probe = designed_probe_radius(seed);
      const Measures measures =
          measure_atoms(atoms, probe, {.gradients = true, .weights = weights});
      const std::array<const Gradient*, 2> gradients{&measures.gradients.weighted_ses_area,
                                                     &measures.gradients.weighted_sas_area};
      const auto weighted = [&](const std::vector<Atom>& moved, double radius) {
        const Measures at = measure_atoms(moved, radius, {.weights = weights});
        return std::array{at.weighted_ses_area, at.weighted_sas_area};
      };
      const auto check_near = [&](const std::array<double, 2>& slopes, auto&& derivative) {
        for (std::size_t q = 0; q < slopes.size(); ++q)
          CHECK(difference(derivative(*gradients[q]), slopes[q]) < 1e-6);
      };
      for (std::size_t i = 0; i < atoms.size(); i += 4) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          check_near(differentiate([&](double h) {
                       std::vector<Atom> moved = atoms;
                       moved[i].center[axis] += h;
                       return weighted(moved, probe);
                     }),
                     [&](const Gradient& gradient) { return gradient.centers[i][axis]; });
        check_near(differentiate([&](double h) {
                     std::vector<Atom> grown = atoms;
                     grown[i].radius += h;
                     return weighted(grown, probe);
                   }),
                   [&](const Gradient& gradient) { return gradient.radii[i]; });
      }
      check_near(differentiate([&](double h) { return weighted(atoms, probe + h); }),
                 [](const Gradient& gradient) { return gradient.probe; });
    }
}

TEST_CASE("measure: weighted areas are sums over the atoms, and linear in the weights") {
  const std::vector<Atom> atoms = ubiquitin();
  const std::vector<double> weights = make_weights(atoms.size()), twos(atoms.size(), 2);
  const Measures measures =
      measure_atoms(atoms, 1.4, {.by_atom = true, .gradients = true, .weights = weights});
  const AtomAreas& areas = measures.by_atom;
  double ses = 0, sas = 0;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    ses += weights[i] * (areas.convex[i] + areas.saddle[i] + areas.concave[i]);
    sas += weights[i] * areas.sas[i];
  }
  CHECK(difference(measures.weighted_ses_area, ses) < 1e-12);
  CHECK(difference(measures.weighted_sas_area, sas) < 1e-12);

  const Measures twice = measure_atoms(atoms, 1.4, {.gradients = true, .weights = twos});
  CHECK(twice.by_atom.sas.empty());
  CHECK(difference(twice.weighted_ses_area, 2 * measures.ses_area) < 1e-11);
  CHECK(difference(twice.weighted_sas_area, 2 * measures.sas_area) < 1e-11);
  const Gradients& all = twice.gradients;
  for (const auto& [weighted, plain] : {std::pair(&all.weighted_ses_area, &all.ses_area),
                                        std::pair(&all.weighted_sas_area, &all.sas_area)}) {
    CHECK(difference(weighted->probe, 2 * plain->probe) < 1e-10);
    for (std::size_t i = 0; i < atoms.size(); ++i) {
      CHECK(norm(weighted->centers[i] - 2 * plain->centers[i]) < 1e-9);
      CHECK(std::fabs(weighted->radii[i] - 2 * plain->radii[i]) < 1e-9);
    }
  }

  // Areas do not change if all atoms move together, and they scale with the square of all lengths.
  for (const auto& [gradient, value] : {std::pair(&measures.gradients.weighted_ses_area, ses),
                                        std::pair(&measures.gradients.weighted_sas_area, sas)}) {
    Vec3 force, torque;
    double scaled = 1.4 * gradient->probe, absolute = 0;
    for (std::size_t i = 0; i < atoms.size(); ++i) {
      force = force + gradient->centers[i];
      torque = torque + cross(atoms[i].center, gradient->centers[i]);
      scaled += dot(atoms[i].center, gradient->centers[i]) + atoms[i].radius * gradient->radii[i];
      absolute += norm(atoms[i].center) * norm(gradient->centers[i]);
    }
    CHECK(norm(force) < 1e-9 * absolute);
    CHECK(norm(torque) < 1e-9 * absolute);
    CHECK(std::fabs(scaled - 2 * value) < 1e-9 * absolute);
  }
}

// The probe touches four or more atoms. The derivatives are those for atoms that grow, each of them
// much more than all later ones.
TEST_CASE("measure: one-sided derivatives where a probe touches more than three atoms") {
  const double half = 1.8;
  const std::vector<Atom> square{{{half, half, 0}, 1.7},
                                 {{-half, half, 0}, 1.7},
                                 {{-half, -half, 0}, 1.7},
                                 {{half, -half, 0}, 1.7}};
  std::vector<Atom> pyramid = square;
  pyramid.push_back({{0, 0, -1.5}, 1.2});
  // The probes above and below these rings cut the patches of each other.
  std::vector<Atom> wide = square, pentagon;
  for (Atom& atom : wide) atom.center = (2.05 / half) * atom.center;
  for (int k = 0; k < 5; ++k)
    pentagon.push_back({{2.9 * std::cos(0.4 * pi * k), 2.9 * std::sin(0.4 * pi * k), 0}, 1.7});
  std::vector<std::vector<Atom>> sets{square, pyramid, wide, pentagon};
  // Further atoms make placements that touch three atoms, and cut these patches or are cut by them.
  // Some keep the probe from one side of the ring.
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Random random(seed);
    std::vector<Atom>& more = sets.emplace_back(seed % 2 == 0 ? wide : pentagon);
    for (int k = 0; k < 3; ++k)
      more.push_back({{random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-5, -2.5)},
                      random.uniform(1, 2)});
  }
  for (const std::vector<Atom>& set : sets) {
    INFO("set " << &set - sets.data());
    const std::vector<Atom> atoms = rotated(set);
    const double probe = 1.4;
    const Measures measures = measure_atoms(atoms, probe, {.gradients = true});
    CHECK_FALSE(measures.gradients.are_smooth);
    // Each atom grows by a fraction of the growth of the one before.
    constexpr double fraction = 0.2;
    const auto grown = [&](double growth) {
      std::vector<Atom> larger = atoms;
      for (Atom& atom : larger) {
        atom.radius += growth;
        growth *= fraction;
      }
      return values_of(larger, probe);
    };
    const std::array<double, 4> slopes = differentiate_above(grown);
    for (std::size_t q = 0; q < slopes.size(); ++q) {
      double expected = 0, growth = 1;
      for (std::size_t i = 0; i < atoms.size(); ++i, growth *= fraction)
        expected += growth * gradients_of(measures)[q]->radii[i];
      CHECK(difference(slopes[q], expected) < 1e-6);
    }
  }
}

// The events of the table in doc/measure.md, at 0. Where there is a kink, the derivatives at the
// event are those of one side.
TEST_CASE("measure: a flag tells where areas and volumes are not smooth") {
  enum class Flag { set, clear, either };
  struct Event {
    const char* name;
    std::function<std::vector<Atom>(double)> atoms_at;
    Flag flag;
    int kink_side = 0;  // where the derivatives are those at a kink; 0 without a kink
    std::vector<double> weights = {};
  };
  const double p = 1.4, r = 1.7, sas = r + p, meeting = std::sqrt(sas * sas - p * p);
  const auto triangle = [&](double distance, std::vector<Atom> more = {}) {
    for (const double angle : {0.0, 2 * pi / 3, 4 * pi / 3})
      more.push_back({{distance * std::cos(angle), distance * std::sin(angle), 0}, r});
    return more;
  };
  const auto in_sphere = [&](double h) {
    return std::vector<Atom>{{{0, 0, 0}, r}, {{0.5 + h, 0, 0}, r - 0.5}};
  };
  const auto outside = [&](double h, double y) {
    return std::vector<Atom>{{{0, 0, 0}, 1.2}, {{2.6 + sas + h, 0, 0}, r}, {{2.6, y, 0}, r}};
  };
  const std::vector<Event> events{
      {"the last place in a cavity closes", [&](double h) { return octahedron(sas + h, r); },
       Flag::set},
      {"a fourth atom touches the probe",
       [&](double h) {
         return triangle(
             2, {{{-0.5, 0, std::sqrt(sas * sas - 4) - std::sqrt(sas * sas - 0.25) - h}, r}});
       },
       Flag::set, -1},
      {"two patches meet", [&](double h) { return triangle(meeting + h); }, Flag::set, -1},
      {"an atom covers the place where two patches meet",
       [&](double h) {
         return triangle(meeting + h, {{{0, 0, -2.5}, r}});
       },
       Flag::clear},
      {"spheres touch from outside", [&](double h) { return outside(h, 9); }, Flag::set, 1},
      {"an atom covers the place where spheres touch", [&](double h) { return outside(h, 0.3); },
       Flag::clear},
      {"a sphere touches another one from inside", in_sphere, Flag::clear},
      {"a sphere with another weight touches another one from inside",
       in_sphere,
       Flag::set,
       -1,
       {1, 2}},
      {"spheres are equal",
       [&](double h) {
         return std::vector<Atom>{{{0, 0, 0}, r}, {{h, 0, 0}, r}};
       },
       Flag::set},
      {"a circle is as large as the probe",
       [&](double h) {
         return std::vector<Atom>{
             {{-meeting - h, 0, 0}, r}, {{meeting + h, 0, 0}, r}, {{0, 2.5, 0.3}, r}};
       },
       Flag::clear},
      {"a window of three atoms closes", [&](double h) { return triangle(sas + h); }, Flag::either},
      {"a sphere grazes a circle",
       [&](double h) {
         const double y = std::sqrt(sas * sas - 4) + sas + h;
         return std::vector<Atom>{{{-2, 0, 0}, r}, {{2, 0, 0}, r}, {{0, y, 0}, r}};
       },
       Flag::either},
  };
  for (const Event& event : events) {
    const auto measure_at = [&](double h, bool gradients) {
      return measure_atoms(rotated(event.atoms_at(h)), p,
                           {.gradients = gradients, .weights = event.weights});
    };
    const auto values_at = [&](double h) {
      const Measures at = measure_at(h, false);
      return std::array{at.ses_area,   at.ses_volume,        at.sas_area,
                        at.sas_volume, at.weighted_ses_area, at.weighted_sas_area};
    };
    const auto slopes_of = [&](const Measures& measures) {
      const std::vector<Atom> from = rotated(event.atoms_at(0)), to = rotated(event.atoms_at(1));
      const Gradients& all = measures.gradients;
      std::array<double, 6> slopes{};
      const std::array gradients{&all.ses_area,   &all.ses_volume,        &all.sas_area,
                                 &all.sas_volume, &all.weighted_ses_area, &all.weighted_sas_area};
      for (std::size_t q = 0; q < slopes.size(); ++q)
        for (std::size_t i = 0; i < gradients[q]->centers.size(); ++i)
          slopes[q] += dot(gradients[q]->centers[i], to[i].center - from[i].center);
      return slopes;
    };
    const auto largest_difference = [](const auto& some, const auto& others) {
      double largest = 0;
      for (std::size_t q = 0; q < some.size(); ++q)
        largest = std::max(largest, difference(some[q], others[q]));
      return largest;
    };
    for (const double h : {-1e-4, -1e-5, 1e-5, 1e-4}) {
      INFO(event.name << ", " << h);
      const Measures measures = measure_at(h, true);
      CHECK(measures.gradients.are_smooth);
      constexpr double step = 1e-6;
      std::array<double, 6> slopes = values_at(h + step);
      const std::array<double, 6> below = values_at(h - step);
      for (std::size_t q = 0; q < slopes.size(); ++q)
        slopes[q] = (slopes[q] - below[q]) / (2 * step);
      CHECK(largest_difference(slopes_of(measures), slopes) < 1e-3);
    }
    INFO(event.name);
    const Measures measures = measure_at(0, true);
    if (event.flag != Flag::either)
      CHECK(measures.gradients.are_smooth == (event.flag == Flag::clear));
    const auto difference_at = [&](double h) {
      return largest_difference(slopes_of(measures), slopes_of(measure_at(h, true)));
    };
    if (event.kink_side != 0) {
      CHECK(difference_at(event.kink_side * 1e-6) < 1e-3);
      CHECK(difference_at(event.kink_side * -1e-6) > 0.1);
    } else if (event.flag != Flag::set) {
      CHECK(difference_at(1e-8) < 0.01);
      CHECK(difference_at(-1e-8) < 0.01);
    }
  }
}

// Areas and volumes do not change if all atoms move together, and they scale with all lengths.
TEST_CASE("measure: derivatives of a protein have no force and no torque, and scale") {
  const std::vector<Atom> atoms = ubiquitin();
  const double probe = 1.4;
  const Measures measures = measure_atoms(atoms, probe, {.gradients = true});
  const std::array<double, 4> values = values_of(atoms, probe), dimensions{2, 3, 2, 3};
  for (std::size_t q = 0; q < values.size(); ++q) {
    const Gradient& gradient = *gradients_of(measures)[q];
    Vec3 force, torque;
    double scaled = probe * gradient.probe, absolute = 0;
    for (std::size_t i = 0; i < atoms.size(); ++i) {
      force = force + gradient.centers[i];
      torque = torque + cross(atoms[i].center, gradient.centers[i]);
      scaled += dot(atoms[i].center, gradient.centers[i]) + atoms[i].radius * gradient.radii[i];
      absolute += norm(atoms[i].center) * norm(gradient.centers[i]);
    }
    CHECK(norm(force) < 1e-9 * absolute);
    CHECK(norm(torque) < 1e-9 * absolute);
    CHECK(std::fabs(scaled - dimensions[q] * values[q]) < 1e-9 * absolute);
  }
}

// Coincident placements have arcs of angle 0 between them. Mirror planes and rotations make them.
TEST_CASE("measure: derivatives of symmetric atoms are finite") {
  std::vector<std::pair<std::vector<Atom>, double>> sets{
      {read_atom_list(std::string(ESES_DATA) + "/c60.xyzr"), 1.4}};
  Random random(44);
  for (int k = 0; k < 60; ++k) {  // two mirror planes
    std::vector<Atom>& atoms = sets.emplace_back(std::vector<Atom>(), 1.0 + k % 3).first;
    for (std::size_t site = random.integer(1, 4); site > 0; --site) {
      const Vec3 center{random.uniform(0.3, 4), random.uniform(0.3, 4), random.uniform(-4, 4)};
      const double radius = random.uniform(1, 2);
      for (const double x : {-center.x, center.x})
        for (const double y : {-center.y, center.y}) atoms.push_back({{x, y, center.z}, radius});
    }
  }
  for (const auto& [atoms, probe] : sets) {
    INFO("set " << &atoms - &sets.front().first);
    const Measures measures = measure_atoms(atoms, probe, {.gradients = true});
    for (const Gradient* const gradient : gradients_of(measures)) {
      Vec3 force;
      for (const Vec3 by_center : gradient->centers) force = force + by_center;
      CHECK(norm(force) < 1e-7);  // also false for NaN
      CHECK(std::all_of(gradient->radii.begin(), gradient->radii.end(),
                        [](double value) { return std::isfinite(value); }));
    }
  }
}

// The derivative of a cut by the motion across the line between two placements is inversely
// proportional to their distance.
TEST_CASE("measure: derivatives of almost symmetric atoms have no force") {
  Random random(1047);
  for (int k = 0; k < 8; ++k) {
    std::vector<Atom> atoms;
    for (int cell = 0; cell < 8; ++cell)
      for (const Vec3 site : {Vec3{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}) {
        const Vec3 corner(2.0 * (cell % 2), 2.0 * (cell / 2 % 2), 2.0 * (cell / 4));
        const Vec3 noise{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        atoms.push_back({2.6 * (corner + site) + 3e-9 * noise, 1.2});
      }
    const Measures measures = measure_atoms(atoms, 1.4, {.gradients = true});
    Vec3 force;
    for (const Vec3 by_center : measures.gradients.ses_area.centers) force = force + by_center;
    INFO("set " << k);
    CHECK(norm(force) < 1e-5);
  }
}

TEST_CASE("measure: many atoms that hold a probe") {
  const int count = 400;
  const double probe = 10;
  std::vector<Atom> atoms;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, rho = std::sqrt(1 - z * z), turn = 2.4 * i;
    atoms.push_back({11.7 * Vec3{rho * std::cos(turn), rho * std::sin(turn), z}, 1.7});
  }
  const Measures held = measure_atoms(atoms, probe), tighter = measure_atoms(atoms, probe + 1e-6);
  CHECK(std::fabs(held.ses_area - tighter.ses_area - 4 * pi * probe * probe) < 1e-3);
  CHECK(held.euler_number == tighter.euler_number + 2);
}

TEST_CASE("measure: invalid options") {
  const Surface surface(pair_of_atoms(1, 2));
  for (const double probe : {-1.0, 0.001, 1001.0, std::nan("")})
    CHECK_THROWS_AS(measure(surface, {.probe_radius = probe}), std::invalid_argument);
  CHECK_THROWS_AS(measure(surface, {.threads = -1}), std::invalid_argument);
  const std::vector<double> one{1}, infinite{1, std::numeric_limits<double>::infinity()};
  CHECK_THROWS_AS(measure(surface, {.weights = one}), std::invalid_argument);
  CHECK_THROWS_AS(measure(surface, {.weights = infinite}), std::invalid_argument);
}

TEST_CASE("measure: an exception of the callback ends the measurement") {
  const Surface surface(pair_of_atoms(1, 2));
  const auto stop = [] { throw std::runtime_error("stop"); };
  CHECK_THROWS_WITH(measure(surface, {.check = stop}), "stop");
}

}  // namespace eses::detail::test
