// Tests of the texts of the real program: help, version and suggestions.

#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "input/read_structure.hpp"
#include "support/sandbox.hpp"

using namespace eses::detail::test;

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

TEST_CASE("the version line names the formats that the build reads", "[cli]") {
  const std::string version = std::string(eses::detail::gemmi_version());
  CHECK(contains(Sandbox().run({"--version"}).out,
                 version.empty() ? "\nreads: xyzr and PQR (built without gemmi)\n"
                                 : "\nreads: xyzr, PQR, PDB and mmCIF (gemmi " + version + ")\n"));
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
