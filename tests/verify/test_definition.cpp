/// Tests of the searches of --verify: they are compared with the oracle of support/brute_force.hpp,
/// which lists all centres of a molecule without any shortcut.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "catch.hpp"
#include "geometry/make_grid.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "support/near_degenerate.hpp"
#include "support/run.hpp"
#include "verify/definition.hpp"
#include "verify/faults.hpp"
#include "verify/sample.hpp"

namespace eses::detail {
namespace {

// Only some names are used: eses::detail::test has a crossing of its own.
using test::AccessibleSet;
using test::all_kinds;
using test::designed_probe_radius;
using test::is_accessible;
using test::Kind;
using test::kind_name;
using test::make_accessible_set;
using test::make_atom_set;
using test::make_chain;
using test::nearest_accessible;
using test::Random;
using test::read_atom_list;
using test::run;
using test::with_copies;

const Outputs no_files = Outputs::none();

Vec3 random_point(Random& random, const Grid& grid) {
  const auto along = [&](std::size_t q) { return random.uniform(grid.origin[q], grid.upper()[q]); };
  const double x = along(0), y = along(1), z = along(2);
  return {x, y, z};
}

double distance_of(const std::optional<Vec3>& center, Vec3 x, double reach) {
  return center ? norm(*center - x) : reach;
}

/// Compares the two distances that bracket the definition with the oracle's distance at one point.
/// The oracle counts centres up to 1e-9 angstrom inside a SAS ball as accessible. Returns whether
/// the bracket is narrow enough to leave no doubt.
bool check_bracket(verify::CentreSearch& search, const AccessibleSet& set, Vec3 x, double reach) {
  constexpr double rounding = 1e-8;
  const auto expected = nearest_accessible(set, x, reach);
  const double distance = expected ? expected->distance : reach;
  const auto possible = search.nearest(x, reach, verify::possibly_accessible);
  const auto certain = search.nearest(x, reach, verify::surely_accessible);
  const double least = distance_of(possible, x, reach), most = distance_of(certain, x, reach);
  REQUIRE(least <= distance + rounding);
  REQUIRE(most >= distance - rounding);
  if (possible) REQUIRE(is_accessible(set, *possible, 2e-6));
  if (certain) REQUIRE(is_accessible(set, *certain, 1e-11));
  if (std::fabs(reach - least) > rounding)
    REQUIRE(search.is_any(x, reach, verify::possibly_accessible));
  if (std::fabs(reach - most) > rounding)
    REQUIRE(search.is_any(x, reach, verify::surely_accessible));
  return most - least < 1e-7;
}

}  // namespace

TEST_CASE("the nearest accessible centre is the oracle's where rounding leaves no doubt",
          "[verify]") {
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      INFO(kind_name(kind) << ", seed " << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const double probe = designed_probe_radius(seed);
      const AccessibleSet set = make_accessible_set(atoms, probe);
      const verify::Definition definition(atoms, probe);
      verify::CentreSearch search(definition);
      const Grid grid = make_grid(atoms, 0.5, 1);
      Random random(seed);
      int clear = 0;
      for (int i = 0; i < 200; ++i)
        clear += check_bracket(search, set, random_point(random, grid),
                               random.uniform(0.3, 1.2) * probe);
      CHECK(clear >= (kind == Kind::gas || kind == Kind::chain ? 200 : 150));
    }
}

TEST_CASE("the nearest accessible centre is found among many atoms around a large probe",
          "[verify]") {
  for (std::uint64_t seed = 0; seed < 3; ++seed)
    for (const double probe : {4.0, 12.0, 40.0}) {
      INFO("seed " << seed << ", probe radius " << probe);
      const std::vector<Atom> atoms = make_chain(60, seed);
      const AccessibleSet set = make_accessible_set(atoms, probe);
      const verify::Definition definition(atoms, probe);
      verify::CentreSearch search(definition);
      const Grid grid = make_grid(atoms, 0.5, 1);
      Random random(seed);
      int clear = 0, found = 0;
      for (int i = 0; i < 100; ++i) {
        const Vec3 x = random_point(random, grid);
        const double reach = random.uniform(0.9, 1.1) * probe;
        clear += check_bracket(search, set, x, reach);
        found += search.is_any(x, reach, verify::surely_accessible);
      }
      CHECK(clear == 100);
      CHECK(found > 10);
      CHECK(found < 100);
    }
}

TEST_CASE("a protein with a large probe verifies", "[verify]") {
  const std::vector<Atom> atoms = read_atom_list(std::string(ESES_DATA) + "/1ubq.xyzr");
  Parameters parameters;
  parameters.probe_radius = 30;
  parameters.verify = 1000;
  const Summary summary = run(atoms, parameters, no_files, "nowhere");
  REQUIRE(summary.verification);
  CHECK(summary.verification->points == 1000);
  CHECK(summary.verification->edges == 1000);
  CHECK(summary.verification->faults.empty());
}

TEST_CASE("the distance to the place where another probe is as near is exact", "[verify]") {
  // On the sphere of an atom, the angle between its SAS circle and the point gives the distance.
  const double probe = 1.4, r = 1.6, distance = 4;
  const std::vector<Atom> atoms{{{0, 0, 0}, r}, {{distance, 0, 0}, r}};
  const verify::Definition definition(atoms, probe);
  verify::CentreSearch search(definition);
  const double seam = std::acos(distance / 2 / (r + probe));
  for (const double angle : {1e-3, 1e-2, 0.03}) {
    const Vec3 out{std::cos(seam + angle), 0.6 * std::sin(seam + angle),
                   0.8 * std::sin(seam + angle)};
    const double found =
        search.distance_to_seam(r * out, (r + probe) * out, 1.1 * probe, verify::surely_accessible);
    CHECK(std::fabs(found - r * std::sin(angle / 2)) < 1e-9);
  }
}

TEST_CASE("points are drawn from the band, each once, and all points of a small band", "[verify]") {
  const std::vector<Atom> atoms = make_chain(20, 3);
  const verify::Definition definition(atoms, 1.4);
  const Grid grid = make_grid(atoms, 0.7, 1);
  const auto is_within = [&](Vec3 x, double beyond) {
    return std::any_of(atoms.begin(), atoms.end(), [&](const Atom& atom) {
      return norm(x - atom.center) < atom.radius + beyond;
    });
  };
  std::size_t in_band = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        in_band += is_within(grid.point({i, j, k}), 1.4) && !is_within(grid.point({i, j, k}), 0);
  for (const std::size_t count : {std::size_t{10}, in_band / 2, 100 * in_band}) {
    std::vector<GridIndex> points = draw_band_points(definition, grid, grid.whole(), count);
    if (count < in_band)
      CHECK(points.size() == count);
    else
      CHECK(static_cast<double>(points.size()) > 0.95 * static_cast<double>(in_band));
    for (const GridIndex& point : points) {
      const Vec3 x = grid.point(point);
      REQUIRE((is_within(x, 1.4) && !is_within(x, 0)));
    }
    std::sort(points.begin(), points.end());
    CHECK(std::adjacent_find(points.begin(), points.end()) == points.end());
  }
}

TEST_CASE("a sample of edges does not depend on the parts in which they come", "[verify]") {
  Grid grid;
  grid.size = {100, 100, 100};
  verify::CrossingSample whole(50), left(50), right(50);
  Random random(5);
  for (std::int64_t i = 0; i < 5000; ++i) {
    Crossing crossing;
    crossing.lower = {i % 100, i / 100 % 100, 7};
    crossing.axis = static_cast<std::uint8_t>(i % 3);
    whole.add(grid, crossing);
    (random.chance(0.3) ? left : right).add(grid, crossing);
  }
  right.merge(left);
  const auto edges = whole.crossings(), merged = right.crossings();
  REQUIRE(edges.size() == 50);
  REQUIRE(merged.size() == 50);
  for (std::size_t e = 0; e < edges.size(); ++e) REQUIRE(edges[e].lower == merged[e].lower);
}

namespace {}  // namespace

TEST_CASE("crowds of atoms that almost coincide take as little time as one atom", "[verify]") {
  const double probe = 1.4, radius = 1.7;
  for (const double apart : {0.0, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5}) {
    INFO(apart << " apart");
    Random random(1);
    const std::vector<Atom> sites{
        {{1, 2, 3}, radius}, {{4, 2, 3}, radius}, {{2.5, 4.6, 3}, radius}};
    for (const std::size_t count : {std::size_t{1}, std::size_t{3}}) {
      const std::vector<Atom> some(sites.begin(),
                                   sites.begin() + static_cast<std::ptrdiff_t>(count));
      const std::vector<Atom> atoms = with_copies(some, 300 / count - 1, apart, random);
      const verify::Definition definition(atoms, probe);
      verify::CentreSearch search(definition);
      const AccessibleSet set = make_accessible_set(some, probe);
      const Grid grid = make_grid(some, 0.5, 1);
      for (int i = 0; i < 200; ++i) {
        const Vec3 x = random_point(random, grid);
        const auto expected = nearest_accessible(set, x, 1.2 * probe);
        const double distance = expected ? expected->distance : 1.2 * probe;
        // The surface of one or three atoms moves by at most a few times the displacement of the
        // atoms.
        for (const auto& access : {verify::possibly_accessible, verify::surely_accessible}) {
          const double found = distance_of(search.nearest(x, 1.2 * probe, access), x, 1.2 * probe);
          REQUIRE(std::fabs(found - distance) < 20 * apart + 2e-8);
        }
      }
    }
  }
}

}  // namespace eses::detail
