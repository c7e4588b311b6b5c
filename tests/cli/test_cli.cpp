// Tests of the real program: command line, exit codes, both reports, and the use of the streams.

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "cli/command.hpp"
#include "cli/report.hpp"
#include "input/read_structure.hpp"
#include "run/engine.hpp"
#include "support/sandbox.hpp"
#include "support/sanitizers.hpp"
#include "support/temporary_directory.hpp"
#include "system/resources.hpp"

namespace fs = std::filesystem;

namespace {

using namespace eses::detail::test;

const std::set<std::string> all_files{"bounding_box.txt", "grid_info.txt", "intersection_info.txt",
                                      "partition_area.txt"};

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (contains(line, part)) lines.push_back(line);
  }
  return lines;
}

/// Returns the value after `key` in the only line that contains it, as callers of ESES look for it.
double value_of(const std::string& text, const std::string& key) {
  const std::vector<std::string> lines = lines_with(text, key);
  REQUIRE(lines.size() == 1);
  return std::stod(lines[0].substr(lines[0].find(key) + key.size()));
}

std::string result_lines(const Outcome& outcome) {
  REQUIRE(outcome.code == 0);
  std::string result;
  for (const std::string key : {"area:", "volume:"}) {
    for (const std::string& line : lines_with(outcome.out, key)) result += line + "\n";
  }
  return result;
}

std::string usage_message(const std::string& message) {
  return "eses-blocks: error: " + message + "\nTry 'eses-blocks --help'.\n";
}

}  // namespace

TEST_CASE("help names every option with unit and default, examples and exit codes", "[cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"--help"});
  CHECK(outcome.code == 0);
  CHECK(outcome.err.empty());
  CHECK(sandbox.run({"-h"}).out == outcome.out);
  CHECK(sandbox.run({"--spacing", "0", "--help", "--other"}).out == outcome.out);
  for (const std::string part : {"Usage: eses-blocks [OPTIONS] FILE [PROBE [SPACING [MARGIN]]]\n",
                                 "--probe-radius ANGSTROM ",
                                 " radius of the solvent probe, 0.01 to 1000 [1.4]\n",
                                 "--spacing ANGSTROM ",
                                 " distance between grid points, > 0 [0.4]\n",
                                 "--margin ANGSTROM ",
                                 " distance from molecule to grid boundary, >= 0 [0.8]\n",
                                 "-o, --output-dir DIR",
                                 "-t, --threads N",
                                 "-b, --block-size N",
                                 "2 to 4096\n",
                                 " [automatic; 64 with --blocks]\n",
                                 "--format NAME",
                                 "--write LIST",
                                 "--mesh FILE",
                                 "--color NAME",
                                 "--potential FILE",
                                 "--potential-offset ANGSTROM",
                                 "--potential-limit KT/E",
                                 "--inside FILE",
                                 "--gzip",
                                 "--independent",
                                 "--region X0,Y0,Z0,X1,Y1,Z1",
                                 "--blocks I0:I1,J0:J1,K0:K1",
                                 "residue_area.csv",
                                 "atoms.csv",
                                 "--max-memory BYTES",
                                 "powers of 1024",
                                 "--dry-run",
                                 "--strict",
                                 "--verify[=N] ",
                                 "-q, --quiet",
                                 "--json",
                                 "--version",
                                 "-h, --help",
                                 "Examples:\n  eses-blocks ",
                                 "Exit codes:\n  0  done\n  1  ",
                                 "  2  "}) {
    INFO(part);
    CHECK(contains(outcome.out, part));
  }
  CHECK_FALSE(contains(outcome.out, "\n\n\n"));
}

TEST_CASE("version names compiler, build type and flags", "[cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"--version"});
  CHECK(outcome.code == 0);
  CHECK(outcome.err.empty());
  CHECK(outcome.out.rfind("eses-blocks ", 0) == 0);
  for (const std::string part : {"\ncompiler: ", "\nbuild type: ", "\nflags: "}) {
    CHECK(contains(outcome.out, part));
  }
}

TEST_CASE("usage errors name option, value and expectation, and write nothing", "[cli]") {
  const Sandbox sandbox;
  const std::string above_zero = ", expected a finite number greater than 0, in angstrom";
  const std::string probe_range = ", expected a number from 0.01 to 1000, in angstrom";
  const std::string at_least_zero = ", expected a finite number of at least 0, in angstrom";
  const std::string map_name = ", expected a file name with the suffix .dx, .dx.gz or .vti";
  const std::string six_numbers =
      ", expected six finite numbers x0,y0,z0,x1,y1,z1 in angstrom, x0 <= x1 and so on";
  const std::string ranges =
      ", expected i0:i1,j0:j1,k0:k1, whole numbers from 0, i0 < i1 and so on";
  const std::string bytes = ", expected a whole number of bytes above 0, or one with K, M, G or T";
  const std::vector<std::pair<Arguments, std::string>> cases{
      {{}, "FILE is required"},
      {{""}, "FILE is '', expected a file"},
      {{"atom.xyzr", "1.4", "0.4", "0.8", "7"},
       "unexpected argument '7' after FILE, PROBE, SPACING and MARGIN"},
      {{"atom.xyzr", "--colour"}, "unknown option '--colour'; did you mean --color?"},
      {{"atom.xyzr", "-x"}, "unknown option '-x'"},
      {{"--spcing", "0.5", "atom.xyzr"}, "unknown option '--spcing'; did you mean --spacing?"},
      {{"atom.xyzr", "1.4", "-.5"},
       "unexpected negative number '-.5' among FILE, PROBE, SPACING and MARGIN"},
      {{"atom.xyzr", "0x1p1"}, "PROBE is '0x1p1'" + probe_range},
      {{"atom.xyzr", " 1.4"}, "PROBE is ' 1.4'" + probe_range},
      {{"atom.xyzr", "-1.4"}, "PROBE is '-1.4'" + probe_range},
      {{"atom.xyzr", "1.4", "-0.4"}, "SPACING is '-0.4'" + above_zero},
      {{"atom.xyzr", "1.4", "0.4", "-0.8"}, "MARGIN is '-0.8'" + at_least_zero},
      {{"atom.xyzr", "0"}, "PROBE is '0'" + probe_range},
      {{"atom.xyzr", "1.4A"}, "PROBE is '1.4A'" + probe_range},
      {{"atom.xyzr", ""}, "PROBE is ''" + probe_range},
      {{"atom.xyzr", "1.4", "nan"}, "SPACING is 'nan'" + above_zero},
      {{"atom.xyzr", "1.4", "0.4", "inf"}, "MARGIN is 'inf'" + at_least_zero},
      {{"atom.xyzr", "--spacing", "0"}, "--spacing is '0'" + above_zero},
      {{"atom.xyzr", "--spacing", "0.4A"}, "--spacing is '0.4A'" + above_zero},
      {{"atom.xyzr", "--spacing", "0,4"}, "--spacing is '0,4'" + above_zero},
      {{"atom.xyzr", "--spacing=1e400"}, "--spacing is '1e400'" + above_zero},
      {{"atom.xyzr", "--probe-radius", "-1.4"}, "--probe-radius is '-1.4'" + probe_range},
      {{"atom.xyzr", "0.005"}, "PROBE is '0.005'" + probe_range},
      {{"atom.xyzr", "nan"}, "PROBE is 'nan'" + probe_range},
      {{"atom.xyzr", "--margin", "-1"}, "--margin is '-1'" + at_least_zero},
      {{"atom.xyzr", "--margin"}, "--margin needs a value"},
      {{"--output-dir=", "atom.xyzr"}, "--output-dir= needs a value"},
      {{"atom.xyzr", "-o", ""}, "--output-dir is '', expected a directory"},
      {{"atom.xyzr", "1.4", "--probe-radius", "1.5"},
       "PROBE is 1.4 but --probe-radius is 1.5; use only one of them"},
      {{"atom.xyzr", "1.4", "0.4", "--spacing", "0.5"},
       "SPACING is 0.4 but --spacing is 0.5; use only one of them"},
      {{"atom.xyzr", "1.4", "0.4", "0.8", "--margin", "0"},
       "MARGIN is 0.8 but --margin is 0; use only one of them"},
      {{"atom.xyzr", "--spacing", "0.4", "--spacing", "0.5"}, "--spacing is given more than once"},
      {{"atom.xyzr", "-b", "1"}, "--block-size is '1', expected a whole number from 2 to 4096"},
      {{"atom.xyzr", "-b", "4097"},
       "--block-size is '4097', expected a whole number from 2 to 4096"},
      {{"atom.xyzr", "-b", "64.0"},
       "--block-size is '64.0', expected a whole number from 2 to 4096"},
      {{"atom.xyzr", "-t", "0x2"}, "--threads is '0x2', expected a whole number from 1 to 4096"},
      {{"atom.xyzr", "-t", "0"}, "--threads is '0', expected a whole number from 1 to 4096"},
      {{"atom.xyzr", "-t", "-2"}, "--threads is '-2', expected a whole number from 1 to 4096"},
      {{"atom.xyzr", "-t", "99999999999999999999"},
       "--threads is '99999999999999999999', expected a whole number from 1 to 4096"},
      {{"atom.xyzr", "--max-memory", "0"}, "--max-memory is '0'" + bytes},
      {{"atom.xyzr", "--max-memory", "-1G"}, "--max-memory is '-1G'" + bytes},
      {{"atom.xyzr", "--max-memory", "2GB"}, "--max-memory is '2GB'" + bytes},
      {{"atom.xyzr", "--max-memory", "1.5G"}, "--max-memory is '1.5G'" + bytes},
      {{"atom.xyzr", "--max-memory", "G"}, "--max-memory is 'G'" + bytes},
      {{"atom.xyzr", "--max-memory", ""}, "--max-memory is ''" + bytes},
      {{"atom.xyzr", "--max-memory", "16777216T"}, "--max-memory is '16777216T'" + bytes},
      {{"atom.xyzr", "--max-memory", "1G", "--max-memory", "2G"},
       "--max-memory is given more than once"},
      {{"atom.xyzr", "--dry-run=yes"}, "--dry-run takes no value"},
      {{"atom.xyzr", "--strict=1"}, "--strict takes no value"},
      {{"atom.xyzr", "--format", "gro"},
       "--format is 'gro', expected auto, xyzr, pqr, pdb or mmcif"},
      {{"atom.xyzr", "--write", "faces"},
       "--write is 'faces', expected some of grid,edges,areas,residues,atoms, or all, or none"},
      {{"atom.xyzr", "--write", "grid,none"},
       "--write is 'grid,none', expected some of grid,edges,areas,residues,atoms, or all, or none"},
      {{"atom.xyzr", "--write", ""},
       "--write is '', expected some of grid,edges,areas,residues,atoms, or all, or none"},
      {{"atom.xyzr", "--inside", "map.txt"}, "--inside is 'map.txt'" + map_name},
      {{"atom.xyzr", "--inside", ".dx"}, "--inside is '.dx'" + map_name},
      {{"atom.xyzr", "--inside", "a/.vti"}, "--inside is 'a/.vti'" + map_name},
      {{"atom.xyzr", "--inside", ""}, "--inside is ''" + map_name},
      {{"atom.xyzr", "--inside", "a/map.dx", "-o", "b"},
       "--inside is 'a/map.dx', but the output directory is b; use the file name alone or "
       "--output-dir a"},
      {{"atom.xyzr", "--inside", "a.dx", "--inside", "b.dx"}, "--inside is given more than once"},
      {{"atom.xyzr", "--gzip=9"}, "--gzip takes no value"},
      {{"atom.xyzr", "--region", "0,0,0,1,1"}, "--region is '0,0,0,1,1'" + six_numbers},
      {{"atom.xyzr", "--region", "0,0,0,1,1,1,1"}, "--region is '0,0,0,1,1,1,1'" + six_numbers},
      {{"atom.xyzr", "--region", "0,2,0,1,1,1"}, "--region is '0,2,0,1,1,1'" + six_numbers},
      {{"atom.xyzr", "--region", "0,0,0,1,1,nan"}, "--region is '0,0,0,1,1,nan'" + six_numbers},
      {{"atom.xyzr", "--region", "0 0 0 1 1 1"}, "--region is '0 0 0 1 1 1'" + six_numbers},
      {{"atom.xyzr", "--blocks", "0:1,0:1"}, "--blocks is '0:1,0:1'" + ranges},
      {{"atom.xyzr", "--blocks", "0:1,0:1,1:1"}, "--blocks is '0:1,0:1,1:1'" + ranges},
      {{"atom.xyzr", "--blocks", "0:1,-1:1,0:1"}, "--blocks is '0:1,-1:1,0:1'" + ranges},
      {{"atom.xyzr", "--blocks", "0,0,0"}, "--blocks is '0,0,0'" + ranges},
      {{"atom.xyzr", "--blocks", "0:1,0:1,0:1", "--region", "0,0,0,1,1,1"},
       "--region excludes --blocks; use only one of them"},
      {{"atom.xyzr", "--json=no"}, "--json takes no value"},
      {{"atom.xyzr", "--fill-cavities=-1"},
       "--fill-cavities is '-1', expected a number of at least 0, in cubic angstrom"},
      {{"atom.xyzr", "--fill-cavities=nan"},
       "--fill-cavities is 'nan', expected a number of at least 0, in cubic angstrom"},
      {{"atom.xyzr", "--fill-cavities", "20.5"},
       "--fill-cavities takes its number after '='; use --fill-cavities=20.5, as 20.5 is a "
       "positional argument"},
      {{"atom.xyzr", "--verify=0"}, "--verify is '0', expected a whole number from 1 to 10000000"},
      {{"atom.xyzr", "--verify=all"},
       "--verify is 'all', expected a whole number from 1 to 10000000"},
      {{"atom.xyzr", "--verify", "--verify=3"}, "--verify is given more than once"},
      {{"atom.xyzr", "--verify", "100"},
       "--verify takes its number after '='; use --verify=100, as 100 is a positional argument"},
  };
  for (const auto& [arguments, message] : cases) {
    check_usage_error(sandbox, arguments, message);
  }
  CHECK(sandbox.files().empty());
}

TEST_CASE("a run does not overwrite its input", "[cli]") {
  const Sandbox sandbox;
  const std::string atoms = "0 0 0 1.5\n";
  for (const std::string name : {"grid_info.txt", "a.obj"}) {
    write_file(sandbox.directory() / name, atoms);
    const Outcome outcome = sandbox.run({name, "--mesh", "a.obj"});
    CHECK(outcome.code == 1);
    CHECK(contains(outcome.err, name + " is the input, and would be overwritten"));
    CHECK(read_file(sandbox.directory() / name) == atoms);
    fs::remove(sandbox.directory() / name);
  }
}

TEST_CASE("a build without gemmi refuses PDB and mmCIF files", "[cli]") {
  if (!eses::detail::gemmi_version().empty()) SKIP("this build has gemmi");
  const Sandbox sandbox;
  for (const std::string name : {"a.pdb", "a.cif"}) {
    write_file(sandbox.directory() / name, "data_x\n");
    const Outcome outcome = sandbox.run({name});
    CHECK(outcome.code == 1);
    CHECK(outcome.err ==
          "eses-blocks: error: " + name +
              ": this build reads xyzr and PQR; for PDB and mmCIF install gemmi-dev and "
              "tao-pegtl-dev (libgemmi-dev in later releases of Debian and Ubuntu) and build "
              "eses-blocks again\n");
    CHECK_FALSE(fs::exists(sandbox.directory() / "bounding_box.txt"));
  }
}

TEST_CASE("the version line names the formats that the build reads", "[cli]") {
  const std::string version = std::string(eses::detail::gemmi_version());
  CHECK(contains(Sandbox().run({"--version"}).out,
                 version.empty() ? "\nreads: xyzr and PQR (built without gemmi)\n"
                                 : "\nreads: xyzr, PQR, PDB and mmCIF (gemmi " + version + ")\n"));
}

TEST_CASE("a run does not overwrite any file that it reads", "[cli]") {
  if (eses::detail::gemmi_version().empty()) SKIP("this build has no gemmi");
  const Sandbox sandbox;
  const fs::path root = sandbox.directory();
  write_file(root / "atom.pdb",
             "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n");
  const std::string radii = "types:\nC 1.9 apolar\natoms:\nANY CA C\n";
  write_file(root / "my.dx", radii);
  fs::create_hard_link(root / "my.dx", root / "hard.dx");
  fs::create_symlink("my.dx", root / "soft.dx");
  fs::create_symlink("my.dx", root / "mesh.obj");
  for (const auto& [read, written] : {std::pair("my.dx", Arguments{"--inside", "my.dx"}),
                                      std::pair("my.dx", Arguments{"--inside", "hard.dx"}),
                                      std::pair("soft.dx", Arguments{"--inside", "my.dx"}),
                                      std::pair("hard.dx", Arguments{"--mesh", "mesh.obj"})}) {
    Arguments arguments{"atom.pdb", "--radii", read};
    arguments.insert(arguments.end(), written.begin(), written.end());
    const Outcome outcome = sandbox.run(arguments);
    INFO(outcome.err);
    CHECK(outcome.code == 1);
    CHECK(contains(outcome.err, "is the file of --radii, and would be overwritten"));
    CHECK(read_file(root / "my.dx") == radii);
  }
  CHECK(sandbox.run({"atom.pdb", "--radii", "my.dx", "-q"}).code == 0);
}

TEST_CASE("a run does not overwrite its standard input", "[cli]") {
  const Sandbox sandbox;
  const std::string atoms = "0 0 0 1.5\n";
  write_file(sandbox.directory() / "a.obj", atoms);
  const Outcome outcome = sandbox.run({"-", "--mesh", "a.obj"}, "<a.obj");
  CHECK(outcome.code == 1);
  CHECK(contains(outcome.err, "a.obj is the input, and would be overwritten"));
  CHECK(read_file(sandbox.directory() / "a.obj") == atoms);
}

TEST_CASE("a run does not remove its input with the chunks of --resume", "[cli]") {
  const Sandbox sandbox;
  const std::string atoms = "0 0 0 1.5\n";
  fs::create_directory(sandbox.directory() / ".eses-blocks.resume");
  const std::string name = ".eses-blocks.resume/a.xyzr";
  write_file(sandbox.directory() / name, atoms);
  const Outcome outcome = sandbox.run({name});
  CHECK(outcome.code == 1);
  CHECK(contains(outcome.err, name + " is the input, and would be removed"));
  CHECK(read_file(sandbox.directory() / name) == atoms);
}

TEST_CASE("a run does not remove its input when it writes the other form of the file", "[cli]") {
  const Sandbox sandbox;
  const std::string atoms = "0 0 0 1.5\n";
  for (const auto& [name, gzip] :
       {std::pair("partition_area.txt", true), std::pair("partition_area.txt.gz", false)}) {
    write_file(sandbox.directory() / name, atoms);
    Arguments arguments{name, "--format", "xyzr"};
    if (gzip) arguments.emplace_back("--gzip");
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == 1);
    INFO(outcome.err);
    CHECK(contains(outcome.err, std::string(name) + " is the input, and would be removed, as a " +
                                    (gzip ? "gzipped" : "plain") + " file takes its place"));
    CHECK(read_file(sandbox.directory() / name) == atoms);
    // If the file is not written, its other form stays.
    arguments.insert(arguments.end(), {"--write", "edges"});
    CHECK(sandbox.run(arguments).code == 0);
    CHECK(read_file(sandbox.directory() / name) == atoms);
    fs::remove(sandbox.directory() / name);
  }
}

TEST_CASE("an instruction set that does not exist is refused", "[cli]") {
  REQUIRE(::setenv("ESES_INSTRUCTION_SET", "AVX2", 1) == 0);
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"atom.xyzr"});
  REQUIRE(::unsetenv("ESES_INSTRUCTION_SET") == 0);
  CHECK(outcome.code == 2);
  CHECK(contains(outcome.err,
                 "ESES_INSTRUCTION_SET is 'AVX2', expected baseline, sse4, avx2 or "
                 "avx512"));
}

TEST_CASE("negative numbers are not taken for options", "[cli]") {
  const Sandbox sandbox;
  for (const std::string number : {"-1", "-.5", "-0.5", "-1e3", "-inf", "-nan"}) {
    INFO(number);
    const Outcome outcome = sandbox.run({"atom.xyzr", "1.4", number});
    CHECK(outcome.code == 2);
    CHECK(contains(outcome.err, "'" + number + "'"));
    CHECK(contains(outcome.err, "SPACING"));
    CHECK_FALSE(contains(outcome.err, "unknown"));
  }
}

TEST_CASE("input and output errors end with code 1, one line and no files", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "empty.xyzr", "");
  write_file(sandbox.directory() / "words.xyzr", "0 0 zero 1.5\n");
  for (const Arguments& arguments :
       {Arguments{"missing.xyzr"}, Arguments{"miss\ning.xyzr"}, Arguments{"empty.xyzr"},
        Arguments{"words.xyzr"}, Arguments{"."}, Arguments{"atom.xyzr", "-o", "atom.xyzr"},
        Arguments{"atom.xyzr", "--spacing", "1e-9"}}) {
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == 1);
    CHECK(outcome.err.rfind("eses-blocks: error: ", 0) == 0);
    CHECK(outcome.err.find('\n') + 1 == outcome.err.size());
    CHECK(lines_with(outcome.out, "area:").empty());
  }
  CHECK(contains(sandbox.run({"missing.xyzr"}).err, "missing.xyzr"));
  CHECK(sandbox.files().empty());
}

TEST_CASE("one atom's area and volume are near those of a sphere", "[cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"atom.xyzr", "1.4", "0.1", "0.8"});
  REQUIRE(outcome.code == 0);
  CHECK(outcome.err.empty());
  const double area = 4 * std::numbers::pi * 1.5 * 1.5;
  CHECK(std::fabs(value_of(outcome.out, "area:") / area - 1) < 0.01);
  CHECK(std::fabs(value_of(outcome.out, "volume:") / (area * 1.5 / 3) - 1) < 0.01);
  CHECK(lines_with(outcome.out, "area:")[0].rfind("surface area: ", 0) == 0);
  CHECK(lines_with(outcome.out, "volume:")[0].rfind("surface volume: ", 0) == 0);
  CHECK(sandbox.files() == all_files);
}

TEST_CASE("the report says which of its two volumes is the accurate one", "[cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"atom.xyzr", "1.4", "0.4", "0.8"});
  REQUIRE(outcome.code == 0);
  const double exact = 4 * std::numbers::pi / 3 * std::pow(1.5, 3);
  const std::string accurate = "divergence theorem: ";
  CHECK(std::fabs(value_of(outcome.out, accurate) - exact) <
        std::fabs(value_of(outcome.out, "volume:") - exact) / 5);
  CHECK(contains(lines_with(outcome.out, accurate).at(0),
                 "the accurate volume (surface volume is ESES's formula)"));
}

TEST_CASE("positional arguments, options and defaults have the same effect", "[cli]") {
  const Sandbox sandbox;
  const std::string defaults = result_lines(sandbox.run({"pair.xyzr"}));
  CHECK(result_lines(sandbox.run({"pair.xyzr", "1.4", "0.4", "0.8"})) == defaults);
  CHECK(result_lines(sandbox.run({"pair.xyzr", "--probe-radius=1.4", "--margin", "0.80",
                                  "--spacing", "4e-1"})) == defaults);
  const std::string fine = result_lines(sandbox.run({"pair.xyzr", "1.5", "0.25", "1"}));
  CHECK(fine != defaults);
  CHECK(result_lines(sandbox.run(
            {"--spacing", "0.25", "--margin", "1", "--probe-radius", "1.5", "pair.xyzr"})) == fine);
  CHECK(result_lines(sandbox.run({"pair.xyzr", "1.5", "--spacing", "0.25", "--probe-radius", "1.50",
                                  "--margin", "1"})) == fine);
}

TEST_CASE("quiet prints only the two result lines", "[cli]") {
  const Sandbox sandbox;
  const Outcome full = sandbox.run({"pair.xyzr"});
  const Outcome quiet = sandbox.run({"pair.xyzr", "--quiet"});
  CHECK(quiet.out == result_lines(full));
  CHECK(quiet.err.empty());
  CHECK(sandbox.run({"missing.xyzr", "-q"}).err.rfind("eses-blocks: error: ", 0) == 0);
}

TEST_CASE("a grid that cuts the molecule produces a warning, unless quiet", "[cli]") {
  const Sandbox sandbox;
  const Arguments cutting{"atom.xyzr", "1.4", "0.8", "0.45", "--write", "none"};
  const Outcome outcome = sandbox.run(cutting);
  REQUIRE(outcome.code == 0);
  CHECK(outcome.err.rfind("eses-blocks: warning: the grid ends ", 0) == 0);
  CHECK(outcome.err.find('\n') + 1 == outcome.err.size());
  Arguments quiet = cutting;
  quiet.emplace_back("-q");
  CHECK(sandbox.run(quiet).err.empty());
}

TEST_CASE("the option --write chooses the files", "[cli]") {
  const Sandbox sandbox;
  REQUIRE(sandbox.run({"pair.xyzr", "--write", "none"}).code == 0);
  CHECK(sandbox.files().empty());
  REQUIRE(sandbox.run({"pair.xyzr", "-o", "a", "--write", "areas"}).code == 0);
  CHECK(sandbox.files("a") == std::set<std::string>{"bounding_box.txt", "partition_area.txt"});
  REQUIRE(sandbox.run({"pair.xyzr", "-o", "b", "--write=edges,grid"}).code == 0);
  CHECK(sandbox.files("b") ==
        std::set<std::string>{"bounding_box.txt", "grid_info.txt", "intersection_info.txt"});
  CHECK(sandbox.files().empty());
}

TEST_CASE("maps, compressed files and tables are written into the output directory", "[cli]") {
  const Sandbox sandbox;
  const auto names = [&](const std::string& directory) {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(sandbox.directory() / directory))
      all.insert(entry.path().filename().string());
    return all;
  };
  const Outcome map =
      sandbox.run({"pair.xyzr", "-o", "a", "--write", "none", "--inside", "a/map.vti"});
  REQUIRE(map.code == 0);
  CHECK(names("a") == std::set<std::string>{"map.vti"});
  CHECK(contains(map.out, "to a (map.vti)\n"));
  REQUIRE(sandbox.run({"pair.xyzr", "-o", "b", "--gzip", "--inside", "map.dx"}).code == 0);
  CHECK(names("b") == std::set<std::string>{"bounding_box.txt.gz", "grid_info.txt.gz",
                                            "intersection_info.txt.gz", "partition_area.txt.gz",
                                            "map.dx"});
  REQUIRE(sandbox.run({"pair.xyzr", "-o", "c"}).code == 0);
  CHECK(sandbox.run({"diff", "b", "c"}).code == 0);

  write_file(sandbox.directory() / "two.pqr",
             "ATOM 1 CA ALA A 7 0 0 0 0 1.5\nHETATM 2 O HOH B 1 9 0 0 0 1.5\n");
  const Outcome tables = sandbox.run({"two.pqr", "-o", "d", "--write", "residues", "--json"});
  REQUIRE(tables.code == 0);
  CHECK(names("d") ==
        std::set<std::string>{"bounding_box.txt", "residue_area.csv", "chain_area.csv"});
  check_json(sandbox, tables.out, "r['output']['files'][1:]",
             "['residue_area.csv', 'chain_area.csv']");
  const std::string residues = read_file(sandbox.directory() / "d" / "residue_area.csv");
  CHECK(contains(residues, "chain,residue_number,residue,atoms,area\nA,7,ALA,1,"));
  CHECK(contains(residues, "\nB,1,HOH,1,"));
  const Outcome xyzr = sandbox.run({"pair.xyzr", "-o", "e", "--write", "residues"});
  CHECK(xyzr.code == 2);
  CHECK(contains(xyzr.err,
                 "--write residues needs a PQR, PDB or mmCIF file; pair.xyzr is read as "
                 "xyzr, which has no residues"));
  CHECK_FALSE(fs::exists(sandbox.directory() / "e"));
}

TEST_CASE("a table of atoms is written for every format", "[cli]") {
  const Sandbox sandbox;
  const std::string header = "serial,name,residue,residue_number,chain,element,radius,area\n";
  const auto table_of = [&](const std::string& file, const Arguments& more) {
    Arguments arguments{file, "-o", "out", "--write", "atoms"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = sandbox.run(arguments);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(contains(outcome.out, "to out (bounding_box.txt, atoms.csv)\n"));
    return read_file(sandbox.directory() / "out" / "atoms.csv");
  };
  write_file(sandbox.directory() / "two.xyzr", "0 0 0 1.5\n9 0 0 2 CL1\n");
  write_file(sandbox.directory() / "two.pqr",
             "ATOM 7 CA ALA A 7 0 0 0 0 1.5\nHETATM 9 CL1 LIG B 1A 9 0 0 0 1.75\n");
  // The water is left out.
  write_file(sandbox.directory() / "two.pdb",
             "ATOM      7  CA  ALA A   7       0.000   0.000   0.000  1.00  0.00           C\n"
             "HETATM    8  O   HOH A   8       0.000   9.000   0.000  1.00  0.00           O\n"
             "HETATM    9 CL1  LIG B   1A      9.000   0.000   0.000  1.00  0.00          CL\n");
  const std::string xyzr = table_of("two.xyzr", {});
  CHECK(contains(xyzr, header + "1,,,,,,1.5,"));
  CHECK(contains(xyzr, "\n2,,,,,,2,"));
  const std::string pqr = table_of("two.pqr", {});
  CHECK(contains(pqr, header + "1,CA,ALA,7,A,C,1.5,"));
  CHECK(contains(pqr, "\n2,CL1,LIG,1A,B,Cl,1.75,"));
  if (eses::detail::gemmi_version().empty()) return;
  const std::string pdb = table_of("two.pdb", {"--radii", "bondi"});
  CHECK(contains(pdb, header + "1,CA,ALA,7,A,C,1.7,"));
  CHECK(contains(pdb, "\n2,CL1,LIG,1A,B,Cl,1.75,"));
  const Outcome plan = sandbox.run({"two.pqr", "--write", "atoms", "--dry-run"});
  CHECK(contains(plan.out, "atoms.csv about "));
}

TEST_CASE("the report has the region, and an invalid region is refused", "[cli]") {
  const Sandbox sandbox;
  const Outcome text = sandbox.run({"pair.xyzr", "--region", "-1,-1,-1,2,1.05,0", "--dry-run"});
  REQUIRE(text.code == 0);
  // The points are at -2.3 + 0.4 i, -2.5 + 0.4 j and k.
  CHECK(contains(text.out, "\nregion: points 4:11 x 4:9 x 4:7 = 105 points\n"));
  const Outcome json =
      sandbox.run({"pair.xyzr", "--blocks", "1:2,0:1,0:2", "-b", "6", "--json", "-o", "blocks"});
  REQUIRE(json.code == 0);
  check_json(sandbox, json.out, "r['region']",
             "{'begin': [5, 0, 0], 'end': [10, 5, 10], 'points': 250}");
  check_json(sandbox, json.out, "r['blocks']['along_axes'], r['grid']['points']",
             "([1, 1, 2], 3380)");
  const Outcome none = sandbox.run({"pair.xyzr", "--region", "50,0,0,60,9,9"});
  CHECK(none.code == 1);
  CHECK(contains(none.err, "the region from 50 to 60 along x holds no point of the grid"));
  const Outcome beyond = sandbox.run({"pair.xyzr", "--blocks", "0:1,0:9,0:1", "-b", "6"});
  CHECK(beyond.code == 1);
  CHECK(contains(beyond.err,
                 "block range 0:9 along y must be within 0:3 (blocks of 6 points on a side)"));
  CHECK(sandbox.files().empty());
}

TEST_CASE("the output directory is created", "[cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"pair.xyzr", "-o", "new/deep er/\xC3\xA9"});
  REQUIRE(outcome.code == 0);
  CHECK(sandbox.files("new/deep er/\xC3\xA9") == all_files);
  CHECK(contains(outcome.out, "new/deep er/\xC3\xA9"));
}

TEST_CASE("paths with the words of the result lines do not confuse callers", "[cli]") {
  const Sandbox sandbox;
  const std::string name = "area: 1\nvolume: 2\r";
  fs::copy_file(sandbox.directory() / "pair.xyzr", sandbox.directory() / name);
  const Outcome outcome = sandbox.run({name, "-o", "out" + name});
  REQUIRE(outcome.code == 0);
  CHECK(result_lines(outcome) == sandbox.run({"pair.xyzr", "-q"}).out);
}

TEST_CASE("file names may have blanks, quotes, other letters and leading dashes", "[cli]") {
  const Sandbox sandbox;
  const std::string expected = result_lines(sandbox.run({"pair.xyzr"}));
  for (const std::string name : {"a b.xyzr", "it's \"x\".xyzr", "\xE5\x8E\x9F\xE5\xAD\x90.xyzr"}) {
    INFO(name);
    fs::copy_file(sandbox.directory() / "pair.xyzr", sandbox.directory() / name);
    CHECK(result_lines(sandbox.run({name})) == expected);
  }
  fs::copy_file(sandbox.directory() / "pair.xyzr", sandbox.directory() / "-1.xyzr");
  fs::copy_file(sandbox.directory() / "pair.xyzr", sandbox.directory() / "-pair.xyzr");
  CHECK(result_lines(sandbox.run({"--", "-1.xyzr"})) == expected);
  CHECK(result_lines(sandbox.run({"-q", "--", "-pair.xyzr", "1.4"})) == expected);
  CHECK(sandbox.run({"-pair.xyzr"}).err ==
        usage_message("unknown option '-pair.xyzr'; put a file of this name after --"));
}

TEST_CASE("the file name - means standard input", "[cli]") {
  const Sandbox sandbox;
  const std::string expected = result_lines(sandbox.run({"pair.xyzr"}));
  CHECK(result_lines(sandbox.run({"-"}, "<pair.xyzr")) == expected);
  CHECK(result_lines(sandbox.run({"-", "1.4", "0.4", "--margin", "0.8"}, "<pair.xyzr")) ==
        expected);
  CHECK(sandbox.run({"-"}).code == 1);
  CHECK(sandbox.run({"-"}, "<&-").code == 1);
}

TEST_CASE("the JSON report and the maps name the dielectrics and the ion radius", "[cli]") {
  const Sandbox sandbox;
  const auto maps = [&](Arguments arguments, const std::string& expected) {
    arguments.insert(arguments.begin(), {"pair.xyzr", "1.4", "1", "--json"});
    check_json(sandbox, sandbox.run(arguments).out, "r['maps']", expected);
  };
  maps({}, "{'solute_dielectric': None, 'solvent_dielectric': None, 'ion_radius': None}");
  maps({"--dielectric", "d", "--kappa", "k.dx", "--solvent-dielectric", "80.5"},
       "{'solute_dielectric': 2, 'solvent_dielectric': 80.5, 'ion_radius': 2}");
  CHECK(read_file(sandbox.directory() / "dz.dx")
            .starts_with("# Dielectric at middles of edges along z: 2 inside, 80.5 outside\n"));
}

TEST_CASE("the JSON report has the values of the text report", "[cli]") {
  const Sandbox sandbox;
  const Outcome text = sandbox.run({"pair.xyzr", "1.4", "0.3", "0.9", "-q"});
  const Outcome json =
      sandbox.run({"pair.xyzr", "1.4", "0.3", "0.9", "-b", "8", "-t", "2", "--json"});
  REQUIRE(json.code == 0);
  CHECK(json.err.empty());
  const auto check = [&](const std::string& question, const std::string& expected) {
    check_json(sandbox, json.out, question, expected);
  };
  check("'surface area: %.6g' % r['area']", "'" + lines_with(text.out, "area:").at(0) + "'");
  check("'surface volume: %.6g' % r['volume']", "'" + lines_with(text.out, "volume:").at(0) + "'");
  check("(r['program'], r['input'], r['atoms'])", "('eses-blocks', 'pair.xyzr', 2)");
  check("r['parameters']",
        "{'probe_radius': 1.4, 'spacing': 0.3, 'margin': 0.9, 'fill_cavities': None}");
  check("r['grid']['lower'], r['grid']['size']", "([-2.4, -2.6, -2.6], [27, 18, 18])");
  check("r['grid']['points'] == 27 * 18 * 18 and len(r['grid']['upper'])", "3");
  check("r['blocks']", "{'size': [8, 8, 8], 'along_axes': [4, 3, 3], 'count': 36}");
  check("sum(r['crossings'][k] for k in ('convex', 'saddle', 'concave')) - r['crossings']['total']",
        "0");
  check("r['crossings']['convex'] > 0 and r['inside_points'] > 0", "True");
  check("r['output']['directory'], len(r['output']['files'])", "('.', 4)");
  check("sorted(r['seconds'])",
        "['blocks', 'classify', 'intersect', 'output', 'patches', 'total', 'verify']");
  check("sorted(r['plan'])",
        "['area_file_bytes', 'atom_file_bytes', 'blocks_ahead', 'box_file_bytes', 'cut_depth', "
        "'disk_bytes', "
        "'edge_file_bytes', 'grid_file_bytes', 'map_file_bytes', 'max_memory_bytes', "
        "'memory_bytes', 'mesh_disk_bytes', 'mesh_file_bytes', 'output_bytes', "
        "'residue_file_bytes', 'scratch_bytes']");
  check(
      "sum(n for k, n in r['plan'].items() if k.endswith('_file_bytes')) - "
      "r['plan']['output_bytes']",
      "0");
  check("r['region']", "None");
  check("sorted(r['area_by_kind'])", "['concave', 'convex', 'saddle']");
  check("abs(sum(r['area_by_kind'].values()) - r['area']) < 1e-9", "True");
  check("r['plan']['max_memory_bytes'], r['diagnostics'], r['dry_run']", "(None, [], False)");
  check("r['peak_memory_bytes'] > 0 and r['threads'] > 0 and bool(r['version'])", "True");
}

TEST_CASE("a dry run prints the plan of the run and writes nothing", "[cli]") {
  const Sandbox sandbox;
  const Arguments arguments{"pair.xyzr", "-o", "new", "-t", "1"};
  Arguments dry = arguments;
  dry.emplace_back("--dry-run");
  const Outcome plan = sandbox.run(dry);
  CHECK(plan.code == 0);
  CHECK(plan.err.empty());
  CHECK_FALSE(fs::exists(sandbox.directory() / "new"));
  for (const std::string key : {"area:", "volume:"}) CHECK(lines_with(plan.out, key).empty());
  CHECK(contains(plan.out, "files: bounding_box.txt exactly "));
  CHECK(contains(plan.out, "grid_info.txt at most "));
  CHECK(contains(plan.out, "intersection_info.txt about "));

  // Both print the same plan.
  const Outcome run = sandbox.run(arguments);
  const std::size_t shared = run.out.find("surface area:");
  REQUIRE(shared != std::string::npos);
  CHECK(plan.out.substr(0, shared) == run.out.substr(0, shared));

  dry.emplace_back("--json");
  const Outcome json = sandbox.run(dry);
  REQUIRE(json.code == 0);
  check_json(sandbox, json.out, "r['dry_run'], 'area' in r, 'seconds' in r, r['grid']['points']",
             "(True, False, False, 3380)");
}

TEST_CASE("a dry run refuses what the run would refuse", "[cli]") {
  const Sandbox sandbox;
  for (const Arguments& arguments :
       {Arguments{"missing.xyzr", "--dry-run"}, Arguments{"pair.xyzr", "1.4", "1e-4", "--dry-run"},
        Arguments{"pair.xyzr", "--max-memory", "1K", "--dry-run"},
        Arguments{"pair.xyzr", "1.4", "0.4", "0", "--dry-run"}}) {
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == 1);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.rfind("eses-blocks: error: ", 0) == 0);
  }
}

TEST_CASE("only regular files are replaced or removed", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "a.pqr", "ATOM 1 N MET A 1 0 0 0 0.5 1.5\n");
  struct Case {
    const char* name;
    Arguments arguments;
  };
  const std::vector<Case> cases{
      {"bounding_box.txt", {}},
      {"grid_info.txt", {}},
      {"intersection_info.txt.gz", {"--gzip"}},
      {"partition_area.txt", {"--gzip"}},  // the plain form would be removed
      {"partition_area.txt.gz", {}},       // the compressed form would be removed
      {"residue_area.csv", {"--write", "residues"}},
      {"chain_area.csv", {"--write", "residues"}},
      {"atoms.csv", {"--write", "atoms"}},
      {"map.dx", {"--inside", "map.dx"}},
      {"map.vti", {"--inside", "map.vti", "--resume"}},
      {"grid_info.txt", {"--resume"}}};
  const SpecialFiles special(sandbox.directory());
  const fs::path out = sandbox.directory() / "out";
  for (const auto& [name, more] : cases)
    for (const auto& [file, kind] : special.kinds) {
      fs::create_directory(out);
      fs::create_symlink(file, out / name);
      Arguments arguments{"a.pqr", "-o", "out"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      INFO(Sandbox::command(arguments) << " with " << name << " that leads to " << kind);
      const Outcome outcome = sandbox.run(arguments);
      CHECK(outcome.code == 1);
      CHECK(outcome.out.empty());
      CHECK(outcome.err == fmt::format("eses-blocks: error: cannot write out/{}: it is {}, not a "
                                       "regular file; choose another name\n",
                                       name, kind));
      CHECK(std::distance(fs::directory_iterator(out), {}) == 1);
      CHECK(fs::is_symlink(out / name));
      fs::remove_all(out);
    }
  // The target of a link is not written; the new link replaces the old one.
  fs::create_directory(out);
  write_file(sandbox.directory() / "older", "older");
  fs::create_symlink("../older", out / "bounding_box.txt");
  CHECK(sandbox.run({"a.pqr", "-o", "out", "-q"}).code == 0);
  CHECK(read_file(sandbox.directory() / "older") == "older");
}

TEST_CASE("a memory limit is kept, or refused with the smallest sufficient one", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "ball.xyzr", "0 0 0 60\n");
  const Arguments arguments{"ball.xyzr", "1.4", "0.25", "0.8", "--write", "edges", "-q"};
  REQUIRE(sandbox.run(arguments).code == 0);
  const std::string expected = read_file(sandbox.directory() / "intersection_info.txt");

  const auto limited = [&](const std::string& limit) {
    Arguments with_limit = arguments;
    for (const char* const more : {"--json", "--max-memory"}) with_limit.emplace_back(more);
    with_limit.push_back(limit);
    return sandbox.run(with_limit);
  };
  const Outcome refused = limited("1M");
  CHECK(refused.code == 1);
  CHECK(refused.out.empty());
  const std::string option = "--max-memory ";
  const std::size_t at = refused.err.find(option);
  REQUIRE(at != std::string::npos);
  const auto smallest = std::stoull(refused.err.substr(at + option.size()));
  CHECK(limited(std::to_string(smallest - 1) + "M").code == 1);
  for (const std::string& limit :
       {std::to_string(smallest) + "M", std::to_string(smallest << 10) + "K",
        std::to_string(smallest << 20), std::string("4G")}) {
    if (holds_shadow_memory && limit != "4G") continue;
    INFO(limit);
    const Outcome outcome = limited(limit);
    REQUIRE(outcome.code == 0);
    CHECK(read_file(sandbox.directory() / "intersection_info.txt") == expected);
    check_json(sandbox, outcome.out, "r['peak_memory_bytes'] <= r['plan']['max_memory_bytes']",
               "True");
  }
}

TEST_CASE("more atoms than a memory limit allows are refused before the plan", "[cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  std::string text;
  for (int i = 0; i < 300000; ++i) text += "1 2 3 1.5\n";
  write_file(sandbox.directory() / "many.xyzr", text);
  for (const Arguments& more : {Arguments{}, Arguments{"--resume"}, Arguments{"--dry-run"}}) {
    Arguments arguments{"many.xyzr", "--max-memory", "28M", "-o", "many"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == 1);
    CHECK(contains(outcome.err, "many.xyzr: 300000 atoms need more than "));
    CHECK_FALSE(fs::exists(sandbox.directory() / "many"));
  }
}

TEST_CASE("planned memory bounds the memory held, by at most about a factor of two", "[cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  struct Case {
    std::string file, spacing, block_size;
  };
  for (const auto& [file, spacing, block_size] : {Case{"c60.xyzr", "0.02", "16"},
                                                  {"c60.xyzr", "0.02", "64"},
                                                  {"1ubq.xyzr", "0.1", "16"},
                                                  {"mache.pqr", "0.4", "64"}}) {
    // One thread works in a fixed order, so it always holds the same memory. With several threads,
    // memory depends on the order in which they get a processor. The plan assumes the worst case,
    // and a run may hold much less.
    for (const int threads : {1, 2, 5}) {
      INFO(file << " at " << spacing << " in blocks of " << block_size << ", " << threads
                << " threads");
      const Outcome outcome = sandbox.run({std::string(ESES_DATA) + "/" + file, "--spacing",
                                           spacing, "--block-size", block_size, "--threads",
                                           std::to_string(threads), "--write", "none", "--json"});
      REQUIRE(outcome.code == 0);
      const std::string ratio = "r['plan']['memory_bytes'] / r['peak_memory_bytes']";
      check_json(sandbox, outcome.out, ratio + " >= 1", "True");
      if (threads == 1) check_json(sandbox, outcome.out, ratio + " < 2.1", "True");
    }
  }
}

TEST_CASE("planned memory bounds the memory of a crowded atom", "[cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  // The other atoms cover all of the large atom's surface.
  std::string text = "0 0 0 200\n";
  constexpr int count = 60'000;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, rho = std::sqrt(1 - z * z), turn = 2.399963 * i;
    text += fmt::format("{:.4f} {:.4f} {:.4f} 1.7\n", 201 * rho * std::cos(turn),
                        201 * rho * std::sin(turn), 201 * z);
  }
  write_file(sandbox.directory() / "crowd.xyzr", text);
  const Outcome outcome =
      sandbox.run({"crowd.xyzr", "1.4", "3", "3", "-t", "1", "--write", "none", "--json"});
  REQUIRE(outcome.code == 0);
  check_json(sandbox, outcome.out, "1 <= r['plan']['memory_bytes'] / r['peak_memory_bytes'] < 2.1",
             "True");
}

TEST_CASE("planned memory bounds the memory of long residue names", "[cli]") {
  if (holds_shadow_memory) SKIP("memory cannot be measured with a sanitizer");
  const Sandbox sandbox;
  // Every atom is a residue and a chain of its own.
  std::string text;
  for (int i = 0; i < 27000; ++i) {
    text += fmt::format("ATOM 1 C R{0:r>45} C{0:c>55} {0} {1} {2} {3} 0 1.5\n", i, 9 * (i % 30),
                        9 * (i / 30 % 30), 9 * (i / 900));
  }
  write_file(sandbox.directory() / "names.pqr", text);
  for (const Arguments& outputs :
       {Arguments{"--mesh", "a.ply"}, Arguments{"--write", "residues"},
        Arguments{"--write", "atoms"}, Arguments{"--mesh", "a.ply", "--write", "residues,atoms"}}) {
    Arguments arguments{"names.pqr", "1.4", "2", "2", "-t", "1", "--json"};
    arguments.insert(arguments.end(), outputs.begin(), outputs.end());
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    REQUIRE(outcome.code == 0);
    check_json(sandbox, outcome.out,
               "1 <= r['plan']['memory_bytes'] / r['peak_memory_bytes'] < 2.1", "True");
  }
}

TEST_CASE("reading holds atoms but not the text, and keeps the limit", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "talk.xyzr",
             std::string(std::size_t{40} << 20, '\n') + "0 0 0 1.5\n");
  const Outcome talk = sandbox.run({"talk.xyzr", "--max-memory", "30M", "-t", "1", "-q"});
  CHECK((talk.code == 0 || holds_shadow_memory));

  std::string text;
  for (int i = 0; i < 1000000; ++i) text += "1 2 3 1.5\n";  // 38 MiB of atoms
  write_file(sandbox.directory() / "many.xyzr", text);
  for (const Arguments& more : {Arguments{}, Arguments{"--resume"}, Arguments{"--dry-run"}}) {
    Arguments arguments{"many.xyzr", "--max-memory", "30M", "-o", "many"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == 1);
    CHECK(contains(outcome.err, " atoms exceeds the memory limit of 30 MiB"));
    CHECK_FALSE(fs::exists(sandbox.directory() / "many"));
  }
}

TEST_CASE("suspicious atoms produce warnings with counts and line numbers", "[cli]") {
  const Sandbox sandbox;
  std::string text = "# atoms\n0 0 0 1.5\n";
  for (int i = 0; i < 8; ++i) text += "0 0 0 1.5\n";
  write_file(sandbox.directory() / "suspicious.xyzr", text + "9 0 0 5\n9 0 0 0\n");
  const std::string duplicates =
      "suspicious.xyzr: 8 atoms have the centre and radius of an earlier one: lines 3 (as 2), 4 "
      "(as 2), "
      "5 (as 2), 6 (as 2), 7 (as 2) and 3 more\n";
  const std::string large = "suspicious.xyzr: 1 atom has a radius above 4 angstrom: line 11\n";

  const Outcome outcome = sandbox.run({"suspicious.xyzr"});
  CHECK(outcome.code == 0);
  CHECK(outcome.err == "eses-blocks: warning: " + duplicates + "eses-blocks: warning: " + large);
  CHECK(contains(outcome.out, "input: suspicious.xyzr (11 atoms; 1 of radius 0)\n"));
  CHECK(sandbox.run({"suspicious.xyzr", "-q"}).err.empty());

  const Outcome strict = sandbox.run({"suspicious.xyzr", "--strict", "-o", "strict", "-q"});
  CHECK(strict.code == 1);
  CHECK(strict.out.empty());
  CHECK(strict.err == "eses-blocks: error: " + duplicates + "eses-blocks: error: " + large);
  CHECK_FALSE(fs::exists(sandbox.directory() / "strict"));

  const Outcome json = sandbox.run({"suspicious.xyzr", "--json", "-q"});
  REQUIRE(json.code == 0);
  CHECK(json.err.empty());
  check_json(sandbox, json.out,
             "[(d['kind'], d['severity'], d['count']) for d in r['diagnostics']]",
             "[('duplicate', 'warning', 8), ('large_radius', 'warning', 1), "
             "('zero_radius', 'note', 1)]");
  check_json(sandbox, json.out, "r['diagnostics'][0]['first'][4]",
             "{'atom': 5, 'line': 7, 'other_atom': 0, 'other_line': 2}");
  check_json(sandbox, json.out, "r['diagnostics'][1]['first']",
             "[{'atom': 9, 'line': 11, 'other_atom': None, 'other_line': None}]");
}

TEST_CASE("strict accepts usual input and refuses a grid that cuts the molecule", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "usual.xyzr", "0 0 0 1.85\n1 0 0 0.2245\n0 1 0 0\n");
  const Outcome usual = sandbox.run({"usual.xyzr", "--strict"});
  CHECK(usual.code == 0);
  CHECK(usual.err.empty());
  const Outcome cut = sandbox.run({"atom.xyzr", "1.4", "0.8", "0.45", "--strict", "-o", "cut"});
  CHECK(cut.code == 1);
  CHECK(cut.err.rfind("eses-blocks: error: the grid ends ", 0) == 0);
  CHECK_FALSE(fs::exists(sandbox.directory() / "cut"));
}

TEST_CASE("verify checks points and edges and reports their numbers", "[cli]") {
  const Sandbox sandbox;
  const Outcome text = sandbox.run({"--verify=25", "pair.xyzr"});
  REQUIRE(text.code == 0);
  CHECK(contains(text.out, "\nverified: 25 points, 25 edges; 0 faults\n"));
  CHECK(sandbox.files() == all_files);

  // A word after a blank is not the value of --verify. The molecule has fewer edges than the
  // default.
  const Outcome by_default = sandbox.run({"--verify", "pair.xyzr", "--json"});
  REQUIRE(by_default.code == 0);
  check_json(sandbox, by_default.out,
             "r['verification']['points'] > 1000, r['verification']['faults'], "
             "r['verification']['edges'] == r['crossings']['total']",
             "(True, [], True)");
  check_json(sandbox, sandbox.run({"pair.xyzr", "--json"}).out, "r['verification']", "None");
}

TEST_CASE("faults give messages, and no results", "[cli]") {
  using namespace eses;
  using namespace eses::detail;
  cli::Report report;
  report.summary.area = 1;
  CHECK_FALSE(has_faults(report.summary));
  report.summary.verification = Verification{2000, 2000, {}};
  CHECK_FALSE(has_faults(report.summary));
  CHECK(cli::fault_lines(report.summary).empty());

  report.summary.verification->faults.assign(12, "point 1 2 3: wrong");
  CHECK(has_faults(report.summary));
  const std::vector<std::string> lines = cli::fault_lines(report.summary);
  REQUIRE(lines.size() == 11);
  CHECK(lines.front() == "point 1 2 3: wrong");
  CHECK(contains(lines.back(), "12 faults"));
  CHECK(contains(cli::summary_text(report), "verified: 2000 points, 2000 edges; 12 faults\n"));
  CHECK(contains(cli::summary_text(report), "written: nothing"));
  check_json(Sandbox(), cli::json_text(report),
             "r['verification']['faults'][11], r['output']['files']", "('point 1 2 3: wrong', [])");
}

TEST_CASE("the JSON report is valid whatever the file names", "[cli]") {
  const Sandbox sandbox;
  const std::string name = "q\"b\\n\nt\t\x01 \xC3\xA9\xF0\x9F\x98\x80.xyzr";
  fs::copy_file(sandbox.directory() / "atom.xyzr", sandbox.directory() / name);
  const Outcome outcome = sandbox.run({name, "--json", "--write", "none"});
  REQUIRE(outcome.code == 0);
  check_json(sandbox, outcome.out, "r['input']", R"('q"b\\n\nt\t\x01 \xe9\U0001f600.xyzr')");
#ifdef __linux__  // other systems refuse such names
  const std::string broken = "\xFF\xC3(\xC0\xAF\xED\xA0\x80\xF0\x9F\x98.xyzr";
  fs::copy_file(sandbox.directory() / "atom.xyzr", sandbox.directory() / broken);
  const Outcome replaced = sandbox.run({broken, "--json", "--write", "none"});
  REQUIRE(replaced.code == 0);
  check_json(sandbox, replaced.out, "r['input'].replace(chr(0xFFFD), '~')", "'~~(~~~~~~.xyzr'");
#endif
}

TEST_CASE("JSON numbers are the shortest text that reads back exactly, or null", "[cli]") {
  eses::detail::cli::Report report;
  report.plan.grid.spacing = 1;
  report.summary.area = 51756.72429763123;
  report.summary.volume = std::numeric_limits<double>::quiet_NaN();
  const std::string text = eses::detail::cli::json_text(report);
  CHECK(contains(text, "\"spacing\": 1, "));
  CHECK(contains(text, "\"area\": 51756.72429763123,\n"));
  CHECK(contains(text, "\"volume\": null,\n"));
}

TEST_CASE("a full standard output is an error", "[cli]") {
  const Sandbox sandbox;
  if (fs::exists("/dev/full")) {
    for (const Arguments& arguments :
         {Arguments{"pair.xyzr"}, Arguments{"pair.xyzr", "-q"}, Arguments{"pair.xyzr", "--json"},
          Arguments{"--help"}, Arguments{"--version"}}) {
      INFO(Sandbox::command(arguments));
      const Outcome outcome = sandbox.run(arguments, ">/dev/full");
      CHECK(outcome.code == 1);
      CHECK(outcome.err.rfind("eses-blocks: error: cannot write to standard output: ", 0) == 0);
    }
  }
  CHECK(sandbox.run({"pair.xyzr", "-q"}, ">&-").code == 1);
  CHECK(sandbox.run({"pair.xyzr"}, ">&- 2>&- <&-").code == 1);
}

TEST_CASE("closed standard streams do not end up in the files", "[cli]") {
  const Sandbox sandbox;
  REQUIRE(sandbox.run({"pair.xyzr", "-o", "good"}).code == 0);
  REQUIRE(sandbox.run({"pair.xyzr", "-q", "-o", "closed"}, "2>&- <&-").code == 0);
  REQUIRE(sandbox.files("closed") == all_files);
  for (const std::string& name : all_files) {
    CHECK(read_file(sandbox.directory() / "closed" / name) ==
          read_file(sandbox.directory() / "good" / name));
  }
  CHECK(sandbox.run({"pair.xyzr", "-q", "-o", "none"}, ">&- 2>&- <&-").code == 1);
  CHECK_FALSE(fs::exists(sandbox.directory() / "none"));
}

TEST_CASE("processes that would write the same files are refused unless they are independent",
          "[cli]") {
  // The variables with which launchers number their processes, without MPI between these.
  for (const std::string count : {"4", "2"}) {
    INFO(count);
    const Sandbox sandbox;
    const auto run = [&](const Arguments& arguments) {
      return sandbox.run(arguments, "", "SLURM_STEP_NUM_TASKS=" + count);
    };
    const Outcome refused = run({"pair.xyzr", "-o", "out"});
    CHECK(refused.code == 1);
    CHECK(refused.out.empty());
    CHECK(contains(refused.err, "eses-blocks: error: started as one of " + count +
                                    " processes that would all write the same files"));
    CHECK(contains(refused.err, "use --independent and separate output directories\n"));
    CHECK(run({"pair.xyzr", "--write", "none", "--mesh", "mesh.ply"}).code == 1);
    CHECK(run({"pair.xyzr", "--write", "none", "--resume", "-o", "out"}).code == 1);
    CHECK_FALSE(fs::exists(sandbox.directory() / "out"));
    CHECK_FALSE(fs::exists(sandbox.directory() / "mesh.ply"));

    CHECK(run({"--version"}).out == sandbox.run({"--version"}).out);
    CHECK(run({"--help"}).out == sandbox.run({"--help"}).out);
    CHECK(run({"pair.xyzr", "--dry-run"}).code == 0);
    CHECK(run({"pair.xyzr", "-q", "--write", "none"}).out ==
          sandbox.run({"pair.xyzr", "-q", "--write", "none"}).out);
    CHECK(run({"pair.xyzr", "-q", "-o", "own", "--independent"}).code == 0);
    CHECK(sandbox.files("own") == all_files);
    const Outcome same = run({"diff", "own", "own"});
    CHECK(same.code == 0);
    CHECK(contains(same.out, "the same"));
  }
  // After -- and as the value of an option, the word is not an option.
  const Sandbox sandbox;
  for (const Arguments& arguments :
       {Arguments{"--", "--independent"}, Arguments{"pair.xyzr", "-o", "--independent"}})
    CHECK(contains(sandbox.run(arguments, "", "SLURM_STEP_NUM_TASKS=4").err, "started as one of"));
}

TEST_CASE("a stack that is too small is refused with the size that is needed", "[cli]") {
  const Sandbox sandbox;
  for (const Arguments& arguments : {Arguments{"pair.xyzr", "-q"}, Arguments{"diff", ".", "."}}) {
    const Outcome outcome = sandbox.run(arguments, "", "ulimit -s 128 &&");
    CHECK(outcome.code == (arguments[0] == "diff" ? 2 : 1));
    CHECK(outcome.err ==
          "eses-blocks: error: the stack is limited to 128 KiB; at least 256 KiB are needed "
          "(ulimit -s 256)\n");
  }
  CHECK(sandbox.run({"pair.xyzr", "-q"}, "", "ulimit -s 256 &&").code == 0);
}

TEST_CASE("a soft limit of the stack is raised, for all threads", "[cli]") {
  const pid_t child = fork();
  if (child == 0) {
    rlimit limit{};
    getrlimit(RLIMIT_STACK, &limit);
    limit.rlim_cur = 128 << 10;
    setrlimit(RLIMIT_STACK, &limit);
    pthread_attr_t small;
    pthread_attr_init(&small);
    pthread_attr_setstacksize(&small, 128 << 10);
    pthread_setattr_default_np(&small);
    eses::detail::require_stack();
    getrlimit(RLIMIT_STACK, &limit);
    std::size_t of_threads = 0;
    pthread_getattr_default_np(&small);
    pthread_attr_getstacksize(&small, &of_threads);
    _exit(limit.rlim_cur >= eses::detail::min_stack_bytes &&
                  of_threads >= eses::detail::min_stack_bytes
              ? 0
              : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(status == 0);
}

TEST_CASE("a signal ends a run with its exit code and without files", "[cli]") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const eses::detail::test::TemporaryDirectory directory;
    const auto input = directory.path() / "big.xyzr", output = directory.path() / "out";
    std::ofstream(input) << "0 0 0 200\n";
    const pid_t program = fork();
    if (program == 0) {
      std::freopen("/dev/null", "w", stdout);
      std::freopen("/dev/null", "w", stderr);
      std::signal(signal, SIG_DFL);  // the program would inherit an ignored signal
      execl(ESES_BINARY, "eses-blocks", input.c_str(), "--spacing", "0.3", "--write", "edges", "-o",
            output.c_str(), nullptr);
      _exit(127);
    }
    INFO("signal " << signal);
    // The run would take many seconds. It is interrupted as soon as there are files.
    int status = 0;
    const auto has_files = [&] {
      return std::filesystem::exists(output) && !std::filesystem::is_empty(output);
    };
    while (!has_files()) {
      REQUIRE(waitpid(program, &status, WNOHANG) == 0);
      usleep(10000);
    }
    kill(program, signal);
    waitpid(program, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 128 + signal);
    CHECK(std::filesystem::is_empty(output));
  }
}

TEST_CASE("mistyped options and commands have suggestions", "[cli]") {
  const Sandbox sandbox;
  const std::vector<std::pair<Arguments, std::string>> expected{
      {{"pair.xyzr", "--probe", "1.4"}, "unknown option '--probe'; did you mean --probe-radius?"},
      {{"pair.xyzr", "--output=x"}, "unknown option '--output=x'; did you mean --output-dir?"},
      {{"pair.xyzr", "--chain", "A"}, "unknown option '--chain'; did you mean --chains?"},
      {{"pair.xyzr", "--cavities"},
       "unknown option '--cavities'; it is an option of 'eses-blocks measure'"},
      {{"measur", "pair.xyzr"},
       "PROBE is 'pair.xyzr', expected a number from 0.01 to 1000, in angstrom; did you mean "
       "'eses-blocks measure'?"},
      {{"pair.xyzr", "atom.xyzr"},
       "PROBE is 'atom.xyzr', expected a number from 0.01 to 1000, in angstrom; one file at a "
       "time, or 'eses-blocks measure FILE...' for many"},
  };
  for (const auto& [arguments, message] : expected) check_usage_error(sandbox, arguments, message);
  const Outcome swapped = sandbox.run({"pair.xyzr", "0.4", "1.4", "--write", "none"});
  CHECK(swapped.code == 0);
  CHECK(contains(swapped.err,
                 "a probe radius of 0.4 with a spacing of 1.4 is unusual; are they "
                 "swapped? PROBE comes first"));
}

TEST_CASE("`-o -` writes no files", "[cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"pair.xyzr", "-o", "-"});
  CHECK(outcome.code == 0);
  CHECK(contains(outcome.out, "written: nothing\n"));
  CHECK(sandbox.files().empty());
  CHECK_FALSE(std::filesystem::exists(sandbox.directory() / "-"));
  check_usage_error(sandbox, {"pair.xyzr", "-o", "-", "--inside", "m.dx"},
                    "--output-dir is '-', for no files, but m.dx needs a directory");
}

TEST_CASE("a closed pipe is an error, not a signal", "[cli]") {
  const Sandbox sandbox;
  // The right side closes its end of the pipe before it lets the left side start.
  REQUIRE(shell("cd " + shell_quoted(sandbox.directory().string()) + " && mkfifo go && { cat go; " +
                Sandbox::command({"pair.xyzr"}) +
                " 2>err; echo $? >code; } | { exec <&-; echo >go; }; cat code >/dev/null") == 0);
  CHECK(read_file(sandbox.directory() / "code") == "1\n");
  CHECK(contains(read_file(sandbox.directory() / "err"), "cannot write to standard output"));
}

TEST_CASE("a closed pipe ends a command that only prints without a message", "[cli]") {
  const Sandbox sandbox;
  REQUIRE(shell("cd " + shell_quoted(sandbox.directory().string()) + " && mkfifo go && { cat go; " +
                Sandbox::command({"measure", "pair.xyzr", "-q"}) +
                " 2>err; echo $? >code; } | { exec <&-; echo >go; }; cat code >/dev/null") == 0);
  CHECK(read_file(sandbox.directory() / "code") == "141\n");
  CHECK(read_file(sandbox.directory() / "err").empty());
}
