// Tests of the files that `eses-blocks measure` reads, and of requests that it refuses.

#include <fmt/format.h>

#include <filesystem>
#include <numbers>
#include <string>
#include <utility>

#include "catch.hpp"
#include "support/sandbox.hpp"
#include "support/two_spheres.hpp"

namespace eses::detail::test {

using namespace two_spheres;

TEST_CASE("measure: folders and lists stand for their files") {
  const Molecules box;
  const fs::path folder = box.directory() / "structures";
  fs::create_directories(folder / "more");
  fs::copy(box.directory() / "two.xyzr", folder / "b.xyzr");
  fs::copy(box.directory() / "dimer.pqr", folder / "a.pqr");
  fs::copy(box.directory() / "one.xyzr", folder / "more/c.xyzr");
  write_file(folder / "notes.txt", "no atoms\n");
  const auto files = [&](const Arguments& arguments, const std::string& redirection = "") {
    const Outcome outcome = box.run(arguments, redirection);
    CHECK(outcome.code == 0);
    Fields names;
    for (const std::string& line : split(outcome.out, '\n'))
      names.push_back(line.substr(line.rfind(' ') + 1));
    return names;
  };
  CHECK(files({"measure", "structures", "-q"}) == Fields{"structures/a.pqr", "structures/b.xyzr"});
  CHECK(files({"measure", "-r", "structures", "one.xyzr", "-q"}) ==
        Fields{"structures/a.pqr", "structures/b.xyzr", "structures/more/c.xyzr", "one.xyzr"});
  // Files of areas in the folder are left out if measure has written them. A file that only has
  // such a name is measured.
  REQUIRE(box.run({"measure", "structures/a.pqr", "--write", "pdb,cif", "-o", "structures"}).code ==
          0);
  const Outcome noted = box.run({"measure", "structures"});
  CHECK(contains(noted.err,
                 "note: left out 2 files of areas that --write has written, such as "
                 "structures/a.areas.cif; name a file to measure it"));
  CHECK(box.run({"measure", "structures", "-q"}).err.empty());
  CHECK(files({"measure", "structures/a.areas.pdb", "two.xyzr", "-q"}) ==
        Fields{"structures/a.areas.pdb", "two.xyzr"});
  fs::copy(folder / "more/c.xyzr", folder / "more/d.areas.xyzr");
  const std::string areas = read_file(folder / "a.areas.pdb");
  write_file(folder / "more/e.areas.pdb", areas.substr(areas.find('\n') + 1));
  CHECK(files({"measure", "-r", "structures", "-q"}) ==
        Fields{"structures/a.pqr", "structures/b.xyzr", "structures/more/c.xyzr",
               "structures/more/d.areas.xyzr", "structures/more/e.areas.pdb"});
  write_file(box.directory() / "list", "two.xyzr\r\n\none.xyzr");
  CHECK(files({"measure", "--files-from", "list", "-q"}) == Fields{"two.xyzr", "one.xyzr"});
  CHECK(files({"measure", "--files-from", "-", "-q"}, "< list") == Fields{"two.xyzr", "one.xyzr"});
  const auto error = [&](const Arguments& arguments) {
    const Outcome outcome = box.run(arguments);
    CHECK(outcome.code == 1);
    return outcome.err;
  };
  fs::create_directory(box.directory() / "empty");
  CHECK(contains(error({"measure", "empty"}),
                 "no PDB, mmCIF, PQR or xyzr files in the folder empty"));
  write_file(box.directory() / "list", "\n");
  CHECK(contains(error({"measure", "--files-from", "list"}), "list: the list has no files"));
  CHECK(contains(error({"measure", "--files-from", "none"}), "cannot open none"));
}

TEST_CASE("measure: a bad file does not stop the others") {
  const Molecules box;
  write_file(box.directory() / "wrong.pqr", "ATOM\n");
  const Outcome outcome =
      box.run({"measure", "one.xyzr", "missing.xyzr", "two.xyzr", "wrong.pqr", "--csv", "all.csv"});
  CHECK(outcome.code == 1);
  CHECK(contains(outcome.err, "error: cannot open missing.xyzr"));
  CHECK(contains(outcome.err, "error: wrong.pqr"));
  const Fields lines = split(outcome.out, '\n');
  REQUIRE(lines.size() == 3);  // with the heading
  CHECK(lines[1].ends_with(" one.xyzr"));
  CHECK(lines[2].ends_with(" two.xyzr"));
  const auto rows = rows_of(box.directory() / "all.csv");
  REQUIRE(rows.size() == 4);
  CHECK(std::stod(rows[0][3]) == Catch::Approx(16 * std::numbers::pi).margin(1e-6));
  CHECK(rows[0].back().empty());
  CHECK(rows[1].front() == "missing.xyzr");
  CHECK(rows[1].size() == rows[0].size());
  CHECK(rows[1].back() == "cannot open missing.xyzr: No such file or directory");
  CHECK(std::stod(rows[2][3]) == Catch::Approx(ses_of_two()).margin(1e-6));
  const Outcome json = box.run({"measure", "one.xyzr", "missing.xyzr", "--json"});
  const Fields objects = split(json.out, '\n');
  REQUIRE(objects.size() == 2);
  check_json(box, objects[1], "sorted(r)", "['error', 'file']");
}

TEST_CASE("measure: bad requests are refused") {
  const Molecules box;
  check_usage_error(box, {"measure"}, "FILE is required");
  check_usage_error(box, {"measure", "two.xyzr", "--write", "x"},
                    "--write is 'x', expected some of "
                    "atoms,residues,chains,derivatives,cavities,pieces,pockets,rsa,"
                    "seq,res,pdb,cif");
  check_usage_error(box, {"measure", "dimer.pqr", "--table", "rsa", "--json"},
                    "--table excludes --json; use only one of them");
  check_usage_error(box, {"measure", "dimer.pqr", "two.xyzr", "--table", "atoms"},
                    "--table prints the table of a single file or model; use --write atoms");
  check_usage_error(
      box, {"measure", "two.xyzr", "--table", "rsa"},
      "--table rsa needs a PQR, PDB or mmCIF file; two.xyzr is read as xyzr, which has no "
      "names (use --format pqr, pdb or mmcif if it is such a file)");
  check_usage_error(box, {"measure", "two.xyzr", "--surface", "sas,x"},
                    "--surface is 'sas,x', expected some of ses,sas,vdw, or all");
  check_usage_error(box, {"measure", "two.xyzr", "--surface", "sas", "--cavities"},
                    "--cavities needs --surface ses or all");
  check_usage_error(box, {"measure", "two.xyzr", "--surface", "sas", "--write", "derivatives"},
                    "--write derivatives needs --surface ses or all");
  check_usage_error(box, {"measure", "two.xyzr", "--surface", "vdw", "--write", "atoms"},
                    "--write atoms needs --surface sas, ses or all");
  check_usage_error(box, {"measure", "-", "two.xyzr"},
                    "standard input (-) cannot be combined with other files");
  check_usage_error(box, {"measure", "two.xyzr", "-o", "out"}, "--output-dir needs --write");
  check_usage_error(box, {"measure", "dimer.pqr", "--parts", "A|A"}, "--parts names chain A twice");
  check_usage_error(box, {"measure", "two.xyzr", "--probe-radius", "0.001"},
                    "--probe-radius is '0.001', expected 0, or a number from 0.01 to 1000, in "
                    "angstrom");
  for (const std::string option : {"--large-probe", "--spacing", "--min-pocket-volume"})
    check_usage_error(box, {"measure", "two.xyzr", option, "1"},
                      option + " needs --pockets or --write pockets");
  check_usage_error(box, {"measure", "two.xyzr", "--write", "pieces", "--at", "1,2,3"},
                    "--at needs --pockets, --cavities, or a table of pockets or cavities");
  check_usage_error(box, {"measure", "two.xyzr", "--pockets", "--large-probe", "1.4"},
                    "the radius of the large probe must be more than that of the probe, 1.4, and "
                    "at most 1000 angstrom, and is 1.4 (--large-probe)");
  check_usage_error(box, {"measure", "two.xyzr", "--write", "pockets", "--spacing", "1.5"},
                    "the spacing must be between 0.04375 and 1.4 angstrom for pockets with a probe "
                    "radius of 1.4, and is 1.5 (--spacing)");
  check_usage_error(box, {"measure", "two.xyzr", "--pockets", "--probe-radius", "0"},
                    "the probe radius must be between 0.01 and 1000 angstrom for pockets, and is "
                    "0 (--probe-radius)");
  check_usage_error(box, {"measure", "two.xyzr", "--pockets", "--min-pocket-volume", "-1"},
                    "--min-pocket-volume is '-1', expected a finite number of at least 0, in cubic "
                    "angstrom");
  const auto fails = [&](const Arguments& arguments, const std::string& message) {
    const Outcome outcome = box.run(arguments);
    CHECK(outcome.code == 1);
    CHECK(outcome.out.empty());
    CHECK(outcome.err == "eses-blocks: error: " + message + "\n");
  };
  fails({"measure", "dimer.pqr", "--parts", "A|X"},
        "dimer.pqr: no atoms of chain X, which --parts names; the chains are A, B, C");
  fails({"measure", "dimer.pqr", "--report", "99"},
        "dimer.pqr: no atoms of chain or residue 99, which --report names; the chains are A "
        "(residues 1 to 1), B (residues 2 to 2), C (residues 3 to 3)");
  CHECK(contains(box.run({"measure", "dimer.pqr", "--report", "2"}).out, "report 2: 1 atom, "));
  fails({"measure", "dimer.pqr", "--report", "GLY"},
        "dimer.pqr: no atoms of chain GLY, which --report names; the chains are A, B, C; residue "
        "GLY is "
        "ligand:GLY");
  std::string ten_chains;
  for (char chain = 'A'; chain <= 'J'; ++chain)
    ten_chains += fmt::format("ATOM 1 CA GLY {} 1 {} 0 0 0 1.7\n", chain, 10 * (chain - 'A'));
  write_file(box.directory() / "ten.pqr", ten_chains);
  write_file(box.directory() / "eleven.pqr", ten_chains + "ATOM 1 CA GLY K 1 0 9 0 0 1.7\n");
  for (const auto& [file, more] : {std::pair("ten.pqr", ""), std::pair("eleven.pqr", ", ...")})
    fails({"measure", file, "--parts", "A|X"},
          fmt::format(
              "{}: no atoms of chain X, which --parts names; the chains are A, B, C, D, E, F, "
              "G, H, I, J{}",
              file, more));
  fs::create_directory(box.directory() / "sub");
  fs::copy(box.directory() / "two.xyzr", box.directory() / "sub");
  fails({"measure", "two.xyzr", "sub/two.xyzr", "--write", "atoms"},
        "./two.atoms.csv would be written twice; use separate output directories");
  fails({"measure", "two.xyzr", "--csv", "two.xyzr"},
        "two.xyzr is an input file, and would be overwritten; choose another name");
  write_file(box.directory() / "radii.cfg", "types:\nC 1 apolar\natoms:\nANY C C\n");
  write_file(box.directory() / "one.pdb",
             "ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00 20.00           C\n");
  fails({"measure", "one.pdb", "--radii", "radii.cfg", "--csv", "radii.cfg"},
        "radii.cfg is the file of --radii, and would be overwritten; choose another name");
  write_file(box.directory() / "list.txt", "two.xyzr\n");
  fails({"measure", "--files-from", "list.txt", "--csv", "list.txt"},
        "list.txt is the file of --files-from, and would be overwritten; choose another name");
  fs::create_hard_link(box.directory() / "two.xyzr", box.directory() / "hard.csv");
  fails({"measure", "two.xyzr", "--csv", "hard.csv"},
        "hard.csv is an input file, and would be overwritten; choose another name");
  fs::create_directory(box.directory() / "tables");
  fs::create_symlink("tables", box.directory() / "link");
  fails({"measure", "two.xyzr", "--write", "atoms", "-o", "tables", "--csv", "link/two.atoms.csv"},
        "link/two.atoms.csv would be written twice; use separate output directories");
  fs::create_symlink("/dev/zero", box.directory() / "device.csv");
  fails({"measure", "two.xyzr", "--csv", "device.csv"},
        "cannot write device.csv: it is a character device, not a regular file; choose another "
        "name");
  fs::create_symlink("tables/real.csv", box.directory() / "kept.csv");
  CHECK(box.run({"measure", "two.xyzr", "--csv", "kept.csv"}).code == 0);
  CHECK(fs::is_symlink(box.directory() / "kept.csv"));
  CHECK(fs::exists(box.directory() / "tables" / "real.csv"));
  fails({"measure", "two.xyzr", "--csv", "sub"},
        "cannot write sub: it is a directory, not a regular file; choose another name");
  write_file(box.directory() / "twice.xyzr", "0 0 0 1\n0 0 0 1\n");
  CHECK(box.run({"measure", "twice.xyzr"}).code == 0);
  CHECK(box.run({"measure", "twice.xyzr", "--strict"}).code == 1);
}

}  // namespace eses::detail::test
