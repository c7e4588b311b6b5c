// Tests of the tables and records of `eses-blocks measure`. Expected values are closed forms of
// spheres.

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "catch.hpp"
#include "support/sandbox.hpp"
#include "support/two_spheres.hpp"

namespace eses::detail::test {

using namespace two_spheres;

TEST_CASE("measure: the report on a file with names has polar atoms and chains") {
  const Molecules box;
  const Outcome report = box.run({"measure", "dimer.pqr"});
  REQUIRE(report.code == 0);
  // The three atoms are carbon.
  CHECK(contains(report.out, fmt::format("SAS by class of atoms: 0.0000 polar, {:.4f} apolar\n",
                                         2 * sas_of_one() + free_sas())));
  CHECK(contains(report.out, fmt::format("chain B: 1 atom, SES area {:.4f}, SAS area {:.4f}\n",
                                         ses_of_two() / 2, sas_of_one())));
  const Outcome sas = box.run({"measure", "dimer.pqr", "--surface", "sas"});
  CHECK(contains(sas.out, fmt::format("chain C: 1 atom, SAS area {:.4f}\n", free_sas())));
  CHECK(!contains(box.run({"measure", "two.xyzr"}).out, "polar"));
  std::string many;
  for (int k = 0; k < 12; ++k)
    many += pqr_line(k + 1, "ALA", std::string(1, static_cast<char>('A' + k)), 20.0 * k);
  write_file(box.directory() / "many.pqr", many);
  const Outcome chains = box.run({"measure", "many.pqr"});
  CHECK(contains(chains.out, "chain J: "));
  CHECK(!contains(chains.out, "chain K: "));
  CHECK(contains(chains.out, "2 more chains (--write chains)\n"));
}

TEST_CASE("measure: tables have the areas of atoms, residues and chains") {
  const Molecules box;
  REQUIRE(box.run({"measure", "dimer.pqr", "--write", "atoms,residues,chains", "-o", "out"}).code ==
          0);
  const auto atoms = rows_of(box.directory() / "out/dimer.atoms.csv");
  REQUIRE(atoms.size() == 3);
  CHECK(Fields(atoms[0].begin(), atoms[0].begin() + 10) ==
        Fields{"1", "CA", "ALA", "1", "A", "C", "0", "0", "0", "1.7"});
  CHECK(std::stod(atoms[0][10]) == Catch::Approx(sas_of_one()).margin(1e-6));
  CHECK(std::stod(atoms[0][11]) == Catch::Approx(ses_of_two() / 2).margin(1e-6));
  CHECK(std::stod(atoms[1][6]) == distance);
  CHECK(std::stod(atoms[2][11]) == Catch::Approx(free_ses()).margin(1e-6));
  const auto residues = rows_of(box.directory() / "out/dimer.residues.csv");
  REQUIRE(residues.size() == 3);
  // Maximum areas of Tien et al. (2013): 129 for alanine, 104 for glycine, none for haem.
  CHECK(std::stod(residues[0][9]) == Catch::Approx(sas_of_one() / 129).margin(1e-6));
  const Outcome other_probe =
      box.run({"measure", "dimer.pqr", "--table", "residues", "--probe-radius", "1.5"});
  CHECK(split(split(other_probe.out, '\n')[1], ',')[9].empty());
  const Outcome miller =
      box.run({"measure", "dimer.pqr", "--table", "residues", "--reference", "miller"});
  const Fields alanine = split(split(miller.out, '\n')[1], ',');
  CHECK(std::stod(alanine[9]) == Catch::Approx(sas_of_one() / 113).margin(1e-6));
  CHECK(residues[1][9].empty());
  CHECK(std::stod(residues[2][9]) == Catch::Approx(free_sas() / 104).margin(1e-6));
  const auto chains = rows_of(box.directory() / "out/dimer.chains.csv");
  REQUIRE(chains.size() == 3);
  CHECK(Fields(chains[2].begin(), chains[2].begin() + 3) == Fields{"C", "1", "1"});
  CHECK(std::stod(chains[2][3]) == Catch::Approx(free_sas()).margin(1e-6));
}

TEST_CASE("measure: amino acids without a maximum area are a note") {
  const Molecules box;
  std::string text;
  for (const char* residue : {"SEP", "MSE", "SEP", "HYP"})
    for (const char* atom : {"N", "CA", "C"}) {
      const std::size_t serial = static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1;
      text += fmt::format("ATOM {} {} {} A {} {} 0 0 0 1.7\n", serial, atom, residue,
                          (serial + 2) / 3, 1.5 * static_cast<double>(serial));
    }
  write_file(box.directory() / "modified.pqr", text);
  constexpr std::string_view note =
      "note: modified.pqr: modified amino acids without a maximum area have no relative area: "
      "HYP (1 residue), SEP (2 residues)\n";
  for (const char* table : {"residues", "rsa"})
    CHECK(contains(box.run({"measure", "modified.pqr", "--table", table}).err, note));
  CHECK(contains(box.run({"measure", "modified.pqr", "--write", "residues"}).err, note));
  for (const Arguments& others :
       {Arguments{"--table", "atoms"}, Arguments{"--table", "residues", "--quiet"},
        Arguments{"--table", "residues", "--report", "2"},
        Arguments{"--table", "residues", "--probe-radius", "1.2"}}) {
    Arguments arguments{"measure", "modified.pqr"};
    arguments.insert(arguments.end(), others.begin(), others.end());
    CHECK(!contains(box.run(arguments).err, "relative area"));
  }
}

TEST_CASE("measure: --table prints what --write writes, also in the formats of other programs") {
  const Molecules box;
  const auto printed = [&](const std::string& table) {
    const Outcome outcome = box.run({"measure", "dimer.pqr", "--table", table});
    CHECK(outcome.code == 0);
    return outcome.out;
  };
  REQUIRE(box.run({"measure", "dimer.pqr", "--write", "residues,rsa,seq,res,pdb,cif", "-o", "out"})
              .code == 0);
  for (const auto& [table, ending] : {std::pair{"residues", "residues.csv"},
                                      {"rsa", "rsa"},
                                      {"seq", "seq"},
                                      {"res", "res"},
                                      {"pdb", "areas.pdb"},
                                      {"cif", "areas.cif"}}) {
    INFO(table);
    CHECK(printed(table) == read_file(box.directory() / "out" / (std::string("dimer.") + ending)));
  }
  // Columns of NACCESS: the area from column 17, the relative one from column 24.
  const std::string rsa = printed("rsa");
  const std::string row = rsa.substr(rsa.find("RES ALA"));
  CHECK(row.substr(0, 14) == "RES ALA A   1 ");
  CHECK(std::stod(row.substr(16, 6)) == Catch::Approx(sas_of_one()).margin(0.005));
  CHECK(std::stod(row.substr(23, 5)) == Catch::Approx(100 * sas_of_one() / 129).margin(0.05));
  CHECK(std::stod(row.substr(29, 6)) == Catch::Approx(0).margin(0.005));  // CA is main chain
  CHECK(std::stod(row.substr(55, 6)) == Catch::Approx(sas_of_one()).margin(0.005));
  CHECK(contains(printed("seq"), fmt::format("SEQ B    2  HEM : {:7.2f}\n", sas_of_one())));
  CHECK(contains(printed("res"), fmt::format("RES GLY : {:10.2f}\n", free_sas())));
  CHECK(
      contains(printed("pdb"), fmt::format("ATOM      1  CA  ALA A   1       0.000   0.000   0.000"
                                           "  1.70{:6.2f}           C\n",
                                           sas_of_one())));
  write_file(box.directory() / "long.pqr", "ATOM 1 CA ALA A 10000 0 0 0 0 2\n");
  const Outcome wide = box.run({"measure", "long.pqr", "--table", "pdb"});
  CHECK(wide.code == 1);
  CHECK(contains(wide.err,
                 "long.pqr: residue number 10000 of A:ALA 10000 is too wide for its column; "
                 "write csv or cif"));
}

// The area of two SAS spheres of radius R at distance d is 4 pi R^2 + 2 pi R d, that of a free
// sphere 4 pi R^2; the derivative of its volume by the radius is its area.
TEST_CASE("measure: derivatives have the closed values of spheres") {
  const Molecules box;
  const Outcome outcome = box.run({"measure", "two.xyzr", "--write", "derivatives", "--json"});
  REQUIRE(outcome.code == 0);
  const auto rows = rows_of(box.directory() / "two.derivatives.csv");
  REQUIRE(rows.size() == 2);
  REQUIRE(rows[0].size() == 17);
  const double sas = radius + probe;
  for (const std::size_t side : {0U, 1U}) {
    const auto value = [&](std::size_t column) { return std::stod(rows[side][column]); };
    CHECK(rows[side][0] == std::to_string(side + 1));
    // The table has all digits.
    CHECK(std::fabs(value(9) - (side == 0 ? -1 : 1) * 2 * std::numbers::pi * sas) < 1e-12);
    CHECK(value(10) == Catch::Approx(0).margin(1e-9));
    CHECK(value(16) == Catch::Approx(sas_of_one()));
  }
  const double by_probe = 8 * std::numbers::pi * sas + 2 * std::numbers::pi * distance;
  check_near(box, outcome.out, "r['derivatives_by_probe_radius']['sas_area']", by_probe);
  check_json(box, outcome.out, "r['derivatives_are_smooth']", "True");
}

// Six atoms of radius 1 around a place that just holds a probe of radius 0.7, and a free atom.
TEST_CASE("measure: cavities and pieces in report, JSON and tables") {
  const Molecules box;
  std::string atoms = "9 9 9 1.5\n";
  for (const char* line : {"1.7 0 0", "-1.7 0 0", "0 1.7 0", "0 -1.7 0", "0 0 1.7", "0 0 -1.7"})
    atoms += fmt::format("{} 1\n", line);
  write_file(box.directory() / "hole.xyzr", atoms);
  const Outcome outcome = box.run({"measure", "hole.xyzr", "--probe-radius", "0.7", "--cavities",
                                   "--json", "--write", "cavities,pieces"});
  REQUIRE(outcome.code == 0);
  const double volume = 4 * std::numbers::pi / 3 * 0.7 * 0.7 * 0.7;
  check_json(box, outcome.out, "len(r['cavities'])", "1");
  check_json(box, outcome.out,
             fmt::format("abs(r['cavities'][0]['void_volume'] - {:.17g}) < 1e-6", volume), "True");
  check_json(box, outcome.out, "r['cavities'][0]['atoms']", "[2, 3, 4, 5, 6, 7]");
  check_json(box, outcome.out, "r['cavities'][0]['overlaps']", "[]");
  check_json(box, outcome.out, "r['cavities'][0]['piece']", "1");
  check_json(box, outcome.out, "[piece['atoms'] for piece in r['pieces']]", "[6, 1]");
  check_json(box, outcome.out, "[piece['cavities'] for piece in r['pieces']]", "[1, 0]");
  const auto cavities = rows_of(box.directory() / "hole.cavities.csv");
  REQUIRE(cavities.size() == 1);
  REQUIRE(cavities[0].size() == 22);
  CHECK(std::stod(cavities[0][1]) == Catch::Approx(volume).margin(1e-6));
  CHECK(cavities[0][20] == "2 3 4 5 6 7");
  const auto pieces = rows_of(box.directory() / "hole.pieces.csv");
  REQUIRE(pieces.size() == 2);
  CHECK(pieces[0][9] == "2");
  CHECK(pieces[1][9] == "1");
  const Outcome report = box.run({"measure", "hole.xyzr", "--probe-radius", "0.7", "--cavities"});
  CHECK(report.out.find("2 pieces, 1 cavity\n") != std::string::npos);
  REQUIRE(box.run({"measure", "hole.xyzr", "two.xyzr", "--cavities", "--probe-radius", "0.7",
                   "--csv", "all.csv"})
              .code == 0);
  const std::string table = read_file(box.directory() / "all.csv");
  CHECK(box.run({"measure", "two.xyzr", "--csv", "/dev/stdout"}, "| cat").out ==
        box.run({"measure", "two.xyzr", "--csv", "-"}).out);
  CHECK(table.find(",cavities,pieces,model,radii,left_out,error\n") != std::string::npos);
  CHECK(table.find(",1,2,,,,\n") != std::string::npos);
  const Outcome plain = box.run({"measure", "two.xyzr", "--json"});
  CHECK(plain.out.find("cavities") == std::string::npos);
}

// Six atoms around a window that the probe passes and the large one does not.
TEST_CASE("measure: pockets in report, JSON and tables") {
  const Molecules box;
  std::string atoms = pqr_line(1, "ALA", "A", 50);
  for (int k = 0; k < 6; ++k)
    atoms +=
        fmt::format("ATOM {:6}  CA  GLY B{:4}    {:8.3f}{:8.3f}   0.000  0.00 3.00\n", k + 2, k / 2,
                    5 * std::cos(k * std::numbers::pi / 3), 5 * std::sin(k * std::numbers::pi / 3));
  write_file(box.directory() / "ring.pqr", atoms);
  const Arguments search{"measure",   "ring.pqr", "--large-probe",       "3.5",
                         "--spacing", "0.2",      "--min-pocket-volume", "5"};
  const auto run = [&](const Arguments& more) {
    Arguments arguments = search;
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = box.run(arguments);
    REQUIRE(outcome.code == 0);
    return outcome.out;
  };
  const std::string json = run({"--pockets", "--json", "--write", "pockets"});
  check_json(box, json, "len(r['pockets'])", "1");
  check_json(box, json, "r['pockets'][0]['mouths']", "2");
  check_json(box, json, "r['pockets'][0]['atoms']", "[2, 3, 4, 5, 6, 7]");
  check_json(box, json, "r['pockets'][0]['residues']", "['B:GLY 0', 'B:GLY 1', 'B:GLY 2']");
  check_json(box, json, "max(abs(x) for x in r['pockets'][0]['centroid']) < 0.1", "True");
  check_json(box, json, "r['pocket_search']['large_probe_radius']", "3.5");
  check_json(box, json, "r['pocket_search']['spacing']", "0.2");
  check_json(box, json,
             "0 <= r['pocket_search']['shallow_volume'] < r['pocket_search']['difference_volume']",
             "True");
  const auto rows = rows_of(box.directory() / "ring.pockets.csv");
  REQUIRE(rows.size() == 1);
  REQUIRE(rows[0].size() == 10);
  check_json(box, json, fmt::format("abs(r['pockets'][0]['volume'] - {}) < 1e-6", rows[0][1]),
             "True");
  CHECK(rows[0][4] == "2");
  CHECK(rows[0][8] == "2 3 4 5 6 7");
  CHECK(rows[0][9] == "B:GLY 0; B:GLY 1; B:GLY 2");
  const std::string report = run({"--pockets"});
  CHECK(report.find("1 pocket for a large probe of 3.5 angstrom on a grid of 0.2 angstrom\n") !=
        std::string::npos);
  CHECK(run({"--pockets", "--csv", "all.csv"}) == report);
  const std::string table = read_file(box.directory() / "all.csv");
  CHECK(table.find(",pockets,pocket_volume,model,radii,left_out,error\n") != std::string::npos);
  CHECK(table.find(fmt::format(",1,{},,,,\n", rows[0][1])) != std::string::npos);
  CHECK(run({"--write", "pockets", "--json"}).find("pockets") == std::string::npos);
}

}  // namespace eses::detail::test
