// Reads the inside map back with code that knows the formats but shares nothing with the program.

#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "output/file.hpp"
#include "output/grid_map.hpp"
#include "output/output_directory.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

/// A map as another program reads it: the places of its points and their values.
struct ReadMap {
  GridIndex size{};
  Vec3 origin, spacing;
  std::vector<int> values;  // x fastest, then y, then z
};

/// Reads as APBS does: word by word, with comments only before the first object.
ReadMap parse_dx(const std::string& text) {
  std::istringstream stream(text);
  std::string line, word;
  std::size_t max_length = 0;
  while (stream.peek() == '#') std::getline(stream, line);
  const auto expect = [&](std::string_view words) {
    std::istringstream wanted{std::string(words)};
    for (std::string want; wanted >> want;) {
      stream >> word;
      REQUIRE(word == want);
    }
  };
  ReadMap map;
  expect("object 1 class gridpositions counts");
  for (auto& n : map.size) stream >> n;
  expect("origin");
  stream >> map.origin.x >> map.origin.y >> map.origin.z;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    expect("delta");
    Vec3 delta;
    stream >> delta.x >> delta.y >> delta.z;
    map.spacing[axis] = delta[axis];
    delta[axis] = 0;
    REQUIRE(delta == Vec3{});
  }
  expect("object 2 class gridconnections counts");
  for (const auto n : map.size) {
    std::int64_t again = 0;
    stream >> again;
    REQUIRE(again == n);
  }
  expect("object 3 class array type double rank 0 items");
  std::int64_t items = 0;
  stream >> items;
  REQUIRE(items == map.size[0] * map.size[1] * map.size[2]);
  expect("data follows");
  map.values.resize(static_cast<std::size_t>(items));
  for (std::int64_t x = 0; x < map.size[0]; ++x)
    for (std::int64_t y = 0; y < map.size[1]; ++y)
      for (std::int64_t z = 0; z < map.size[2]; ++z) {
        double value = -1;
        stream >> value;
        const std::int64_t place = (z * map.size[1] + y) * map.size[0] + x;
        map.values[static_cast<std::size_t>(place)] = static_cast<int>(value);
      }
  expect(R"(attribute "dep" string "positions")");
  expect("object \"regular positions regular connections\" class field");
  expect("component \"positions\" value 1");
  expect("component \"connections\" value 2");
  expect("component \"data\" value 3");
  CHECK_FALSE(stream >> word);
  // VMD reads lines of up to 84 characters with three values each.
  std::istringstream lines(text);
  std::int64_t lines_of_values = 0;
  for (; std::getline(lines, line);) {
    max_length = std::max(max_length, line.size());
    if (line.find_first_not_of("01 ") == std::string::npos) ++lines_of_values;
  }
  CHECK(max_length < 84);
  CHECK(lines_of_values == (items + 2) / 3);
  return map;
}

std::string attribute(const std::string& text, const std::string& element,
                      const std::string& name) {
  const auto begin = text.find("<" + element + " ");
  REQUIRE(begin != std::string::npos);
  const std::string tag = text.substr(begin, text.find('>', begin) - begin);
  const auto value = tag.find(" " + name + "=\"");
  REQUIRE(value != std::string::npos);
  const auto first = value + name.size() + 3;
  return tag.substr(first, tag.find('"', first) - first);
}

ReadMap parse_vti(const std::string& text) {
  CHECK(attribute(text, "VTKFile", "type") == "ImageData");
  CHECK(attribute(text, "VTKFile", "byte_order") == "LittleEndian");
  REQUIRE(attribute(text, "VTKFile", "header_type") == "UInt64");
  REQUIRE(attribute(text, "DataArray", "type") == "UInt8");
  REQUIRE(attribute(text, "DataArray", "format") == "appended");
  REQUIRE(attribute(text, "DataArray", "offset") == "0");
  REQUIRE(attribute(text, "AppendedData", "encoding") == "raw");
  CHECK(attribute(text, "DataArray", "Name") == attribute(text, "PointData", "Scalars"));
  CHECK(attribute(text, "Piece", "Extent") == attribute(text, "ImageData", "WholeExtent"));
  ReadMap map;
  std::istringstream extent(attribute(text, "Piece", "Extent"));
  std::istringstream origin(attribute(text, "ImageData", "Origin"));
  std::istringstream spacing(attribute(text, "ImageData", "Spacing"));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::int64_t first = 0, last = 0;
    extent >> first >> last;
    origin >> map.origin[axis];
    spacing >> map.spacing[axis];
    map.size[axis] = last - first + 1;
    map.origin[axis] += static_cast<double>(first) * map.spacing[axis];
  }
  const std::size_t begin = text.find('_', text.find("<AppendedData")) + 1;
  std::uint64_t bytes = 0;
  for (std::size_t b = 8; b-- > 0;)
    bytes = bytes << 8 | static_cast<unsigned char>(text.at(begin + b));
  REQUIRE(bytes == static_cast<std::uint64_t>(map.size[0] * map.size[1] * map.size[2]));
  for (const char value : text.substr(begin + 8, bytes)) map.values.push_back(value);
  CHECK(text.substr(begin + 8 + bytes) == "\n  </AppendedData>\n</VTKFile>\n");
  return map;
}

ReadMap parse(const std::string& name, const std::string& text) {
  return name.ends_with(".dx") ? parse_dx(text) : parse_vti(text);
}

std::string map_of(const std::vector<Atom>& atoms, const Parameters& parameters,
                   const std::string& name) {
  const TemporaryDirectory directory;
  Outputs outputs = Outputs::none();
  outputs.inside_map = name;
  const RunPlan plan = make_plan(atoms, parameters, outputs);
  const Summary summary = run(atoms, plan.parameters, outputs, directory.path());
  std::string bytes = read_bytes(directory.path() / name);
  CHECK(plan.files.maps == bytes.size());
  CHECK(summary.bytes_written == bytes.size());
  return bytes;
}

}  // namespace

TEST_CASE("the inside map has the points of grid_info.txt", "[maps]") {
  std::size_t endings = 0;  // bits: last lines with one, two or three values occur
  // The sets that the seeds give depend on the compiler.
  for (std::uint64_t seed = 0; seed < 6 || (endings != 7 && seed < 40); ++seed) {
    const std::vector<Atom> atoms = make_chain(10 + 7 * (seed % 6), seed);
    Parameters parameters;
    grid_options(parameters).spacing = 0.37 + 0.05 * static_cast<double>(seed % 6);
    const EsesFiles files = run_and_read(atoms, parameters).files;
    endings |= std::size_t{1} << files.points.size() % 3;
    for (const std::string name : {"map.dx", "map.vti"}) {
      INFO(name << ", seed " << seed);
      const ReadMap map = parse(name, map_of(atoms, parameters, name));
      CHECK(map.size == files.size);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        CHECK(map.origin[axis] == Catch::Approx(files.lower[axis]).margin(1e-12));
        CHECK(map.spacing[axis] == Catch::Approx(grid_options(parameters).spacing));
      }
      REQUIRE(map.values.size() == files.points.size());
      std::size_t different = 0;
      for (std::size_t p = 0; p < map.values.size(); ++p)
        different += map.values[p] != (files.points[p].sign > 0 ? 1 : 0);
      CHECK(different == 0);
    }
  }
  CHECK(endings == 7);
}

TEST_CASE("the map does not depend on threads and block size", "[maps]") {
  const std::vector<Atom> atoms = make_chain(80, 3);
  for (const std::string name : {"map.dx", "map.vti"}) {
    Parameters parameters;
    parameters.threads = 1;
    const std::string expected = map_of(atoms, parameters, name);
    for (const int threads : {1, 3})
      for (const std::int64_t block_size : {9, 33, 1000}) {
        INFO(name << ", " << threads << " threads, block size " << block_size);
        parameters.threads = threads;
        parameters.block_size = block_size;
        const bool same = map_of(atoms, parameters, name) == expected;
        CHECK(same);
      }
  }
}

TEST_CASE("rows of a map may come in any order and are transposed in several tiles", "[maps]") {
  Random random(17);
  for (const GridIndex& size : {GridIndex{3, 300, 400}, {130, 5, 7}, {64, 2, 70000}, {1, 1, 1}}) {
    INFO(size[0] << " x " << size[1] << " x " << size[2]);
    Grid grid;
    grid.spacing = 0.5;
    grid.size = {200, 400, 80000};
    const GridRegion region{{2, 3, 4}, {2 + size[0], 3 + size[1], 4 + size[2]}};
    const auto per_row = static_cast<std::size_t>((size[0] + 63) / 64);
    const auto rows = static_cast<std::size_t>(size[1] * size[2]);
    std::vector<std::uint64_t> words;
    std::vector<int> expected;
    for (std::size_t row = 0; row < rows; ++row) {
      words.resize(words.size() + per_row);
      for (std::int64_t x = 0; x < size[0]; ++x) {
        expected.push_back(random.chance(0.4) ? 1 : 0);
        if (expected.back() == 1)
          words[row * per_row + static_cast<std::size_t>(x / 64)] |= std::uint64_t{1} << (x % 64);
      }
    }
    for (const std::string name : {"map.dx", "map.vti"}) {
      const TemporaryDirectory directory;
      {
        const OutputDirectory place(directory.path());
        OutputFile file(place, name);
        GridMap map({MapQuantity::inside, name, *map_format(name)}, "solvent excluded surface",
                    grid, region);
        const std::size_t step = 1 + rows / 7;
        for (std::size_t end = rows; end > 0;) {
          const std::size_t begin = end > step ? end - step : 0;
          const auto part = std::span(words).subspan(begin * per_row, (end - begin) * per_row);
          map.add_rows(static_cast<std::int64_t>(begin), {{part.begin(), part.end()}, {}});
          end = begin;
        }
        map.write(file, 3, [] {});
        file.close();
        file.commit();
      }
      const ReadMap map = parse(name, read_bytes(directory.path() / name));
      CHECK(map.size == size);
      CHECK(map.origin == Vec3{1, 1.5, 2});
      const bool same = map.values == expected;
      CHECK(same);
    }
  }
}

TEST_CASE("a run with maps leaves nothing if it is ended at any moment", "[maps][gzip]") {
  const std::vector<Atom> atoms = make_chain(20, 4);
  Outputs plain;
  plain.inside_map = "map.dx";
  Outputs compressed = Outputs::none();
  compressed.gzip = true;
  compressed.inside_map = "map.dx.gz";
  compressed.dielectric = DielectricMaps{"diel_"};
  compressed.ion_access = IonAccessMap{"kappa.dx.gz"};
  Parameters parameters;
  parameters.threads = 1;
  for (const Outputs& outputs : {plain, compressed}) {
    const TemporaryDirectory directory;
    const RunPlan plan = make_plan(atoms, parameters, outputs);
    int calls = 0;
    run(atoms, plan.parameters, outputs, directory.path() / "whole",
        {.progress = [&](std::int64_t, std::int64_t) { ++calls; }});
    REQUIRE(calls > 12);
    for (int last = 1; last <= calls; ++last) {
      INFO("call " << last << " of " << calls);
      int call = 0;
      const auto end_it = [&](std::int64_t, std::int64_t) {
        if (++call == last) throw std::runtime_error("ended");
      };
      CHECK_THROWS_AS(
          run(atoms, plan.parameters, outputs, directory.path() / "ended", {.progress = end_it}),
          std::runtime_error);
      CHECK(std::filesystem::is_empty(directory.path() / "ended"));
    }
  }
}

TEST_CASE("the suffix of a map decides its format", "[maps]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  Outputs outputs;
  for (const std::string name : {"map", "map.DX", "dx", "map.vti.gz", "map.gz"}) {
    outputs.inside_map = name;
    CHECK_THROWS_AS(make_plan(atoms, {}, outputs), std::invalid_argument);
  }
}

TEST_CASE("the next run removes the parts of a map that a killed run has left", "[maps]") {
  const TemporaryDirectory directory;
  for (const char* left : {".old.dx.123.part", ".old.vti.7.part", ".grid_info.txt.gz.5.part"})
    std::ofstream(directory.path() / left) << "left";
  for (const char* other : {".old.png.123.part", ".old.dx.part", ".dx.1x.part", "old.dx"})
    std::ofstream(directory.path() / other) << "not ours";
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  run(atoms, {}, {}, directory.path());
  const auto files = std::distance(std::filesystem::directory_iterator(directory.path()), {});
  CHECK(files == 4 + 4);
  CHECK(std::filesystem::exists(directory.path() / ".old.png.123.part"));
}

}  // namespace eses::detail::test
