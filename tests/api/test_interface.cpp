// Tests of interfaces. Expected values are closed forms of two spheres, and differences of areas
// that `measure` finds.

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <eses/eses.hpp>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "catch.hpp"
#include "support/near_degenerate.hpp"
#include "support/sandbox.hpp"

namespace eses::detail::test {
namespace {

constexpr double probe = 1.4, radius = 1.7, distance = 3;

/// SAS area that a sphere loses to an equal one at `distance`: that of a cap.
double lost_sas() {
  const double sas = radius + probe;
  return 2 * std::numbers::pi * sas * (sas - distance / 2);
}

double free_sas() { return 4 * std::numbers::pi * (radius + probe) * (radius + probe); }

std::string atom_line(int serial, const char* name, const char* residue, char chain, double x) {
  return fmt::format("ATOM  {:5} {:4} {} {}{:4}    {:8.3f}   0.000   0.000  0.00 {:.2f}\n", serial,
                     name, residue, chain, serial, x, radius);
}

/// A sandbox with two atoms in contact, of chains A and B, and a third one far away, of chain C.
struct Complex : Sandbox {
  Complex() {
    write_file(directory() / "dimer.pqr", atom_line(1, " N", "ALA", 'A', 0) +
                                              atom_line(2, " C1", "HEM", 'B', distance) +
                                              atom_line(3, " CA", "GLY", 'C', 50));
  }
};

std::vector<Atom> random_atoms(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> coordinate(0, 14), size(1.2, 2);
  std::vector<Atom> atoms(static_cast<std::size_t>(count));
  for (Atom& atom : atoms)
    atom = {{coordinate(random), coordinate(random), coordinate(random)}, size(random)};
  return atoms;
}

double sas_area(const std::vector<Atom>& atoms, const std::vector<std::uint32_t>& parts,
                std::vector<std::uint32_t> chosen, double probe_radius = probe) {
  std::vector<Atom> some;
  for (std::size_t i = 0; i < atoms.size(); ++i)
    if (std::find(chosen.begin(), chosen.end(), parts[i]) != chosen.end()) some.push_back(atoms[i]);
  return some.empty() ? 0 : measure(Surface(some), {.probe_radius = probe_radius}).sas_area;
}

}  // namespace

TEST_CASE("interfaces: pairs of parts have the differences of their areas") {
  std::mt19937 random(49);
  const std::vector<Atom> atoms = random_atoms(random, 120);
  std::vector<std::uint32_t> parts;
  for (std::size_t i = 0; i < atoms.size(); ++i)
    parts.push_back(i % 4 == 3 ? no_part : static_cast<std::uint32_t>(i % 4));
  const std::vector<Interface> found = measure_interfaces(Surface(atoms), parts);
  REQUIRE(found.size() == 3);
  for (const Interface& interface : found) {
    CHECK(interface.first < interface.second);
    const double expected = sas_area(atoms, parts, {interface.first}) +
                            sas_area(atoms, parts, {interface.second}) -
                            sas_area(atoms, parts, {interface.first, interface.second});
    CHECK(interface.sas.total() == Catch::Approx(expected).epsilon(1e-10));
    CHECK(interface.sas.interface_area() == Catch::Approx(expected / 2).epsilon(1e-10));
    double by_atom = 0;
    for (const BuriedAtom& buried : interface.atoms) {
      by_atom += buried.sas;
      CHECK(buried.sas >= -1e-9);
      CHECK((parts[buried.atom] == interface.first || parts[buried.atom] == interface.second));
    }
    CHECK(by_atom == Catch::Approx(expected).epsilon(1e-10));
  }
}

TEST_CASE("interfaces: parts of almost degenerate sets have the differences of their areas") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const NearDegenerateSet set = make_near_degenerate_set(seed);
    std::vector<std::uint32_t> parts;
    for (std::size_t i = 0; i < set.atoms.size(); ++i)
      parts.push_back(static_cast<std::uint32_t>(i % 2));
    INFO(set.name);
    const auto area = [&](std::vector<std::uint32_t> chosen) {
      return sas_area(set.atoms, parts, std::move(chosen), set.probe_radius);
    };
    for (const Interface& interface :
         measure_interfaces(Surface(set.atoms, {.probe_radius = set.probe_radius}), parts))
      CHECK(interface.sas.total() ==
            Catch::Approx(area({0}) + area({1}) - area({0, 1})).margin(1e-5));
  }
}

TEST_CASE("interfaces: only spheres that a probe touches at once make one") {
  constexpr double gap = 2 * (radius + probe);
  const std::vector<std::uint32_t> parts{0, 1};
  for (const double x : {gap - 1e-3, gap + 1e-3}) {
    const Surface surface({Atom{{0, 0, 0}, radius}, Atom{{x, 0, 0}, radius}});
    CHECK(measure_interfaces(surface, parts).size() == (x < gap ? 1 : 0));
  }
  CHECK_THROWS_AS(measure_interfaces(Surface({Atom{{0, 0, 0}, 1}}), parts), std::invalid_argument);
}

TEST_CASE("interfaces: polar atoms, with the hydrogens at them") {
  const std::vector<Atom> atoms{
      {{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{5, 0, 0}, 1}, {{6, 0, 0}, 1}, {{5.9, 0, 0}, 1}};
  std::vector<AtomLabel> labels(5, AtomLabel{"A", "SER", "1", "X"});
  labels[0].element = "O";
  labels[1].element = "H";
  labels[2].element = "C";
  labels[3].element = "D";
  labels[4].element = "Se";
  labels[4].residue_number = "2";  // is nearer to the hydrogen, but of another residue
  CHECK(find_polar_atoms(atoms, labels) == std::vector<bool>{true, true, false, false, true});
}

TEST_CASE("interfaces: halogens are apolar in molecules, and ions are polar") {
  const std::vector<Atom> atoms(4, Atom{{0, 0, 0}, 1});
  std::vector<AtomLabel> labels(4, AtomLabel{"A", "LIG", "1", "X"});
  for (const auto& [i, element] :
       {std::pair<std::size_t, const char*>{0, "Cl"}, {1, "C"}, {2, "Cl"}, {3, "Zn"}})
    labels[i].element = element;
  labels[2].residue_number = "2";
  labels[3].residue_number = "3";
  CHECK(find_polar_atoms(atoms, labels) == std::vector<bool>{false, false, true, true});
  labels[0].atom_class = AtomClass::polar;  // as the set of radii has it
  labels[3].atom_class = AtomClass::apolar;
  CHECK(find_polar_atoms(atoms, labels) == std::vector<bool>{true, false, true, false});
}

TEST_CASE("interface: a file of one chain says what to choose") {
  const Sandbox box;
  write_file(box.directory() / "one.pqr", atom_line(1, " CA", "ALA", 'A', 0));
  const Outcome outcome = box.run({"interface", "one.pqr"});
  CHECK(outcome.code == 0);
  CHECK(contains(outcome.out, "0 interfaces"));
  CHECK(contains(outcome.out, "the file has a single chain; --ligand NAME"));
}

TEST_CASE("interface: all pairs of chains that touch, as text, JSON and tables") {
  const Complex box;
  const Outcome text = box.run({"interface", "dimer.pqr"});
  REQUIRE(text.code == 0);
  CHECK(text.err.empty());
  CHECK(contains(text.out, "1 interface "));
  CHECK(contains(text.out,
                 fmt::format("A and B: SAS interface area {:.4f} ({:.4f} polar, {:.4f} apolar)",
                             lost_sas(), lost_sas() / 2, lost_sas() / 2)));
  CHECK(contains(text.out,
                 fmt::format("  SAS lost by A: {0:.4f} of {1:.4f} ({2:.1f} %); by B: {0:.4f} of",
                             lost_sas(), free_sas(), 100 * lost_sas() / free_sas())));
  CHECK(contains(text.out, fmt::format("  A: 1 residue: A:ALA 1 {:.1f}\n", lost_sas())));
  const Outcome json = box.run({"interface", "dimer.pqr", "--json"});
  check_json(box, json.out, "len(r['interfaces'])", "1");
  for (const char* side : {"lost_by_first", "lost_by_second", "interface_area"})
    check_json(
        box, json.out,
        fmt::format("abs(r['interfaces'][0]['sas']['{}'] - {:.17g}) < 1e-9", side, lost_sas()),
        "True");
  check_json(box, json.out, "r['interfaces'][0]['second']['residues'][0]['residue']", "'HEM'");
  const Outcome rows = box.run({"interface", "dimer.pqr", "--table", "interfaces"});
  CHECK(contains(rows.out, fmt::format("\nA,B,{0:.6f},{0:.6f},{0:.6f},", lost_sas())));
  const Outcome residues = box.run({"interface", "dimer.pqr", "--table", "residues"});
  CHECK(contains(residues.out, fmt::format("\nB,A,B,2,HEM,{:.6f},", lost_sas())));
  const Outcome atoms = box.run({"interface", "dimer.pqr", "--table", "atoms"});
  CHECK(contains(atoms.out, fmt::format("\nA,B,1,N,ALA,1,A,N,1,{:.6f},", lost_sas())));
}

TEST_CASE("interface: chains without a name are named so") {
  const Sandbox box;
  write_file(box.directory() / "blank.pqr",
             atom_line(1, " N", "ALA", 'A', 0) + atom_line(2, " C1", "HEM", ' ', distance));
  const Outcome outcome = box.run({"interface", "blank.pqr"});
  CHECK(contains(outcome.out, "A and no chain: SAS interface area"));
  CHECK(contains(outcome.out, "; by no chain: "));
  CHECK(contains(outcome.out, fmt::format("  no chain: 1 residue: HEM 2 {:.1f}\n", lost_sas())));
  CHECK(contains(box.run({"measure", "blank.pqr"}).out, "\nno chain: 1 atom, SES area "));
}

TEST_CASE("interface: groups, ligands and cutoffs choose what is measured") {
  const Complex box;
  const Outcome groups = box.run({"interface", "dimer.pqr", "--groups", "A+C", "ligand:HEM"});
  CHECK(contains(groups.out, fmt::format("A,C and HEM: SAS interface area {:.4f}", lost_sas())));
  // Beside a side of ligands, a side of chains is without them, in any order.
  write_file(box.directory() / "one.pqr",
             atom_line(1, " N", "ALA", 'A', 0) + atom_line(2, " C1", "HEM", 'A', distance));
  for (const Arguments& sides : {Arguments{"A", "ligand:HEM"}, Arguments{"ligand:HEM", "A"}}) {
    const Outcome one = box.run({"interface", "one.pqr", "--groups", sides[0], sides[1]});
    CHECK(contains(one.out, fmt::format("SAS interface area {:.4f}", lost_sas())));
  }
  const Outcome ligand = box.run({"interface", "dimer.pqr", "--ligand", "HEM"});
  CHECK(contains(ligand.out, "B:HEM 2 and all other atoms: SAS interface area"));
  const Outcome cut = box.run({"interface", "dimer.pqr", "--area-cutoff", "300"});
  CHECK(cut.code == 0);
  CHECK(contains(cut.out, "0 interfaces"));
  CHECK(contains(cut.out, "no interface has 300 A^2, the area of --area-cutoff\n"));
  const Outcome residues = box.run({"interface", "dimer.pqr", "--residue-cutoff", "300"});
  CHECK(contains(residues.out, "  A: 0 residues\n"));
  // `measure --parts` takes the same parts.
  const Outcome parts = box.run({"measure", "dimer.pqr", "--parts", "A|ligand:HEM", "--json"});
  check_json(box, parts.out,
             fmt::format("abs(r['buried_sas_area'] - {:.17g}) < 1e-9", 2 * lost_sas()), "True");
}

TEST_CASE("interface: errors say what is wrong") {
  const Complex box;
  const auto error = [&](const Arguments& arguments) {
    const Outcome outcome = box.run(arguments);
    CHECK(outcome.code == 1);
    CHECK(outcome.out.empty());
    return outcome.err;
  };
  CHECK(contains(error({"interface", "dimer.pqr", "--groups", "A", "X"}),
                 "dimer.pqr: no atoms of chain X, which --groups names; the chains are A, B, C"));
  CHECK(contains(error({"interface", "dimer.pqr", "--ligand", "STI"}),
                 "no atoms of residue STI, which --ligand names; the residues are HEM, ALA, GLY"));
  CHECK(contains(error({"interface", "dimer.pqr", "--groups", "ligand:HEM", "ligand:HEM"}),
                 "dimer.pqr: the atom in line 2 belongs to two parts of --groups: HEM and HEM"));
  CHECK(contains(box.run({"interface", "dimer.pqr", "--groups", "//A", "2"}).out,
                 "//A and 2: SAS interface area"));
  CHECK(contains(error({"interface", "none.pdb"}), "cannot open none.pdb"));
  CHECK(contains(error({"interface", "none.xyzr"}), "cannot open none.xyzr"));
  write_file(box.directory() / "a.xyzr", "0 0 0 1\n");
  check_usage_error(
      box, {"interface", "a.xyzr"},
      "interface needs a PQR, PDB or mmCIF file; a.xyzr is read as xyzr, which has no "
      "chains (use --format pqr, pdb or mmcif if it is such a file)");
  check_usage_error(box, {"interface", "a.pdb", "--groups", "A", "A+B"},
                    "--groups names chain A twice");
  check_usage_error(box, {"interface", "a.pdb", "--groups", "A", "B", "--ligand", "X"},
                    "--ligand cannot be combined with --groups; use --groups ligand:X A");
  check_usage_error(box, {"interface", "a.pdb", "--groups", "A"},
                    "--groups needs two sides, such as --groups A+B C");
  check_usage_error(box, {"interface", "a.pdb", "--json", "--table", "atoms"},
                    "--table excludes --json; use only one of them");
}

}  // namespace eses::detail::test
