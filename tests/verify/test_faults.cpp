/// Tests of --verify: wrong results are found and named.

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "geometry/make_grid.hpp"
#include "run/verifier.hpp"
#include "solve/block_solver.hpp"
#include "support/all_patches.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "support/eses_files.hpp"
#include "support/near_degenerate.hpp"
#include "support/run.hpp"
#include "verify/definition.hpp"
#include "verify/faults.hpp"

namespace eses::detail {
namespace {

// Only some names are used: eses::detail::test has a crossing of its own.
using test::AccessibleSet;
using test::all_kinds;
using test::designed_probe_radius;
using test::grid_options;
using test::Kind;
using test::kind_name;
using test::make_accessible_set;
using test::make_atom_set;
using test::make_chain;
using test::make_plan;
using test::nearest_accessible;
using test::Random;
using test::run;
using test::with_copies;

const Outputs no_files = Outputs::none();
constexpr std::int64_t everything = 1'000'000;

Parameters coarse(std::uint64_t seed) {
  Parameters parameters;
  parameters.probe_radius = designed_probe_radius(seed);
  grid_options(parameters).spacing = parameters.probe_radius < 2 ? 0.4 : 0.6;
  grid_options(parameters).margin = 1;
  parameters.block_size = 16;
  parameters.threads = 2;
  return parameters;
}

}  // namespace

TEST_CASE("right results have no faults, degenerate ones included", "[verify]") {
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      INFO(kind_name(kind) << ", seed " << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      Parameters parameters = coarse(seed);
      parameters.verify = 300;
      const Summary summary = run(atoms, parameters, no_files, "nowhere");
      REQUIRE(summary.verification);
      INFO((summary.verification->faults.empty() ? "" : summary.verification->faults.front()));
      CHECK(summary.verification->faults.empty());
      CHECK(summary.verification->points > 0);
      CHECK(summary.verification->edges == std::min<std::int64_t>(300, summary.edges()));
    }
}

TEST_CASE("a probe that touches four atoms does not reach past its patch", "[verify]") {
  // The probe also meets edges of the saddle patches around it, within 1e-7 angstrom of them.
  const std::vector<Atom> atoms = test::make_cube(4, 3.8, 1.5);
  Parameters parameters;
  grid_options(parameters).spacing = 0.25;
  parameters.verify = everything;
  const Summary summary = run(atoms, parameters, no_files, "nowhere");
  REQUIRE(summary.verification);
  CHECK(summary.verification->faults.empty());
}

namespace {

using Spoil = std::function<void(BlockResult&)>;

/// Returns the verification of results that are all altered before.
Verification verification_of(const std::vector<Atom>& atoms, const Parameters& parameters,
                             const Spoil& spoil) {
  const test::RunPlan plan = make_plan(atoms, parameters, no_files);
  const test::AllPatches all(atoms, parameters.probe_radius);
  BlockWorkspace workspace;
  Verifier verifier(atoms, parameters.probe_radius, plan.grid, plan.schedule.tiling,
                    plan.schedule.threads, parameters.verify);
  const GridIndex& blocks = plan.schedule.tiling.blocks;
  for (std::int64_t b = 0; b < plan.schedule.tiling.block_count(); ++b) {
    const BlockBounds block = plan.schedule.tiling.block(b % blocks[0], b / blocks[0] % blocks[1],
                                                         b / blocks[0] / blocks[1]);
    BlockResult result = solve_block(all.patches, plan.grid, block, workspace);
    spoil(result);
    verifier.take_block(result, static_cast<std::size_t>(b % plan.schedule.threads));
  }
  return verifier.check({});
}

/// Verifies a chain in one block after one crossing that cuts its edge well was altered. Returns
/// the text of its fault after the name of the edge.
std::string fault_of(std::uint8_t atom_count, const std::function<void(BlockCrossing&)>& spoil) {
  const std::vector<Atom> atoms = make_chain(12, 7);
  Parameters parameters;
  grid_options(parameters).spacing = 0.5;
  parameters.threads = 1;
  parameters.verify = everything;
  const Grid grid = make_plan(atoms, parameters, no_files).grid;
  std::string name;
  const Verification verification = verification_of(atoms, parameters, [&](BlockResult& result) {
    const std::int64_t rows_y = result.block.owned[1];
    for (std::size_t row = 0; row + 1 < result.row_begin.size() && name.empty(); ++row)
      for (auto c = result.row_begin[row]; c < result.row_begin[row + 1] && name.empty(); ++c) {
        BlockCrossing& crossing = result.crossings[c];
        const auto r = static_cast<std::int64_t>(row);
        const GridIndex row_start{0, r % rows_y, r / rows_y};
        const GridIndex lower = to_crossing(grid, row_start, crossing).lower;
        const double low = grid.coordinate(crossing.axis, lower[crossing.axis]);
        const double place = (crossing.coordinate - low) / grid.spacing;
        if (crossing.atom_count != atom_count || place < 0.1 || place > 0.9 ||
            std::fabs(crossing.normal[crossing.axis]) < 0.5)
          continue;
        spoil(crossing);
        const Crossing spoilt = to_crossing(grid, row_start, crossing);
        const GridIndex in = spoilt.inside_point(), out = spoilt.outside_point();
        std::ostringstream text;
        text << "edge " << in[0] << ' ' << in[1] << ' ' << in[2] << " -> " << out[0] << ' '
             << out[1] << ' ' << out[2] << ": ";
        name = text.str();
      }
  });
  REQUIRE_FALSE(name.empty());
  if (verification.faults.empty()) return "";
  CHECK(verification.faults.size() == 1);
  CHECK(verification.faults.front().rfind(name, 0) == 0);
  return verification.faults.front().substr(
      std::min(name.size(), verification.faults.front().size()));
}

}  // namespace

TEST_CASE("wrong crossings are found and named", "[verify]") {
  for (const std::uint8_t atoms : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{3}}) {
    INFO("crossing of " << int{atoms} << " atoms");
    CHECK(fault_of(atoms, [](BlockCrossing&) {}).empty());
    const double inward = 1e-5;
    CHECK(fault_of(atoms, [&](BlockCrossing& c) {
            c.coordinate += c.lower_is_inside ? inward : -inward;
          }) == "a probe covers the crossing");
    CHECK(fault_of(atoms, [&](BlockCrossing& c) {
            c.coordinate -= c.lower_is_inside ? inward : -inward;
          }) != "");
    CHECK(fault_of(atoms, [](BlockCrossing& c) { c.coordinate += 0.5; }) ==
          "the crossing is not on the edge");
    CHECK(fault_of(atoms, [](BlockCrossing& c) { c.coordinate = std::nan(""); }) ==
          "the crossing is not on the edge");
    CHECK(fault_of(atoms, [](BlockCrossing& c) { c.normal = (1 + 1e-8) * c.normal; }) ==
          "the normal has not length 1");
    CHECK(fault_of(atoms, [](BlockCrossing& c) { c.normal = -c.normal; }) ==
          "the normal does not lead to an accessible probe");
    CHECK(fault_of(atoms, [](BlockCrossing& c) {
            c.normal = normalized(c.normal + 1e-4 * any_perpendicular(c.normal));
          }) != "");
    CHECK(fault_of(atoms, [](BlockCrossing& c) { c.atoms[0] = c.atoms[0] == 0 ? 11 : 0; }) != "");
    CHECK(fault_of(atoms, [](BlockCrossing& c) { c.atoms[c.atom_count - 1] = 12; }) ==
          "there is no such atom");
    CHECK(fault_of(atoms, [](BlockCrossing& c) { c.atom_count = 0; }) ==
          "the crossing does not have 1 to 3 atoms");
    CHECK(fault_of(atoms, [](BlockCrossing& c) { c.lower_is_inside = !c.lower_is_inside; }) != "");
    if (atoms == 1) continue;
    CHECK(fault_of(atoms, [](BlockCrossing& c) { std::swap(c.atoms[0], c.atoms[1]); }) ==
          "the atoms are not in ascending order");
    CHECK(fault_of(atoms, [](BlockCrossing& c) { --c.atom_count; }) ==
          "the normal and the crossing's atoms do not agree");
  }
}

TEST_CASE("a crossing that is not the last of its edge is a fault", "[verify]") {
  // Along x, the line is inside the large atom up to 1, outside up to 1.25, and inside the small
  // one up to 1.45. Grid points are at 0.98 and 1.48 on a line 0.02 off the axis.
  Parameters parameters;
  parameters.probe_radius = 0.1;
  grid_options(parameters).spacing = 0.5;
  grid_options(parameters).margin = 1.02;
  parameters.verify = everything;
  const std::vector<Atom> atoms{{{0, 0, 0}, 1}, {{1.35, 0, 0}, 0.1}};
  const auto verified = [&](bool spoil) {
    return verification_of(atoms, parameters, [&](BlockResult& result) {
      for (BlockCrossing& crossing : result.crossings)
        if (spoil && crossing.axis == 0 && crossing.atoms[0] == 1) {
          crossing.coordinate = std::sqrt(1 - 2 * 0.02 * 0.02);
          crossing.normal = {crossing.coordinate, -0.02, -0.02};
          crossing.atoms[0] = 0;
        }
    });
  };
  CHECK(verified(false).faults.empty());
  const Verification verification = verified(true);
  REQUIRE(verification.faults.size() == 1);
  CHECK(verification.faults.front() ==
        "edge 6 4 4 -> 7 4 4: the crossing is not the last before the outside end");
}

namespace {

std::vector<Atom> with_radii_changed(std::vector<Atom> atoms, double by) {
  for (Atom& atom : atoms) atom.radius = std::max(0.0, atom.radius + by);
  return atoms;
}

/// Returns all crossings of a result.
std::vector<Crossing> crossings_of(const std::vector<Atom>& atoms, const Parameters& parameters) {
  const Grid grid =
      make_grid(atoms, grid_options(parameters).spacing, grid_options(parameters).margin);
  std::vector<Crossing> crossings;
  verification_of(atoms, parameters, [&](BlockResult& result) {
    const std::int64_t rows_y = result.block.owned[1];
    for (std::size_t row = 0; row + 1 < result.row_begin.size(); ++row)
      for (auto c = result.row_begin[row]; c < result.row_begin[row + 1]; ++c) {
        const auto r = static_cast<std::int64_t>(row);
        const GridIndex row_start{result.block.first[0], result.block.first[1] + r % rows_y,
                                  result.block.first[2] + r / rows_y};
        crossings.push_back(to_crossing(grid, row_start, result.crossings[c]));
      }
  });
  return crossings;
}

/// Returns ordinary and degenerate sets in which faults must be found.
struct Case {
  std::string name;
  std::vector<Atom> atoms;
  Parameters parameters;
};

std::vector<Case> cases_for_faults() {
  std::vector<Case> cases;
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      Parameters parameters = coarse(seed);
      parameters.verify = 1;
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const std::string name = std::string(kind_name(kind)) + ", seed " + std::to_string(seed);
      cases.push_back({name, atoms, parameters});
      Random random(seed);
      for (const double apart : {1e-4, 1e-7, 1e-12})
        cases.push_back(
            {name + ", almost coincident", with_copies(atoms, 2, apart, random), parameters});
    }
  return cases;
}

}  // namespace

TEST_CASE("a point on the wrong side is a fault, on either side, degenerate or not", "[verify]") {
  for (const Case& c : cases_for_faults()) {
    INFO(c.name);
    const double probe = c.parameters.probe_radius;
    const verify::Definition definition(c.atoms, probe);
    verify::CentreSearch search(definition);
    const Grid grid =
        make_grid(c.atoms, grid_options(c.parameters).spacing, grid_options(c.parameters).margin);
    // Points are clear if the oracle's decision does not change with a small change of the radii.
    const AccessibleSet larger = make_accessible_set(with_radii_changed(c.atoms, 1e-7), probe);
    const AccessibleSet smaller = make_accessible_set(with_radii_changed(c.atoms, -1e-7), probe);
    int inside = 0, outside = 0;
    for (const GridIndex& point : draw_band_points(definition, grid, grid.whole(), 60)) {
      const Vec3 x = grid.point(point);
      const bool is_inside = !nearest_accessible(smaller, x, probe + 1e-4);
      const bool is_outside = nearest_accessible(larger, x, probe - 1e-4).has_value();
      if (!is_inside && !is_outside) continue;
      ++(is_inside ? inside : outside);
      REQUIRE(fault_of_point(search, grid, point, is_inside).empty());
      REQUIRE_FALSE(fault_of_point(search, grid, point, is_outside).empty());
    }
    CHECK(inside + outside > 20);
  }
}

TEST_CASE("an altered crossing is a fault, degenerate or not", "[verify]") {
  std::size_t altered = 0;
  for (const Case& c : cases_for_faults()) {
    INFO(c.name);
    const verify::Definition definition(c.atoms, c.parameters.probe_radius);
    verify::CentreSearch search(definition);
    const Grid grid =
        make_grid(c.atoms, grid_options(c.parameters).spacing, grid_options(c.parameters).margin);
    const std::vector<Crossing> crossings = crossings_of(c.atoms, c.parameters);
    const std::size_t stride = crossings.size() / 40 + 1;
    for (std::size_t e = 0; e < crossings.size(); e += stride) {
      const Crossing& crossing = crossings[e];
      const std::uint8_t axis = crossing.axis;
      const double low = grid.coordinate(axis, crossing.lower[axis]);
      const double place = (crossing.position[axis] - low) / grid.spacing;
      if (place < 0.1 || place > 0.9 || std::fabs(crossing.normal[axis]) < 0.5) continue;
      // If the result itself is wrong, or the probe fits only in doubt, a fault is not certain.
      const Vec3 center = crossing.position + c.parameters.probe_radius * crossing.normal;
      if (!fault_of_edge(search, grid, crossing).empty() ||
          !search.is_any(center, 1e-6, verify::surely_accessible))
        continue;
      INFO("edge " << crossing.lower[0] << ' ' << crossing.lower[1] << ' ' << crossing.lower[2]
                   << " along " << int{axis} << ", " << int{crossing.atom_count} << " atoms");
      ++altered;
      const auto is_found = [&](const std::function<void(Crossing&)>& alter) {
        Crossing other = crossing;
        alter(other);
        return !fault_of_edge(search, grid, other).empty();
      };
      const Vec3 normal = crossing.normal, across = any_perpendicular(normal);
      CHECK(is_found([](Crossing& x) { x.position[x.axis] += 1e-5; }));
      CHECK(is_found([](Crossing& x) { x.position[x.axis] -= 1e-5; }));
      CHECK(is_found([&](Crossing& x) { x.normal = normalized(normal + 3e-4 * across); }));
      CHECK(is_found(
          [&](Crossing& x) { x.normal = normalized(normal + 3e-4 * cross(normal, across)); }));
      CHECK(is_found([&](Crossing& x) {
        x.atoms = {0, 1, static_cast<AtomIndex>(c.atoms.size())};
        x.atom_count = 3;
      }));
      for (AtomIndex a = 0; a < c.atoms.size(); ++a)
        if (std::fabs(norm(c.atoms[a].center - center) - c.atoms[a].radius -
                      c.parameters.probe_radius) > 1e-4) {
          CHECK(is_found([&](Crossing& x) {
            x.atoms[0] = a;
            x.atom_count = 1;
          }));
          break;
        }
      CHECK(is_found([](Crossing& x) { x.lower_is_inside = !x.lower_is_inside; }));
    }
  }
  CHECK(altered > 1000);
}

TEST_CASE("a crossing that is not the last is a fault where atoms almost coincide", "[verify]") {
  // The arrangement is the one above: a large and a small atom, and an edge that the surface cuts
  // three times.
  Parameters parameters;
  parameters.probe_radius = 0.1;
  Random random(1);
  const std::vector<Atom> atoms =
      with_copies({{{0, 0, 0}, 1}, {{1.35, 0, 0}, 0.1}}, 20, 1e-10, random);
  const verify::Definition definition(atoms, parameters.probe_radius);
  verify::CentreSearch search(definition);
  const Grid grid = make_grid(std::vector<Atom>{{{0, 0, 0}, 1}, {{1.35, 0, 0}, 0.1}}, 0.5, 1.02);
  Crossing crossing;
  crossing.lower = {6, 4, 4};
  crossing.position = grid.point(crossing.lower);
  crossing.lower_is_inside = true;
  crossing.atom_count = 1;
  crossing.atoms = {21, 0, 0};
  crossing.position.x = 1.35 + std::sqrt(0.1 * 0.1 - 2 * 0.02 * 0.02);
  crossing.normal = 10.0 * (crossing.position - Vec3{1.35, 0, 0});
  CHECK(fault_of_edge(search, grid, crossing).empty());
  crossing.atoms = {0, 0, 0};
  crossing.position.x = std::sqrt(1 - 2 * 0.02 * 0.02);
  crossing.normal = crossing.position;
  CHECK(fault_of_edge(search, grid, crossing) ==
        "edge 6 4 4 -> 7 4 4: the crossing is not the last before the outside end");
}

TEST_CASE("atoms that almost coincide have no faults if the oracle finds none", "[verify]") {
  int right = 0, sets = 0;
  const auto check = [&](const std::vector<Atom>& atoms, Parameters parameters) {
    ++sets;
    const test::RunResult result = test::run_and_read(atoms, parameters);
    if (!test::find_faults(atoms, parameters, result.files, result.summary).empty()) return;
    ++right;
    parameters.verify = everything;
    const Summary summary = run(atoms, parameters, no_files, "nowhere");
    REQUIRE(summary.verification);
    INFO((summary.verification->faults.empty() ? "" : summary.verification->faults.front()));
    CHECK(summary.verification->faults.empty());
  };
  Parameters fine;
  grid_options(fine).spacing = 0.2;
  check({{{0, 0, 0}, 1.6999}, {{0, 0.0001, -0.0001}, 1.6999}}, fine);
  REQUIRE(right == 1);
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    INFO("seed " << seed);
    Random random(seed);
    const double apart = std::pow(10, -random.uniform(3.5, seed % 2 == 0 ? 4.5 : 14));
    const std::vector<Atom> sites = make_chain(random.integer(1, 5), seed);
    Parameters parameters;
    grid_options(parameters).spacing = 0.45;
    check(with_copies(sites, random.integer(1, 3), apart, random), parameters);
  }
  CHECK(2 * right > sets);
}

TEST_CASE("points on the wrong side are found and named, at any block size", "[verify]") {
  const std::vector<Atom> atoms = make_chain(20, 7);
  Parameters parameters;
  parameters.verify = 100;
  std::vector<std::string> expected;
  for (const std::int64_t size : {std::int64_t{200}, std::int64_t{64}, std::int64_t{9}})
    for (const int threads : {1, 3}) {
      parameters.block_size = size;
      parameters.threads = threads;
      const Verification verification = verification_of(atoms, parameters, [](BlockResult& result) {
        for (std::uint64_t& word : result.inside.words) word = ~word;
        for (BlockCrossing& crossing : result.crossings) crossing.normal = -crossing.normal;
      });
      CHECK(verification.points == 100);
      CHECK(verification.edges == 100);
      if (expected.empty()) expected = verification.faults;
      CHECK(verification.faults == expected);
    }
  // Blocks without atoms have no words to flip, but also no points of the band.
  CHECK(expected.size() == 200);
  const auto begins = [&](const std::string& name) {
    return std::count_if(expected.begin(), expected.end(),
                         [&](const std::string& fault) { return fault.rfind(name, 0) == 0; });
  };
  CHECK(begins("point ") == 100);
  CHECK(begins("edge ") == 100);
}

TEST_CASE("a missing block is found", "[verify]") {
  const std::vector<Atom> atoms = make_chain(20, 7);
  Parameters parameters;
  parameters.verify = 100;
  const test::RunPlan plan = make_plan(atoms, parameters, no_files);
  Verifier verifier(atoms, parameters.probe_radius, plan.grid, plan.schedule.tiling,
                    plan.schedule.threads, parameters.verify);
  const Verification verification = verifier.check({});
  REQUIRE(verification.faults.size() == 100);
  CHECK(verification.faults.front().ends_with("is in no block"));
}

TEST_CASE("the progress callback can end a verification", "[verify]") {
  const std::vector<Atom> atoms = make_chain(20, 7);
  Parameters parameters;
  parameters.verify = 100;
  const test::RunPlan plan = make_plan(atoms, parameters, no_files);
  std::int64_t calls = 0;
  const auto end_after_blocks = [&](std::int64_t, std::int64_t total) {
    if (++calls > total) throw std::runtime_error("enough");
  };
  CHECK_THROWS_AS(run(atoms, plan.parameters, no_files, "nowhere", {.progress = end_after_blocks}),
                  std::runtime_error);
  const auto end_halfway = [&](std::int64_t done, std::int64_t all) {
    if (2 * done > all) throw std::runtime_error("enough");
  };
  CHECK_THROWS_AS(run(atoms, plan.parameters, no_files, "nowhere", {.verification = end_halfway}),
                  std::runtime_error);
}

TEST_CASE("a verification reports its progress", "[verify]") {
  const std::vector<Atom> atoms = make_chain(20, 7);
  // If there are few edges, all are checked. If there are many, some are looked at first.
  for (const std::int64_t wanted : {50, 100000}) {
    Parameters parameters;
    parameters.verify = wanted;
    parameters.threads = 2;
    std::vector<std::int64_t> seen;
    std::int64_t total = 0;
    const Summary summary = run(atoms, parameters, no_files, "nowhere",
                                {.verification = [&](std::int64_t done, std::int64_t all) {
                                  seen.push_back(done);
                                  total = all;
                                }});
    REQUIRE(summary.verification);
    const auto& [points, edges, faults] = *summary.verification;
    CHECK(total == points + edges + (wanted == 50 ? 4 * wanted - wanted / 2 : 0));
    REQUIRE(!seen.empty());
    CHECK(seen.front() == 0);
    CHECK(std::is_sorted(seen.begin(), seen.end()));
    CHECK(seen.back() < total);
    CHECK(2 * seen.back() > total);
  }
}

}  // namespace eses::detail
