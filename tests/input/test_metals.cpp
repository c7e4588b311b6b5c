// Tests of the elements of metals and of unknown atoms in files without elements.

#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/structures.hpp"

namespace eses::detail::test {
namespace {

/// An atom of a ligand without an element.
PdbAtom atom_of(const std::string& name, double x = 0) {
  return {.record = "HETATM", .name = name, .residue = "LIG", .x = x, .element = "  "};
}

TEST_CASE("metals of ligands whose names begin in the second column", "[structure]") {
  // The first letter of these symbols is no element.
  for (const auto& [name, element] :
       {std::pair{" MG ", "Mg"}, {" MO ", "Mo"}, {" AS1", "As"}, {" ZN2", "Zn"}})
    CHECK(elements_of(read_bondi(line_of(atom_of(" C1 ", 20)) + line_of(atom_of(name)))) ==
          Names{"C", element});
  // The lengths of bonds decide on the others.
  const auto pair = [](const std::string& name, const std::string& neighbor, double distance,
                       char altloc = ' ') {
    PdbAtom other = atom_of(neighbor, distance);
    other.altloc = altloc;
    return elements_of(read_bondi(line_of(atom_of(name)) + line_of(other)));
  };
  CHECK(pair(" CU1", " CU2", 2.5) == Names{"Cu", "Cu"});
  CHECK(pair(" NI ", " N1 ", 2.0) == Names{"Ni", "N"});
  CHECK(pair(" CO ", " N1 ", 1.9) == Names{"Co", "N"});
  CHECK(pair(" PT1", " N1 ", 2.0) == Names{"Pt", "N"});
  CHECK(pair(" CO ", " N1 ", 1.5) == Names{"C", "N"});
  CHECK(pair(" CO ", " N1 ", 3.5) == Names{"C", "N"});
  CHECK(pair(" COA", " N1 ", 1.9) == Names{"C", "N"});
  CHECK(pair(" PT1", " O1 ", 1.6) == Names{"P", "O"});
  CHECK(pair(" CO ", " N1 ", 1.9, 'B') == Names{"C", "N"});
  // The element column wins.
  CHECK(elements_of(read_bondi(
            line_of({.record = "HETATM", .name = " CO ", .residue = "LIG"}) +
            line_of({.record = "HETATM", .name = " N1 ", .residue = "LIG", .x = 1.9}))) ==
        Names{"C", "C"});
}

TEST_CASE("elements that files mark as unknown", "[structure]") {
  StructureOptions known;
  known.radii = "bondi";
  known.unknown_radius = 1;
  for (const std::string element : {"  ", " X"})
    CHECK(elements_of(read_pdb(
              line_of({.record = "HETATM", .name = " UNK", .residue = "UNX", .element = element}),
              known)) == Names{""});
  CHECK(elements_of(read_bondi(line_of({.name = "SE  ", .residue = "MSE", .element = " X"}))) ==
        Names{"Se"});
}

}  // namespace
}  // namespace eses::detail::test
