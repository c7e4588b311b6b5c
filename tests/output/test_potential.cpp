/// Tests of meshes with the values and colours of a potential.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "input/grid_reader.hpp"
#include "output/mesh_format.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/mesh_files.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

namespace fs = std::filesystem;

/// A function that linear interpolation along x, y and z reproduces on every grid.
double potential_at(const Vec3& p) {
  return 0.3 + 0.2 * p.x - 0.1 * p.y + 0.05 * p.z + 0.01 * p.x * p.y * p.z;
}

constexpr Vec3 map_origin{-60, -61, -62};
constexpr Vec3 map_spacing{5, 4, 2.5};
constexpr GridIndex map_size{25, 31, 49};

/// Returns a map of potential_at, with another spacing along each axis as in maps of APBS.
std::string map_text() {
  std::string text = fmt::format(
      "# Data from 3.4.1\n#\n# POTENTIAL (kT/e)\n#\n"
      "object 1 class gridpositions counts {0} {1} {2}\norigin {3} {4} {5}\ndelta {6} 0 0\n"
      "delta 0 {7} 0\ndelta 0 0 {8}\nobject 2 class gridconnections counts {0} {1} {2}\n"
      "object 3 class array type double rank 0 items {9} data follows\n",
      map_size[0], map_size[1], map_size[2], map_origin.x, map_origin.y, map_origin.z,
      map_spacing.x, map_spacing.y, map_spacing.z, map_size[0] * map_size[1] * map_size[2]);
  int column = 0;
  for (std::int64_t x = 0; x < map_size[0]; ++x)
    for (std::int64_t y = 0; y < map_size[1]; ++y)
      for (std::int64_t z = 0; z < map_size[2]; ++z) {
        const Vec3 steps{static_cast<double>(x) * map_spacing.x,
                         static_cast<double>(y) * map_spacing.y,
                         static_cast<double>(z) * map_spacing.z};
        text += fmt::format("{:.9e}{}", potential_at(map_origin + steps),
                            ++column % 3 == 0 ? "\n" : " ");
      }
  return text + "\nattribute \"dep\" string \"positions\"\n";
}

struct Colored {
  Mesh mesh;
  std::string bytes;
};

/// Returns a mesh with the format of this file name. The default limit is that of MeshPotential.
Colored run_colored(const Molecule& molecule, const Parameters& parameters,
                    const MeshOptions& choice, double offset = 0, double limit = 5) {
  const TemporaryDirectory directory;
  const fs::path map = directory.path() / "map.dx";
  write_file(map, map_text());
  MeshOptions mesh = choice;
  mesh.file = directory.path() / choice.file;
  mesh.color = MeshColor::potential;
  mesh.potential = MeshPotential{map, offset, limit};
  Outputs outputs = Outputs::none();
  outputs.mesh = mesh;
  run(molecule, parameters, outputs, directory.path());
  return {read_mesh(mesh.file), read_bytes(mesh.file)};
}

/// Returns the message of the error for a map with this text.
std::string error_of(const std::string& text) {
  const TemporaryDirectory directory;
  write_file(directory.path() / "a.dx", text);
  try {
    const PotentialMap map(directory.path() / "a.dx", 0);
  } catch (const Error& error) {
    const std::string message = error.what();
    const std::string name = (directory.path() / "a.dx").string();
    REQUIRE(message.starts_with(name));
    return message.substr(name.size());
  }
  return "";
}

std::string replaced(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  REQUIRE(at != std::string::npos);
  return text.replace(at, part.size(), by);
}

}  // namespace

TEST_CASE("potential: vertices have the values and colours of the map", "[mesh][potential]") {
  const Molecule molecule(make_chain(60, 11));
  const double limit = 2;
  for (const double offset : {0.0, 1.5})
    for (const MeshOptions& choice :
         {MeshOptions{"a.ply"}, MeshOptions{"a.ply", MeshColor::potential, true},
          MeshOptions{"a.vtp"}}) {
      INFO(choice.file << ", offset " << offset);
      const Mesh mesh = run_colored(molecule, {}, choice, offset, limit).mesh;
      REQUIRE(mesh.potentials.size() == mesh.positions.size());
      REQUIRE(mesh.colors.size() == mesh.positions.size());
      double largest = 0;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const double expected = potential_at(mesh.positions[v] + offset * mesh.normals[v]);
        largest = std::max(largest, std::fabs(expected));
        REQUIRE(std::fabs(mesh.potentials[v] - expected) < 1e-4);
        const mesh::Color color = mesh::potential_color(expected, limit);
        for (std::size_t part = 0; part < 3; ++part)
          REQUIRE(std::abs(mesh.colors[v][part] - color[part]) <= 1);
      }
      CHECK(largest > limit);  // some colours are those of the ends
    }
}

TEST_CASE("potential: formats without attributes have only colours", "[mesh][potential]") {
  const Molecule molecule(make_chain(30, 4));
  const auto colors = [&](const char* name) {
    const Mesh mesh = run_colored(molecule, {}, {name}).mesh;
    CHECK(mesh.potentials.empty() == (std::string(name) != "a.ply"));
    return mesh.colors;
  };
  const auto expected = colors("a.ply");
  CHECK(colors("a.obj") == expected);
  CHECK(colors("a.glb").size() == expected.size());
}

TEST_CASE("potential: the scale is red, white and blue", "[potential]") {
  using mesh::potential_color;
  for (const double limit : {0.5, 5.0}) {
    CHECK(potential_color(-limit, limit) == mesh::Color{200, 20, 30});
    CHECK(potential_color(0, limit) == mesh::Color{248, 248, 248});
    CHECK(potential_color(limit, limit) == mesh::Color{25, 50, 205});
    CHECK(potential_color(-9 * limit, limit) == potential_color(-limit, limit));
    CHECK(potential_color(9 * limit, limit) == potential_color(limit, limit));
    CHECK(potential_color(0.75 * limit, limit) ==
          mesh::Color{83, 110, 225});  // half of two colours
  }
}

TEST_CASE("potential: the bytes do not depend on threads and block size", "[mesh][potential]") {
  const Molecule molecule(make_chain(120, 20180102));
  for (const char* name : {"a.ply", "a.vtp"}) {
    Parameters parameters;
    parameters.threads = 1;
    const auto bytes = [&] { return run_colored(molecule, parameters, {name}, 1).bytes; };
    const std::string expected = bytes();
    REQUIRE(expected.size() > 10000);
    for (const auto& [threads, block_size] : {std::pair(1, 2), std::pair(3, 9), std::pair(4, 33)}) {
      INFO(name << ", " << threads << " threads, block size " << block_size);
      parameters.threads = threads;
      parameters.block_size = block_size;
      const bool same = bytes() == expected;
      CHECK(same);
    }
  }
}

TEST_CASE("potential: the map ends before the mesh", "[mesh][potential]") {
  const auto atoms_at = [](double x) { return Molecule({{{x, 0, 0}, 1.5}}); };
  // The map ends at x = 60.
  CHECK_NOTHROW(run_colored(atoms_at(58.4), {}, {"a.ply"}));
  CHECK_NOTHROW(run_colored(atoms_at(57.4), {}, {"a.ply"}, 1));
  for (const auto& [x, offset] : {std::pair(58.9, 0.0), std::pair(57.9, 1.0), std::pair(80.0, 0.0)})
    CHECK_THROWS_WITH(run_colored(atoms_at(x), {}, {"a.ply"}, offset),
                      Catch::Matchers::EndsWith(
                          "map.dx: the mesh has points outside of the map, which is from -60 -61 "
                          "-62 to 60 59 58 (angstrom); use a larger map"));
}

TEST_CASE("potential: the estimated memory includes the map", "[plan][potential]") {
  const Molecule molecule(make_chain(30, 4));
  const TemporaryDirectory directory;
  const auto map = directory.path() / "map.dx";
  write_file(map, map_text());
  Outputs outputs = Outputs::none();
  outputs.mesh = MeshOptions{directory.path() / "a.ply", MeshColor::patch};
  const std::uint64_t without = make_plan(molecule, {.threads = 1}, outputs).schedule.memory_bytes;
  outputs.mesh->color = MeshColor::potential;
  outputs.mesh->potential = MeshPotential{map};
  const std::uint64_t values = 4ULL * 25 * 31 * 49;
  CHECK(make_plan(molecule, {.threads = 1}, outputs).schedule.memory_bytes == without + values);
  // The values of a map are refused before they are read if they do not fit.
  const std::string header =
      replaced(replaced(map_text().substr(0, map_text().find("data follows\n") + 13), "items 37975",
                        "items 1000000000000"),
               "counts 25 31 49", "counts 10000 10000 10000");
  write_file(map, header);
  CHECK_THROWS_WITH(
      make_plan(molecule, {}, outputs),
      Catch::Matchers::ContainsSubstring("map.dx: the map of the potential needs 4 TB of"));
  write_file(map, replaced(replaced(header, "10000 10000 10000", "1000 1000 1000"), "1000000000000",
                           "1000000000"));
  CHECK_THROWS_WITH(make_plan(molecule, {.max_memory = 1 << 28}, outputs),
                    Catch::Matchers::ContainsSubstring("exceeds the memory limit of 256 MiB"));
}

TEST_CASE("potential: faulty maps are refused with the line", "[potential]") {
  const std::string map = map_text();
  CHECK(error_of(map).empty());
  for (const auto& [part, by, message] :
       {std::tuple{"counts 25 31 49\norigin", "counts 25 1 49\norigin",
                   ":9: expected at least two points along x, y and z"},
        {"items 37975", "items 37974", ":11: expected 37975 items, a value for each point"},
        {"items 37975", "things",
         ":11: items: expected a finite number, found the end of the line"},
        {"delta 0 4 0", "delta 0 4 1",
         ":8: the axes of the grid must be those of the coordinates, in the order x, y, z"},
        {"delta 0 4 0", "delta 0 -4 0",
         ":9: expected a positive spacing along x, y and z, found 5, -4 and 2.5"},
        {"data follows\n", "data follows\nnan ",
         ":12: potential: expected a finite number, found \"nan\""},
        {"data follows\n", "data follows\n1e40 ", ":12: potential: the number is too large"},
        {"data follows", "data",
         ": expected a line that ends with 'data follows', before the "
         "values of an OpenDX map"}}) {
    INFO(by);
    const std::string found = error_of(replaced(map, part, by));
    CHECK(contains(found, message));
  }
  const std::string short_map = map.substr(0, map.find("attribute") - 100);
  CHECK(contains(error_of(short_map.substr(0, short_map.rfind('\n') + 1)),
                 "expected a value for each point"));
}

TEST_CASE("potential: wrong options of the library are refused", "[potential]") {
  const Molecule molecule(make_chain(3, 1));
  const auto refused = [&](const MeshOptions& mesh) {
    Outputs outputs = Outputs::none();
    outputs.mesh = mesh;
    try {
      make_plan(molecule, {}, outputs);
    } catch (const std::invalid_argument&) {
      return true;
    } catch (const Error&) {  // there is no map
    }
    return false;
  };
  const MeshPotential map{"no.dx"};
  CHECK_FALSE(refused({"a.ply", MeshColor::potential, false, false, map}));
  CHECK(refused({"a.ply", MeshColor::potential}));
  CHECK(refused({"a.ply", MeshColor::patch, false, false, map}));
  CHECK(refused({"a.ply", MeshColor::potential, false, false, MeshPotential{"no.dx", -1}}));
  CHECK(refused({"a.ply", MeshColor::potential, false, false, MeshPotential{"no.dx", 0, 0}}));
  CHECK(refused({"a.ply", MeshColor::potential, false, false, MeshPotential{"no.dx", NAN}}));
}

TEST_CASE("potential: long lines and tabs are read, vectors and surplus values refused",
          "[potential]") {
  const TemporaryDirectory directory;
  const fs::path path = directory.path() / "a.dx";
  const auto identity = [&](const std::string& text) {
    write_file(path, text);
    return PotentialMap(path, 0).identity();
  };
  const auto error = [&](const std::string& text) -> std::string {
    try {
      identity(text);
    } catch (const Error& fault) {
      return fault.what();
    }
    return "";
  };
  const std::string map = map_text(), expected = identity(map);
  const std::size_t values = map.find("data follows\n") + 13, end = map.find("\nattribute");
  std::string line = map;
  std::replace(line.begin() + static_cast<std::ptrdiff_t>(values),
               line.begin() + static_cast<std::ptrdiff_t>(end), '\n', ' ');
  CHECK(identity(line) == expected);
  std::string tabs = map;
  std::replace(tabs.begin(), tabs.end(), ' ', '\t');
  CHECK(identity(tabs) == expected);
  // Comments may have any length, also more than the reader has in memory at a time.
  for (const std::size_t length : {5000U, 100000U, 600000U}) {
    const std::string comment = "# " + std::string(length, 'x') + "\n";
    std::string commented = comment + map;
    commented.insert(commented.find("object 3"), comment);
    CHECK(identity(commented) == expected);
    CHECK(contains(error(comment.substr(0, length)), "a.dx:1: the line has no end"));
  }
  std::string vectors = map;
  vectors.replace(vectors.find("rank 0"), 6, "rank 1 shape 3");
  CHECK(
      contains(error(vectors), "the map has vectors; expected a map of a potential, with rank 0"));
  std::string surplus = map;
  surplus.insert(end, "\n1.5");
  CHECK(contains(error(surplus), "more than 37975 values, one for each point"));
  surplus = map;
  surplus.insert(end, " 1.5");
  CHECK(contains(error(surplus), "more than 37975 values"));
}

// --- the program --------------------------------------------------------------------------------

TEST_CASE("potential: the program reports the limits", "[potential][cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "map.dx", map_text());
  Arguments arguments{"pair.xyzr",   "--mesh", "a.ply",   "--color", "potential",
                      "--potential", "map.dx", "--write", "none"};
  const Outcome text = sandbox.run(arguments);
  REQUIRE(text.code == 0);
  CHECK(contains(text.out,
                 "\npotential: colours from -5 (red) to 5 kT/e (blue), 0 angstrom outside\n"));
  for (const char* more : {"--potential-offset", "1", "--potential-limit", "2.5", "--json"})
    arguments.emplace_back(more);
  const Outcome json = sandbox.run(arguments);
  REQUIRE(json.code == 0);
  check_json(sandbox, json.out, "r['mesh']['potential']",
             "{'file': 'map.dx', 'offset': 1, 'limits': [-2.5, 2.5]}");
}

TEST_CASE("potential: wrong combinations are refused", "[potential][cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "map.dx", map_text());
  const auto check = [&](const Arguments& more, const std::string& message) {
    Arguments arguments{"pair.xyzr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_usage_error(sandbox, arguments, message);
  };
  check({"--mesh", "a.ply", "--color", "potential"},
        "--color potential needs --potential with a map of the potential");
  check({"--mesh", "a.ply", "--potential", "map.dx"}, "--potential needs --color potential");
  check({"--mesh", "a.ply", "--potential-offset", "1"},
        "--potential-offset needs --color potential");
  check({"--mesh", "a.ply", "--color", "patch", "--potential-limit", "1"},
        "--potential-limit needs --color potential");
  check({"--mesh", "a.off", "--color", "potential", "--potential", "map.dx"},
        "--color needs --mesh with a .ply, .obj, .vtp or .glb file");
  check({"--mesh", "a.ply", "--color", "potential", "--potential", "map.vti"},
        "--potential is 'map.vti', expected a file name with the suffix .dx or .dx.gz");
  check({"--mesh", "a.ply", "--color", "potential", "--potential", "map.dx", "--potential-limit",
         "0"},
        "--potential-limit is '0', expected a finite number greater than 0, in kT/e");
  const Outcome missing =
      sandbox.run({"pair.xyzr", "--mesh", "a.ply", "--color", "potential", "--potential", "no.dx"});
  CHECK(missing.code == 1);
  CHECK(contains(missing.err, "no.dx"));
  CHECK(sandbox.files().empty());
  const Outcome overwritten = sandbox.run({"pair.xyzr", "--mesh", "a.ply", "--color", "potential",
                                           "--potential", "map.dx", "--inside", "map.dx"});
  CHECK(overwritten.code == 1);
  CHECK(contains(overwritten.err, "map.dx is the file of --potential, and would be overwritten"));
}

}  // namespace eses::detail::test
