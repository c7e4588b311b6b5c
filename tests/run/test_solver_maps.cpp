// Reads the maps for Poisson-Boltzmann solvers back and compares them with the definition of the
// surface.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/eses.hpp"
#include "run/plan.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "support/eses_files.hpp"
#include "support/near_degenerate.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

namespace fs = std::filesystem;

struct DxMap {
  GridIndex size{};
  Vec3 origin;
  std::vector<double> values;  // z fastest

  double at(const GridIndex& point) const {
    return values[static_cast<std::size_t>((point[0] * size[1] + point[1]) * size[2] + point[2])];
  }
};

DxMap parse_map(const std::string& text) {
  std::istringstream stream(text);
  std::string line, word;
  while (stream.peek() == '#') std::getline(stream, line);
  DxMap map;
  stream >> word >> word >> word >> word >> word;  // object 1 class gridpositions counts
  for (std::int64_t& count : map.size) stream >> count;
  stream >> word >> map.origin.x >> map.origin.y >> map.origin.z;
  while (stream >> word && word != "follows") continue;
  map.values.resize(static_cast<std::size_t>(map.size[0] * map.size[1] * map.size[2]));
  for (double& value : map.values) {
    stream >> value;
    REQUIRE(stream);
  }
  stream >> word;
  CHECK(word == "attribute");
  return map;
}

constexpr double solute = 2, solvent = 80;

Outputs all_maps() {
  Outputs outputs = Outputs::none();
  outputs.dielectric = DielectricMaps{"diel_", solute, solvent};
  outputs.ion_access = IonAccessMap{"kappa.dx", 2};
  return outputs;
}

struct SolverMaps {
  std::array<DxMap, 3> dielectric;
  DxMap ion_access;
};

SolverMaps maps_in(const fs::path& directory) {
  SolverMaps maps;
  for (std::size_t axis = 0; axis < 3; ++axis)
    maps.dielectric[axis] =
        parse_map(read_bytes(directory / fmt::format("diel_{}.dx", "xyz"[axis])));
  maps.ion_access = parse_map(read_bytes(directory / "kappa.dx"));
  return maps;
}

/// Returns the share of an edge that lies inside, from its dielectric.
double share_of(double dielectric) {
  return (1 / dielectric - 1 / solvent) / (1 / solute - 1 / solvent);
}

/// Whether a point is inside a surface that is moved inwards by `depth` angstrom.
bool is_inside(const AccessibleSet& set, Vec3 point, double depth = 0) {
  return !nearest_accessible(set, point, set.probe_radius + depth);
}

/// Returns the length inside between two points. `parts` pieces are tested first, so that thin ones
/// are not missed. Pieces whose ends differ are halved down to 1e-7 angstrom. With `depth`, the
/// surface is moved inwards by this distance.
double inside_length(const AccessibleSet& set, Vec3 low, Vec3 high, int parts, double depth = 0) {
  double inside = 0;
  const Vec3 step = high - low;
  const double length = norm(step);
  const auto at = [&](double t) { return low + t * step; };
  bool was_inside = is_inside(set, low, depth);
  for (int part = 0; part < parts; ++part) {
    double begin = static_cast<double>(part) / parts, end = static_cast<double>(part + 1) / parts;
    const bool ends_inside = is_inside(set, at(end), depth);
    if (ends_inside == was_inside) {
      if (was_inside) inside += (end - begin) * length;
    } else {
      const double first = begin, last = end;
      while ((end - begin) * length > 1e-8) {
        const double middle = 0.5 * (begin + end);
        (is_inside(set, at(middle), depth) == was_inside ? begin : end) = middle;
      }
      inside += (was_inside ? begin - first : last - begin) * length;
    }
    was_inside = ends_inside;
  }
  return inside;
}

/// Compares edges with the definition if they have a mean value or a neighbour with another value.
/// If an edge differs, its inside length must be between those of surfaces that are moved by
/// `depth` angstrom: if an edge is nearly tangential, a small depth makes a large difference.
void check_edges(const std::vector<Atom>& atoms, double probe_radius, const Grid& grid,
                 const SolverMaps& maps, int max_edges, double depth = 0) {
  const AccessibleSet set = make_accessible_set(atoms, probe_radius);
  Random random(7);
  int partial = 0, several = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const DxMap& map = maps.dielectric[axis];
    CHECK(map.size == grid.size);
    Vec3 origin = grid.origin;
    origin[axis] += 0.5 * grid.spacing;
    CHECK(norm(map.origin - origin) < 1e-10);
    std::vector<GridIndex> edges;
    for (std::int64_t x = 0; x < grid.size[0]; ++x)
      for (std::int64_t y = 0; y < grid.size[1]; ++y)
        for (std::int64_t z = 0; z < grid.size[2]; ++z) {
          const GridIndex lower{x, y, z};
          const double value = map.at(lower);
          if (lower[axis] + 1 == grid.size[axis]) {
            CHECK(value == solvent);
            continue;
          }
          CHECK((value >= solute && value <= solvent));
          edges.push_back(lower);
        }
    // Edges with a mean come first, then any others.
    std::stable_partition(edges.begin(), edges.end(), [&](const GridIndex& lower) {
      const double value = map.at(lower);
      return value != solute && value != solvent;
    });
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const double chance = static_cast<double>(max_edges) / static_cast<double>(edges.size());
      const GridIndex lower = edges[e];
      const double value = map.at(lower);
      const bool is_partial = value != solute && value != solvent;
      if (!random.chance(is_partial ? 0.5 : chance)) continue;
      GridIndex upper = lower;
      ++upper[axis];
      const Vec3 low = grid.point(lower), high = grid.point(upper);
      const double inside = inside_length(set, low, high, 64) / grid.spacing;
      INFO("axis " << axis << " edge " << lower[0] << ' ' << lower[1] << ' ' << lower[2]
                   << " value " << value << " share " << share_of(value) << " expected " << inside);
      // The value has seven digits. Pieces shorter than 1/64 of the edge may escape the sampling.
      constexpr double tolerance = 2e-6;
      if (depth > 0 && std::fabs(share_of(value) - inside) >= tolerance) {
        const auto share_at = [&](double by) {
          return inside_length(set, low, high, 4096, by) / grid.spacing;
        };
        CHECK(share_of(value) > share_at(depth) - tolerance);
        CHECK(share_of(value) < share_at(-depth) + tolerance);
      } else {
        CHECK(std::fabs(share_of(value) - inside) < tolerance);
      }
      if (is_partial) ++partial;
      if (is_partial && is_inside(set, low) == is_inside(set, high)) ++several;
    }
  }
  CAPTURE(partial, several);
  CHECK(partial > 0);
}

void check_ion_access(const std::vector<Atom>& atoms, double ion_radius, const Grid& grid,
                      const DxMap& map) {
  CHECK(map.size == grid.size);
  CHECK(norm(map.origin - grid.origin) < 1e-10);
  std::size_t wrong = 0, covered = 0;
  for (std::int64_t x = 0; x < grid.size[0]; ++x)
    for (std::int64_t y = 0; y < grid.size[1]; ++y)
      for (std::int64_t z = 0; z < grid.size[2]; ++z) {
        const Vec3 point = grid.point({x, y, z});
        double depth = -1e9;
        for (const Atom& atom : atoms)
          depth = std::max(depth, atom.radius + ion_radius - norm(point - atom.center));
        if (std::fabs(depth) < 1e-9) continue;  // on a sphere up to rounding
        const double expected = depth > 0 ? 0 : 1;
        wrong += map.at({x, y, z}) != expected ? 1 : 0;
        covered += depth > 0 ? 1 : 0;
      }
  CHECK(wrong == 0);
  CHECK(covered > 0);
}

Parameters parameters_for(double probe_radius, double spacing) {
  Parameters parameters{.probe_radius = probe_radius};
  grid_options(parameters).spacing = spacing;
  parameters.threads = 1;
  return parameters;
}

SolverMaps maps_of(const std::vector<Atom>& atoms, const Parameters& parameters, Grid& grid) {
  const TemporaryDirectory directory;
  const Outputs outputs = all_maps();
  const RunPlan plan = make_plan(atoms, parameters, outputs);
  const Summary summary = run(atoms, plan.parameters, outputs, directory.path());
  CHECK(summary.bytes_written == plan.files.maps);
  grid = plan.grid;
  return maps_in(directory.path());
}

}  // namespace

TEST_CASE("maps for solvers agree with the definition on all kinds of atoms", "[solver-maps]") {
  for (const Kind kind : all_kinds)
    for (const std::uint64_t seed : {1U, 2U}) {
      INFO(kind_name(kind) << ' ' << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      const double probe_radius = designed_probe_radius(seed);
      Grid grid;
      const SolverMaps maps = maps_of(atoms, parameters_for(probe_radius, 0.9), grid);
      check_edges(atoms, probe_radius, grid, maps, 60);
      check_ion_access(atoms, 2, grid, maps.ion_access);
    }
}

// These atoms have copies, lattices, rings, polyhedra and cavities into which a probe almost fits.
TEST_CASE("maps for solvers agree with the definition on near-degenerate atoms",
          "[solver-maps][near-degenerate]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const NearDegenerateSet set = make_near_degenerate_set(seed);
    INFO(set.name << ", noise " << set.noise);
    Grid grid;
    const SolverMaps maps = maps_of(set.atoms, parameters_for(set.probe_radius, 0.7), grid);
    check_edges(set.atoms, set.probe_radius, grid, maps, 40, 1e-6);
    check_ion_access(set.atoms, 2, grid, maps.ion_access);
  }
}

// Where spheres are coarse on the grid, the surface cuts many edges twice.
TEST_CASE("edges that the surface cuts several times have the sum of their inside lengths",
          "[solver-maps]") {
  const double r = 0.3, probe = 1.4, h = 1;
  Parameters parameters = parameters_for(probe, h);
  // The edge from (0, 0, 0) to (1, 0, 0) passes through the centre of the first sphere. The edge
  // along y passes the centre of the second one at 0.2. Both ends of both edges are outside.
  const std::vector<Atom> atoms{{{0.5, 0, 0}, r}, {{8.2, 0.45, 0}, r}};
  parameters.grid = Grid{{-2, -2, -2}, h, {14, 6, 6}};
  Grid grid;
  const SolverMaps maps = maps_of(atoms, parameters, grid);
  const double through = maps.dielectric[0].at({2, 2, 2});
  const double aside = maps.dielectric[1].at({10, 2, 2});
  CHECK(share_of(through) == Catch::Approx(2 * r).epsilon(1e-5));
  CHECK(share_of(aside) == Catch::Approx(2 * std::sqrt(r * r - 0.04)).epsilon(1e-5));
  // All other edges miss the spheres.
  int others = 0;
  for (const DxMap& map : maps.dielectric)
    others += static_cast<int>(std::count_if(map.values.begin(), map.values.end(),
                                             [](double value) { return value != solvent; }));
  CHECK(others == 2);
}

TEST_CASE("a hole that a probe reaches is left out of an edge whose ends are inside",
          "[solver-maps]") {
  // There is a slit between two large atoms that contains no grid point.
  const std::vector<Atom> atoms{{{-3.2, 0, 0}, 3}, {{3.2, 0, 0}, 3}};
  Parameters parameters = parameters_for(0.1, 1);
  parameters.grid = Grid{{-8.5, -4, -4}, 1, {18, 9, 9}};
  Grid grid;
  const SolverMaps maps = maps_of(atoms, parameters, grid);
  const double value = maps.dielectric[0].at({8, 4, 4});  // from -0.5 to 0.5
  CHECK(share_of(value) == Catch::Approx(0.6).epsilon(1e-5));
}

TEST_CASE("the dielectric of an edge is the harmonic mean", "[solver-maps]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.3}};
  Parameters parameters = parameters_for(1.4, 0.5);
  parameters.grid = Grid{{-2, -2, -2}, 0.5, {9, 9, 9}};
  Grid grid;
  const SolverMaps maps = maps_of(atoms, parameters, grid);
  const double t = (1.3 - 1) / 0.5;  // share of the edge from 1 to 1.5
  const double mean = 1 / (t / solute + (1 - t) / solvent);
  CHECK(maps.dielectric[0].at({6, 4, 4}) == Catch::Approx(mean).epsilon(1e-6));
  CHECK(maps.dielectric[1].at({4, 6, 4}) == Catch::Approx(mean).epsilon(1e-6));
  CHECK(maps.dielectric[2].at({4, 4, 6}) == Catch::Approx(mean).epsilon(1e-6));
  CHECK(maps.dielectric[2].at({4, 4, 1}) == Catch::Approx(mean).epsilon(1e-6));
  CHECK(maps.dielectric[0].at({4, 4, 4}) == solute);
  CHECK(maps.dielectric[0].at({7, 4, 4}) == solvent);
}

TEST_CASE("maps for solvers do not depend on threads, block size and a mesh", "[solver-maps]") {
  for (const Kind kind : {Kind::chain, Kind::lattice, Kind::snapped, Kind::tangent}) {
    const std::vector<Atom> atoms = make_atom_set(kind, 3);
    std::array<std::string, 4> expected;
    for (const int threads : {1, 3})
      for (const std::int64_t block_size : {5, 17, 64})
        for (const bool has_mesh : {false, true}) {
          INFO(kind_name(kind) << ", " << threads << " threads, block size " << block_size);
          const TemporaryDirectory directory;
          Parameters parameters = parameters_for(designed_probe_radius(3), 0.7);
          parameters.threads = threads;
          parameters.block_size = block_size;
          Outputs outputs = all_maps();
          if (has_mesh) outputs.mesh = MeshOptions{directory.path() / "a.ply"};
          run(atoms, parameters, outputs, directory.path());
          std::size_t file = 0;
          for (const char* const name : {"diel_x.dx", "diel_y.dx", "diel_z.dx", "kappa.dx"}) {
            const std::string bytes = read_bytes(directory.path() / name);
            if (expected[file].empty()) expected[file] = bytes;
            const bool is_same = bytes == expected[file++];
            CHECK(is_same);
          }
        }
  }
}

TEST_CASE("maps of a region are those of the grid", "[solver-maps]") {
  const std::vector<Atom> atoms = make_chain(30, 9);
  Grid grid;
  Parameters parameters = parameters_for(1.4, 0.6);
  const SolverMaps whole = maps_of(atoms, parameters, grid);
  const GridRegion region{{3, 4, 5}, {grid.size[0] - 4, grid.size[1], grid.size[2] - 3}};
  parameters.block_size = 9;
  parameters.part = Box{
      grid.point(region.begin) - Vec3{0.1, 0.1, 0.1},
      grid.point({region.end[0] - 1, region.end[1] - 1, region.end[2] - 1}) + Vec3{0.1, 0.1, 0.1}};
  const SolverMaps part = maps_of(atoms, parameters, grid);
  CHECK(part.ion_access.size == region.size());
  std::size_t different = 0;
  for (std::int64_t x = region.begin[0]; x < region.end[0]; ++x)
    for (std::int64_t y = region.begin[1]; y < region.end[1]; ++y)
      for (std::int64_t z = region.begin[2]; z < region.end[2]; ++z) {
        const GridIndex local{x - region.begin[0], y - region.begin[1], z - region.begin[2]};
        different += whole.ion_access.at({x, y, z}) != part.ion_access.at(local) ? 1 : 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
          different +=
              whole.dielectric[axis].at({x, y, z}) != part.dielectric[axis].at(local) ? 1 : 0;
      }
  CHECK(different == 0);
}

TEST_CASE("the volume by the divergence theorem converges to that of a sphere", "[volume]") {
  const double radius = 3.1, exact = 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
  for (const double h : {0.5, 0.25, 0.125}) {
    Random random(11);
    for (int place = 0; place < 4; ++place) {
      const Vec3 center{random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
      Parameters parameters = parameters_for(1.4, h);
      const auto points = static_cast<std::int64_t>(10 / h);
      parameters.grid = centered_grid({0.5, 0.5, 0.5}, h, {points, points, points});
      const std::vector<Atom> atoms{{center, radius}};
      const Summary summary = compute(atoms, parameters, {});
      INFO(h << ' ' << summary.divergence_volume << " of " << exact);
      CHECK(std::fabs(summary.divergence_volume - exact) < 0.02 * h * h * exact);
    }
  }
}

TEST_CASE("the volume by the divergence theorem is the sum of signed coordinates of crossings",
          "[volume]") {
  const std::vector<Atom> atoms = make_chain(60, 2);
  const RunResult result = run_and_read(Molecule(atoms, {}), parameters_for(1.4, 0.5));
  double sum = 0;
  for (const Crossing& crossing : result.files.crossings)
    for (std::size_t axis = 0; axis < 3; ++axis)
      sum += static_cast<double>(crossing.outside[axis] - crossing.inside[axis]) *
             crossing.point[axis];
  CHECK(result.summary.divergence_volume == Catch::Approx(0.25 * sum / 3).epsilon(1e-9));
}

TEST_CASE("volumes of parts by the divergence theorem add up", "[volume]") {
  const std::vector<Atom> atoms = make_chain(60, 2);
  const Grid grid = make_grid(eses::Surface(atoms), {.spacing = 0.5});
  const eses::Surface whole_surface(atoms);
  const auto volume = [&](const GridRegion& region) {
    RunOptions options;
    options.region = region;
    return eses::compute(whole_surface, grid, options).summary().divergence_volume;
  };
  const std::int64_t x = grid.size[0] / 2, z = grid.size[2] / 3;
  const GridIndex& n = grid.size;
  const double sum = volume({{0, 0, 0}, {x, n[1], n[2]}}) + volume({{x, 0, 0}, {n[0], n[1], z}}) +
                     volume({{x, 0, z}, n});
  CHECK(sum == Catch::Approx(volume(grid.whole())).epsilon(1e-12));
  // A box of 4 x 4 x 4 points is completely inside the large sphere.
  const eses::Surface ball(std::vector<Atom>{{{0, 0, 0}, 9}});
  const Grid within{{-1, -1, -1}, 0.5, {4, 4, 4}};
  CHECK(eses::compute(ball, within).summary().divergence_volume == Catch::Approx(8));
}

TEST_CASE("usage errors of maps for solvers name the option", "[solver-maps][cli]") {
  const Sandbox sandbox;
  const std::string permittivity = ", expected a number from 1e-09 to 1e+09";
  const std::vector<std::pair<Arguments, std::string>> cases{
      {{"--dielectric", "a", "--solute-dielectric", "0"},
       "--solute-dielectric is '0'" + permittivity},
      {{"--dielectric", "a", "--solvent-dielectric", "-80"},
       "--solvent-dielectric is '-80'" + permittivity},
      {{"--dielectric", "a", "--solvent-dielectric", "nan"},
       "--solvent-dielectric is 'nan'" + permittivity},
      {{"--solute-dielectric", "2"}, "--solute-dielectric needs --dielectric"},
      {{"--solvent-dielectric", "2"}, "--solvent-dielectric needs --dielectric"},
      {{"--ion-radius", "2"}, "--ion-radius needs --kappa"},
      {{"--kappa", "a.dx", "--ion-radius", "-1"},
       "--ion-radius is '-1', expected a number from 0 to 1000, in angstrom"},
      {{"--kappa", "a.vti"},
       "--kappa is 'a.vti', expected a file name with the suffix .dx or .dx.gz"},
      {{"--dielectric", "a/"}, "--dielectric is 'a/', expected the first part of a file name"},
      {{"--dielectric", "b/a"},
       "--dielectric is 'b/a', but the output directory is .; use the file name alone or "
       "--output-dir b"},
      {{"--dielectric", "a", "--inside", "ay.dx"}, "two maps would have the name ay.dx"},
      {{"--kappa", "a.dx", "--inside", "a.dx"}, "two maps would have the name a.dx"},
  };
  for (const auto& [given, message] : cases) {
    Arguments arguments{"atom.xyzr"};
    arguments.insert(arguments.end(), given.begin(), given.end());
    check_usage_error(sandbox, arguments, message);
  }
  CHECK(sandbox.files().empty());
}

TEST_CASE("the program writes maps for solvers, and the plan has their sizes",
          "[solver-maps][cli]") {
  const Sandbox sandbox;
  const Arguments arguments{"pair.xyzr",    "--write",   "none",    "-o",      "out",
                            "--dielectric", "out/diel_", "--kappa", "kappa.dx"};
  Arguments dry = arguments;
  dry.emplace_back("--dry-run");
  const Outcome planned = sandbox.run(dry);
  CHECK(contains(planned.out, "kappa.dx, diel_x.dx, diel_y.dx, diel_z.dx exactly "));
  const Outcome outcome = sandbox.run(arguments);
  REQUIRE(outcome.code == 0);
  const SolverMaps maps = maps_in(sandbox.directory() / "out");
  const auto& values = maps.dielectric[2].values;
  CHECK(*std::min_element(values.begin(), values.end()) == 2);
  CHECK(*std::max_element(values.begin(), values.end()) == 78.54);
  CHECK(contains(outcome.out, "(kappa.dx, diel_x.dx, diel_y.dx, diel_z.dx)"));
  Arguments json = arguments;
  json.insert(json.end(), {"--json", "-q"});
  CHECK(contains(sandbox.run(json).out, "\"divergence_volume\": "));
}

}  // namespace eses::detail::test
