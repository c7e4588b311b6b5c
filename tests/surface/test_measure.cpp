/// Tests of areas and volumes without a grid.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/compute.hpp"
#include "eses/measure.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"
#include "support/measured_sets.hpp"
#include "support/near_degenerate.hpp"
#include "surface/concave_patch.hpp"

namespace eses::detail::test {
namespace {

using std::numbers::pi;

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
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
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

// Noise of about the distance within which placements are merged leaves many placements in the
// hole, some of them on one circle.
TEST_CASE("measure: a probe that almost fits into an icosahedron adds its whole sphere twice") {
  constexpr double golden = std::numbers::phi, probe = 2;
  Random random(44);
  int count = 0;
  for (const double noise : {1e-13, 1e-11, 1e-10, 3e-10, 1e-9, 3e-9})
    for (int set = 0; set < 8; ++set) {
      std::vector<Atom> atoms;
      for (const double a : {-1.0, 1.0})
        for (const double b : {-golden, golden})
          for (const Vec3 corner : {Vec3{0, a, b}, Vec3{a, b, 0}, Vec3{b, 0, a}}) {
            const Vec3 shift{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
            atoms.push_back({3.2 * normalized(corner) + noise * shift, 1.2});
          }
      const Measures measures = measure_atoms(atoms, probe);
      if (measures.euler_number != 4) continue;  // the probe does not fit
      ++count;
      INFO("noise " << noise << ", set " << set);
      CHECK(std::fabs(measures.ses_areas.concave - 8 * pi * probe * probe) < 2e-7);
    }
  CHECK(count > 20);
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

TEST_CASE("measure: the part of each of many atoms that a probe touches") {
  Random random(3);
  const auto random_direction = [&] {
    return normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  };
  for (const bool is_cut : {false, true}) {
    // Atoms all over a sphere, and some of them almost in the same direction.
    std::vector<Atom> atoms;
    ConcavePatch patch;
    for (AtomIndex i = 0; i < 150; ++i) {
      const Vec3 direction = i % 10 == 9
                                 ? normalized(patch.toward.back() + 1e-3 * random_direction())
                                 : random_direction();
      const double radius = random.uniform(1, 2);
      atoms.push_back({(1.4 + radius) * direction, radius});
      patch.touched.push_back(i);
      patch.toward.push_back(direction);
    }
    if (is_cut) patch.caps = {{{0, 0, 1}, 0.3}, {{0.6, 0, -0.8}, 0.1}};
    const SurfaceModel surface(atoms, 1.4);
    ConcaveScratch scratch;
    std::size_t borders = 0;
    double sum = 0;
    for (const AtomIndex owner : patch.touched) {
      const SpherePart part = part_of_atom(surface, patch, owner, scratch);
      sum += part.solid_angle;
      std::vector<SphericalCap> caps = patch.caps;
      for (const AtomIndex other : patch.touched) {
        if (other == owner) continue;
        const Vec3 toward = atoms[other].center - atoms[owner].center;
        caps.push_back(
            {normalized(toward), (atoms[other].radius - atoms[owner].radius) / norm(toward)});
      }
      SpherePartFinder finder;
      const SpherePart expected = finder.find(caps);
      CHECK(std::fabs(part.solid_angle - expected.solid_angle) < 1e-9);
      CHECK(norm(part.vector_area - expected.vector_area) < 1e-9);
      borders += scratch.borders.size();
    }
    CHECK(borders < 150 * 149 / 2);
    SpherePartFinder finder;
    const double whole = is_cut ? finder.find(patch.caps).solid_angle : 4 * pi;
    CHECK(std::fabs(sum - whole) < 1e-8);
  }
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
