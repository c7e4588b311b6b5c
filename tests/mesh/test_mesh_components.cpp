/// Tests of meshes with components, and of meshes of one component.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "catch.hpp"
#include "eses/compute.hpp"
#include "eses/error.hpp"
#include "eses/measure.hpp"
#include "output/mesh_format.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/measured_sets.hpp"
#include "support/mesh_files.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

namespace fs = std::filesystem;

constexpr double all = std::numeric_limits<double>::infinity();

struct ComponentRun {
  Mesh mesh;
  Summary summary;
  std::string bytes;
};

ComponentRun run_mesh(const std::vector<Atom>& atoms, const Parameters& parameters,
                      MeshOptions choice) {
  const TemporaryDirectory directory;
  choice.file = directory.path() / choice.file;
  Outputs outputs = Outputs::none();
  outputs.mesh = choice;
  ComponentRun result;
  result.summary = run(atoms, parameters, outputs, directory.path());
  result.mesh = read_mesh(choice.file);
  result.bytes = read_bytes(choice.file);
  return result;
}

MeshOptions colored(const char* file = "a.ply") {
  return {.file = file, .color = MeshColor::component};
}

MeshOptions alone(std::uint32_t component, bool quality = false) {
  return {
      .file = "a.ply", .color = MeshColor::component, .quality = quality, .component = component};
}

Parameters parameters_for(double probe, double spacing) {
  Parameters parameters;
  parameters.probe_radius = probe;
  grid_options(parameters).spacing = spacing;
  grid_options(parameters).margin = 0.8;
  parameters.threads = 1;
  return parameters;
}

/// A grid around a cavity.
Grid grid_around(const Cavity& cavity, double spacing) {
  Grid grid{cavity.low - Vec3{1, 1, 1}, spacing, {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.size[axis] =
        static_cast<std::int64_t>((cavity.high[axis] + 1 - grid.origin[axis]) / spacing) + 1;
  return grid;
}

std::vector<Cavity> cavities_of(const std::vector<Atom>& atoms, double probe) {
  return measure(Surface(atoms), {.probe_radius = probe, .cavities = true}).cavities;
}

/// Checks that the mesh of a cavity is closed, and has the exact measures of its void.
void check_void(const ComponentRun& found, const Cavity& cavity, double error) {
  CHECK(find_mesh_faults(found.mesh.positions.size(), found.mesh.triangles).empty());
  const MeshMeasures measures = measure(found.mesh);
  CHECK(measures.volume == Approx(-cavity.void_volume).epsilon(error));
  CHECK(measures.area == Approx(cavity.ses_area).epsilon(error));
  CHECK(measures.euler_number == cavity.euler_number);
  CHECK(measures.components == cavity.wall_count);
  CHECK(found.summary.divergence_volume == Approx(cavity.void_volume).epsilon(error));
  CHECK(found.summary.area == Approx(cavity.ses_area).epsilon(error));
}

std::array<double, 3> place(const Vec3& p) { return {p.x, p.y, p.z}; }

/// Checks the components of a mesh with the meshes of the components alone, which other
/// computations find.
void check_with_meshes_alone(const std::vector<Atom>& atoms, const Parameters& parameters,
                             const std::vector<Cavity>& cavities) {
  const Mesh whole = run_mesh(atoms, parameters, colored()).mesh;
  REQUIRE(whole.components.size() == whole.positions.size());
  for (std::uint32_t k = 0; k <= cavities.size(); ++k) {
    INFO("component " << k);
    std::set<std::array<double, 3>> places;
    const Mesh mesh = run_mesh(atoms, parameters, alone(k)).mesh;
    for (const Vec3& position : mesh.positions) places.insert(place(position));
    std::size_t wrong = 0, shared = 0, labelled = 0;
    for (std::size_t v = 0; v < whole.positions.size(); ++v) {
      labelled += whole.components[v] == k ? 1 : 0;
      if (!places.contains(place(whole.positions[v]))) continue;
      ++shared;
      wrong += whole.components[v] != k ? 1 : 0;
    }
    CHECK(wrong == 0);
    // An edge between two voids that overlap is cut by one of them only.
    const bool overlaps =
        k == 0 ? std::any_of(cavities.begin(), cavities.end(),
                             [](const Cavity& cavity) { return cavity.overlaps_outside; })
               : cavities[k - 1].overlaps_outside || !cavities[k - 1].overlaps.empty();
    if (overlaps)
      CHECK(static_cast<double>(shared) >= 0.9 * static_cast<double>(labelled));
    else
      CHECK((shared == labelled && shared == mesh.positions.size()));
  }
}

}  // namespace

TEST_CASE("mesh components: the mesh of a cavity is the surface of its void", "[mesh]") {
  const std::vector<Atom> shell = make_icosahedron(4.4, 2.2);
  const std::vector<Cavity> one = cavities_of(shell, 0.9);
  REQUIRE(one.size() == 1);
  check_void(run_mesh(shell, parameters_for(0.9, 0.1), alone(1)), one[0], 5e-3);
  // Voids that overlap each other and the outside.
  const std::vector<Atom> protein = read_atom_list(std::string(ESES_DATA) + "/1ubq.xyzr");
  const std::vector<Cavity> several = cavities_of(protein, 1.4);
  REQUIRE(several.size() == 3);
  REQUIRE(several[0].overlaps_outside);
  for (std::uint32_t k = 1; k <= 3; ++k) {
    INFO(k);
    const Cavity& cavity = several[k - 1];
    Parameters parameters = parameters_for(1.4, 0.15);
    parameters.grid = grid_around(cavity, 0.15);
    check_void(run_mesh(protein, parameters, alone(k)), cavity, 1e-2);
    const ComponentRun quality = run_mesh(protein, parameters, alone(k, true));
    check_void(quality, cavity, 2e-2);
    CHECK(5 * quality.summary.mesh->vertices <
          4 * static_cast<std::uint64_t>(quality.summary.edges()));
  }
}

TEST_CASE("mesh components: an atom that floats in a cavity is on its inner wall", "[mesh]") {
  std::vector<Atom> atoms = make_icosahedron(9, 5);
  atoms.push_back({{0.1, 0.2, -0.1}, 0.7});
  const std::vector<Cavity> cavities = cavities_of(atoms, 0.6);
  REQUIRE(!cavities.empty());
  REQUIRE(cavities[0].wall_count == 2);
  check_void(run_mesh(atoms, parameters_for(0.6, 0.15), alone(1)), cavities[0], 5e-3);
}

TEST_CASE("mesh components: cavities of random atoms", "[mesh]") {
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    INFO("seed " << seed);
    const std::vector<Atom> atoms = make_sponge(seed);
    const double probe = 0.45;
    const std::vector<Cavity> cavities = cavities_of(atoms, probe);
    for (std::uint32_t k = 1; k <= cavities.size(); ++k) {
      INFO("cavity " << k);
      Parameters parameters = parameters_for(probe, 0.06);
      parameters.grid = grid_around(cavities[k - 1], 0.06);
      parameters.verify = 100;
      const ComponentRun run = run_mesh(atoms, parameters, alone(k));
      CHECK(run.summary.verification->faults.empty());
      check_void(run, cavities[k - 1], 2e-2);
    }
    check_with_meshes_alone(atoms, parameters_for(probe, 0.25), cavities);
    found += cavities.size();
  }
  CHECK(found > 8);
}

TEST_CASE("mesh components: the outer surface is the surface with all cavities filled", "[mesh]") {
  const std::vector<Atom> atoms = make_sponge(3);
  Parameters parameters = parameters_for(0.4, 0.3);
  const ComponentRun outside = run_mesh(atoms, parameters, {.file = "a.ply", .component = 0});
  parameters.max_filled_void = all;
  const ComponentRun filled = run_mesh(atoms, parameters, {.file = "a.ply"});
  REQUIRE(!filled.summary.filled_cavities.empty());
  CHECK(outside.bytes == filled.bytes);
  CHECK(outside.summary.volume == filled.summary.volume);
}

TEST_CASE("mesh components: with filled cavities, the others are numbered anew", "[mesh]") {
  const double probe = 0.9;
  std::vector<Atom> atoms;
  for (const auto& [radius, x] : {std::pair{2.2, 0.1}, {2.3, 14.2}, {2.25, 28.3}})
    for (Atom atom : make_icosahedron(2 * radius, radius)) {
      atom.center.x += x;
      atoms.push_back(atom);
    }
  const std::vector<Cavity> cavities = cavities_of(atoms, probe);
  REQUIRE(cavities.size() == 3);
  REQUIRE(cavities[0].centroid.x == Approx(14.2).margin(1e-6));
  Parameters parameters = parameters_for(probe, 0.4);
  for (const bool fills : {false, true}) {
    if (fills)
      parameters.max_filled_void = 0.5 * (cavities[1].void_volume + cavities[2].void_volume);
    const Mesh mesh = run_mesh(atoms, parameters, colored()).mesh;
    std::set<std::uint32_t> found;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const std::uint32_t k = mesh.components[v];
      found.insert(k);
      const double inside = 3;  // angstrom; the void ends nearer to its centre
      for (std::uint32_t c = 1; c <= 3; ++c)
        CHECK((norm(mesh.positions[v] - cavities[c - 1].centroid) < inside) == (k == c));
      const mesh::Color color = mesh::component_color(k);
      CHECK(mesh.colors[v] == std::array<int, 3>{color[0], color[1], color[2]});
    }
    CHECK(found.size() == (fills ? 3 : 4));
  }
}

TEST_CASE("mesh components: the colours of components are distinct", "[mesh]") {
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = 0; b < a; ++b) {
      int difference = 0;
      for (std::size_t part = 0; part < 3; ++part)
        difference += std::abs(mesh::component_color(a)[part] - mesh::component_color(b)[part]);
      CHECK(difference > 40);
    }
}

TEST_CASE("mesh components: formats and meshes in memory have the same components", "[mesh]") {
  const std::vector<Atom> atoms = make_sponge(2);
  Parameters parameters = parameters_for(0.35, 0.25);
  const Mesh expected = run_mesh(atoms, parameters, colored()).mesh;
  REQUIRE(std::set(expected.components.begin(), expected.components.end()).size() > 2);
  CHECK(run_mesh(atoms, parameters, colored("a.vtp")).mesh.components == expected.components);
  MeshOptions ascii = colored();
  ascii.is_ascii = true;
  CHECK(run_mesh(atoms, parameters, ascii).mesh.components == expected.components);
  const Mesh obj = run_mesh(atoms, parameters, colored("a.obj")).mesh;
  CHECK(obj.components.empty());
  CHECK(obj.colors == expected.colors);
  CHECK(run_mesh(atoms, parameters, {.file = "a.ply", .color = MeshColor::patch})
            .mesh.components.empty());
  const Surface surface(atoms, {.probe_radius = 0.35});
  const Grid grid = make_plan(atoms, parameters, Outputs::none()).grid;
  const Result result = eses::compute(surface, grid);
  CHECK(make_mesh(result, surface).components == expected.components);
  CHECK(make_mesh(result).components.empty());
  MeshOptions quality = colored();
  quality.quality = true;
  const Mesh improved = run_mesh(atoms, parameters, quality).mesh;
  CHECK(improved.components.size() < expected.components.size());
  CHECK(make_quality_mesh(result, surface).components == improved.components);
}

TEST_CASE("mesh components: the bytes do not depend on threads and blocks", "[mesh]") {
  const std::vector<Atom> atoms = make_sponge(2);
  for (const MeshOptions& choice : {colored(), colored("a.vtp"), alone(1), alone(2, true)}) {
    Parameters parameters = parameters_for(0.35, 0.3);
    const std::string expected = run_mesh(atoms, parameters, choice).bytes;
    for (const std::int64_t block : {5, 13, 70})
      for (const int threads : {1, 3}) {
        parameters.block_size = block;
        parameters.threads = threads;
        CHECK(run_mesh(atoms, parameters, choice).bytes == expected);
      }
  }
}

TEST_CASE("mesh components: a part of the grid has the components of the whole molecule",
          "[mesh][region]") {
  const std::vector<Atom> atoms = make_sponge(2);
  Parameters parameters = parameters_for(0.35, 0.3);
  for (const MeshOptions& choice : {colored(), alone(1)}) {
    parameters.part = std::monostate();
    const Mesh whole = run_mesh(atoms, parameters, choice).mesh;
    std::set<std::pair<std::array<double, 3>, std::uint32_t>> expected, found;
    for (std::size_t v = 0; v < whole.positions.size(); ++v)
      expected.insert({place(whole.positions[v]), whole.components[v]});
    const GridRegion grid = make_plan(atoms, parameters, Outputs::none()).grid.whole();
    const std::int64_t middle = grid.end[2] / 2;
    for (const bool is_upper : {false, true}) {
      GridRegion part = grid;
      (is_upper ? part.begin : part.end)[2] = middle;
      parameters.part = part;
      const Mesh mesh = run_mesh(atoms, parameters, choice).mesh;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        found.insert({place(mesh.positions[v]), mesh.components[v]});
    }
    CHECK(found == expected);
  }
}

TEST_CASE("mesh components: a run of other components is not resumed", "[mesh][processes]") {
  const TemporaryDirectory directory;
  std::string text;
  for (const Atom& atom : make_icosahedron(4.4, 2.2))
    text += std::to_string(atom.center.x) + " " + std::to_string(atom.center.y) + " " +
            std::to_string(atom.center.z) + " 2.2\n";
  write_file(directory.path() / "a.xyzr", text);
  Request task{.atoms = InputFile{directory.path() / "a.xyzr"},
               .parameters = parameters_for(0.9, 0.5),
               .outputs = Outputs::none(),
               .output_directory = directory.path(),
               .resume = true};
  task.outputs.mesh = MeshOptions{.file = directory.path() / "a.ply", .component = 0};
  const auto keep_chunk = [&] {
    const PlannedRun plan = plan_run(task, Processes());
    plan.checkpoint->prepare();
    PlaneChunk chunk;
    chunk.planes = {0, 4};
    plan.checkpoint->finish(chunk);
  };
  keep_chunk();
  CHECK(plan_run(task, Processes()).finished_planes.size() == 1);
  task.outputs.mesh->component = 1;
  CHECK_THROWS_AS(plan_run(task, Processes()), Error);
  task.outputs.mesh->component.reset();
  CHECK_THROWS_AS(plan_run(task, Processes()), Error);
}

TEST_CASE("mesh components: wrong choices of the library are refused", "[mesh]") {
  const std::vector<Atom> atoms = make_icosahedron(4.4, 2.2);
  const Grid grid{{-9, -9, -9}, 1, {19, 19, 19}};
  const TemporaryDirectory directory;
  Outputs outputs = Outputs::none();
  outputs.mesh = MeshOptions{.file = directory.path() / "a.ply", .component = 1};
  CHECK_NOTHROW(
      write_files(Surface(atoms, {.probe_radius = 0.9}), grid, directory.path(), outputs));
  CHECK_THROWS_AS(write_files(Surface(atoms, {.probe_radius = 0.9, .max_filled_void = all}), grid,
                              directory.path(), outputs),
                  std::invalid_argument);
  outputs.mesh->component = 2;
  CHECK_THROWS_AS(
      write_files(Surface(atoms, {.probe_radius = 0.9}), grid, directory.path(), outputs), Error);
  outputs.mesh->component = 1;
  outputs.areas = true;
  CHECK_THROWS_AS(
      write_files(Surface(atoms, {.probe_radius = 0.9}), grid, directory.path(), outputs),
      std::invalid_argument);
}

TEST_CASE("mesh components: the program writes only the mesh", "[mesh][cli]") {
  const Sandbox sandbox;
  const std::string file = std::string(ESES_DATA) + "/1ubq.xyzr";
  const Arguments mesh{file, "--spacing", "0.5", "--mesh", "out/a.ply", "-o", "out"};
  const auto with = [&](const Arguments& more) {
    Arguments arguments = mesh;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const Outcome text = sandbox.run(with({"--component", "3"}));
  CHECK(text.code == 0);
  CHECK(contains(text.out, "\ncomponent: cavity 3; area and volume of its void\n"));
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(sandbox.directory() / "out"))
    if (entry.path().filename().string()[0] != '.') names.push_back(entry.path().filename());
  CHECK(names == std::vector<std::string>{"a.ply"});
  const Outcome json = sandbox.run(with({"--component", "outside", "--json"}));
  REQUIRE(json.code == 0);
  check_json(sandbox, json.out, "r['mesh']['component']", "0");
  for (const Arguments& more : {Arguments{}, Arguments{"--dry-run"}}) {
    Arguments arguments = with({"--component", "4"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome missing = sandbox.run(arguments);
    CHECK(missing.code == 1);
    CHECK(contains(missing.err,
                   file + ": there is no cavity 4; the molecule has 3 cavities for this probe "
                          "(--component)\n"));
  }
  check_usage_error(sandbox, {file, "--component", "1"}, "--component needs --mesh");
  check_usage_error(sandbox, with({"--component", "-1"}),
                    "--component is '-1', expected outside, or a whole number of at least 0");
  for (const auto& [option, more] :
       {std::pair<std::string, Arguments>{"--fill-cavities", {"--fill-cavities"}},
        {"--exact", {"--exact"}},
        {"--inside", {"--inside", "out/a.dx"}},
        {"--dielectric", {"--dielectric", "out/d"}},
        {"--kappa", {"--kappa", "out/k.dx"}},
        {"--write", {"--write", "areas"}}}) {
    Arguments arguments = with({"--component", "1"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_usage_error(sandbox, arguments,
                      "--component cannot be combined with " + option + "; it makes only a mesh");
  }
}

}  // namespace eses::detail::test
