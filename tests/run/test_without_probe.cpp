// Tests of surfaces without a probe: the van der Waals surface and, with larger radii, the solvent
// accessible surface. The references are brute force and closed forms.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/eses.hpp"
#include "support/atom_sets.hpp"
#include "support/sandbox.hpp"

namespace eses::detail::test {
namespace {

/// Returns how deep a point is inside the atoms; negative outside.
double depth(const std::vector<Atom>& atoms, Vec3 point) {
  double deepest = -1e9;
  for (const Atom& atom : atoms)
    deepest = std::max(deepest, atom.radius - norm(point - atom.center));
  return deepest;
}

/// Area and volume of two spheres that overlap, or not.
struct Union {
  double area, volume;
};

Union two_spheres(double a, double b, double distance) {
  constexpr double pi = std::numbers::pi;
  Union sum{4 * pi * (a * a + b * b), 4 * pi / 3 * (a * a * a + b * b * b)};
  if (distance >= a + b) return sum;
  const double x = (distance * distance + a * a - b * b) / (2 * distance);
  for (const auto& [radius, height] : {std::pair(a, a - x), std::pair(b, b - (distance - x))}) {
    sum.area -= 2 * pi * radius * height;
    sum.volume -= pi * height * height * (3 * radius - height) / 3;
  }
  return sum;
}

const Vec3 askew{0.36, 0.48, 0.8};

std::string pair_text(double a, double b, double distance) {
  const Vec3 second = distance * askew;
  return "0 0 0 " + std::to_string(a) + "\n" + std::to_string(second.x) + " " +
         std::to_string(second.y) + " " + std::to_string(second.z) + " " + std::to_string(b) + "\n";
}

}  // namespace

TEST_CASE("without a probe, points and crossings are those of the spheres", "[grid]") {
  constexpr double rounding = 1e-7;
  for (const Kind kind : all_kinds)
    for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{3}}) {
      INFO(kind_name(kind) << ' ' << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const eses::Surface surface(atoms, {.probe_radius = 0});
      const Grid grid = make_grid(surface, {.spacing = 0.45, .margin = 0.8});
      const Result result = eses::compute(surface, grid, {.threads = 1, .block_size = 16});
      std::int64_t inside = 0;
      for (std::int64_t x = 0; x < grid.size[0]; ++x)
        for (std::int64_t y = 0; y < grid.size[1]; ++y)
          for (std::int64_t z = 0; z < grid.size[2]; ++z) {
            const double depth_there = depth(atoms, grid.point({x, y, z}));
            const bool is_inside = result.is_inside({x, y, z});
            inside += is_inside ? 1 : 0;
            if (std::fabs(depth_there) > rounding) REQUIRE(is_inside == (depth_there > 0));
          }
      CHECK(inside == result.summary().inside_points);
      CHECK(result.summary().saddle + result.summary().concave == 0);
      for (const Crossing& crossing : result.crossings()) {
        REQUIRE(crossing.atom_count == 1);
        REQUIRE(std::fabs(depth(atoms, crossing.position)) < rounding);
        const Atom& atom = atoms[crossing.atoms[0]];
        if (atom.radius > 0)
          REQUIRE(norm(crossing.position - atom.center - atom.radius * crossing.normal) < rounding);
        // It is the crossing that is nearest to the outside end.
        const Vec3 outside = grid.point(crossing.outside_point());
        for (int step = 1; step < 20; ++step)
          REQUIRE(depth(atoms, outside + step / 20.0 * (crossing.position - outside)) < rounding);
      }
    }
}

TEST_CASE("without a probe, options that need one are refused", "[api]") {
  const std::vector<Atom> atom{{{0, 0, 0}, 1.5}};
  CHECK_THROWS_AS(eses::Surface(atom, {.probe_radius = 0.001}), std::invalid_argument);
  CHECK_THROWS_AS(eses::Surface(atom, {.probe_radius = 0, .max_filled_void = 10}),
                  std::invalid_argument);
}

TEST_CASE("surfaces: --surface sas and vdw have area and volume of the closed form", "[cli]") {
  const Sandbox sandbox;
  const auto check = [&](const std::string& surface, double a, double b, double distance,
                         double growth) {
    INFO(surface << ' ' << a << ' ' << b << ' ' << distance);
    write_file(sandbox.directory() / "two.xyzr", pair_text(a, b, distance));
    const Outcome outcome = sandbox.run(
        {"two.xyzr", "--surface", surface, "--spacing", "0.1", "--write", "none", "--exact"});
    REQUIRE(outcome.code == 0);
    const Union exact = two_spheres(a + growth, b + growth, distance);
    CHECK(std::fabs(value_of(outcome.out, "surface area:") / exact.area - 1) < 0.005);
    CHECK(std::fabs(value_of(outcome.out, "divergence theorem:") / exact.volume - 1) < 0.005);
    CHECK(std::fabs(value_of(outcome.out, "exact:") / exact.area - 1) < 1e-8);
  };
  check("vdw", 1.7, 1.2, 2, 0);
  check("vdw", 1.7, 1.2, 4, 0);
  check("sas", 1.7, 1.2, 2, 1.4);
  check("sas", 1.7, 1.2, 4, 1.4);
  check("sas", 1.7, 1.2, 7, 1.4);
}

TEST_CASE(
    "surfaces: --surface names the surface in report and JSON, with the radii of the file in "
    "warnings",
    "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "a.xyzr", "0 0 0 3\n0.1 0 0 2.9\n");
  const Outcome sas = sandbox.run({"a.xyzr", "1.2", "--surface", "sas", "--write", "none"});
  CHECK(contains(sas.out, "solvent accessible surface, probe radius 1.2, spacing 0.4"));
  CHECK(contains(sas.err, "within 0.5 angstrom"));
  CHECK_FALSE(contains(sas.err, "more than 4"));
  const Outcome json = sandbox.run({"a.xyzr", "1.2", "--surface", "sas", "--json", "-o", "-"});
  check_json(sandbox, json.out, "r['parameters']['surface']", "'sas'");
  check_json(sandbox, json.out, "r['parameters']['probe_radius']", "1.2");
  const Outcome vdw = sandbox.run({"a.xyzr", "--surface", "vdw", "--json", "-o", "-"});
  check_json(sandbox, vdw.out, "r['parameters']['surface']", "'vdw'");
  check_json(sandbox, vdw.out, "r['parameters']['probe_radius']", "0");
}

TEST_CASE("surfaces: --surface refuses what needs the solvent excluded surface", "[cli]") {
  const Sandbox sandbox;
  check_usage_error(sandbox, {"atom.xyzr", "1.4", "--surface", "vdw"},
                    "--surface vdw cannot be combined with PROBE; it has no probe");
  check_usage_error(sandbox, {"atom.xyzr", "--probe-radius", "1.4", "--surface", "vdw"},
                    "--surface vdw cannot be combined with --probe-radius; it has no probe");
  for (const Arguments& other : {Arguments{"--fill-cavities"},
                                 {"--verify"},
                                 {"--kappa", "k.dx"},
                                 {"--mesh", "m.ply", "--component", "0"},
                                 {"--mesh", "m.ply", "--color", "component"}}) {
    Arguments arguments{"atom.xyzr", "--surface", "sas"};
    arguments.insert(arguments.end(), other.begin(), other.end());
    const std::string name = other.size() < 4 ? other[0] : other[2];
    check_usage_error(sandbox, arguments,
                      "--surface sas cannot be combined with " +
                          (name == "--color" ? "--color component" : name) +
                          "; it needs the solvent excluded surface");
  }
}

TEST_CASE("surfaces: files name the surface of --surface", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "a.xyzr", "0 0 0 1.5\n2 0 0 1.5\n");
  for (const auto& [option, name] :
       {std::pair<std::string, std::string>{"ses", "solvent excluded surface"},
        {"sas", "solvent accessible surface"},
        {"vdw", "van der Waals surface"}})
    for (const std::string suffix : {"ply", "obj", "stl", "vtp", "vert"}) {
      INFO(option << ' ' << suffix);
      const Outcome outcome = sandbox.run({"a.xyzr", "--surface", option, "--mesh", "m." + suffix,
                                           "--inside", "i.dx", "--write", "none"});
      REQUIRE(outcome.code == 0);
      const std::filesystem::path folder = sandbox.directory();
      CHECK(contains(read_file(folder / ("m." + suffix)), name));
      CHECK(contains(read_file(folder / "i.dx"), "# Inside of the " + name + ": 1 inside"));
      if (option != "ses")
        CHECK_FALSE(contains(read_file(folder / ("m." + suffix)), "excluded surface"));
    }
}

TEST_CASE("surfaces: a probe radius that may be the spacing has a warning for --surface sas",
          "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "a.xyzr", "0 0 0 1.5\n");
  for (const std::string surface : {"ses", "sas"})
    CHECK(contains(sandbox.run({"a.xyzr", "0.4", "1.4", "--surface", surface, "--dry-run"}).err,
                   "are they swapped?"));
}

}  // namespace eses::detail::test
