// Tests of `eses-blocks measure`: its values. Expected values are closed forms of spheres, and
// those of FreeSASA.

#include <fmt/format.h>

#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "catch.hpp"
#include "support/sandbox.hpp"
#include "support/two_spheres.hpp"

namespace eses::detail::test {

using namespace two_spheres;

namespace {

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

}  // namespace eses::detail::test
