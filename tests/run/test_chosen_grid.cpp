// Tests of grids that the user chooses: their options, the files from which they are read, and the
// surface on them.

#include <fmt/ranges.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "catch.hpp"
#include "eses/eses.hpp"
#include "geometry/make_grid.hpp"
#include "input/eses_reader.hpp"
#include "run/plan.hpp"
#include "run/planned_run.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

namespace fs = std::filesystem;

// Header and first values of a map that APBS 3.4.1 has written.
constexpr char apbs_map[] =
    "# Data from 3.4.1\n# \n# POTENTIAL (kT/e)\n# \n"
    "object 1 class gridpositions counts 9 17 5\n"
    "origin -7.000000e+00 1.250000e-01 3.300000e+01\n"
    "delta 7.291667e-01 0.000000e+00 0.000000e+00\n"
    "delta 0.000000e+00 7.291667e-01 0.000000e+00\n"
    "delta 0.000000e+00 0.000000e+00 7.291667e-01\n"
    "object 2 class gridconnections counts 9 17 5\n"
    "object 3 class array type double rank 0 items 765 data follows\n1 2 3\n";

constexpr char image[] =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">\n"
    "  <ImageData WholeExtent=\"2 10 -1 15 0 4\"\n"
    "    Origin=\"1 -2 3.5\" Spacing='0.25 0.25 0.25' Direction=\"1 0 0 0 1 0 0 0 1\">\n"
    "    <Piece Extent=\"2 10 -1 15 0 4\">\n\x01\x02";

void require_equal(const Grid& grid, const Grid& expected) {
  CHECK(grid.origin == expected.origin);
  CHECK(grid.spacing == expected.spacing);
  CHECK(grid.size == expected.size);
}

void write_gzipped(const fs::path& path, const std::string& text) {
  gzFile file = gzopen(path.c_str(), "wb");
  REQUIRE(file != nullptr);
  CHECK(gzwrite(file, text.data(), static_cast<unsigned>(text.size())) ==
        static_cast<int>(text.size()));
  gzclose(file);
}

std::string message_of_reading(const fs::path& path) {
  try {
    read_grid(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  REQUIRE(at != std::string::npos);
  return text.replace(at, part.size(), by);
}

/// Returns the lines of grid_info.txt or intersection_info.txt by the points with which they begin,
/// renumbered as if the grid began at `shift`.
std::map<std::vector<std::int64_t>, std::string> lines_by_points(const std::string& text,
                                                                 std::size_t indices,
                                                                 const GridIndex& shift) {
  std::map<std::vector<std::int64_t>, std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream fields(line);
    std::vector<std::int64_t> key(indices);
    for (std::size_t i = 0; i < indices; ++i) {
      fields >> key[i];
      key[i] += shift[i % 3];
    }
    std::getline(fields, lines[key]);
  }
  return lines;
}

struct Files {
  std::string points, edges;
  Summary summary;
};

Files files_of(const std::vector<Atom>& atoms, const Parameters& parameters) {
  const TemporaryDirectory directory;
  Files files;
  files.summary = run(atoms, parameters, {}, directory.path());
  files.points = read_bytes(directory.path() / "grid_info.txt");
  files.edges = read_bytes(directory.path() / "intersection_info.txt");
  return files;
}

}  // namespace

TEST_CASE("the grid of an OpenDX map is read as APBS writes it", "[grid]") {
  const TemporaryDirectory directory;
  const Grid expected{{-7, 0.125, 33}, 0.7291667, {9, 17, 5}};
  write_file(directory.path() / "a.dx", apbs_map);
  write_gzipped(directory.path() / "a.dx.gz", apbs_map);
  require_equal(read_grid(directory.path() / "a.dx"), expected);
  require_equal(read_grid(directory.path() / "a.dx.gz"), expected);
}

TEST_CASE("the grid of VTK image data is read whatever its first index", "[grid]") {
  const TemporaryDirectory directory;
  const Grid expected{{1.5, -2.25, 3.5}, 0.25, {9, 17, 5}};
  write_file(directory.path() / "a.vti", std::string(image) + "\n");
  write_gzipped(directory.path() / "a.vti.gz", std::string(image) + "\n");
  require_equal(read_grid(directory.path() / "a.vti"), expected);
  require_equal(read_grid(directory.path() / "a.vti.gz"), expected);
}

TEST_CASE("the spacing of bounding_box.txt is recovered from its corners", "[grid]") {
  const TemporaryDirectory directory;
  for (const double spacing : {0.4, 0.37, 1.0 / 3, 0.123456789, 0.05, 1.0, 0.7291667})
    for (const double origin : {0.0, -17.123456789012345, 312.7, 99999.5}) {
      INFO(spacing << ' ' << origin);
      const Grid grid{{origin, -origin, 3}, spacing, {41, 2, 160}};
      Outputs outputs = Outputs::none();
      outputs.box = true;
      const Parameters parameters{.grid = grid};
      const std::vector<Atom> atoms{{grid.origin, 1}};
      run(atoms, parameters, outputs, directory.path());
      const Grid read = read_grid(directory.path() / "bounding_box.txt");
      CHECK(read.size == grid.size);
      for (std::size_t axis = 0; axis < 3; ++axis)
        CHECK(std::fabs(read.origin[axis] - grid.origin[axis]) <=
              1e-12 * std::fabs(grid.origin[axis]));
      // The thirteen digits of the corners do not hold all digits of a third.
      if (spacing == 1.0 / 3) {
        CHECK(std::fabs(read.spacing - spacing) < 1e-8 * spacing);
      } else if (std::fabs(origin) < 1000) {
        CHECK(read.spacing == spacing);
      }
    }
}

TEST_CASE("files without a grid are refused with the place of the fault", "[grid]") {
  const TemporaryDirectory directory;
  const std::string dx = apbs_map, vti = std::string(image) + "\n";
  const std::string box = "0 0 0\n1 1 2\n3 3 5\n";
  struct Case {
    std::string name, text, message;
  };
  const std::vector<Case> cases{
      {"a.dx", replaced(dx, "7.291667e-01 0.0", "7.391667e-01 0.0"),
       ":9: the spacing is 0.7391667 along x, 0.7291667 along y and 0.7291667 along z; it must be "
       "the same along all axes"},
      {"a.dx", replaced(dx, "7.291667e-01 0.000000e+00", "7.291667e-01 1.000000e+00"),
       ":7: the axes of the grid must be those of the coordinates"},
      {"a.dx", replaced(dx, "counts 9", "counts nine"),
       ":5: counts: expected a finite number, found \"nine\""},
      {"a.dx", replaced(dx, "counts 9", "counts 9.5"),
       ":5: counts: expected a whole number from 1"},
      {"a.dx", replaced(dx, "counts 9 17 5", "counts 9 17"),
       ":5: counts: expected a finite number, found the end of the line"},
      {"a.dx", replaced(dx, "delta 7.291667e-01", "delta 0.000000e+00"),
       ":9: expected a positive spacing along x, y and z"},
      {"a.dx", replaced(dx, "-7.000000e+00", "inf"), ":6: origin: expected a finite number"},
      {"a.dx", "# nothing\n", "expected the positions of an OpenDX grid"},
      {"a.dx", "", "expected the positions of an OpenDX grid"},
      {"a.vti", replaced(vti, "Origin", "Place"), "the tag ImageData has no attribute Origin"},
      {"a.vti", replaced(vti, "\"2 10", "\"10 2"),
       ":4: WholeExtent: expected a whole number from 10"},
      {"a.vti", replaced(vti, "'0.25 0.25", "'0.25 0.35"), "it must be the same along all axes"},
      {"a.vti", replaced(vti, "ImageData W", "RectilinearGrid W"), "the tag ImageData"},
      {"b.txt", replaced(box, "1 1 2", "1 1.1 2"), "the corners give different spacings"},
      {"b.txt", replaced(box, "1 1 2", "0 0 0"), "the corners and counts give no valid spacing"},
      {"b.txt", replaced(box, "3 3 5", "1 1 1"), "the corners and counts give no valid spacing"},
      {"b.txt", replaced(box, "3 3 5", "3 3"), ":3: field 3 (nz): expected a whole number"},
      {"c.map", dx, "needs the suffix .dx, .vti or .txt"},
  };
  for (const auto& [name, text, message] : cases) {
    const fs::path path = directory.path() / name;
    write_file(path, text);
    const std::string found = message_of_reading(path);
    INFO(found << "\nexpected " << message);
    CHECK(contains(found, path.string()));
    CHECK(contains(found, message));
  }
  CHECK(contains(message_of_reading(directory.path() / "none.dx"), "none.dx"));
}

TEST_CASE("a centred grid has its centre at the given point", "[grid]") {
  require_equal(centered_grid({1, 2, -3}, 0.5, {5, 4, 2}), {{0, 1.25, -3.25}, 0.5, {5, 4, 2}});
}

TEST_CASE("a chosen grid that lies within another has its lines", "[grid]") {
  const std::vector<Atom> atoms = make_chain(40, 5);
  // Multiples of 1/4 are exact, so both grids have the same points.
  const Grid wide{{-30, -30, -30}, 0.25, {240, 241, 239}};
  const GridIndex shift{101, 95, 108};
  const Grid narrow{wide.point(shift), 0.25, {37, 50, 21}};
  Parameters parameters{.grid = wide, .block_size = 17};
  const Files all = files_of(atoms, parameters);
  parameters.grid = narrow;
  const Files part = files_of(atoms, parameters);
  REQUIRE(part.summary.edges() > 500);
  REQUIRE(all.summary.edges() > 2 * part.summary.edges());
  const auto all_points = lines_by_points(all.points, 3, {});
  const auto points = lines_by_points(part.points, 3, shift);
  CHECK(points.size() == static_cast<std::size_t>(narrow.point_count()));
  for (const auto& [point, line] : points) REQUIRE(all_points.at(point) == line);
  const auto all_edges = lines_by_points(all.edges, 6, {});
  const auto edges = lines_by_points(part.edges, 6, shift);
  CHECK(edges.size() == static_cast<std::size_t>(part.summary.edges()));
  for (const auto& [edge, line] : edges) REQUIRE(all_edges.at(edge) == line);
  std::size_t within = 0;
  for (const auto& [edge, line] : all_edges) {
    bool is_within = true;
    for (std::size_t i = 0; i < 6; ++i)
      is_within =
          is_within && edge[i] >= shift[i % 3] && edge[i] < shift[i % 3] + narrow.size[i % 3];
    within += is_within ? 1 : 0;
  }
  CHECK(within == edges.size());
}

TEST_CASE("chosen grids pass the verification on all kinds of atoms", "[grid]") {
  for (const Kind kind : all_kinds)
    for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{2}}) {
      INFO(kind_name(kind) << ' ' << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      Random random(seed);
      Parameters parameters{.probe_radius = designed_probe_radius(seed)};
      grid_options(parameters).spacing = random.uniform(0.2, 0.6);
      parameters.verify = 500;
      const Vec3 center = atoms[random.integer(0, atoms.size() - 1)].center;
      parameters.grid = centered_grid(center, grid_options(parameters).spacing, {23, 31, 17});
      const RunPlan plan = make_plan(atoms, parameters, Outputs::none());
      const Summary summary = compute(atoms, plan.parameters, {});
      CHECK(summary.inside_points > 0);
      CHECK(summary.verification->points > 0);
      CHECK(summary.verification->faults.empty());
    }
}

TEST_CASE("a small grid in a large molecule needs little from program and library", "[grid][cli]") {
  const Sandbox sandbox;
  const Grid grid = centered_grid({60, 60, 60}, 0.05, {20, 20, 20});
  const auto atoms_of = [](int side) {
    std::vector<Atom> atoms;
    for (int i = 0; i < side * side * side; ++i)
      atoms.push_back({{120.0 / (side - 1) * (i % side), 120.0 / (side - 1) * (i / side % side),
                        120.0 / (side - 1) * (i / side / side)},
                       1.7});
    return atoms;
  };
  std::vector<std::uint64_t> memory;
  std::vector<std::size_t> sizes;
  for (const int side : {25, 40}) {
    const std::vector<Atom> atoms = atoms_of(side);
    const Estimate library = estimate(eses::Surface(atoms), grid, Outputs::none());
    std::string text;
    for (const auto& [center, radius] : atoms)
      text += fmt::format("{} {} {} {}\n", center.x, center.y, center.z, radius);
    write_file(sandbox.directory() / "large.xyzr", text);
    const Outcome program =
        sandbox.run({"large.xyzr", "1.4", "0.05", "--grid-center", "60,60,60", "--grid-points",
                     "20,20,20", "--write", "none", "--dry-run", "--json"});
    INFO(program.err);
    REQUIRE(program.code == 0);
    check_json(sandbox, program.out, "r['plan']['memory_bytes']",
               std::to_string(library.memory_bytes));
    check_json(sandbox, program.out, "r['threads']", std::to_string(library.threads));
    check_json(sandbox, program.out, "r['blocks']['size']",
               fmt::format("[{}]", fmt::join(library.block_size, ", ")));
    check_json(sandbox, program.out, "r['plan']['cut_depth']",
               fmt::format("{}", library.cut_depth));
    memory.push_back(library.memory_bytes);
    sizes.push_back(atoms.size());
  }
  // The list of the atoms grows, but not the patches and crossings.
  CHECK(memory[1] < memory[0] + 200 * (sizes[1] - sizes[0]));
  const eses::Surface surface(atoms_of(40));
  CHECK(compute(surface, grid, {.max_memory = std::uint64_t{1} << 30}).inside().size() == 8000);
}

TEST_CASE("invalid chosen grids are refused", "[grid]") {
  const auto message = [&](const Grid& grid) {
    try {
      require_chosen(grid);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(message({{0, 0, 0}, 0.5, {2, 2, 2}}).empty());
  CHECK(
      contains(message({{0, 0, 0}, 0.5, {2, 1, 2}}), "points along y is 1; it must be 2 or more"));
  CHECK(contains(message({{0, 0, 1e9}, 0.5, {2, 2, 2}}), "too far from 0"));
  CHECK(contains(message({{0, 0, 0}, 0.5, {2, 2, 3000000000}}), "3000000000 points along z"));
  CHECK(contains(message({{0, 0, 0}, 0.001, {1000000, 1000000, 1000000}}), "1e+18 points"));
}

TEST_CASE("a checkpoint of another grid is not resumed", "[grid][processes]") {
  const TemporaryDirectory directory;
  write_file(directory.path() / "a.xyzr", "0 0 0 1.5\n");
  Request task;
  task.atoms = InputFile{directory.path() / "a.xyzr"};
  task.output_directory = directory.path();
  task.resume = true;
  task.parameters.grid = Grid{{-2, -2, -2}, 0.5, {9, 9, 9}};
  const auto keep_piece = [&] {
    const PlannedRun plan = plan_run(task, Processes());
    plan.checkpoint->prepare();
    PlaneChunk chunk;
    chunk.planes = {0, 4};
    plan.checkpoint->finish(chunk);
  };
  keep_piece();
  CHECK(plan_run(task, Processes()).finished_planes.size() == 1);
  std::get<Grid>(task.parameters.grid).origin.x = -2.5;
  CHECK_THROWS_AS(plan_run(task, Processes()), Error);
  task.parameters.grid = Grid{{-2, -2, -2}, 0.5, {9, 10, 9}};
  CHECK_THROWS_AS(plan_run(task, Processes()), Error);
}

TEST_CASE("usage errors of chosen grids name the option", "[grid][cli]") {
  const Sandbox sandbox;
  const std::string place = ", expected three finite numbers x,y,z, in angstrom";
  const std::string counts = ", expected three whole numbers nx,ny,nz of at least 2";
  const std::string like =
      ", expected a file name with the suffix .dx, .vti or .txt, or one of these and .gz";
  const std::vector<std::pair<Arguments, std::string>> cases{
      {{"--grid-origin", "0,0"}, "--grid-origin is '0,0'" + place},
      {{"--grid-origin", "0,0,nan"}, "--grid-origin is '0,0,nan'" + place},
      {{"--grid-center=1,2,3,4"}, "--grid-center is '1,2,3,4'" + place},
      {{"--grid-center="}, "--grid-center= needs a value"},
      {{"--grid-points", "2,1,2"}, "--grid-points is '2,1,2'" + counts},
      {{"--grid-points", "2,2.5,2"}, "--grid-points is '2,2.5,2'" + counts},
      {{"--grid-points", "2,2,-2"}, "--grid-points is '2,2,-2'" + counts},
      {{"--grid-origin", "0,0,0"}, "--grid-origin needs --grid-points"},
      {{"--grid-center", "0,0,0"}, "--grid-center needs --grid-points"},
      {{"--grid-points", "2,2,2"}, "--grid-points needs --grid-origin or --grid-center"},
      {{"--grid-origin", "0,0,0", "--grid-center", "0,0,0", "--grid-points", "2,2,2"},
       "--grid-origin excludes --grid-center; use only one of them"},
      {{"--grid-like", "map.txt", "--grid-points", "2,2,2"},
       "--grid-points excludes --grid-like; use only one of them"},
      {{"--grid-like", "map.ccp4"}, "--grid-like is 'map.ccp4'" + like},
      {{"--grid-like", "map.dx", "--margin", "1"}, "--margin cannot be combined with --grid-like"},
      {{"1.4", "0.4", "0.8", "--grid-origin", "0,0,0", "--grid-points", "2,2,2"},
       "MARGIN cannot be combined with --grid-origin"},
  };
  for (const auto& [given, message] : cases) {
    Arguments arguments{"atom.xyzr"};
    arguments.insert(arguments.end(), given.begin(), given.end());
    check_usage_error(sandbox, arguments, message);
  }
  CHECK(sandbox.files().empty());
}

TEST_CASE("maps of the dielectric give the grid, not the middles of its edges", "[grid]") {
  const TemporaryDirectory directory;
  const auto read = [&](const std::string& comment) {
    const fs::path path = directory.path() / "map.dx";
    write_file(path, comment +
                         "\nobject 1 class gridpositions counts 4 5 6\norigin 1.25 2 3\n"
                         "delta 0.5 0 0\ndelta 0 0.5 0\ndelta 0 0 0.5\n");
    return read_grid(path).origin;
  };
  CHECK(read("# Data from APBS\n#\n# POTENTIAL") == Vec3{1.25, 2, 3});
  CHECK(read("# Dielectric at middles of edges along x: 2 inside, 80 outside") == Vec3{1, 2, 3});
  CHECK(read("# Data from APBS\n#\n# Y-SHIFTED DIELECTRIC MAP") == Vec3{1.25, 1.75, 3});
  CHECK(read("# Z-SHIFTED DIELECTRIC MAP") == Vec3{1.25, 2, 2.75});
}

TEST_CASE("a grid file that gives an invalid grid is named", "[grid]") {
  const TemporaryDirectory directory;
  const fs::path path = directory.path() / "flat.dx";
  write_file(path,
             "object 1 class gridpositions counts 1 5 6\norigin 1 2 3\n"
             "delta 0.5 0 0\ndelta 0 0.5 0\ndelta 0 0 0.5\n");
  CHECK_THROWS_WITH(read_grid(path), path.string() +
                                         ": the number of grid points along x is 1; it must be 2 "
                                         "or more");
}

TEST_CASE("the grid of every file that a run writes gives the same files", "[grid][cli]") {
  const Sandbox sandbox;
  REQUIRE(sandbox
              .run({"pair.xyzr", "1.4", "0.37", "-o", "a", "--inside", "map.dx", "--dielectric",
                    "eps-"})
              .code == 0);
  REQUIRE(
      sandbox.run({"pair.xyzr", "1.4", "0.37", "-o", "b", "--inside", "map.vti", "--gzip"}).code ==
      0);
  const fs::path root = sandbox.directory();
  for (const char* const file :
       {"a/bounding_box.txt", "a/map.dx", "a/eps-y.dx", "b/bounding_box.txt.gz", "b/map.vti"}) {
    INFO(file);
    REQUIRE(sandbox.run({"pair.xyzr", "--grid-like", file, "-o", "c"}).code == 0);
    for (const std::string name : eses_file_names) {
      INFO(name);
      const bool is_same = read_file(root / "a" / name) == read_file(root / "c" / name);
      CHECK(is_same);
    }
  }
  const Outcome same = sandbox.run({"pair.xyzr", "1.4", "0.37", "--grid-like", "a/map.dx", "-q"});
  CHECK(same.code == 0);
  const Outcome other = sandbox.run({"pair.xyzr", "1.4", "0.38", "--grid-like", "a/map.dx"});
  CHECK(other.code == 1);
  CHECK(other.err ==
        "eses-blocks: error: a/map.dx has a grid with a spacing of 0.37, but the given spacing "
        "is 0.38; omit it\n");
  const Outcome lost =
      sandbox.run({"pair.xyzr", "--grid-like", "a/map.dx", "--inside", "map.dx", "-o", "a"});
  CHECK(lost.code == 1);
  CHECK(contains(lost.err, "is the file of --grid-like, and would be overwritten"));
  CHECK(sandbox.run({"pair.xyzr", "--grid-like", "a/none.dx"}).code == 1);
}

TEST_CASE("a molecule that reaches beyond the grid produces one warning", "[grid][cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "one.xyzr", "0 0 0 2\n");
  const auto run_on = [&](const Arguments& grid) {
    Arguments arguments{"one.xyzr", "--spacing", "0.5"};
    arguments.insert(arguments.end(), grid.begin(), grid.end());
    return sandbox.run(arguments);
  };
  const Outcome around = run_on({"--grid-center", "0,0,0", "--grid-points", "11,11,11"});
  CHECK(around.code == 0);
  CHECK(around.err.empty());
  // The points on the axes at the faces are inside.
  const Outcome touched = run_on({"--grid-center", "0,0,0", "--grid-points", "9,9,9"});
  CHECK(touched.code == 0);
  CHECK(touched.err ==
        "eses-blocks: warning: the grid ends where the molecule does, up to rounding, so that a "
        "mesh can be open there; use a larger grid or margin\n");
  const Outcome cut = run_on({"--grid-origin=-2.5,-1,-2", "--grid-points", "9,9,9"});
  CHECK(cut.code == 0);
  CHECK(cut.err ==
        "eses-blocks: warning: the van der Waals spheres extend beyond the grid by 0.5 at high x, "
        "1 at low y (angstrom); area and volume are those of the part inside the grid\n");
  CHECK(run_on({"--grid-origin=-2.5,-1,-2", "--grid-points", "9,9,9", "--strict"}).code == 1);
  const Outcome missed = run_on({"--grid-origin", "2.25,0,0", "--grid-points", "3,3,3"});
  CHECK(missed.code == 0);
  CHECK(missed.err ==
        "eses-blocks: warning: the grid does not overlap the molecule; all grid points are "
        "outside\n");
  CHECK(read_file(sandbox.directory() / "intersection_info.txt").empty());
  CHECK(contains(read_file(sandbox.directory() / "grid_info.txt"), "2 2 2 -1\n"));
  const Outcome dry = run_on({"--grid-origin", "2.25,0,0", "--grid-points", "3,3,4", "--dry-run"});
  CHECK(contains(dry.out, "grid: 3 x 3 x 4 = 36 points\n"));
  CHECK(contains(dry.out, "custom grid: from 2.25 0 0 to 3.25 1 1.5 (angstrom)\n"));
  const Outcome json =
      run_on({"--grid-origin", "2.25,0,0", "--grid-points", "3,3,4", "--json", "-q"});
  CHECK(contains(json.out, R"("margin": null)"));
  CHECK(contains(json.out, R"("size": [3, 3, 4])"));
}

}  // namespace eses::detail::test
