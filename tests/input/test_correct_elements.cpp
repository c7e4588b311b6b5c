#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "eses/radii.hpp"

namespace eses::detail::test {
namespace {

/// An atom of a residue with its number.
struct Given {
  std::string residue, number, name, element;
  Vec3 center;
};

/// Returns the elements after correct_elements, and adds the atoms that have changed to `changed`.
std::vector<std::string> corrected(const std::vector<Given>& atoms,
                                   std::vector<AtomIndex>* changed = nullptr) {
  std::vector<Vec3> centers;
  std::vector<AtomLabel> labels;
  for (const auto& [residue, number, name, element, center] : atoms) {
    centers.push_back(center);
    labels.push_back({"A", residue, number, name, element});
  }
  const std::vector<AtomIndex> found = correct_elements(centers, labels);
  if (changed != nullptr) *changed = found;
  std::vector<std::string> elements;
  for (const AtomLabel& label : labels) elements.push_back(label.element);
  return elements;
}

using Texts = std::vector<std::string>;

TEST_CASE("correct_elements: ions alone in their residue", "[radii]") {
  std::vector<AtomIndex> changed;
  CHECK(corrected({{"ION", "1", "NA+", "N", {}},
                   {"ION", "2", "CL-", "C", {}},
                   {"SOD", "3", "SOD", "S", {}},
                   {"POT", "4", "POT", "Po", {}},
                   {"CA", "5", "CA", "Ca", {}},
                   {"ZN", "6", "ZN", "", {}}},
                  &changed) == Texts{"Na", "Cl", "Na", "K", "Ca", "Zn"});
  CHECK(changed == std::vector<AtomIndex>{0, 1, 2, 3, 5});
  // An alpha carbon alone and a nitrogen of a ligand are no ions.
  CHECK(corrected({{"ALA", "1", "CA", "C", {}}, {"LIG", "2", "NA", "N", {}}}) == Texts{"C", "N"});
}

TEST_CASE("correct_elements: names tell the elements of amino acids", "[radii]") {
  CHECK(corrected({{"LYS", "1", "CA", "Ca", {}},
                   {"LYS", "1", "CE", "Ce", {0, 0, 9}},
                   {"LYS", "1", "HD1", "D", {9, 0, 0}},
                   {"MSE", "2", "SE", "S", {}},
                   {"HIS", "3", "ND1", "Nd", {}},
                   {"TRP", "4", "SC1", "Sc", {}},
                   {"TRP", "4", "ZN", "Zn", {}},
                   {"DA", "5", "CA", "Ca", {}},
                   {"DA", "5", "X1", "Ca", {}}}) ==
        Texts{"C", "C", "D", "Se", "N", "S", "Zn", "C", "Ca"});
}

TEST_CASE("correct_elements: lengths of bonds decide in ligands", "[radii]") {
  std::vector<AtomIndex> changed;
  CHECK(corrected({{"LIG", "1", "C1", "C", {}},
                   {"LIG", "1", "CL1", "C", {1.74, 0, 0}},
                   {"LIG", "1", "Br2", "B", {0, 1.9, 0}},
                   {"LIG", "1", "CL3", "C", {0, 0, 1.54}},
                   {"LIG", "1", "CLA", "C", {0, 0, 9}},
                   {"LIG", "1", "SE", "S", {0, -1.82, 0}}},
                  &changed) == Texts{"C", "Cl", "Br", "C", "C", "S"});
  CHECK(changed == std::vector<AtomIndex>{1, 2});
  CHECK(corrected({{"HEM", "1", "FE", "F", {}},
                   {"HEM", "1", "NA", "Na", {2, 0, 0}},
                   {"HEM", "1", "C1A", "C", {3.37, 0, 0}},
                   {"HEM", "1", "CO", "Co", {0, 0, 2}},
                   {"HEM", "1", "HO", "Ho", {9, 0, 0}},
                   {"HEM", "1", "O", "O", {9.97, 0, 0}}}) == Texts{"Fe", "N", "C", "Co", "H", "O"});
  CHECK(corrected({{"CUA", "1", "CU1", "C", {}},
                   {"CUA", "1", "CU2", "C", {2.5, 0, 0}},
                   {"F43", "2", "NI", "N", {}},
                   {"F43", "2", "NA", "N", {2, 0, 0}},
                   {"LIG", "3", "CO", "C", {}},
                   {"LIG", "3", "C1", "C", {1.5, 0, 0}},
                   {"LIG", "3", "PT1", "P", {0, 9, 0}},
                   {"LIG", "4", "PT1", "P", {}},
                   {"LIG", "4", "N1", "N", {0, 2.03, 0}}}) ==
        Texts{"Cu", "Cu", "Ni", "N", "C", "C", "P", "Pt", "N"});
  // Without names of residues, elements are those of the source.
  CHECK(corrected({{"", "", "NA", "Na", {}}, {"", "", "C", "C", {1.4, 0, 0}}}) == Texts{"Na", "C"});
}

TEST_CASE("correct_elements: as many centres as labels", "[radii]") {
  std::vector<AtomLabel> labels(2);
  CHECK_THROWS_AS(correct_elements(std::vector<Vec3>(1), labels), Error);
}

TEST_CASE("find_waters: names in any case of letters", "[radii]") {
  const std::vector<AtomLabel> labels{{"A", "hoh", "1", "O", "O"},
                                      {"A", "Wat", "2", "O", "O"},
                                      {"A", "h2o", "3", "O", "O"},
                                      {"A", "lig", "4", "O", "O"}};
  CHECK(find_waters(labels) == std::vector<bool>{true, true, true, false});
}

TEST_CASE("check_residues: coarse-grained residues and traces", "[radii]") {
  const std::vector<AtomLabel> martini{{"A", "ALA", "1", "BB"},
                                       {"A", "LYS", "2", "BB"},
                                       {"A", "LYS", "2", "SC1"},
                                       {"A", "W", "3", "W"}};
  std::vector<Diagnostic> found = check_residues(martini);
  REQUIRE(found.size() == 1);
  CHECK(found[0].kind == DiagnosticKind::foreign_residue);
  CHECK(found[0].count == 3);
  CHECK(found[0].examples[1].atom == 1);
  // A part without a backbone is no diagnostic.
  CHECK(check_residues(std::vector<AtomLabel>{{"A", "LYS", "1", "CB"}, {"A", "LYS", "1", "CG"}})
            .empty());
  found = check_residues(std::vector<AtomLabel>{{"A", "LYS", "1", "CA"}, {"A", "ALA", "2", "CA"}});
  REQUIRE(found.size() == 1);
  CHECK(found[0].kind == DiagnosticKind::one_atom_residue);
  CHECK(found[0].count == 2);
}

}  // namespace
}  // namespace eses::detail::test
