// Tests of the real program: values, files and names.

#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <string>

#include "catch.hpp"
#include "input/read_structure.hpp"
#include "support/sandbox.hpp"

namespace fs = std::filesystem;
using namespace eses::detail::test;

namespace {

std::string usage_message(const std::string& message) {
  return "eses-blocks: error: " + message + "\nTry 'eses-blocks --help'.\n";
}

}  // namespace

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
