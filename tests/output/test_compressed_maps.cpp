// Tests of compressed maps: they have the text of plain maps, and the plan bounds their memory.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/eses.hpp"
#include "output/file.hpp"
#include "output/grid_map.hpp"
#include "output/output_directory.hpp"
#include "output/output_files.hpp"
#include "run/plan.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/sanitizers.hpp"
#include "support/temporary_directory.hpp"
#include "system/gzip.hpp"

namespace eses::detail::test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> map_names{"inside.dx", "kappa.dx", "diel_x.dx", "diel_y.dx",
                                         "diel_z.dx"};

Outputs all_maps(bool gzip) {
  Outputs outputs = Outputs::none();
  outputs.gzip = gzip;
  outputs.inside_map = gzip ? "inside.dx.gz" : "inside.dx";
  outputs.dielectric = DielectricMaps{"diel_"};
  outputs.ion_access = IonAccessMap{gzip ? "kappa.dx.gz" : "kappa.dx"};
  return outputs;
}

void write_maps(const std::vector<Atom>& atoms, const Parameters& parameters, bool gzip,
                const fs::path& directory) {
  const Outputs outputs = all_maps(gzip);
  const RunPlan plan = make_plan(atoms, parameters, outputs);
  const Summary summary = run(atoms, plan.parameters, outputs, directory);
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(directory)) bytes += entry.file_size();
  CHECK(summary.bytes_written == bytes);
}

}  // namespace

TEST_CASE("compressed maps have the text of plain ones, whatever computes them",
          "[maps][solver-maps][gzip]") {
  // Several cells along x, and several slices for each x.
  const std::vector<Atom> atoms = make_chain(60, 3);
  Parameters parameters;
  grid_options(parameters).spacing = 0.22;
  parameters.threads = 1;
  const TemporaryDirectory directory;
  const fs::path plain = directory.path() / "plain";
  write_maps(atoms, parameters, false, plain);
  const Grid grid = make_plan(atoms, parameters, Outputs::none()).grid;
  REQUIRE(grid.size[0] > 64);
  REQUIRE(grid.size[1] * grid.size[2] > std::int64_t{1} << 13);
  std::vector<std::string> expected;
  for (const int threads : {1, 3})
    for (const std::int64_t block_size : {8, 33, 128}) {
      INFO(threads << " threads, block size " << block_size);
      parameters.threads = threads;
      parameters.block_size = block_size;
      const fs::path packed = directory.path() / "packed";
      write_maps(atoms, parameters, true, packed);
      for (std::size_t map = 0; map < map_names.size(); ++map) {
        INFO(map_names[map]);
        const fs::path path = packed / (map_names[map] + ".gz");
        const std::string bytes = read_bytes(path);
        if (expected.size() == map) {
          expected.push_back(bytes);
          const bool is_same_text = read_gzipped(path) == read_bytes(plain / map_names[map]);
          CHECK(is_same_text);
          CHECK(bytes.size() < fs::file_size(plain / map_names[map]) / 5);
        }
        const bool is_same = bytes == expected[map];
        CHECK(is_same);
      }
      fs::remove_all(packed);
    }
}

TEST_CASE("compressed maps with any values, from several slices", "[maps][gzip]") {
  Random random(23);
  for (const MapQuantity quantity : {MapQuantity::inside, MapQuantity::dielectric_y})
    for (const GridIndex& size : {GridIndex{3, 300, 400}, {130, 5, 7}, {70, 60, 90}, {1, 1, 1}}) {
      INFO(size[0] << " x " << size[1] << " x " << size[2]);
      Grid grid;
      grid.spacing = 0.5;
      grid.size = size;
      const auto rows = static_cast<std::uint32_t>(size[1] * size[2]);
      const std::uint32_t half = rows / 2;
      // Rows of one value among random ones, in two parts.
      std::array<MapRows, 2> parts;
      for (std::uint32_t row = 0; row < rows; ++row) {
        auto& [bits, partial_edges] = parts[row < half ? 0 : 1];
        const bool is_uniform = row < half || random.chance(0.5);
        const std::uint64_t value = random.chance(0.5) ? 0 : ~std::uint64_t{0};
        for (std::uint32_t x = 0; x < static_cast<std::uint32_t>(size[0]); ++x) {
          if (x % 64 == 0)
            bits.push_back(is_uniform ? value : random.integer(0, ~std::uint64_t{0} >> 1));
          if (is_uniform || !is_of_edges(quantity) || random.chance(0.5)) continue;
          bits.back() &= ~(std::uint64_t{1} << (x % 64));
          partial_edges.push_back({row < half ? row : row - half, x,
                                   static_cast<std::uint32_t>(random.integer(1, whole_edge - 1))});
        }
      }
      const TemporaryDirectory directory;
      const OutputDirectory place(directory.path());
      MapChoice choice{quantity, "map.dx", MapFormat::dx, 2, 80, false};
      for (const bool gzip : {false, true}) {
        choice.gzip = gzip;
        OutputFile file(place, gzip ? "packed.dx.gz" : "plain.dx");
        GridMap map(choice, "solvent excluded surface", grid, grid.whole());
        map.add_rows(half, parts[1]);
        map.add_rows(0, parts[0]);
        map.write(file, 3, [] {});
        const std::uint64_t bytes = file.size();
        file.close();
        file.commit();
        CHECK(bytes == fs::file_size(file.path()));
      }
      const bool is_same = read_gzipped(directory.path() / "packed.dx.gz") ==
                           read_bytes(directory.path() / "plain.dx");
      CHECK(is_same);
    }
}

TEST_CASE("the plan knows about how long compressed maps are, and what they need for a while",
          "[maps][gzip][plan]") {
  const std::vector<Atom> atoms = read_atoms(fs::path(ESES_DATA) / "1ubq.xyzr").atoms;
  Parameters parameters;
  for (const double spacing : {0.4, 0.8}) {
    INFO(spacing);
    grid_options(parameters).spacing = spacing;
    const Outputs outputs = all_maps(true);
    const RunPlan plan = make_plan(atoms, parameters, outputs);
    const TemporaryDirectory directory;
    const Summary summary = run(atoms, plan.parameters, outputs, directory.path());
    CHECK(plan.files.maps == plan.files.gzip_maps);
    CHECK(summary.bytes_written < plan.files.maps);
    CHECK(plan.files.maps < 2 * summary.bytes_written);
    const std::vector<DiskSpace> disk = require_disk_space(plan.files, outputs, directory.path());
    CHECK(disk[0].expected == plan.files.maps);
    RunPlan large = plan;
    large.files.maps += std::uint64_t{1} << 61;
    large.files.gzip_maps += std::uint64_t{1} << 61;
    CHECK_NOTHROW(require_disk_space(large.files, outputs, directory.path()));
  }
}

TEST_CASE("maps of the dielectric exist in one form at a time", "[solver-maps][gzip]") {
  const TemporaryDirectory directory;
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  for (const bool gzip : {false, true, false}) {
    Outputs outputs = Outputs::none();
    outputs.dielectric = DielectricMaps{"d"};
    outputs.gzip = gzip;
    run(atoms, {}, outputs, directory.path());
    for (const std::string name : {"dx.dx", "dy.dx", "dz.dx"}) {
      CHECK(fs::exists(directory.path() / name) == !gzip);
      CHECK(fs::exists(directory.path() / (name + ".gz")) == gzip);
    }
  }
}

TEST_CASE("the program names compressed maps", "[solver-maps][gzip][cli]") {
  const Sandbox sandbox;
  Arguments arguments{"pair.xyzr", "--write",      "none", "-o",      "out",
                      "--gzip",    "--dielectric", "d",    "--kappa", "k.dx.gz"};
  arguments.insert(arguments.end(), {"--inside", "i.dx.gz"});
  Arguments dry = arguments;
  dry.emplace_back("--dry-run");
  CHECK(contains(sandbox.run(dry).out, "i.dx.gz, k.dx.gz, dx.dx.gz, dy.dx.gz, dz.dx.gz about "));
  const Outcome outcome = sandbox.run(arguments);
  REQUIRE(outcome.code == 0);
  for (const char* const name : {"i.dx.gz", "k.dx.gz", "dx.dx.gz", "dy.dx.gz", "dz.dx.gz"})
    CHECK(read_gzipped(sandbox.directory() / "out" / name).starts_with("# "));
  // The grid of a compressed map can be chosen for the next run.
  CHECK(sandbox.run({"pair.xyzr", "--grid-like", "out/k.dx.gz", "-o", "again"}).code == 0);
}

TEST_CASE("what is planned bounds what runs with maps hold", "[solver-maps][cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  for (const std::string gzip : {"", "--gzip"})
    for (const std::string block_size : {"16", "64"})
      for (const int threads : {1, 3}) {
        Arguments arguments{std::string(ESES_DATA) + "/1ubq.xyzr",
                            "--spacing",
                            "0.15",
                            "--block-size",
                            block_size,
                            "--threads",
                            std::to_string(threads),
                            "--write",
                            "none",
                            "--json",
                            "--dielectric",
                            "d",
                            "--kappa",
                            gzip.empty() ? "k.dx" : "k.dx.gz"};
        if (!gzip.empty()) arguments.push_back(gzip);
        INFO(Sandbox::command(arguments));
        const Outcome outcome = sandbox.run(arguments);
        REQUIRE(outcome.code == 0);
        const std::string ratio = "r['plan']['memory_bytes'] / r['peak_memory_bytes']";
        check_json(sandbox, outcome.out, ratio + " >= 1", "True");
        // Several threads may hold much less than is possible.
        if (threads == 1) check_json(sandbox, outcome.out, ratio + " < 2.1", "True");
      }
}

TEST_CASE("a disk that plain maps would fill is refused before anything is written",
          "[solver-maps][plan]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  Outputs outputs = Outputs::none();
  outputs.dielectric = DielectricMaps{"d"};
  Parameters parameters;
  const TemporaryDirectory directory;
  const std::vector<DiskSpace> disk =
      require_disk_space(make_plan(atoms, parameters, outputs).files, outputs, directory.path());
  // The maps in memory take a hundredth of the files.
  if (disk[0].available > std::uint64_t{1} << 38)
    SKIP("the file system has too much free space, or does not report it");
  // Three maps with 13 bytes an edge, on a grid of which the molecule takes a small part; twice
  // what is free, because other programs may delete files meanwhile.
  const auto planes = static_cast<std::int64_t>(2 * disk[0].available / (3 * 13 * 1'000'000)) + 1;
  parameters.grid = Grid{{-5, -5, -5}, 0.01, {1000, 1000, planes}};
  const RunPlan plan = make_plan(atoms, parameters, outputs);
  CHECK(plan.files.maps >= 2 * disk[0].available);
  CHECK_THROWS_WITH(
      run(atoms, plan.parameters, outputs, directory.path() / "out"),
      Catch::Matchers::ContainsSubstring("the files need about ") &&
          Catch::Matchers::EndsWith(" free; use a larger spacing or compress the files"));
  CHECK_FALSE(fs::exists(directory.path() / "out"));
}

}  // namespace eses::detail::test
