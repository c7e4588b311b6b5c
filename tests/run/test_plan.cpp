// Tests of plans: estimates of the surface, memory limits, and the disk.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "eses/measure.hpp"
#include "geometry/make_grid.hpp"
#include "output/output_files.hpp"
#include "run/plan.hpp"
#include "support/atom_lists.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"
#include "surface/survey.hpp"
#include "system/bytes_text.hpp"

namespace eses::detail::test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double probe = 1.4;

double surveyed_area(const std::vector<Atom>& atoms) {
  return SurfaceSurvey(atoms, probe).totals().area;
}

/// Memory of a machine that has more than enough, whatever this machine has.
constexpr std::uint64_t plenty = std::uint64_t{1} << 42;

/// Returns the schedule for a machine on which `available` bytes are free.
Schedule plan_within(std::uint64_t available, const std::vector<Atom>& atoms,
                     const Parameters& parameters) {
  const Plan plan = plan_grid(sphere_bounds(atoms), parameters);
  return plan_schedule({.available = [available] { return available; }}, atoms,
                       {.atoms = InputFile(), .parameters = parameters}, plan, plan.planes());
}

Schedule plan_with_plenty(const std::vector<Atom>& atoms, const Parameters& parameters) {
  return plan_within(plenty, atoms, parameters);
}

std::string message_of(const std::vector<Atom>& atoms, const Parameters& parameters) {
  try {
    plan_with_plenty(atoms, parameters);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// Returns the limit that a refusal recommends, in MiB.
std::uint64_t min_limit(const std::vector<Atom>& atoms, Parameters parameters) {
  parameters.max_memory = 1;
  const std::string message = message_of(atoms, parameters);
  const std::string advice = "use a limit of at least ";
  const std::size_t at = message.find(advice);
  REQUIRE(at != std::string::npos);
  return std::stoull(message.substr(at + advice.size()));
}

// Atoms in a row, far apart in z, so that there are many layers.
std::vector<Atom> column_of_atoms(int count) {
  std::vector<Atom> atoms;
  atoms.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) atoms.push_back({{0.1 * i, 0, 3.5 * i}, 1.7});
  return atoms;
}

// A sheet of hexagons of side 1.42 in the plane z = 0.
std::vector<Atom> flat_sheet(int side) {
  std::vector<Atom> atoms;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double x = 2.13 * i, y = 2.46 * (j + 0.5 * (i % 2));
      atoms.push_back({{x, y, 0}, 1.7});
      atoms.push_back({{x + 0.71, y + 1.23, 0}, 1.7});
    }
  return atoms;
}

// Spheres that do not meet. The area of one is 30,000 times that of each of the others.
std::vector<Atom> gas_around_a_large_atom(std::size_t place_of_large) {
  std::vector<Atom> atoms;
  atoms.reserve(8001);
  for (int i = 0; i < 8000; ++i) {
    const int layer = i / 400;
    atoms.push_back({{400 + 7.0 * (i % 20), 7.0 * (i / 20 % 20), 7.0 * layer}, 1.7});
  }
  atoms.insert(atoms.begin() + static_cast<std::ptrdiff_t>(place_of_large), {{0, 0, 0}, 300});
  return atoms;
}

// Returns the message with which a plan is refused if this much memory is available.
std::string refusal(std::uint64_t available, const std::vector<Atom>& atoms,
                    const Parameters& parameters) {
  try {
    plan_within(available, atoms, parameters);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("the survey of spheres that do not meet is exact", "[plan]") {
  CHECK(surveyed_area({{{1, 2, 3}, 1.5}}) == Approx(4 * pi * 1.5 * 1.5));
  CHECK(surveyed_area({{{0, 0, 0}, 1.5}, {{50, 0, 0}, 2}}) == Approx(4 * pi * (2.25 + 4)));
  std::vector<Atom> gas;
  gas.reserve(5000);
  for (int i = 0; i < 5000; ++i) {
    const int layer = i / 289;
    gas.push_back({{20.0 * (i % 17), 20.0 * (i / 17 % 17), 20.0 * layer}, 1.6});
  }
  CHECK(surveyed_area(gas) == Approx(5000 * 4 * pi * 1.6 * 1.6));
}

TEST_CASE("the survey of atoms that meet has about the area of the surface", "[plan]") {
  const std::vector<Atom> pair{{{0, 0, 0}, 1.6}, {{0, 0, 3}, 1.6}};
  const double area = measure(Surface(pair), {.probe_radius = probe}).ses_area;
  CHECK(surveyed_area(pair) >= area);
  CHECK(surveyed_area(pair) <= 1.6 * area);
}

TEST_CASE("a survey approximates the area of a protein", "[plan]") {
  const std::vector<Atom> atoms = read_atom_list(ESES_DATA "/1a0q.xyzr");
  Outputs nothing{false, false, false, false};
  const Summary summary = run(atoms, {}, nothing, ".");
  const SurfaceSurvey survey(atoms, probe);
  CHECK(survey.totals().area == Approx(summary.area).epsilon(0.35));
  CHECK(survey.max_slab_area(1000) >= survey.totals().area);
}

TEST_CASE("a slab of a sphere has the area of its zone", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 100}};
  const SurfaceSurvey survey(atoms, probe);
  const double zone = 2 * pi * 100 * 20;
  CHECK(survey.max_slab_area(20) >= zone);
  CHECK(survey.max_slab_area(20) <= 1.1 * zone);
}

TEST_CASE("a survey counts a large atom once, wherever it is in the file", "[plan]") {
  for (const std::size_t place : {std::size_t{0}, std::size_t{4000}, std::size_t{8000}}) {
    INFO("the large atom has index " << place);
    const std::vector<Atom> atoms = gas_around_a_large_atom(place);
    const double area = 4 * pi * (300.0 * 300 + 8000 * 1.7 * 1.7);
    CHECK(surveyed_area(atoms) == Approx(area).epsilon(0.01));
    Parameters parameters;
    grid_options(parameters).spacing = 3;
    grid_options(parameters).margin = 3;
    Outputs edges;
    edges.grid = edges.areas = false;
    const TemporaryDirectory directory;
    const RunPlan plan = make_plan(atoms, parameters, edges);
    run(atoms, plan.parameters, edges, directory.path());
    const auto written =
        static_cast<double>(std::filesystem::file_size(directory.path() / "intersection_info.txt"));
    CHECK(static_cast<double>(plan.files.edges) == Approx(written).epsilon(0.3));
  }
}

TEST_CASE("a survey of atoms of many sizes does not depend on their order", "[plan]") {
  std::vector<Atom> atoms;
  double area = 0;
  for (int i = 0; i < 20000; ++i) {
    // The radii, from 1 to 20, are such that few are large.
    const double radius = 20 / (1 + 19 * std::sqrt(std::fmod(i * 0.754877666, 1)));
    const int layer = i / 729;
    atoms.push_back({{50.0 * (i % 27), 50.0 * (i / 27 % 27), 50.0 * layer}, radius});
    area += 4 * pi * radius * radius;
  }
  CHECK(surveyed_area(atoms) == Approx(area).epsilon(0.1));
  const auto smaller = [](const Atom& a, const Atom& b) { return a.radius < b.radius; };
  std::sort(atoms.begin(), atoms.end(), smaller);
  CHECK(surveyed_area(atoms) == Approx(area).epsilon(0.1));
  std::reverse(atoms.begin(), atoms.end());
  CHECK(surveyed_area(atoms) == Approx(area).epsilon(0.1));
}

TEST_CASE("a thin slab has no more area than a zone of its thickness", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 3}};
  const SurfaceSurvey survey(atoms, probe);
  for (const double thickness : {0.05, 0.16, 0.64}) {
    INFO("thickness " << thickness);
    const double zone = 2 * pi * 3 * thickness;
    CHECK(survey.max_slab_area(thickness) >= zone);
    CHECK(survey.max_slab_area(thickness) <= 1.1 * zone);
  }
}

TEST_CASE("the top of a flat sheet lies in a thin slab", "[plan]") {
  const std::vector<Atom> atoms = flat_sheet(20);
  const SurfaceSurvey survey(atoms, probe);
  // Between atoms, which are 1.42 apart, the surface is less than 0.3 below the tops.
  const double top = 2.13 * 19 * 2.46 * 19;
  CHECK(survey.max_slab_area(0.4) > top);
  CHECK(survey.max_slab_area(0.4) < 2.2 * top);
}

TEST_CASE("a survey includes all atoms of a small molecule", "[plan]") {
  // The surface of a small molecule is smaller than the SAS, whose area the survey takes.
  for (const char* const file : {"c60.xyzr", "boxb.pqr"}) {
    INFO(file);
    const std::vector<Atom> atoms = read_atom_list(std::string(ESES_DATA) + "/" + file);
    const Outputs nothing{false, false, false, false};
    const Summary summary = run(atoms, {}, nothing, ".");
    const SurfaceSurvey survey(atoms, probe);
    CHECK(survey.totals().area >= 0.95 * summary.area);
    CHECK(survey.totals().area <= 2.1 * summary.area);
  }
}

TEST_CASE("blocks are cubes, or flat if the molecule is wide", "[plan]") {
  Parameters parameters;
  const Schedule small = plan_with_plenty(column_of_atoms(40), parameters);
  CHECK((small.tiling.block_size == GridIndex{64, 64, 64}));
  grid_options(parameters).spacing = 0.2;
  const Schedule wide = plan_with_plenty({{{0, 0, 0}, 120}}, parameters);
  CHECK(wide.tiling.block_size[2] < 64);
  CHECK(wide.tiling.block_size[0] >= 64);
}

TEST_CASE("a plan treats the available memory as a limit", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 120}};
  Parameters parameters;
  grid_options(parameters).spacing = 0.2;
  parameters.threads = 2;
  const Schedule free = plan_with_plenty(atoms, parameters);
  const std::uint64_t smallest = min_limit(atoms, parameters) << 20;
  const Schedule tight = plan_within(smallest, atoms, parameters);
  CHECK(tight.memory_bytes < free.memory_bytes);
  CHECK(tight.memory_bytes <= smallest);
  parameters.max_memory = smallest;
  const Schedule limited = plan_with_plenty(atoms, parameters);
  CHECK((limited.tiling.block_size == tight.tiling.block_size));
  CHECK(limited.memory_bytes == tight.memory_bytes);
  parameters.max_memory = plenty;  // more than is available
  CHECK(plan_within(smallest, atoms, parameters).memory_bytes == tight.memory_bytes);
}

TEST_CASE("a refusal says whether the limit or the machine is too small", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 120}};
  Parameters parameters;
  grid_options(parameters).spacing = 0.2;
  const std::string machine = "but 1 MB are available; use a larger spacing";
  const std::string limit = "but the limit is 1 MiB";
  CHECK(refusal(1'000'000, atoms, parameters).find(machine) != std::string::npos);
  parameters.max_memory = 1 << 20;
  CHECK(refusal(1'000'000, atoms, parameters).find(machine) != std::string::npos);
  CHECK(refusal(std::uint64_t{1} << 40, atoms, parameters).find(limit) != std::string::npos);
  parameters.block_size = 64;
  parameters.threads = 2;
  const std::string text = refusal(1'000'000, atoms, parameters);
  CHECK(text.find(" in blocks of 64 with 2 threads need up to ") != std::string::npos);
  CHECK(text.find("or a smaller block size or fewer threads") != std::string::npos);
}

TEST_CASE("bytes are printed in the unit that leaves one to three digits before the point",
          "[plan]") {
  CHECK(bytes_text(0) == "0 B");
  CHECK(bytes_text(999) == "999 B");
  CHECK(bytes_text(1000) == "1 kB");
  CHECK(bytes_text(34'970'000) == "35 MB");
  CHECK(bytes_text(999'499) == "999 kB");
  CHECK(bytes_text(999'500) == "1 MB");
  CHECK(bytes_text(24'180'000'000) == "24.2 GB");
  CHECK(bytes_text(1'640'000'000'000) == "1.64 TB");
  CHECK(bytes_text(18'446'744'073'709'551'615U) == "18.4 EB");
  CHECK(binary_bytes_text(1023) == "0.999 KiB");
  CHECK(binary_bytes_text(1 << 20) == "1 MiB");
  CHECK(binary_bytes_text(std::uint64_t{500} << 20) == "500 MiB");
  CHECK(binary_bytes_text(std::uint64_t{20} << 30) == "20 GiB");
  CHECK(binary_bytes_text(18'446'744'073'709'551'615U) == "16 EiB");
}

TEST_CASE("a large memory limit changes nothing", "[plan]") {
  const std::vector<Atom> atoms = column_of_atoms(40);
  Parameters parameters;
  parameters.threads = 2;
  const Schedule free = plan_with_plenty(atoms, parameters);
  parameters.max_memory = std::uint64_t{1} << 40;
  const Schedule limited = plan_with_plenty(atoms, parameters);
  CHECK((limited.tiling.block_size == free.tiling.block_size));
  CHECK(limited.threads == free.threads);
  CHECK(limited.blocks_ahead == free.blocks_ahead);
  CHECK(limited.memory_bytes >= free.memory_bytes);
}

TEST_CASE("a refusal names the smallest limit that is accepted", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 120}};
  for (const std::int64_t block_size : {0, 64, 100})
    for (const int threads : {0, 1, 2}) {
      INFO("block size " << block_size << ", threads " << threads);
      Parameters parameters;
      grid_options(parameters).spacing = 0.2;
      parameters.block_size = block_size;
      parameters.threads = threads;
      const std::uint64_t smallest = min_limit(atoms, parameters);
      parameters.max_memory = smallest << 20;
      const Schedule plan = plan_with_plenty(atoms, parameters);
      CHECK(plan.memory_bytes <= parameters.max_memory);
      if (block_size > 0)
        CHECK((plan.tiling.block_size == GridIndex{block_size, block_size, block_size}));
      if (threads > 0) CHECK(plan.threads == threads);
      parameters.max_memory = (smallest - 1) << 20;
      CHECK_THROWS_AS(plan_with_plenty(atoms, parameters), MemoryLimitError);
    }
}

TEST_CASE("a tight limit gives smaller blocks and holds fewer of them", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 120}};
  Parameters parameters;
  grid_options(parameters).spacing = 0.2;
  parameters.threads = 2;
  const Schedule free = plan_with_plenty(atoms, parameters);
  parameters.max_memory = free.memory_bytes - 1;
  const Schedule fewer = plan_with_plenty(atoms, parameters);
  CHECK((fewer.tiling.block_size == free.tiling.block_size));
  CHECK(fewer.blocks_ahead < free.blocks_ahead);
  parameters.max_memory = min_limit(atoms, parameters) << 20;
  const Schedule smallest = plan_with_plenty(atoms, parameters);
  CHECK((smallest.tiling.block_size != free.tiling.block_size));
  CHECK(smallest.memory_bytes < fewer.memory_bytes);
}

TEST_CASE("a run that exceeds its memory limit ends and leaves no file", "[plan]") {
  const std::vector<Atom> atoms = column_of_atoms(40);
  PlannedRun run = plan_run({.atoms = Molecule(atoms)}, Processes());
  run.request.parameters.max_memory = 1000;
  const TemporaryDirectory directory;
  run.request.output_directory = directory.path();
  CHECK_THROWS_AS(execute(run, {}, Processes()), Error);
  CHECK(std::filesystem::is_empty(directory.path()));
}

TEST_CASE("free disk space is that of the place where the directory will be", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  const RunPlan plan = make_plan(atoms, {}, {});
  const std::vector<DiskSpace> here = require_disk_space(plan.files, {}, ".");
  const std::vector<DiskSpace> below = require_disk_space(plan.files, {}, "not/made/yet");
  REQUIRE(here.size() == 1);
  REQUIRE(below.size() == 1);
  CHECK(here[0].expected == plan.files.output());
  CHECK(below[0].available >= plan.files.output());
  CHECK_FALSE(std::filesystem::exists("not"));
}

TEST_CASE("a plan whose files do not fit on the disk is refused", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  RunPlan plan = make_plan(atoms, {}, {});
  const std::vector<DiskSpace> here = require_disk_space(plan.files, {}, ".");
  if (here[0].available > std::uint64_t{1} << 60)
    SKIP("the file system does not report its free space");
  plan.files.edges = std::uint64_t{1} << 62;
  const DiskSpace full = require_disk_space(plan.files, {}, ".")[0];
  CHECK(full.expected > full.available);
  plan.files.grid = std::uint64_t{1} << 62;
  CHECK_THROWS_WITH(require_disk_space(plan.files, {}, "."),
                    Catch::Matchers::EndsWith("; use a larger spacing or leave out grid_info.txt"));
}

TEST_CASE("each file system is checked for the files that it receives", "[plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  const TemporaryDirectory directory;
  Outputs outputs;
  outputs.inside_map = "map.dx";
  outputs.mesh = MeshOptions{directory.path() / "a" / "mesh.ply"};
  const RunPlan plan = make_plan(atoms, {}, outputs);
  REQUIRE(plan.files.mesh_scratch > 0);
  CHECK(plan.files.mesh_scratch < plan.files.mesh);
  const std::uint64_t of_mesh = plan.files.mesh + plan.files.mesh_scratch;
  const std::uint64_t of_others = plan.files.output() - plan.files.mesh;
  std::vector<DiskSpace> one = require_disk_space(plan.files, outputs, directory.path());
  REQUIRE(one.size() == 1);
  CHECK(one[0].expected == of_mesh + of_others);

  // The files of /proc are in a file system of their own.
  std::vector<DiskSpace> two = require_disk_space(plan.files, outputs, "/proc/self");
  REQUIRE(two.size() == 2);
  CHECK(two[0].directory == "/proc/self");
  CHECK(two[0].expected == of_others);
  CHECK(two[1].directory == directory.path() / "a");
  CHECK(two[1].expected == of_mesh);
  // Other processes may change the free space between two calls.
  for (int i = 0; i < 1000 && two[1].available != one[0].available; ++i) {
    one = require_disk_space(plan.files, outputs, directory.path());
    two = require_disk_space(plan.files, outputs, "/proc/self");
  }
  CHECK(two[1].available == one[0].available);
}

TEST_CASE("the plan knows the length of the tables and of the bounding box", "[plan]") {
  std::vector<Atom> atoms;
  std::vector<AtomLabel> labels;
  for (int i = 0; i < 300; ++i) {
    const int x = i % 7, y = i / 7 % 7, z = i / 49;
    atoms.push_back({{9.0 * x, 9.0 * y, 9.0 * z}, 1.5});
    labels.push_back({std::string(static_cast<std::size_t>(i / 100 + 1), 'A'),
                      "RESIDUE_WITH_A_LONG_NAME", std::to_string(i / 2), "C", "C"});
  }
  const Molecule molecule(atoms, labels);
  Outputs outputs;
  outputs.residues = true;
  outputs.atoms = true;
  for (const bool gzip : {false, true}) {
    outputs.gzip = gzip;
    const TemporaryDirectory directory;
    const RunPlan plan =
        make_plan(molecule, {.grid = GridOptions{.spacing = 1, .margin = 1}}, outputs);
    run(molecule, plan.parameters, outputs, directory.path());
    const auto size = [&](const char* name) {
      return static_cast<double>(std::filesystem::file_size(directory.path() / name));
    };
    CHECK(static_cast<double>(plan.files.box) ==
          size(gzip ? "bounding_box.txt.gz" : "bounding_box.txt"));
    CHECK(static_cast<double>(plan.files.residues) ==
          Approx(size("residue_area.csv") + size("chain_area.csv")).epsilon(0.1));
    CHECK(static_cast<double>(plan.files.atoms) == Approx(size("atoms.csv")).epsilon(0.1));
  }
}

TEST_CASE("no plan takes less memory than the minimum for its number of atoms") {
  // Equal atoms need the least memory, because only one of them is part of the surface.
  for (const std::size_t count : {1U, 1000U, 30000U}) {
    const std::vector<Atom> atoms(count, {{0, 0, 0}, 1.5});
    INFO(count);
    const auto bytes =
        static_cast<double>(make_plan(atoms, {}, Outputs::none()).schedule.memory_bytes);
    CHECK(bytes >= min_expected_memory(count));
    CHECK(min_expected_memory(count) >= static_cast<double>(count * sizeof(Atom)));
  }
}

}  // namespace eses::detail::test
