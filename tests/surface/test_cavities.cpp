/// Tests of the cavities of a surface and the pieces of a molecule.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/measure.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"
#include "support/flood_fill.hpp"
#include "support/measured_sets.hpp"
#include "surface/connect_walls.hpp"
#include "surface/measure_patches.hpp"

namespace eses::detail::test {
namespace {

using std::numbers::pi;

Measures measure_cavities(const std::vector<Atom>& atoms, double probe, int threads = 1) {
  return measure(Surface(atoms), {.probe_radius = probe, .cavities = true, .threads = threads});
}

std::vector<Atom> joined(std::vector<Atom> atoms, const std::vector<Atom>& others) {
  atoms.insert(atoms.end(), others.begin(), others.end());
  return atoms;
}

std::vector<Atom> read_data(const std::string& name) {
  return read_atom_list(std::string(ESES_DATA) + "/" + name);
}

/// Atoms on a sphere around the origin, on a spiral of the golden angle.
std::vector<Atom> hollow_ball(std::size_t count, double distance, double radius) {
  std::vector<Atom> atoms;
  for (std::size_t k = 0; k < count; ++k) {
    const double height = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count);
    const double ring = std::sqrt(1 - height * height);
    const double turn = pi * (3 - std::sqrt(5.0)) * static_cast<double>(k);
    atoms.push_back(
        {distance * Vec3{ring * std::cos(turn), ring * std::sin(turn), height}, radius});
  }
  return atoms;
}

/// Two chambers between three squares of atoms. The window in the middle square opens when the SAS
/// radius of its atoms is half of its diagonal. `gap` is that half minus the SAS radius.
std::vector<Atom> two_chambers(double probe, double gap) {
  const double b = 2, open = b * std::numbers::sqrt2;
  std::vector<Atom> atoms;
  for (const double x : {-b, 0., b})
    for (const double y : {-b, b})
      for (const double z : {-b, b})
        atoms.push_back({{x, y, z}, (x == 0 ? open - gap : 1.45 * b) - probe});
  return rotated(atoms);
}

/// The cavity between six atoms, where no patch is cut: polynomials of the probe radius (Steiner).
struct OctahedralCavity {
  double probe_center_volume, sas_area, void_volume, ses_area;

  OctahedralCavity(double distance, double radius, double probe) {
    const double d = distance, R = radius + probe, half = d / std::numbers::sqrt2;
    const double q = (d - std::sqrt(3 * R * R - 2 * d * d)) / 3;  // placements: (+-q, +-q, +-q)
    const double rho = std::sqrt(R * R - half * half), c = half / R, s = rho / R;
    const double h = std::atan2(q, half - q * std::numbers::sqrt2), t = 2 * h;  // angle of an arc
    const Vec3 corner = (1 / R) * Vec3{q - d, q, q};
    const auto outward = [&](Vec3 axis) { return normalized(axis - dot(axis, corner) * corner); };
    const double turn =
        std::acos(dot(outward(normalized({-1, 1, 0})), outward(normalized({-1, 0, 1}))));
    const double angle = 2 * pi - 4 * turn + 4 * c * t;  // Gauss-Bonnet
    const double vector_area = 4 * (-s * c * std::sin(h) + s * s * h) / std::numbers::sqrt2;
    sas_area = 6 * R * R * angle;
    probe_center_volume = -2 * R * R * (R * angle + d * vector_area);
    const double p = probe;
    const double mean_curvature = -sas_area / R + 12 * rho * t * std::asin(c);
    void_volume =
        probe_center_volume + p * sas_area + p * p * mean_curvature + 4 * pi / 3 * p * p * p;
    ses_area = sas_area + 2 * p * mean_curvature + 4 * pi * p * p;
  }
};

void check_same(const Cavity& a, const Cavity& b, double error) {
  CHECK(difference(a.void_volume, b.void_volume) < error);
  CHECK(difference(a.probe_center_volume, b.probe_center_volume) < error);
  CHECK(difference(a.ses_area, b.ses_area) < error);
  CHECK(difference(a.sas_area, b.sas_area) < error);
  CHECK(a.euler_number == b.euler_number);
}

/// Checks what follows from the definitions.
void check_consistent(const Measures& measures, double probe) {
  double sas_area = 0, sas_volume = 0, ses_area = 0, ses_volume = 0;
  std::int64_t euler_number = 0;
  for (const Piece& piece : measures.pieces) {
    sas_area += piece.sas_area;
    sas_volume += piece.sas_volume;
    ses_area += piece.ses_area;
    ses_volume += piece.ses_volume;
    euler_number += piece.euler_number;
  }
  CHECK(difference(sas_area, measures.sas_area) < 1e-10);
  CHECK(difference(sas_volume, measures.sas_volume) < 1e-10);
  CHECK(difference(ses_area, measures.ses_area) < 1e-10);
  CHECK(difference(ses_volume, measures.ses_volume) < 1e-10);
  CHECK(euler_number == measures.euler_number);
  std::size_t cavity_count = 0;
  for (const Piece& piece : measures.pieces) cavity_count += piece.cavity_count;
  CHECK(cavity_count == measures.cavities.size());
  for (std::size_t k = 0; k < measures.cavities.size(); ++k) {
    const Cavity& cavity = measures.cavities[k];
    CHECK(cavity.void_volume > 4 * pi / 3 * probe * probe * probe * (1 - 1e-8));
    CHECK(cavity.void_volume >= cavity.probe_center_volume);
    CHECK(cavity.largest_probe >= probe);
    CHECK(!cavity.atoms.empty());
    CHECK(cavity.wall_count == 1 + cavity.inner.size());
    for (const std::size_t piece : cavity.inner) CHECK(measures.pieces[piece].cavity == k);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CHECK(cavity.centroid[axis] >= cavity.low[axis] + probe * (1 - 1e-8));
      CHECK(cavity.centroid[axis] <= cavity.high[axis] - probe * (1 - 1e-8));
    }
    for (const std::size_t other : cavity.overlaps) {
      const auto& others = measures.cavities[other].overlaps;
      CHECK(std::count(others.begin(), others.end(), k) == 1);
    }
  }
}

AtomIndex nearest_atom(const std::vector<Atom>& atoms, Vec3 point) {
  const auto gap = [&](const Atom& atom) { return norm(point - atom.center) - atom.radius; };
  const auto nearest = std::min_element(
      atoms.begin(), atoms.end(), [&](const Atom& a, const Atom& b) { return gap(a) < gap(b); });
  return static_cast<AtomIndex>(nearest - atoms.begin());
}

/// The component of a free point, or nothing if rounding decides.
std::optional<ComponentIndex> component_at(const Components& components,
                                           const std::vector<Atom>& atoms, Vec3 point) {
  const AtomIndex nearest = nearest_atom(atoms, point);
  const auto wall = components.wall_at(nearest, normalized(point - atoms[nearest].center));
  return wall ? std::optional(components[*wall].component) : std::nullopt;
}

void check_against_flood_fill(const std::vector<Atom>& atoms, double probe, double spacing) {
  const Measures measures = measure_cavities(atoms, probe);
  check_consistent(measures, probe);
  FloodFill fill(atoms, probe, spacing);
  const Molecule molecule(atoms);
  const Components components =
      find_components(molecule, {.probe_radius = probe, .cavities = true});
  CHECK(components.count == measures.cavities.size() + 1);
  // The points of each component of the grid are in the same component.
  for (std::size_t k = 0; k < fill.component_count(); ++k) {
    std::set<ComponentIndex> found;
    for (const Vec3 point : fill.points(k))
      if (const auto component = component_at(components, atoms, point)) found.insert(*component);
    CHECK(found.size() == 1);
    if (k == 0) CHECK(*found.begin() == Components::outside);
  }
  // No component has points of two cavities, or of a cavity and the outside.
  std::map<int, std::size_t> cavity_of;
  for (std::size_t k = 0; k < measures.cavities.size(); ++k) {
    const Cavity& cavity = measures.cavities[k];
    if (cavity.largest_probe - probe < 0.87 * spacing) continue;
    const int component = fill.label_near(cavity.largest_probe_center);
    CHECK(component > 0);
    CHECK(cavity_of.emplace(component, k).second);
  }
}

}  // namespace

TEST_CASE("cavities: a shell of atoms around one void") {
  // With the larger distance, the void overlaps that of the outside in the windows.
  for (const double distance : {2.7, 2.8}) {
    const double radius = 2, probe = 0.3;
    const Measures measures = measure_cavities(octahedron(distance, radius), probe);
    check_consistent(measures, probe);
    REQUIRE(measures.cavities.size() == 1);
    const Cavity& cavity = measures.cavities[0];
    const OctahedralCavity expected(distance, radius, probe);
    CHECK(difference(cavity.void_volume, expected.void_volume) < 1e-12);
    CHECK(difference(cavity.probe_center_volume, expected.probe_center_volume) < 1e-12);
    CHECK(difference(cavity.ses_area, expected.ses_area) < 1e-12);
    CHECK(difference(cavity.sas_area, expected.sas_area) < 1e-12);
    CHECK(cavity.euler_number == 2);
    CHECK(norm(cavity.centroid) < 1e-12);
    CHECK(std::fabs(cavity.largest_probe - (distance - radius)) < 1e-9);
    CHECK(norm(cavity.largest_probe_center) < 1e-8);
    CHECK(cavity.atoms == std::vector<AtomIndex>{0, 1, 2, 3, 4, 5});
    CHECK(cavity.overlaps_outside == (distance == 2.8));
    REQUIRE(measures.pieces.size() == 1);
    CHECK(measures.pieces[0].cavity_count == 1);
    CHECK(!measures.pieces[0].cavity);
  }
}

TEST_CASE("cavities: volumes and areas are those that an atom in the cavity removes") {
  const std::vector<Atom> shell = make_icosahedron(4.4, 2.2);
  const double probe = 0.9;
  const Measures open = measure_cavities(shell, probe);
  REQUIRE(open.cavities.size() == 1);
  const Cavity& cavity = open.cavities[0];
  REQUIRE(!cavity.overlaps_outside);
  const Measures full = measure_cavities(joined(shell, {{{0, 0, 0}, 2.4}}), probe);
  REQUIRE(full.cavities.empty());
  CHECK(difference(full.sas_volume - open.sas_volume, cavity.probe_center_volume) < 1e-11);
  CHECK(difference(open.sas_area - full.sas_area, cavity.sas_area) < 1e-11);
  CHECK(difference(full.ses_volume - open.ses_volume, cavity.void_volume) < 1e-11);
  CHECK(difference(open.ses_area - full.ses_area, cavity.ses_area) < 1e-11);
}

TEST_CASE("cavities: nested shells") {
  const double probe = 1.4;
  const std::vector<Atom> outer = hollow_ball(150, 14, 1.7), inner = hollow_ball(40, 6.5, 1.7);
  const Measures both = measure_cavities(joined(outer, inner), probe);
  const Measures outer_alone = measure_cavities(outer, probe);
  const Measures inner_alone = measure_cavities(inner, probe);
  check_consistent(both, probe);
  REQUIRE(outer_alone.cavities.size() == 1);
  REQUIRE(inner_alone.cavities.size() == 1);
  REQUIRE(both.cavities.size() == 2);
  REQUIRE(both.pieces.size() == 2);
  const Cavity &gap = both.cavities[0], &core = both.cavities[1];
  check_same(core, inner_alone.cavities[0], 1e-10);
  CHECK(difference(gap.probe_center_volume,
                   outer_alone.cavities[0].probe_center_volume - inner_alone.sas_volume -
                       inner_alone.cavities[0].probe_center_volume) < 1e-11);
  CHECK(gap.wall_count == 2);
  CHECK(core.wall_count == 1);
  CHECK(gap.euler_number == 4);
  CHECK(gap.piece == 0);
  CHECK(gap.inner == std::vector<std::size_t>{1});
  CHECK(core.piece == 1);
  CHECK(both.pieces[1].cavity == 0);
  CHECK(both.pieces[1].cavity_count == 1);
  CHECK(gap.atoms.size() > core.atoms.size());
}

TEST_CASE("cavities: an atom and a ring of atoms float in a cavity") {
  const double probe = 1;
  const std::vector<Atom> shell = hollow_ball(400, 18, 1.7);
  std::vector<Atom> ring;
  for (int k = 0; k < 12; ++k)
    ring.push_back({{6 * std::cos(pi * k / 6 + 0.1), 6 * std::sin(pi * k / 6 + 0.1), 1}, 1.5});
  const std::vector<Atom> atom{{{0.3, 0.2, -9}, 1.5}};
  const Measures empty = measure_cavities(shell, probe);
  const Measures all = measure_cavities(joined(joined(shell, ring), atom), probe);
  check_consistent(all, probe);
  REQUIRE(empty.cavities.size() == 1);
  REQUIRE(all.cavities.size() == 1);
  CHECK(all.cavities[0].wall_count == 3);
  CHECK(all.cavities[0].euler_number == empty.cavities[0].euler_number + 2);
  CHECK(all.cavities[0].inner == std::vector<std::size_t>{1, 2});
  const Measures ring_alone = measure_cavities(ring, probe);
  CHECK(ring_alone.euler_number == 0);
  CHECK(ring_alone.cavities.empty());
  CHECK(difference(all.cavities[0].probe_center_volume, empty.cavities[0].probe_center_volume -
                                                            ring_alone.sas_volume -
                                                            4 * pi / 3 * std::pow(2.5, 3)) < 1e-11);
  CHECK(difference(all.cavities[0].void_volume, empty.cavities[0].void_volume -
                                                    ring_alone.ses_volume -
                                                    4 * pi / 3 * std::pow(1.5, 3)) < 1e-11);
  CHECK(difference(all.cavities[0].ses_area,
                   empty.cavities[0].ses_area + ring_alone.ses_area + 9 * pi) < 1e-11);
}

// The faces of atoms in the middle of a rod have two separate clusters of caps.
TEST_CASE("cavities: a rod through a cavity") {
  const double probe = 1;
  const std::vector<Atom> shell = hollow_ball(120, 11, 1.7);
  std::vector<Atom> rod;
  for (double z = -10; z <= 10; z += 2.4) rod.push_back({{0.1, 0.2, z}, 1.5});
  const Measures measures = measure_cavities(joined(shell, rod), probe);
  check_consistent(measures, probe);
  REQUIRE(measures.cavities.size() == 1);
  CHECK(measures.cavities[0].wall_count == 1);
  CHECK(measures.cavities[0].euler_number == 0);
  CHECK(measures.pieces.size() == 1);
  const Measures alone = measure_cavities(rod, probe);
  CHECK(alone.cavities.empty());
  REQUIRE(alone.pieces.size() == 1);
  CHECK(alone.pieces[0].euler_number == 2);
}

// A ring of atoms around a large atom divides its exposed part into two faces.
TEST_CASE("cavities: one atom between two cavities") {
  const double probe = 1, distance = 9;
  std::vector<Atom> atoms = hollow_ball(90, distance, 1.9);
  for (int k = 0; k < 40; ++k)
    for (const double radius : {5.2, 7.0})
      atoms.push_back(
          {{radius * std::cos(pi * k / 20), radius * std::sin(pi * k / 20), 0.01 * k}, 1.5});
  atoms.push_back({{0, 0, 0}, 3.6});
  const Measures measures = measure_cavities(atoms, probe);
  check_consistent(measures, probe);
  REQUIRE(measures.cavities.size() == 2);
  const auto center = static_cast<AtomIndex>(atoms.size() - 1);
  for (const Cavity& cavity : measures.cavities) {
    CHECK(cavity.euler_number == 2);
    CHECK(cavity.atoms.back() == center);
  }
  const Cavity &first = measures.cavities[0], &second = measures.cavities[1];
  CHECK(first.centroid.z * second.centroid.z < 0);
}

TEST_CASE("cavities: C60, by the radius of the probe") {
  const std::vector<Atom> atoms = read_data("c60.xyzr");
  double min_distance = 1e9;
  for (const Atom& atom : atoms) {
    Vec3 middle;
    for (const Atom& other : atoms)
      middle = middle + (1.0 / static_cast<double>(atoms.size())) * other.center;
    min_distance = std::min(min_distance, norm(atom.center - middle));
  }
  const double largest = min_distance - atoms.front().radius;
  const Measures inside = measure_cavities(atoms, 1.4);
  check_consistent(inside, 1.4);
  REQUIRE(inside.cavities.size() == 1);
  CHECK(inside.cavities[0].largest_probe > largest - 1e-9);
  CHECK(inside.cavities[0].largest_probe < largest + 0.01);
  CHECK(inside.cavities[0].atoms.size() == 60);
  CHECK(measure_cavities(atoms, largest + 0.01).cavities.empty());
  // Small atoms leave the hexagons open for a small probe, and not for a larger one.
  std::vector<Atom> small = atoms;
  for (Atom& atom : small) atom.radius = 0.7;
  CHECK(measure_cavities(small, 0.6).cavities.empty());
  CHECK(measure_cavities(small, 0.6).euler_number < 0);
  CHECK(measure_cavities(small, 0.8).cavities.size() == 1);
}

TEST_CASE("cavities: a trapped probe") {
  const double p = 0.7;
  for (const double slack : {0.0, 5e-10}) {
    INFO(slack);
    const Measures measures = measure_cavities(octahedron(1 + p + slack, 1), p);
    REQUIRE(measures.cavities.size() == 1);
    const Cavity& cavity = measures.cavities[0];
    CHECK(difference(cavity.void_volume, 4 * pi / 3 * p * p * p) < 1e-7);
    CHECK(difference(cavity.ses_area, 4 * pi * p * p) < 1e-7);
    CHECK(cavity.probe_center_volume < 1e-20);
    CHECK(cavity.euler_number == 2);
    CHECK(std::fabs(cavity.largest_probe - p) < 1e-8);
    CHECK(norm(cavity.centroid) < 1e-7);
    CHECK(cavity.atoms.size() == 6);
  }
  CHECK(measure_cavities(octahedron(1 + p - 1e-7, 1), p).cavities.empty());
  const Measures open = measure_cavities(octahedron(1 + p + 1e-6, 1), p);
  REQUIRE(open.cavities.size() == 1);
  CHECK(std::fabs(open.cavities[0].largest_probe - p - 1e-6) < 1e-9);
  // The rounding error of the volume is about 1e-15.
  CHECK(measure_cavities(octahedron(1 + p + 1e-3, 1), p).cavities[0].probe_center_volume > 1e-10);
}

TEST_CASE("cavities: the largest probe of a cube that holds a probe by a hair") {
  for (const double excess : {1e-9, 1e-8, 1e-6, 1e-3, 0.1}) {
    INFO(excess);
    const double half = (3.1 + excess) / std::numbers::sqrt3;
    std::vector<Atom> atoms;
    for (const double x : {-half, half})
      for (const double y : {-half, half})
        for (const double z : {-half, half}) atoms.push_back({{x, y, z}, 1.7});
    const Measures measures = measure_cavities(atoms, 1.4);
    REQUIRE(measures.cavities.size() == 1);
    CHECK(std::fabs(measures.cavities[0].largest_probe - (1.4 + excess)) < 1e-12);
  }
}

TEST_CASE("cavities: parts that touch in one point are one cavity") {
  const double probe = 1;
  for (const double gap : {1e-6, 1e-9, 0.0}) {
    const Measures one = measure_cavities(two_chambers(probe, gap), probe);
    INFO(gap);
    check_consistent(one, probe);
    REQUIRE(one.cavities.size() == 1);
    CHECK(one.cavities[0].overlaps.empty());
  }
  const Measures two = measure_cavities(two_chambers(probe, -1e-6), probe);
  check_consistent(two, probe);
  REQUIRE(two.cavities.size() == 2);
  CHECK(two.cavities[0].overlaps == std::vector<std::size_t>{1});
  CHECK(two.cavities[1].overlaps == std::vector<std::size_t>{0});
  CHECK(two.cavities[0].atoms < two.cavities[1].atoms);
  check_same(two.cavities[0], two.cavities[1], 1e-10);
}

TEST_CASE("cavities: the void of a cavity does not depend on what is behind a narrow window") {
  const double probe = 1;
  std::vector<Atom> atoms = two_chambers(probe, -0.01);
  const Measures two = measure_cavities(atoms, probe);
  REQUIRE(two.cavities.size() == 2);
  REQUIRE(two.cavities[0].overlaps.size() == 1);
  // An atom fills one chamber, and reaches as far as the middle of the window, which is the origin.
  atoms.push_back({1.03 * normalized(two.cavities[1].centroid), 0.03});
  const Measures one = measure_cavities(atoms, probe);
  REQUIRE(one.cavities.size() == 1);
  check_same(one.cavities[0], two.cavities[0], 1e-10);
  CHECK(one.cavities[0].overlaps.empty());
}

TEST_CASE("cavities: thousands of voids of a lattice") {
  const double spacing = 3, radius = 1.6, probe = 0.7;
  const Measures one = measure_cavities(make_cube(2, spacing, radius), probe);
  REQUIRE(one.cavities.size() == 1);
  const std::size_t side = 13;
  const Measures all = measure_cavities(make_cube(side, spacing, radius), probe);
  CHECK(all.cavities.size() == (side - 1) * (side - 1) * (side - 1));
  AtomIndex last = 0;
  for (const Cavity& cavity : all.cavities) {
    REQUIRE(difference(cavity.void_volume, one.cavities[0].void_volume) < 1e-9);
    REQUIRE(difference(cavity.probe_center_volume, one.cavities[0].probe_center_volume) < 1e-9);
    REQUIRE(cavity.euler_number == 2);
    REQUIRE(cavity.atoms.size() == 8);
    REQUIRE(cavity.atoms.front() >= last);  // equal volumes are in the order of their atoms
    last = cavity.atoms.front();
  }
}

// All faces of an atom between cavities are tiny, so that none of them is the rest of its sphere,
// although it is nearest to some directions that caps cover.
TEST_CASE("cavities: tiny faces of an atom in several cavities") {
  const double spacing = 3.4 + 5e-7;
  Random random(788);
  for (int k = 0; k < 120; ++k) {
    const Vec3 x = random_direction(random);
    const Vec3 y = normalized(cross(x, random_direction(random))), z = cross(x, y);
    std::vector<Atom> atoms;
    for (int cell = 0; cell < 64; ++cell)
      if (const int i = cell % 4, j = cell / 4 % 4, l = cell / 16; (i + j + l) % 2 == 0)
        atoms.push_back({(i * spacing) * x + (j * spacing) * y + (l * spacing) * z, 2});
    const Measures measures = measure_cavities(atoms, 1.4);
    INFO("set " << k);
    CHECK(measures.cavities.size() == 4);
    for (const Cavity& cavity : measures.cavities)
      CHECK(std::fabs(cavity.ses_area - 4 * pi * 1.4 * 1.4) < 1e-3);
  }
}

TEST_CASE("cavities: pieces of the molecule") {
  const std::vector<Atom> atoms{
      {{0, 0, 0}, 1.5}, {{9, 0, 0}, 1.7}, {{2, 0, 0}, 1.5}, {{0, 20, 0}, 1.6}, {{0, 0, 0}, 1}};
  const Measures measures = measure_cavities(atoms, 1.4);
  check_consistent(measures, 1.4);
  CHECK(measures.cavities.empty());
  REQUIRE(measures.pieces.size() == 3);
  CHECK(measures.pieces[0].atoms == std::vector<AtomIndex>{0, 2, 4});
  CHECK(measures.pieces[1].atoms == std::vector<AtomIndex>{1});
  CHECK(measures.pieces[2].atoms == std::vector<AtomIndex>{3});
  CHECK(difference(measures.pieces[1].sas_volume, 4 * pi / 3 * 3.1 * 3.1 * 3.1) < 1e-12);
  CHECK(difference(measures.pieces[2].ses_area, 4 * pi * 1.6 * 1.6) < 1e-12);
}

TEST_CASE("cavities: rotation, translation and order do not matter") {
  const std::vector<Atom> atoms = read_data("1a0q.xyzr");
  const Measures reference = measure_cavities(atoms, 1.4);
  check_consistent(reference, 1.4);
  REQUIRE(reference.cavities.size() > 10);
  std::vector<Atom> turned = rotated(atoms);
  for (Atom& atom : turned) atom.center = atom.center + Vec3{1000, -200, 3000};
  std::vector<Atom> reversed(atoms.rbegin(), atoms.rend());
  for (const std::vector<Atom>* other : {&turned, &reversed}) {
    const Measures measures = measure_cavities(*other, 1.4);
    REQUIRE(measures.cavities.size() == reference.cavities.size());
    for (std::size_t k = 0; k < reference.cavities.size(); ++k) {
      check_same(measures.cavities[k], reference.cavities[k], 1e-8);
      CHECK(std::fabs(measures.cavities[k].largest_probe - reference.cavities[k].largest_probe) <
            3e-9);
      CHECK(measures.cavities[k].atoms.size() == reference.cavities[k].atoms.size());
      CHECK(measures.cavities[k].overlaps == reference.cavities[k].overlaps);
      CHECK(measures.cavities[k].overlaps_outside == reference.cavities[k].overlaps_outside);
    }
  }
}

TEST_CASE("cavities: the number of threads does not matter, and measures stay the same") {
  const std::vector<Atom> atoms = read_data("1a0q.xyzr");
  const Measures one = measure_cavities(atoms, 1.4, 1);
  for (const int threads : {2, 3, 8}) {
    const Measures many = measure_cavities(atoms, 1.4, threads);
    REQUIRE(many.cavities.size() == one.cavities.size());
    for (std::size_t k = 0; k < one.cavities.size(); ++k) {
      const Cavity &a = many.cavities[k], &b = one.cavities[k];
      CHECK(a.void_volume == b.void_volume);
      CHECK(a.ses_area == b.ses_area);
      CHECK(a.centroid == b.centroid);
      CHECK(a.largest_probe == b.largest_probe);
      CHECK(a.atoms == b.atoms);
    }
  }
  const Measures without = measure(Surface(atoms));
  CHECK(without.ses_volume == one.ses_volume);
  CHECK(without.ses_area == one.ses_area);
  CHECK(without.sas_area == one.sas_area);
  CHECK(without.cavities.empty());
  CHECK(without.pieces.empty());
}

TEST_CASE("cavities: flood fills of random atoms agree") {
  std::size_t cavities = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    INFO(seed);
    const std::vector<Atom> atoms = make_sponge(seed);
    for (const double probe : {0.2, 0.4}) {
      check_against_flood_fill(atoms, probe, 0.35);
      cavities += measure_cavities(atoms, probe).cavities.size();
    }
  }
  CHECK(cavities > 15);
}

TEST_CASE("cavities: flood fills of degenerate atoms agree") {
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    for (const Kind kind : all_kinds) {
      INFO(kind_name(kind) << " " << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const double probe = designed_probe_radius(seed);
      const Measures measures = measure_cavities(atoms, probe);
      std::int64_t euler_number = 0;
      for (const Piece& piece : measures.pieces) euler_number += piece.euler_number;
      CHECK(euler_number == measures.euler_number);
      // A smaller probe, in general position.
      check_against_flood_fill(atoms, 0.77 * probe, 0.7);
    }
}

TEST_CASE("cavities: the callback is called during the long steps of the search") {
  // Several times for 27,000 atoms, so that Ctrl-C is served for a million.
  const Molecule lattice(make_cube(30, 3, 1));
  int calls = 0;
  const CheckCallback check = [&] { ++calls; };
  find_pieces(SurfaceModel(lattice, 1.4), check);
  CHECK(calls >= 6);
  // A rod of atoms around a cavity, where many spheres are almost the largest.
  std::vector<Atom> rod;
  for (int k = 0; k < 40; ++k)
    for (int side = 0; side < 12; ++side)
      rod.push_back({{4 * std::cos(side * pi / 6), 4 * std::sin(side * pi / 6), k * 1.5}, 1.6});
  for (const double z : {-1.0, 60.0})
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y) rod.push_back({{1.5 * x, 1.5 * y, z}, 1.6});
  const auto calls_of = [&](bool largest_probes) {
    calls = 0;
    const Measures measures = measure_patches(
        Molecule(rod),
        {.probe_radius = 1.4, .cavities = true, .check = check, .largest_probes = largest_probes});
    CHECK(measures.cavities.size() == 1);
    return calls;
  };
  CHECK(calls_of(true) > calls_of(false));
}

}  // namespace eses::detail::test
