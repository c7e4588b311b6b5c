// Tests of the texts of the real program: help, version and suggestions.

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "input/read_structure.hpp"
#include "support/sandbox.hpp"

using namespace eses::detail::test;

TEST_CASE("help names every option with unit and default, examples and exit codes", "[cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"--help-all"});
  CHECK(outcome.code == 0);
  CHECK(outcome.err.empty());
  CHECK(sandbox.run({"--spacing", "0", "--help-all", "--other"}).out == outcome.out);
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

TEST_CASE("help is short and begins with examples", "[cli]") {
  const Sandbox sandbox;
  for (const std::string command : {"", "measure", "interface", "diff", "msms", "pdb_to_xyzr"}) {
    INFO(command);
    const Arguments start = command.empty() ? Arguments{} : Arguments{command};
    const auto with = [&](const std::string& option) {
      Arguments arguments = start;
      arguments.push_back(option);
      return arguments;
    };
    const Outcome brief = sandbox.run(with("--help")), all = sandbox.run(with("--help-all"));
    CHECK(brief.code == 0);
    CHECK(all.code == 0);
    CHECK(sandbox.run(with("-h")).out == brief.out);
    CHECK(std::count(brief.out.begin(), brief.out.end(), '\n') < 60);
    CHECK_FALSE(contains(brief.out, "\n\n\n"));
    const std::size_t examples = brief.out.find("\nExamples:\n"), options = brief.out.find("\n  -");
    REQUIRE(examples != brief.out.npos);
    CHECK(examples < options);
    const std::string lines = brief.out.substr(examples + 11, options - examples - 11);
    CHECK(lines_with(lines.substr(0, lines.find("\n\n") + 1), "eses-").size() == 3);
    // Every option of --help is in --help-all.
    for (const std::string& line : lines_with(brief.out, "  -"))
      CHECK(contains(all.out, line + "\n"));
    CHECK(contains(all.out, "Exit codes:\n"));
  }
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
      {{"msms", "-if", "pair.xyzr", "-probe_radus", "1"},
       "unknown option '-probe_radus'; did you mean -probe_radius?"},
      {{"measure", "pair.xyzr", "--radi", "bondi"},
       "unknown option '--radi'; did you mean --radii?"},
      {{"interface", "pair.pdb", "--ligands", "STI"},
       "unknown option '--ligands'; did you mean --ligand?"},
      {{"diff", "a", "b", "--tolerence", "1"},
       "unknown option '--tolerence'; did you mean --tolerance?"},
      {{"view", "pair.xyzr"},
       "PROBE is 'pair.xyzr', expected a number from 0.01 to 1000, in angstrom; did you mean "
       "'eses-view', a program of its own?"},
      {{"pair.xyzr", "--cavities"},
       "unknown option '--cavities'; it is an option of 'eses-blocks measure'"},
      {{"measure", "pair.pdb", "--rsa"},
       "unknown option '--rsa'; relative areas of residues are printed by 'eses-blocks measure "
       "FILE --table residues' or, as NACCESS does, '--table rsa'"},
      {{"pair.pdb", "--depth", "residue"},
       "unknown option '--depth'; areas by chain, residue or atom are printed by 'eses-blocks "
       "measure FILE --table chains', 'residues' or 'atoms'"},
      {{"measure", "pair.pdb", "--mesh", "a.ply"},
       "unknown option '--mesh'; it is an option of 'eses-blocks FILE', without a command"},
      {{"measure", "pair.pdb", "--format", "csv"},
       "--format is 'csv', expected auto, xyzr, pqr, pdb or mmcif, the format of the input; "
       "outputs of 'eses-blocks measure' are chosen by --csv, --json and --table"},
      {{"measur", "pair.xyzr"},
       "PROBE is 'pair.xyzr', expected a number from 0.01 to 1000, in angstrom; did you mean "
       "'eses-blocks measure'?"},
      {{"pair.xyzr", "atom.xyzr"},
       "PROBE is 'atom.xyzr', expected a number from 0.01 to 1000, in angstrom; one file at a "
       "time, or 'eses-blocks measure FILE...' for many"},
      {{"pair.xyzr", "1.4", "atom.xyzr"},
       "SPACING is 'atom.xyzr', expected a finite number greater than 0, in angstrom; one file at "
       "a "
       "time, or 'eses-blocks measure FILE...' for many"},
      {{"pair.xyzr", "1.4", "0.5", "1", "atom.xyzr"},
       "unexpected argument 'atom.xyzr' after FILE, PROBE, SPACING and MARGIN; one file at a time, "
       "or 'eses-blocks measure FILE...' for many"},
      {{"pair.xyzr", "-o", "-q"}, "-o needs a value before -q; for the text '-q', write -o-q"},
      {{"pair.xyzr", "-o", "-d"}, "-o needs a value before -d; for the text '-d', write -o-d"},
      {{"measure", "pair.xyzr", "--csv", "--quite"},
       "--csv needs a value before --quite; for the text '--quite', write --csv=--quite"},
      {{"msms", "-if", "pair.xyzr", "-of", "-d", "3"},
       "-of needs a value before -d; for a file of this name, write ./-d"},
      {{"pair.xyzr", "--surface", "--write", "none"},
       "--surface is '--write', expected ses, sas or vdw"},
      {{"measure", "pair.xyzr", "--csv", "--quiet"},
       "--csv needs a value before --quiet; for the text '--quiet', write --csv=--quiet"},
      {{"msms", "-if", "pair.xyzr", "-of", "-density", "3"},
       "-of needs a value before -density; for a file of this name, write ./-density"},
      {{"measure", "pair.xyzr", "--format", "-q"},
       "--format is '-q', expected auto, xyzr, pqr, pdb or mmcif"},
      {{"--", "pair.xyzr", "--mesh", "a.ply"},
       "PROBE is '--mesh', expected a number from 0.01 to 1000, in angstrom; options must come "
       "before '--' and FILE"},
  };
  for (const auto& [arguments, message] : expected) check_usage_error(sandbox, arguments, message);
  const Outcome swapped = sandbox.run({"pair.xyzr", "0.4", "1.4", "--write", "none"});
  CHECK(swapped.code == 0);
  CHECK(contains(swapped.err,
                 "a probe radius of 0.4 with a spacing of 1.4 is unusual; are they "
                 "swapped? PROBE comes first"));
}
