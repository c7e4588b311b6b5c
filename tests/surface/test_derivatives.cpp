/// Tests of the derivatives of areas and volumes.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/measure.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"
#include "support/measured_sets.hpp"

namespace eses::detail::test {
namespace {

using std::numbers::pi;

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

}  // namespace

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
        const Vec3 corner{2.0 * (cell % 2), 2.0 * (cell / 2 % 2), 2.0 * (cell / 4)};
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

// Returns the larger one of the force and the torque of derivatives by centres.
double imbalance(const std::vector<Atom>& atoms, const std::vector<Vec3>& by_center) {
  Vec3 force, torque;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    force = force + by_center[i];
    torque = torque + cross(atoms[i].center, by_center[i]);
  }
  return std::max(norm(force), norm(torque));
}

// The planes between close placements, and those of their cones, contain the axis of two atoms. In
// the first set, a probe has 5e-7 angstrom of room between four atoms. In the others, an atom
// grazes a circle that is as large as the probe within 2e-11 angstrom. The values of the first set
// are differences of areas with 40 digits.
TEST_CASE("measure: derivatives of areas where close placements cut each other beyond an axis") {
  const std::vector<Atom> shell{
      {{-2.5137878604835699, 3.0733736661990783, -1.1980433970022353}, 1.1472954038691126},
      {{3.6988510720947794, 1.7219027889178729, 0.74405325320909466}, 1.1472954038691126},
      {{-2.838638800687614, -2.2866284370863292, 1.9782628473542703}, 1.1472954038691134},
      {{1.0595407549753979, -2.1186666883521839, -3.4042162423498192}, 1.1472954038691126}};
  const std::vector<Vec3> expected{{2.1160616228731, -3.4563002483939, 1.0410805131212},
                                   {-2.7519193500394, -1.3362199228257, -1.8343338661066},
                                   {1.4100362234831, 2.2171605233690, -2.4123270973521},
                                   {-0.77417849631676, 2.5753596478506, 3.2055804503375}};
  const std::vector<Vec3> found =
      measure_atoms(shell, 3, {.gradients = true}).gradients.ses_area.centers;
  CHECK(imbalance(shell, found) < 1e-10);
  for (std::size_t i = 0; i < shell.size(); ++i) CHECK(norm(found[i] - expected[i]) < 1e-7);

  const std::vector<Atom> three{
      {{1.5521307346487225, -3.5093137085534112, -0.96176637186581182}, 1.9648149085888786},
      {{-1.5521307346487225, 3.5093137085534112, 0.96176637186581182}, 1.9648149085888786},
      {{0.97206915548432682, -3.4564733701617509, -2.460922784054671}, 1.2794154410504803}};
  CHECK(imbalance(three, measure_atoms(three, 3, {.gradients = true}).gradients.ses_area.centers) <
        1e-8);
  const std::vector<Atom> six{
      {{0.77015855633530084, 1.5732785763592676, 0.6063402438682457}, 0.92292879185309273},
      {{-0.77015855633530084, -1.5732785763592676, -0.6063402438682457}, 0.92292879185309273},
      {{-1.9030844122241319, -2.4096617871071535, -0.545120263255082}, 1.6733602624718684},
      {{0.084392228009679382, -0.94593353712744321, 0.0017228517971529245}, 0.70453957281318813},
      {{-1.1115233568557774, -2.8003684902705688, 0.22496980368472747}, 1.3710447911717578},
      {{3.1388552368598397, -0.82215796789598061, 0.92794805746317122}, 0.66151402467148468}};
  CHECK(imbalance(six, measure_atoms(six, 1.4, {.gradients = true}).gradients.ses_area.centers) <
        1e-8);
}

// A probe almost fits between six atoms, so that eight placements are close to each other there,
// and as many in each hole nearby. The caps of those in one hole are almost equal, as seen from
// another.
TEST_CASE("measure: the volume around probes that almost fit has no force") {
  Random random(230);
  for (int k = 0; k < 4; ++k) {
    std::vector<Atom> atoms;
    for (const double height : {4.7, 9.4})
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const double side : {-1, 1}) {
          Vec3 center{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
          center = 1e-8 * center;
          center[axis] += side * (height + 2e-8);
          atoms.push_back({center, 1.7});
        }
    const Measures measures = measure_atoms(atoms, 3, {.gradients = true});
    Vec3 force;
    for (const Vec3 by_center : measures.gradients.ses_volume.centers) force = force + by_center;
    INFO("set " << k);
    CHECK(norm(force) < 1e-9);
  }
}

// Each square of the lattice holds two placements at the ends of a short arc, which cut each other.
// Far from the origin, positions of placements have fewer digits.
TEST_CASE("measure: the volume around a noisy lattice has no force") {
  Random random(80);
  for (const double noise : {1e-8, 1e-7, 3e-6}) {
    std::vector<Atom> atoms = make_cube(3, 4, 1);
    for (Atom& atom : atoms)
      for (std::size_t axis = 0; axis < 3; ++axis)
        atom.center[axis] += 43.7 + noise * random.uniform(-1, 1);
    const Measures measures = measure_atoms(atoms, 3, {.gradients = true});
    Vec3 force;
    for (const Vec3 by_center : measures.gradients.ses_volume.centers) force = force + by_center;
    INFO("noise " << noise);
    CHECK(norm(force) < 1e-8);
  }
}

// With SAS spheres that are smaller by the tolerance of accessibility, these meet in one point
// within rounding errors.
TEST_CASE("measure: the volume of a ring that a probe fits by the tolerance has no force") {
  const double distance = 1.7 + 1.4 - 1e-9;
  for (int count = 5; count <= 12; ++count)
    for (int turn = 0; turn < 4; ++turn) {
      std::vector<Atom> atoms;
      for (int k = 0; k < count; ++k) {
        const double angle = 2 * pi * k / count + turn;
        atoms.push_back({{distance * std::cos(angle), distance * std::sin(angle), 0}, 1.7});
      }
      const Measures measures = measure_atoms(atoms, 1.4, {.gradients = true});
      Vec3 force;
      for (const Vec3 by_center : measures.gradients.ses_volume.centers) force = force + by_center;
      INFO(count << " atoms, turned by " << turn);
      CHECK(norm(force) < 1e-9);
    }
}

}  // namespace eses::detail::test
