// Tests of callbacks that end an operation, of errors that have a kind, and of functions for
// callers that hold results in other forms, such as the Python package.

#include <atomic>
#include <cstdint>
#include <fstream>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "catch.hpp"
#include "eses/eses.hpp"
#include "input/read_structure.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

struct Stop {};

/// A callback that throws at its n-th call, and counts its calls.
class StopAt {
 public:
  explicit StopAt(int n) : n_(n) {}
  CheckCallback callback() {
    return [this] {
      if (++calls_ == n_) throw Stop();
    };
  }
  int calls() const { return calls_; }

 private:
  int n_;
  std::atomic<int> calls_ = 0;
};

constexpr int never = -1;

std::vector<Atom> lattice(int side) {
  std::vector<Atom> atoms;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        atoms.push_back({{3.1 * x, 3.1 * y, 3.1 * z}, 1.5 + 0.01 * (x % 7)});
  return atoms;
}

Grid grid_of(const eses::Surface& surface, double spacing) {
  return make_grid(surface, {.spacing = spacing, .margin = 2 * spacing});
}

template <class Expected>
bool throws(const std::function<void()>& action) {
  try {
    action();
  } catch (const Expected&) {
    return true;
  }
  return false;
}

}  // namespace

TEST_CASE("checks: a callback ends the indexing of atoms", "[api]") {
  const std::vector<Atom> atoms = lattice(25);
  for (const int threads : {1, 2}) {
    StopAt counter(never);
    const eses::Surface surface(atoms, {.threads = threads, .check = counter.callback()});
    // There is one call for every few thousand atoms.
    CHECK(counter.calls() > 4);
    for (int n = 1; n <= counter.calls(); ++n) {
      StopAt stop(n);
      CHECK_THROWS_AS(eses::Surface(atoms, {.threads = threads, .check = stop.callback()}), Stop);
    }
  }
}

TEST_CASE("checks: an exception of a callback is not taken for an invalid argument", "[api]") {
  const CheckCallback fail = [] { throw Error("enough"); };
  CHECK(throws<Error>([&] { eses::Surface({{{0, 0, 0}, 1}}, {.check = fail}); }));
}

TEST_CASE("checks: a callback ends the reading of a file", "[api]") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "atoms.xyzr";
  std::ofstream file(path);
  for (int i = 0; i < 200000; ++i) file << "1.25 2.5 3.75 1.5\n";
  file.close();
  StopAt counter(never);
  CHECK(read_atoms(path, {.check = counter.callback()}).atoms.size() == 200000);
  CHECK(counter.calls() > 1);
  StopAt stop(counter.calls());
  CHECK_THROWS_AS(read_atoms(path, {.check = stop.callback()}), Stop);
}

TEST_CASE("checks: progress is reported while crossings are sorted and the mesh is made", "[api]") {
  const eses::Surface surface(lattice(6));
  const Grid grid = grid_of(surface, 0.25);
  std::int64_t at_end = 0;
  const RunOptions options{.threads = 1, .progress = [&](std::int64_t done, std::int64_t total) {
                             if (done == total) ++at_end;
                           }};
  const Result result = compute(surface, grid, options, {.mesh = true});
  // There is a call for each plane of the mesh. There are more crossings than are sorted between
  // two calls.
  REQUIRE(result.crossings().size() > 30000);
  CHECK(at_end > grid.size[2] + 2);
}

TEST_CASE("api: the mesh of a result is that of a computation with mesh", "[api]") {
  const eses::Surface surface(lattice(3));
  const Grid grid = grid_of(surface, 0.5);
  const GridRegion region{{2, 3, 4}, {17, 20, 21}};
  for (const auto& part : {std::optional<GridRegion>(), std::optional(region)}) {
    const Result result = compute(surface, grid, {.region = part}, {.mesh = true});
    const Mesh mesh = make_mesh(result);
    REQUIRE(result.mesh().has_value());
    CHECK(mesh.vertices == result.mesh()->vertices);
    CHECK(mesh.normals == result.mesh()->normals);
    CHECK(mesh.atoms == result.mesh()->atoms);
    CHECK(mesh.patches == result.mesh()->patches);
    CHECK(mesh.faces == result.mesh()->faces);
    CHECK(mesh.faces.size() > 100);
  }
  const Result result = compute(surface, grid);
  StopAt stop(3);
  CHECK_THROWS_AS(make_mesh(result, stop.callback()), Stop);
  for (const ResultParts& parts : {ResultParts{.inside = false}, ResultParts{.crossings = false}}) {
    const Result lacking = compute(surface, grid, {}, parts);
    CHECK(lacking.parts().inside == parts.inside);
    CHECK_THROWS_AS(make_mesh(lacking), std::invalid_argument);
  }
}

TEST_CASE("api: the inside of a block is a part of that of the result", "[api]") {
  const eses::Surface surface(lattice(3));
  const Grid grid = grid_of(surface, 0.5);
  const Result result = compute(surface, grid);
  std::int64_t points = 0;
  const auto compare = [&](const eses::Block& block) {
    const std::vector<std::uint8_t> inside = block.owned_inside();
    const auto& [begin, end] = block.owned();
    REQUIRE(static_cast<std::int64_t>(inside.size()) == block.owned().point_count());
    std::size_t place = 0;
    bool is_equal = true;
    for (std::int64_t z = begin[2]; z < end[2]; ++z)
      for (std::int64_t y = begin[1]; y < end[1]; ++y)
        for (std::int64_t x = begin[0]; x < end[0]; ++x)
          is_equal = is_equal && (inside[place++] != 0) == result.is_inside({x, y, z});
    CHECK(is_equal);
    points += block.owned().point_count();
  };
  for_each_block(surface, grid, compare, {.threads = 1, .block_size = 9});
  CHECK(points == grid.point_count());
}

TEST_CASE("api: a range of blocks has the points that its blocks own", "[api]") {
  // 100 points make (100 - 2) / 15 + 1 = 7 blocks of 16 points; the last owns the far face.
  const Grid grid{{0, 0, 0}, 0.5, {100, 31, 2}};
  CHECK(points_of_blocks(grid, 16, {{0, 0, 0}, {7, 2, 1}}) == grid.whole());
  CHECK(points_of_blocks(grid, 16, {{2, 1, 0}, {4, 2, 1}}) == GridRegion{{30, 15, 0}, {60, 31, 2}});
  CHECK(points_of_blocks(grid, 16, {{6, 0, 0}, {7, 1, 1}}) == GridRegion{{90, 0, 0}, {100, 15, 2}});
  const auto is_refused = [&](std::int64_t block_size, const BlockRange& blocks) {
    return throws<std::invalid_argument>([&] { points_of_blocks(grid, block_size, blocks); });
  };
  CHECK(is_refused(16, {{0, 0, 0}, {8, 1, 1}}));
  CHECK(is_refused(16, {{-1, 0, 0}, {1, 1, 1}}));
  CHECK(is_refused(16, {{1, 0, 0}, {1, 1, 1}}));
  CHECK(is_refused(1, {{0, 0, 0}, {1, 1, 1}}));
  CHECK(is_refused(4097, {{0, 0, 0}, {1, 1, 1}}));
}

TEST_CASE("api: grids are validated", "[api]") {
  CHECK_NOTHROW(validate({{0, 0, 0}, 0.5, {1, 1, 1}}));
  for (const Grid& grid : {Grid{{0, 0, 0}, 0, {1, 1, 1}}, Grid{{0, 0, 0}, -1, {1, 1, 1}},
                           Grid{{0, 0, 0}, 0.5, {0, 1, 1}}, Grid{{1e308, 0, 0}, 1e308, {9, 1, 1}},
                           Grid{{0, 0, 0}, 0.5, {2000000000, 2000000000, 2}}})
    CHECK_THROWS_AS(validate(grid), std::invalid_argument);
}

TEST_CASE("api: errors of files have the code of the operating system", "[api]") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "missing.xyzr";
  try {
    read_atoms(path);
    FAIL("a missing file was read");
  } catch (const FileError& error) {
    CHECK(error.code() == std::errc::no_such_file_or_directory);
    CHECK(std::string(error.what()) ==
          "cannot open " + path.string() + ": No such file or directory");
  }
  const eses::Surface surface({{{0, 0, 0}, 2}});
  std::ofstream(directory.path() / "file") << "not a directory\n";
  CHECK_THROWS_AS(write_files(surface, grid_of(surface, 1), directory.path() / "file/out"),
                  FileError);
  std::ofstream(path) << "0 0 0\n";
  CHECK(throws<Error>([&] { read_atoms(path); }));
  CHECK_FALSE(throws<FileError>([&] {
    try {
      read_atoms(path);
    } catch (const FileError&) {
      throw;
    } catch (const Error&) {  // for errors in the text
    }
  }));
}

TEST_CASE("api: options of structures are checked", "[api]") {
  if (eses::detail::gemmi_version().empty()) SKIP("this build has no gemmi");
  const std::string text =
      "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n";
  const auto parse = [&](const StructureOptions& options) {
    return parse_atoms(text, AtomFormat::pdb, "text", options);
  };
  StructureOptions options;
  CHECK(parse(options).atoms.size() == 1);
  options.unknown_radius = 0;
  CHECK(parse(options).atoms.size() == 1);
  for (const double radius : {std::numeric_limits<double>::quiet_NaN(), -1.0, -1e-300, 2e6,
                              std::numeric_limits<double>::infinity()}) {
    options.unknown_radius = radius;
    CHECK_THROWS_AS(parse(options), std::invalid_argument);
  }
  options = {};
  options.model = -1;
  CHECK_THROWS_AS(parse(options), std::invalid_argument);
  options = {};
  options.altloc = "AB";
  CHECK_THROWS_AS(parse(options), std::invalid_argument);
  const TemporaryDirectory directory;
  const auto path = directory.path() / "a.pdb";
  std::ofstream(path) << text;
  ReadOptions reading;
  reading.structure = options;
  CHECK_THROWS_AS(read_atoms(path, reading), std::invalid_argument);
}

TEST_CASE("api: too little memory throws MemoryLimitError", "[api]") {
  const eses::Surface surface({{{0, 0, 0}, 2}});
  const Grid grid = grid_of(surface, 0.05);
  try {
    compute(surface, grid, {.max_memory = 1 << 20});
    FAIL("a limit was not kept");
  } catch (const MemoryLimitError& error) {
    const std::string message = error.what();
    INFO(message);
    CHECK(message.find("; use a limit of at least ") != std::string::npos);
    CHECK(message.find("--") == std::string::npos);  // the options of the program
  }
  CHECK_THROWS_AS(compute(surface, {{0, 0, 0}, 1e-3, {100000, 100000, 100000}}), MemoryLimitError);
}

}  // namespace eses::detail::test
