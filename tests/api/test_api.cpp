// Tests of the public functions of eses/eses.hpp.

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/eses.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/mesh_files.hpp"
#include "support/other_threads.hpp"
#include "support/sanitizers.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

namespace fs = std::filesystem;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<Atom> chain() { return make_atom_set(Kind::chain, 3); }

/// Returns the message of std::invalid_argument, or "" if nothing or something else is thrown.
std::string argument_error(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

/// The texts of grid_info.txt and intersection_info.txt made from results in memory.
std::string grid_text(const Result& result) {
  std::string text;
  const GridRegion& region = result.region();
  std::size_t place = 0;
  for (std::int64_t z = region.begin[2]; z < region.end[2]; ++z)
    for (std::int64_t y = region.begin[1]; y < region.end[1]; ++y)
      for (std::int64_t x = region.begin[0]; x < region.end[0]; ++x)
        text += std::to_string(x) + ' ' + std::to_string(y) + ' ' + std::to_string(z) +
                (result.inside()[place++] != 0 ? " 1\n" : " -1\n");
  return text;
}

/// From now on, these system calls end the process. Returns false if the system cannot do so.
bool forbid(const std::vector<unsigned>& calls) {
  std::vector<sock_filter> filter{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr))};
  for (const unsigned call : calls) {
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1));
    filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS));
  }
  filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12e ", value);
  return text;
}

std::string crossings_text(std::span<const eses::Crossing> crossings) {
  std::string text;
  for (const eses::Crossing& crossing : crossings) {
    for (const GridIndex& point : {crossing.inside_point(), crossing.outside_point()})
      for (const std::int64_t index : point) text += std::to_string(index) + ' ';
    for (const Vec3& vector : {crossing.position, crossing.normal})
      for (std::size_t axis = 0; axis < 3; ++axis) text += number_text(vector[axis]);
    for (const AtomIndex atom : crossing.adjacent_atoms()) text += std::to_string(atom) + ' ';
    text += '\n';
  }
  return text;
}

std::string areas_text(std::span<const double> areas) {
  std::string text;
  for (std::size_t atom = 0; atom < areas.size(); ++atom) {
    text += std::to_string(atom) + ' ' + number_text(areas[atom]);
    text.back() = '\n';
  }
  return text;
}

/// Returns a text without the blanks at the ends of its lines.
std::string without_last_blanks(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n')
      while (!result.empty() && result.back() == ' ') result.pop_back();
    result += c;
  }
  return result;
}

void require_same_files(const Result& result, const fs::path& directory) {
  const auto text_of = [&](const char* name) {
    return without_last_blanks(read_bytes(directory / name));
  };
  REQUIRE(text_of("grid_info.txt") == grid_text(result));
  REQUIRE(text_of("intersection_info.txt") ==
          without_last_blanks(crossings_text(result.crossings())));
  REQUIRE(text_of("partition_area.txt") == areas_text(result.atom_areas()));
}

/// Returns all values that may depend only on the surface and the grid.
auto values_of(const Result& result) {
  std::vector<std::uint8_t> inside(result.inside().begin(), result.inside().end());
  std::vector<double> areas(result.atom_areas().begin(), result.atom_areas().end());
  return std::tuple(result.area(), result.volume(), std::move(areas), std::move(inside),
                    crossings_text(result.crossings()));
}

}  // namespace

TEST_CASE("api: results in memory are those of the files", "[api]") {
  for (const Kind kind : {Kind::chain, Kind::nested, Kind::snapped}) {
    INFO(kind_name(kind));
    const eses::Surface surface(make_atom_set(kind, 3));
    const Grid grid = make_grid(surface, {.spacing = 0.5, .margin = 0.8});
    const TemporaryDirectory directory;
    Outputs outputs;
    outputs.mesh = MeshOptions{.file = directory.path() / "mesh.ply", .color = MeshColor::none};
    const Summary written =
        write_files(surface, grid, directory.path(), outputs, {.threads = 2, .block_size = 7});
    const Result result = eses::compute(surface, grid, {.threads = 3}, {.mesh = true});
    require_same_files(result, directory.path());
    CHECK(written.area == result.area());
    CHECK(written.volume == result.volume());
    CHECK(written.atom_areas == result.summary().atom_areas);
    CHECK(written.edges() == static_cast<std::int64_t>(result.crossings().size()));
    CHECK(result.region() == grid.whole());

    const test::Mesh file = read_mesh(directory.path() / "mesh.ply");
    const eses::Mesh& mesh = result.mesh().value();
    REQUIRE(written.mesh.has_value());
    CHECK(mesh.vertices.size() == written.mesh->vertices);
    CHECK(file.triangles == mesh.faces);
    CHECK(file.atoms == mesh.atoms);
    REQUIRE(file.positions.size() == mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      REQUIRE(norm(file.positions[v] - mesh.vertices[v]) < 1e-5);
      REQUIRE(norm(file.normals[v] - mesh.normals[v]) < 1e-5);
      REQUIRE(file.patches[v] == mesh.patches[v]);
    }
  }
}

TEST_CASE("api: a region has the points and crossings of the whole grid", "[api]") {
  const eses::Surface surface(chain());
  const Grid grid = make_grid(surface, {.spacing = 0.5});
  const Result whole = eses::compute(surface, grid);
  GridRegion region{{3, 4, 5}, {grid.size[0] - 4, grid.size[1] - 2, grid.size[2]}};
  const TemporaryDirectory directory;
  const RunOptions options{.block_size = 9, .region = region};
  write_files(surface, grid, directory.path(), {}, options);
  const Result part = eses::compute(surface, grid, options, {.mesh = true});
  CHECK(part.region() == region);
  require_same_files(part, directory.path());
  for (std::int64_t z = region.begin[2]; z < region.end[2]; ++z)
    for (std::int64_t y = region.begin[1]; y < region.end[1]; ++y)
      for (std::int64_t x = region.begin[0]; x < region.end[0]; ++x)
        REQUIRE(part.is_inside({x, y, z}) == whole.is_inside({x, y, z}));
  std::vector<eses::Crossing> expected;
  std::copy_if(whole.crossings().begin(), whole.crossings().end(), std::back_inserter(expected),
               [&](const eses::Crossing& crossing) { return region.contains(crossing.lower); });
  CHECK(crossings_text(part.crossings()) == crossings_text(expected));
  const auto in_cells = std::count_if(
      expected.begin(), expected.end(),
      [&](const eses::Crossing& crossing) { return region.contains(crossing.upper()); });
  CHECK(part.mesh()->vertices.size() == static_cast<std::size_t>(in_cells));
  CHECK(!part.mesh()->faces.empty());
  const auto require_crossings = [](const Result& result, const eses::Mesh& mesh,
                                    double tolerance) {
    REQUIRE(mesh.crossings.size() == mesh.vertices.size());
    CHECK(std::ranges::adjacent_find(mesh.crossings, std::greater_equal<>()) ==
          mesh.crossings.end());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const eses::Crossing& crossing = result.crossings()[mesh.crossings[v]];
      REQUIRE(norm(crossing.position - mesh.vertices[v]) <= tolerance * result.grid().spacing);
      REQUIRE(crossing.normal == mesh.normals[v]);
    }
  };
  for (const Result* const result : {&whole, &part}) {
    require_crossings(*result, make_mesh(*result), 1.1e-4);
    require_crossings(*result, make_quality_mesh(*result), 1.1e-6);
  }
}

TEST_CASE("api: blocks have each point and each crossing once", "[api]") {
  const eses::Surface surface(chain());
  const Grid grid = make_grid(surface, {.spacing = 0.4});
  const Result result = eses::compute(surface, grid);
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(grid.point_count()), 2);
  std::vector<eses::Crossing> crossings;
  const auto take = [&](const eses::Block& block) {
    const GridRegion& owned = block.owned();
    for (std::int64_t z = owned.begin[2]; z < owned.end[2]; ++z)
      for (std::int64_t y = owned.begin[1]; y < owned.end[1]; ++y)
        for (std::int64_t x = owned.begin[0]; x < owned.end[0]; ++x) {
          auto& value = inside[static_cast<std::size_t>((z * grid.size[1] + y) * grid.size[0] + x)];
          CHECK(value == 2);
          value = block.is_inside({x, y, z}) ? 1 : 0;
        }
    for (const eses::Crossing& crossing : block.crossings()) {
      CHECK(owned.contains(crossing.lower));
      crossings.push_back(crossing);
    }
    CHECK_THROWS_AS(block.is_inside(block.points().end), std::invalid_argument);
    CHECK(block.seconds() >= 0);
  };
  const Summary summary = for_each_block(surface, grid, take, {.block_size = 11});
  CHECK(std::ranges::equal(inside, result.inside()));
  const auto key = [](const eses::Crossing& c) {
    return std::tuple(c.lower[2], c.lower[1], c.lower[0], c.axis);
  };
  std::sort(crossings.begin(), crossings.end(),
            [&](const auto& a, const auto& b) { return key(a) < key(b); });
  CHECK(crossings_text(crossings) == crossings_text(result.crossings()));
  CHECK(summary.area == result.area());
  CHECK(summary.bytes_written == 0);
}

TEST_CASE("api: one surface serves several spacings and threads", "[api]") {
  const eses::Surface surface(chain());
  const Grid fine = make_grid(surface, {.spacing = 0.3}),
             coarse = make_grid(surface, {.spacing = 0.6});
  const auto expected_fine = values_of(eses::compute(eses::Surface(chain()), fine));
  const auto expected_coarse = values_of(eses::compute(eses::Surface(chain()), coarse));
  CHECK(values_of(eses::compute(surface, fine)) == expected_fine);
  CHECK(values_of(eses::compute(surface, coarse)) == expected_coarse);
  bool is_fine_equal = false, is_coarse_equal = false;
  {
    const eses::Surface copy = surface;
    std::thread other([&] {
      is_fine_equal = values_of(eses::compute(copy, fine, {.threads = 2})) == expected_fine;
    });
    is_coarse_equal = values_of(eses::compute(surface, coarse, {.threads = 2})) == expected_coarse;
    other.join();
  }
  CHECK(is_fine_equal);
  CHECK(is_coarse_equal);
}

TEST_CASE("api: small results in memory neither open files nor give memory back", "[api]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Surface surface(std::vector<Atom>{{{0, 0, 0}, 1.7}});
  const Grid grid = make_grid(surface, {.spacing = 0.5, .margin = 1});
  const std::vector<unsigned> calls{SYS_openat, SYS_statfs, SYS_getrusage, SYS_madvise};
  const pid_t child = fork();
  if (child == 0) {
    // The first call reads the quota, and starts OpenMP.
    const double area = compute(surface, grid).summary().area;
    if (!forbid(calls)) _exit(2);
    _exit(compute(surface, grid).summary().area == area ? 0 : 1);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 2) SKIP("system calls cannot be forbidden");
  CHECK(status == 0);
}

TEST_CASE("api: any grid is accepted, also that of another surface", "[api]") {
  const std::vector<Atom> atoms = chain();
  const eses::Surface surface(atoms);
  const std::vector<Atom> half(atoms.begin(), atoms.begin() + static_cast<long>(atoms.size() / 2));
  const Grid of_part = make_grid(eses::Surface(half), {.spacing = 0.4, .margin = 0.4});
  const Grid around = make_grid(surface, {.spacing = 0.5});
  const Grid within{around.point({5, 6, 4}) + Vec3{0.05, 0.1, 0.2}, 0.37, {17, 12, 9}};
  const Grid thin{around.point({9, 9, 2}), 0.45, {1, 14, 20}};
  const Grid point{atoms[0].center, 0.5, {1, 1, 1}};
  const Grid far{{1000, 1000, 1000}, 0.5, {4, 4, 4}};
  for (const Grid& grid : {of_part, within, thin, point, far}) {
    INFO(grid.size[0] << ' ' << grid.size[1] << ' ' << grid.size[2]);
    // The verification compares with the definition of the surface.
    const Result result = eses::compute(surface, grid, {.block_size = 6, .verify = 3000});
    CHECK(result.inside().size() == static_cast<std::size_t>(grid.point_count()));
    CHECK(values_of(result) == values_of(eses::compute(surface, grid, {.threads = 1})));
    const TemporaryDirectory directory;
    write_files(surface, grid, directory.path(), {}, {.block_size = 5});
    require_same_files(result, directory.path());
  }
  CHECK(eses::compute(surface, point).is_inside({0, 0, 0}));
  CHECK(eses::compute(surface, far).summary().inside_points == 0);
  CHECK(estimate(surface, within).cut_depth > 0);
  CHECK(estimate(surface, around).cut_depth < 0);
}

TEST_CASE("api: atoms and options of a surface are checked", "[api]") {
  const Atom sound{{0, 0, 0}, 1.5};
  const auto error_of = [](std::vector<Atom> atoms, const SurfaceOptions& options) {
    return argument_error([&] { eses::Surface(std::move(atoms), options); });
  };
  CHECK(error_of({}, {}) == "a surface needs at least one atom");
  for (const double bad : {nan, infinity, -infinity}) {
    CHECK(error_of({sound, {{bad, 0, 0}, 1}}, {}).starts_with("atom 1 (counted from 0) has x"));
    CHECK(error_of({sound, {{0, bad, 0}, 1}}, {}).starts_with("atom 1 (counted from 0) has y"));
    CHECK(error_of({{{0, 0, bad}, 1}, sound}, {}).starts_with("atom 0 (counted from 0) has z"));
    CHECK(error_of({{{0, 0, 0}, bad}}, {}).starts_with("atom 0 (counted from 0) has radius"));
    CHECK(!error_of({sound}, {.probe_radius = bad}).empty());
  }
  CHECK(error_of({sound, {{0, 0, 0}, -1}}, {}).starts_with("atom 1 (counted from 0) has radius"));
  for (const double far : {1.1e6, -1e7, 1e300}) {
    CHECK(error_of({sound, {{far, 0, 0}, 1}}, {}).starts_with("atom 1 (counted from 0) has x"));
    CHECK(error_of({{{0, 0, far}, 1}}, {}).ends_with("; the limit is 1000000 angstrom"));
  }
  CHECK_NOTHROW(eses::Surface({{{1e6, -1e6, 1e6}, 1}}));
  for (const double large : {1.1e6, 1e150, 1e200})
    CHECK(error_of({sound, {{0, 0, 0}, large}}, {})
              .starts_with("atom 1 (counted from 0) has radius"));
  for (const double probe : {-1.4, 0.001, 1001.0})
    CHECK(error_of({sound}, {.probe_radius = probe}).starts_with("the probe radius must be"));
  CHECK(!error_of({sound}, {.threads = -1}).empty());
  CHECK(argument_error([&] {
          eses::Surface({sound}, {AtomLabel{}, AtomLabel{}}, {});
        }) == "2 labels for 1 atoms");
  const eses::Surface surface({sound, sound}, {.probe_radius = 2});
  CHECK(surface.probe_radius() == 2);
  CHECK(surface.atoms().size() == 2);
  CHECK(surface.labels().empty());
  REQUIRE(surface.diagnostics().size() == 1);
  CHECK(surface.diagnostics()[0].kind == DiagnosticKind::duplicate);
}

TEST_CASE("api: an added radius gives the solvent accessible surface", "[api]") {
  const std::vector<Atom> given{{{0, 0, 0}, 0.1}, {{0.1, 0, 0}, 0.11}, {{0, 2, 0}, 0}};
  std::vector<Atom> grown = given;
  for (Atom& atom : grown) atom.radius += 1.4;
  const eses::Surface surface(given, {.probe_radius = 0, .added_radius = 1.4});
  for (std::size_t i = 0; i < grown.size(); ++i)
    CHECK(surface.atoms()[i].radius == grown[i].radius);
  const eses::Surface expected(grown, {.probe_radius = 0});
  CHECK(measure(surface).ses_area == measure(expected).ses_area);
  const auto kinds = [](const eses::Surface& of) {
    std::vector<std::pair<DiagnosticKind, std::uint64_t>> found;
    for (const Diagnostic& each : of.diagnostics()) found.emplace_back(each.kind, each.count);
    return found;
  };
  CHECK(kinds(surface) == kinds(eses::Surface(given)));
  CHECK(kinds(surface) != kinds(expected));
  for (const double bad : {-1.0, 1001.0, nan})
    CHECK(argument_error([&] {
            eses::Surface(given, {.added_radius = bad});
          }).starts_with("the added radius is"));
}

TEST_CASE("api: the surface of a file has its labels", "[api]") {
  AtomFile file = read_atoms(ESES_DATA "/fas2.pqr");
  const std::vector<AtomLabel> labels = file.labels;
  const eses::Surface copied(file, {.probe_radius = 2});
  CHECK(copied.probe_radius() == 2);
  CHECK(file.labels == labels);
  const eses::Surface moved(std::move(file));
  for (const eses::Surface& surface : {copied, moved}) {
    CHECK(surface.atoms().size() == labels.size());
    CHECK(std::vector<AtomLabel>(surface.labels().begin(), surface.labels().end()) == labels);
  }
  const TemporaryDirectory directory;
  const Grid grid = make_grid(moved, {.spacing = 1});
  Outputs outputs = Outputs::none();
  outputs.residues = true;
  CHECK_NOTHROW(write_files(moved, grid, directory.path(), outputs));
}

TEST_CASE("api: options and parts of compute may have any order", "[api]") {
  const eses::Surface surface(chain());
  const Grid grid = make_grid(surface);
  const RunOptions options{.region = GridRegion{{0, 0, 0}, {5, 6, 7}}};
  const ResultParts parts{.inside = false};
  const auto check = [&](const Result& result, bool has_inside, bool has_mesh, bool is_region) {
    CHECK(result.parts().inside == has_inside);
    CHECK(result.mesh().has_value() == has_mesh);
    CHECK((result.region().end == GridIndex{5, 6, 7}) == is_region);
  };
  check(eses::compute(surface, grid, {.mesh = true}), true, true, false);
  check(eses::compute(surface, grid, {.mesh = true}, options), true, true, true);
  check(eses::compute(surface, grid, parts), false, false, false);
  check(eses::compute(surface, grid, parts, {.threads = 1}), false, false, false);
  // The order of version 0.1.
  check(eses::compute(surface, grid, {}), true, false, false);
  check(eses::compute(surface, grid, {}, {}), true, false, false);
  check(eses::compute(surface, grid, {}, {.mesh = true}), true, true, false);
  check(eses::compute(surface, grid, options), true, false, true);
  check(eses::compute(surface, grid, options, parts), false, false, true);
  check(eses::compute(surface, grid, {.threads = 1}, parts), false, false, false);
}

TEST_CASE("api: the macros are the numbers of the version", "[api]") {
  CHECK(std::to_string(ESES_VERSION_MAJOR) + "." + std::to_string(ESES_VERSION_MINOR) + "." +
            std::to_string(ESES_VERSION_PATCH) ==
        eses::version);
}

TEST_CASE("api: all threads are the default of all options", "[api]") {
  CHECK(SurfaceOptions{}.threads == 0);
  CHECK(RunOptions{}.threads == 0);
  CHECK(MeasureOptions{}.threads == 0);
}

TEST_CASE("api: grids and regions are checked", "[api]") {
  const eses::Surface surface({{{0, 0, 0}, 1.5}});
  for (const double bad : {nan, infinity, -0.5, 0.0, 1e-300})
    CHECK(!argument_error([&] { make_grid(surface, {.spacing = bad}); }).empty());
  for (const double bad : {nan, infinity, -0.5, 0.0})
    CHECK(!argument_error([&] { make_grid(surface, {.spacing = 0.4, .margin = bad}); }).empty());
  const Grid sound = make_grid(surface);
  const auto refused = [&](const Grid& grid, const RunOptions& options) {
    const std::string message = argument_error([&] { eses::compute(surface, grid, options); });
    CHECK(argument_error([&] {
            for_each_block(
                surface, grid, [](const auto&) {}, options);
          }) == message);
    CHECK(argument_error([&] { estimate(surface, grid, {}, options); }) == message);
    CHECK(argument_error([&] { write_files(surface, grid, "/nowhere", {}, options); }) == message);
    return !message.empty();
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const std::int64_t bad : {std::int64_t{0}, std::int64_t{-3}, std::int64_t{1} << 40}) {
      Grid grid = sound;
      grid.size[axis] = bad;
      CHECK(refused(grid, {}));
    }
    for (const double bad : {nan, infinity}) {
      Grid grid = sound;
      grid.origin[axis] = bad;
      CHECK(refused(grid, {}));
    }
    GridRegion region = sound.whole();
    region.end[axis] += 1;
    CHECK(refused(sound, {.region = region}));
    region = sound.whole();
    region.begin[axis] = -1;
    CHECK(refused(sound, {.region = region}));
    region = sound.whole();
    region.begin[axis] = region.end[axis];
    CHECK(refused(sound, {.region = region}));
  }
  CHECK(refused({{0, 0, 0}, 0.5, {1900000000, 1900000000, 1000}}, {}));
  CHECK(refused(Grid{}, {}));
  for (const double bad : {nan, infinity, 0.0, -1.0})
    CHECK(refused({{0, 0, 0}, bad, {4, 4, 4}}, {}));
  CHECK(refused(sound, {.threads = -1}));
  for (const std::int64_t bad : {-1, 1, 4097}) CHECK(refused(sound, {.block_size = bad}));
  for (const std::int64_t bad : {-1, 10'000'001}) CHECK(refused(sound, {.verify = bad}));
  CHECK(!argument_error([&] { for_each_block(surface, sound, {}); }).empty());

  CHECK(eses::points_in_box(sound, sound.origin, sound.upper()) == sound.whole());
  CHECK(!argument_error([&] { eses::points_in_box(sound, {nan, 0, 0}, {1, 1, 1}); }).empty());
  CHECK(!argument_error([&] { eses::points_in_box(sound, {90, 0, 0}, {91, 1, 1}); }).empty());
}

TEST_CASE("api: outputs are checked", "[api]") {
  const eses::Surface surface({{{0, 0, 0}, 1.5}});
  const Grid grid = make_grid(surface);
  const TemporaryDirectory directory;
  const auto refused = [&](const Outputs& outputs) {
    return !argument_error([&] { write_files(surface, grid, directory.path(), outputs); }).empty();
  };
  CHECK(refused({.residues = true}));
  CHECK(refused({.inside_map = "map.txt"}));
  CHECK(refused({.inside_map = "below/map.dx"}));
  CHECK(refused({.dielectric = DielectricMaps{}}));
  CHECK(refused({.mesh = MeshOptions{}}));
  CHECK(refused({.mesh = MeshOptions{.file = "mesh.xyz"}}));
  CHECK(refused({.mesh = MeshOptions{.file = "mesh.ply", .color = MeshColor::chain}}));
  CHECK(refused({.mesh = MeshOptions{.file = "mesh.vtp", .is_ascii = true}}));
  CHECK(fs::is_empty(directory.path()));
  CHECK_THROWS_AS(write_files(surface, grid, "/dev/null/here"), Error);
  CHECK_THROWS_AS(eses::compute(surface, grid, {.max_memory = 1}), Error);
  const eses::Surface named({{{0, 0, 0}, 1.5}}, {AtomLabel{"A", "GLY", "1", "CA"}}, {});
  CHECK(write_files(named, grid, directory.path(), {.residues = true}).bytes_written > 0);
  CHECK(fs::exists(directory.path() / "residue_area.csv"));
  // Atoms without labels have a table, too.
  const Outputs table{.box = false, .grid = false, .edges = false, .areas = false, .atoms = true};
  CHECK(estimate(surface, grid, table).atoms_bytes > 0);
  CHECK(estimate(surface, grid, table).file_bytes() == estimate(surface, grid, table).atoms_bytes);
  const Summary written = write_files(surface, grid, directory.path(), table);
  CHECK(written.bytes_written == fs::file_size(directory.path() / "atoms.csv"));
}

TEST_CASE("api: objects that were moved from can be used without harm", "[api]") {
  eses::Surface surface({{{0, 0, 0}, 1.5}});
  const eses::Surface moved_to = std::move(surface);
  // NOLINTBEGIN(bugprone-use-after-move,hicpp-invalid-access-moved)
  CHECK(surface.atoms().size() == 1);
  CHECK(surface.diagnostics().empty());
  Result result = eses::compute(surface, make_grid(surface, {.spacing = 0.5}));
  const GridIndex point = result.region().begin;
  const Result taken = std::move(result);
  CHECK_FALSE(taken.is_inside(point));
  CHECK_THROWS_AS(result.is_inside(point), std::logic_error);
  CHECK_THROWS_AS(make_mesh(result), std::logic_error);
  CHECK(result.crossings().empty());
  CHECK(result.atom_areas().empty());
  // NOLINTEND(bugprone-use-after-move,hicpp-invalid-access-moved)
}

TEST_CASE("api: a result has only the chosen parts", "[api]") {
  const eses::Surface surface(chain());
  const Grid grid = make_grid(surface);
  const Result sums = eses::compute(surface, grid, {}, {.inside = false, .crossings = false});
  CHECK(sums.inside().empty());
  CHECK(sums.crossings().empty());
  CHECK(!sums.mesh());
  CHECK_THROWS_AS(sums.is_inside({0, 0, 0}), std::invalid_argument);
  const Result all = eses::compute(surface, grid);
  CHECK(all.area() == sums.area());
  CHECK_THROWS_AS(all.is_inside(grid.size), std::invalid_argument);
  CHECK_THROWS_AS(all.is_inside({-1, 0, 0}), std::invalid_argument);
  const Result mesh =
      eses::compute(surface, grid, {.inside = false, .crossings = false, .mesh = true});
  CHECK(mesh.inside().empty());
  CHECK(mesh.crossings().empty());
  CHECK(mesh.mesh()->vertices.size() == all.crossings().size());
}

TEST_CASE("api: callbacks are called one at a time and their exceptions reach the caller",
          "[api]") {
  const eses::Surface surface(chain());
  const Grid grid = make_grid(surface, {.spacing = 0.4});
  std::atomic<int> running = 0;
  std::atomic<std::int64_t> overlaps = 0, blocks = 0, progress = 0, checks = 0, waits = 0;
  // A thread that does not wait for the end of a call makes a call of its own meanwhile.
  const auto stay = [&](std::atomic<std::int64_t>& calls) {
    if (++running > 1) ++overlaps;
    if (++calls <= 20 && !wait_until_others_sleep()) ++waits;
    if (--running > 0) ++overlaps;
  };
  RunOptions options{.threads = 4, .block_size = 8, .verify = 100};
  options.progress = [&](std::int64_t, std::int64_t) { stay(progress); };
  options.verification_progress = [&](std::int64_t, std::int64_t) { stay(checks); };
  for_each_block(
      surface, grid, [&](const eses::Block&) { stay(blocks); }, options);
  const GridIndex expected = estimate(surface, grid, Outputs::none(), options).blocks;
  CHECK(blocks == expected[0] * expected[1] * expected[2]);
  CHECK(progress >= blocks);
  CHECK(overlaps == 0);
  CHECK(waits == 0);  // all others slept in time

  int calls = 0;
  const auto third_throws = [&](const eses::Block&) {
    if (++calls == 3) throw std::domain_error("three are enough");
  };
  CHECK_THROWS_AS(for_each_block(surface, grid, third_throws, {.threads = 4, .block_size = 8}),
                  std::domain_error);
  const TemporaryDirectory directory;
  options = {.block_size = 8};
  options.progress = [](std::int64_t done, std::int64_t) {
    if (done > 2) throw std::domain_error("two are enough");
  };
  CHECK_THROWS_WITH(write_files(surface, grid, directory.path(), {}, options), "two are enough");
  CHECK(!fs::exists(directory.path() / "bounding_box.txt"));
  CHECK_THROWS_WITH(eses::compute(surface, grid, options), "two are enough");
}

TEST_CASE("api: estimates bound or approximate the size of files", "[api]") {
  const eses::Surface surface(chain());
  const Grid grid = make_grid(surface, {.spacing = 0.3});
  const TemporaryDirectory directory;
  Outputs outputs;
  outputs.inside_map = "inside.dx";
  const Estimate expected = estimate(surface, grid, outputs, {.threads = 1});
  write_files(surface, grid, directory.path(), outputs, {.threads = 1});
  const auto size = [&](const char* name) { return fs::file_size(directory.path() / name); };
  CHECK(size("bounding_box.txt") == expected.box_bytes);
  CHECK(size("inside.dx") == expected.map_bytes);
  CHECK(size("grid_info.txt") <= expected.grid_bytes);
  CHECK(size("partition_area.txt") <= expected.areas_bytes);
  CHECK(expected.edges_bytes > size("intersection_info.txt") / 2);
  CHECK(expected.file_bytes() > expected.grid_bytes + expected.map_bytes);
  CHECK(expected.threads == 1);
  CHECK(expected.memory_bytes > 0);
  CHECK(expected.residues_bytes + expected.atoms_bytes + expected.mesh_bytes == 0);
}

}  // namespace eses::detail::test
