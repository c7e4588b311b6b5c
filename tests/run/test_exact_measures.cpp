// Tests of --exact. Expected values are closed forms of spheres.

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "catch.hpp"
#include "eses/compute.hpp"
#include "eses/measure.hpp"
#include "eses/read_atoms.hpp"
#include "run/verifier.hpp"
#include "support/atom_sets.hpp"
#include "support/sandbox.hpp"
#include "system/formatted.hpp"

namespace eses::detail::test {
namespace {

double ball_volume(double radius) { return 4.0 / 3 * std::numbers::pi * std::pow(radius, 3); }

double half_diagonal(double spacing) { return std::sqrt(3.0) / 2 * spacing; }

// Two spheres of radius 1.7 at 3 angstrom, and a probe of 1.4.
constexpr const char* two_spheres = "0 0 0 1.7\n0 0 3 1.7\n";
constexpr const char* exact_values =
    "abs(r['exact_area'] - 66.0779806211) < 1e-9, abs(r['exact_volume'] - 42.3467039769) < 1e-9";

struct TwoSpheres : Sandbox {
  TwoSpheres() { write_file(directory() / "two.xyzr", two_spheres); }

  Outcome run_exact(const Arguments& more) const {
    Arguments arguments{"two.xyzr", "--exact", "--spacing", "0.5", "-o", "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
};

}  // namespace

TEST_CASE("the cells of inside points of a ball lie between two balls", "[exact]") {
  const Molecule ball({{{1, 2, 3}, 2}});
  for (const double spacing : {0.1, 0.4, 1.0}) {
    const VolumeBounds bounds = bound_inside_cells(ball, 1.4, spacing, 1, {});
    CHECK(bounds.low == Catch::Approx(ball_volume(2 - half_diagonal(spacing))));
    CHECK(bounds.high == Catch::Approx(ball_volume(2 + half_diagonal(spacing))));
  }
  // Cells that are larger than the probe and the ball.
  const VolumeBounds coarse = bound_inside_cells(ball, 1.4, 3, 1, {});
  CHECK(coarse.low == 0);
  CHECK(coarse.high == Catch::Approx(ball_volume(3.4)));
}

TEST_CASE("a number of inside points beyond the bounds is a fault", "[exact]") {
  const VolumeBounds bounds{1000, 1100};
  for (const std::int64_t points : {8000, 8400, 8800})
    CHECK(find_volume_fault(points, 0.5, bounds) == std::nullopt);
  CHECK(find_volume_fault(7999, 0.5, bounds) ==
        "the cells of the inside points have a volume of 999.875 cubic angstrom, but the exact "
        "surface requires 1000 to 1100");
  CHECK(find_volume_fault(8801, 0.5, bounds).has_value());
}

TEST_CASE("grids of all kinds of sets are within the bounds", "[exact]") {
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      const double probe = designed_probe_radius(seed);
      const Molecule molecule(make_atom_set(kind, seed));
      const Surface surface({molecule.atoms().begin(), molecule.atoms().end()},
                            {.probe_radius = probe});
      for (const double spacing : {0.2, 0.7}) {
        const Grid grid = make_grid(surface, {.spacing = spacing, .margin = spacing});
        const std::int64_t points =
            compute(surface, grid, ResultParts{.inside = false, .crossings = false})
                .summary()
                .inside_points;
        INFO(kind_name(kind) << ", seed " << seed << ", spacing " << spacing);
        const VolumeBounds bounds = bound_inside_cells(molecule, probe, spacing, 1, {});
        CHECK(find_volume_fault(points, spacing, bounds).value_or("") == "");
      }
    }
}

TEST_CASE("exact: --exact reports area and volume in closed form", "[exact]") {
  const TwoSpheres sandbox;
  for (const Arguments& more : {Arguments{"--json"}, Arguments{"--json", "--resume"},
                                Arguments{"--json", "--region", "-1,-1,-1,1,1,1"},
                                Arguments{"--json", "-t", "2", "-b", "4", "--write", "none"}}) {
    const Outcome done = sandbox.run_exact(more);
    REQUIRE(done.code == 0);
    check_json(sandbox, done.out, exact_values, "(True, True)");
  }
  check_json(sandbox, sandbox.run({"two.xyzr", "--json"}).out, "r['exact_area'], r['exact_volume']",
             "(None, None)");
}

// The grid takes the patches of the exact values. If only a part of it is computed, the patches are
// built twice. In c60.xyzr, decisions depend on tolerances, so that other patches are measured.
TEST_CASE("exact: values and grid do not depend on shared patches", "[exact]") {
  const Sandbox sandbox;
  for (const char* const name : {"1ubq", "c60"})
    for (const std::optional<double> max_filled_void :
         {std::optional<double>(), std::optional<double>(50)}) {
      const std::string file = std::string(ESES_DATA) + "/" + name + ".xyzr";
      const Measures measures =
          measure(Surface(read_atoms(file).atoms, {.max_filled_void = max_filled_void}));
      const std::string question = formatted("r['exact_area'] == {}, r['exact_volume'] == {}",
                                             measures.ses_area, measures.ses_volume);
      const auto run_into = [&](const char* directory, const Arguments& more) {
        Arguments arguments{file, "--spacing", "0.8", "--json", "-o", directory};
        if (max_filled_void) arguments.emplace_back("--fill-cavities=50");
        arguments.insert(arguments.end(), more.begin(), more.end());
        return sandbox.run(arguments);
      };
      REQUIRE(run_into("plain", {}).code == 0);
      for (const Arguments& more :
           {Arguments{"--exact", "-t", "1"}, Arguments{"--exact", "-t", "3", "--resume"}}) {
        check_json(sandbox, run_into("exact", more).out, question, "(True, True)");
        CHECK(sandbox.run({"diff", "plain", "exact"}).code == 0);
      }
      check_json(sandbox, run_into("part", {"--exact", "--region", "0,0,0,30,30,30"}).out, question,
                 "(True, True)");
    }
}

TEST_CASE("exact: the report compares the grid with the exact values", "[exact]") {
  const TwoSpheres sandbox;
  const Outcome whole = sandbox.run_exact({});
  CHECK(contains(whole.out,
                 "exact: 66.07798062 square angstrom, 42.34670398 cubic angstrom (the "
                 "grid differs by "));
  const Outcome part = sandbox.run_exact({"--region", "-1,-1,-1,1,1,1"});
  CHECK(contains(part.out,
                 "exact: 66.07798062 square angstrom, 42.34670398 cubic angstrom, of the "
                 "whole surface\n"));
  CHECK_FALSE(contains(sandbox.run({"two.xyzr"}).out, "exact:"));
  // Scripts search for `area:` and `volume:`.
  const Outcome plain = sandbox.run({"two.xyzr", "--spacing", "0.5", "-q"});
  CHECK(sandbox.run_exact({"-q"}).out == plain.out);
}

TEST_CASE("exact: --verify accepts a grid that fits the exact volume", "[exact]") {
  const TwoSpheres sandbox;
  for (const char* const spacing : {"0.1", "0.5", "2"}) {
    const Outcome done = sandbox.run({"two.xyzr", "--exact", "--verify=50", "--spacing", spacing,
                                      "--margin", spacing, "--json"});
    CHECK(done.code == 0);
    check_json(sandbox, done.out, exact_values, "(True, True)");
    check_json(sandbox, done.out, "r['verification']['faults']", "[]");
  }
}

}  // namespace eses::detail::test
