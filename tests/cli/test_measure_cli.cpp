// Tests of `eses-blocks measure`. Expected values are closed forms of spheres, and those of
// FreeSASA.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/sandbox.hpp"

namespace fs = std::filesystem;

namespace eses::detail::test {
namespace {

constexpr double probe = 1.4, radius = 1.7, distance = 3;

using Fields = std::vector<std::string>;

Fields split(const std::string& text, char separator) {
  std::istringstream stream(text);
  Fields fields;
  for (std::string field; std::getline(stream, field, separator);) fields.push_back(field);
  if (!text.empty() && text.back() == separator && separator != '\n') fields.emplace_back();
  return fields;
}

/// Rows of a CSV file, without the heading.
std::vector<Fields> rows_of(const fs::path& file) {
  std::vector<Fields> rows;
  for (const std::string& line : split(read_file(file), '\n')) rows.push_back(split(line, ','));
  if (!rows.empty()) rows.erase(rows.begin());
  return rows;
}

/// Area of a sphere that a plane at distance `height` from its centre cuts.
double cut_sphere_area(double sphere, double height) {
  return 2 * std::numbers::pi * sphere * (sphere + height);
}

/// SAS area of one of two atoms at `distance`.
double sas_of_one() { return cut_sphere_area(radius + probe, distance / 2); }

double free_sas() { return 4 * std::numbers::pi * (radius + probe) * (radius + probe); }

double free_ses() { return 4 * std::numbers::pi * radius * radius; }

// Area of two spheres of radius 1.7 at 3 angstrom, whose saddle has no spindle: the convex zones,
// and the torus patch t p (rho 2a - 2 p sin a) for a full circle.
double ses_of_two() {
  const double sas = radius + probe, half = distance / 2;
  const double rho = std::sqrt(sas * sas - half * half), angle = std::asin(half / sas);
  const double convex = 2 * cut_sphere_area(radius, radius * half / sas);
  const double saddle = 4 * std::numbers::pi * probe * (rho * angle - probe * std::sin(angle));
  return convex + saddle;
}

std::string pqr_line(int serial, const std::string& residue, const std::string& chain, double x) {
  return fmt::format("ATOM {:6}  CA  {} {}{:4}    {:8.3f}   0.000   0.000  0.00 {:.2f}\n", serial,
                     residue, chain, serial, x, radius);
}

/// A sandbox with two atoms in contact, as xyzr and, with a third atom far away, as PQR.
struct Molecules : Sandbox {
  Molecules() {
    write_file(directory() / "two.xyzr", "0 0 0 1.7\n3 0 0 1.7\n");
    write_file(directory() / "one.xyzr", "1 2 3 2\n");
    write_file(directory() / "dimer.pqr", pqr_line(1, "ALA", "A", 0) +
                                              pqr_line(2, "HEM", "B", distance) +
                                              pqr_line(3, "GLY", "C", 50));
  }
};

void check_near(const Molecules& box, const std::string& json, const std::string& key,
                double expected) {
  check_json(box, json, fmt::format("abs({} - {:.17g}) < 1e-9", key, expected), "True");
}

/// Writes random overlapping atoms as cluster.xyzr, and as cluster.pdb with the radii in the column
/// of the occupancy, where FreeSASA can read them. Both have the same numbers.
void write_cluster(const fs::path& directory) {
  std::mt19937 random(28);
  std::uniform_real_distribution<double> coordinate(0, 18);
  std::uniform_int_distribution<int> hundredths(140, 190);
  std::string xyzr, pdb;
  for (int i = 1; i <= 300; ++i) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    const double r = hundredths(random) / 100.0;
    xyzr += fmt::format("{:.3f} {:.3f} {:.3f} {:.2f}\n", x, y, z, r);
    pdb +=
        fmt::format("ATOM  {:5}  CA  ALA A{:4}    {:8.3f}{:8.3f}{:8.3f}{:6.2f}  0.00           C\n",
                    i, i, x, y, z, r);
  }
  write_file(directory / "cluster.xyzr", xyzr);
  write_file(directory / "cluster.pdb", pdb);
}

}  // namespace

TEST_CASE("measure: two spheres have their closed values") {
  const Molecules box;
  const Outcome outcome = box.run({"measure", "two.xyzr", "--json"});
  REQUIRE(outcome.code == 0);
  CHECK(outcome.err.empty());
  check_near(box, outcome.out, "r['ses_area']", ses_of_two());
  check_near(box, outcome.out, "r['sas_area']", 2 * sas_of_one());
  check_near(box, outcome.out, "r['vdw_area']", 2 * cut_sphere_area(radius, distance / 2));
  check_near(box, outcome.out, "sum(r['ses_area_by_kind'].values())", ses_of_two());
  check_json(box, outcome.out, "r['euler_number']", "2");
  check_json(box, outcome.out, "r['ses_area_by_kind']['concave']", "0");
  // With a probe of radius 0, all surfaces are that of the spheres.
  const Outcome bare = box.run({"measure", "--probe-radius", "0", "--json", "two.xyzr"});
  for (const char* key : {"r['ses_area']", "r['sas_area']", "r['vdw_area']"})
    check_near(box, bare.out, key, 2 * cut_sphere_area(radius, distance / 2));
  const Outcome standard_input = box.run({"measure", "-", "--json"}, "< two.xyzr");
  check_near(box, standard_input.out, "r['ses_area']", ses_of_two());
}

TEST_CASE("measure: only the chosen surfaces are measured and shown") {
  const Molecules box;
  const auto run = [&](const std::string& surfaces) {
    return box.run({"measure", "two.xyzr", "--surface", surfaces});
  };
  const auto has = [](const Outcome& outcome, const char* name) {
    return contains(outcome.out, fmt::format("\n{:<14}", name));
  };
  for (const auto& [surfaces, ses, sas, vdw] : {std::tuple{"ses", true, false, false},
                                                {"sas", false, true, false},
                                                {"vdw", false, false, true},
                                                {"sas,vdw", false, true, true},
                                                {"all", true, true, true}}) {
    INFO(surfaces);
    const Outcome outcome = run(surfaces);
    REQUIRE(outcome.code == 0);
    CHECK(has(outcome, "SES") == ses);
    CHECK(has(outcome, "SAS") == sas);
    CHECK(has(outcome, "van der Waals ") == vdw);
    CHECK(contains(outcome.out, "Euler number") == ses);
  }
  const Outcome json = box.run({"measure", "two.xyzr", "--surface", "sas,vdw", "--json"});
  check_near(box, json.out, "r['sas_area']", 2 * sas_of_one());
  check_near(box, json.out, "r['vdw_area']", 2 * cut_sphere_area(radius, distance / 2));
  check_json(box, json.out, "'ses_area' in r or 'euler_number' in r", "False");
  const Outcome tables = box.run({"measure", "dimer.pqr", "--surface", "sas", "--parts", "chains",
                                  "--write", "atoms,residues,chains", "-o", "sas"});
  REQUIRE(tables.code == 0);
  const auto chains = rows_of(box.directory() / "sas/dimer.chains.csv");
  REQUIRE(chains.size() == 3);
  CHECK(chains[0].size() == 6);
  CHECK(std::stod(chains[0][3]) == Catch::Approx(sas_of_one()).margin(1e-6));
  CHECK(std::stod(chains[0][5]) == Catch::Approx(free_sas() - sas_of_one()).margin(1e-6));
}

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
  CHECK(table.find(",pockets,model,radii,left_out,error\n") != std::string::npos);
  CHECK(table.find(",1,,,,\n") != std::string::npos);
  CHECK(run({"--write", "pockets", "--json"}).find("pockets") == std::string::npos);
}

TEST_CASE("measure: parts bury the areas of closed forms") {
  const Molecules box;
  const double sas = 2 * (free_sas() - sas_of_one()), ses = 2 * free_ses() - ses_of_two();
  for (const std::string parts : {"chains", "A|B", "B|A,C"}) {
    const Outcome outcome = box.run(
        {"measure", "dimer.pqr", "--parts", parts, "--json", "--write", "residues", "-o", "parts"});
    REQUIRE(outcome.code == 0);
    check_near(box, outcome.out, "r['buried_sas_area']", sas);
    check_near(box, outcome.out, "r['buried_ses_area']", ses);
    check_near(box, outcome.out, "r['parts'][0]['vdw_area']",
               4 * std::numbers::pi * radius * radius);
    check_json(box, outcome.out, "r['other_atoms']", parts == "A|B" ? "1" : "0");
    const auto residues = rows_of(box.directory() / "parts/dimer.residues.csv");
    REQUIRE(residues.size() == (parts == "A|B" ? 2 : 3));
    const std::size_t last = residues[0].size() - 1;
    CHECK(std::stod(residues[0][last - 1]) == Catch::Approx(sas / 2).margin(1e-6));
    CHECK(std::stod(residues[0][last]) == Catch::Approx(ses / 2).margin(1e-6));
    if (residues.size() == 3) CHECK(residues[2][last] == "0.000000");
  }
}

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
                 "note: left out 2 files of areas that measure has written, such as "
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

TEST_CASE("measure: results do not depend on threads") {
  const Molecules box;
  write_cluster(box.directory());
  const Arguments files{"measure", "--json", "cluster.xyzr", "two.xyzr", "one.xyzr", "dimer.pqr"};
  const auto with_threads = [&](const char* threads) {
    Arguments arguments = files;
    arguments.insert(arguments.end(), {"--threads", threads});
    return box.run(arguments).out;
  };
  const std::string expected = with_threads("1");
  CHECK(split(expected, '\n').size() == 4);
  CHECK(with_threads("2") == expected);
  CHECK(with_threads("7") == expected);
}

TEST_CASE("measure: SAS areas are those of FreeSASA with 1000 slices") {
  if (shell("command -v freesasa > /dev/null 2>&1") != 0) SKIP("freesasa is not installed");
  const Molecules box;
  write_cluster(box.directory());
  const std::string directory = shell_quoted(box.directory().string());
  REQUIRE(shell("cd " + directory +
                " && freesasa --lee-richards --resolution=1000 --radius-from-occupancy "
                "--no-warnings --format=pdb cluster.pdb > areas.pdb") == 0);
  REQUIRE(box.run({"measure", "cluster.xyzr", "--write", "atoms"}).code == 0);
  const auto atoms = rows_of(box.directory() / "cluster.atoms.csv");
  std::vector<double> areas;  // in the column of the temperature factor, with two digits
  for (const std::string& line : split(read_file(box.directory() / "areas.pdb"), '\n'))
    if (line.starts_with("ATOM")) areas.push_back(std::stod(line.substr(60, 6)));
  REQUIRE(areas.size() == 300);
  REQUIRE(atoms.size() == 300);
  double ours = 0, theirs = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double area = std::stod(atoms[i][10]);
    INFO("atom " << i);
    CHECK(area == Catch::Approx(areas[i]).epsilon(0).margin(0.05));
    ours += area;
    theirs += areas[i];
  }
  CHECK(ours > 1000);
  CHECK(ours == Catch::Approx(theirs).epsilon(1e-4));
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
                    "--table prints the table of a single file; use --write");
  check_usage_error(
      box, {"measure", "two.xyzr", "--table", "rsa"},
      "--table rsa needs a PQR, PDB or mmCIF file; two.xyzr is read as xyzr, which has no "
      "names (use --format pqr if it is PQR)");
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
  check_usage_error(box, {"measure", "two.xyzr", "--pockets", "--large-probe", "1.4"},
                    "the radius of the large probe must be more than that of the probe, 1.4, and "
                    "at most 1000 angstrom, and is 1.4");
  check_usage_error(box, {"measure", "two.xyzr", "--write", "pockets", "--spacing", "1.5"},
                    "the spacing must be between 0.04375 and 1.4 angstrom for pockets with a probe "
                    "radius of 1.4, and is 1.5");
  check_usage_error(box, {"measure", "two.xyzr", "--pockets", "--probe-radius", "0"},
                    "the probe radius must be between 0.01 and 1000 angstrom for pockets, and is "
                    "0");
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
  fails({"measure", "dimer.pqr", "--report", "2"},
        "dimer.pqr: no atoms of chain 2, which --report names; the chains are A, B, C; residue 2 "
        "is //B/2");
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
  fs::create_symlink("/dev/null", box.directory() / "device.csv");
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
