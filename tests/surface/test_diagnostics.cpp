// Tests of the diagnostics of a set of atoms: warnings and notes.

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/atom_lists.hpp"
#include "surface/molecule.hpp"

namespace eses::detail::test {
namespace {

using Kind = DiagnosticKind;
using Counts = std::vector<std::pair<Kind, std::uint64_t>>;

Counts counts_of(std::span<const Diagnostic> diagnostics) {
  Counts counts;
  for (const Diagnostic& diagnostic : diagnostics)
    counts.emplace_back(diagnostic.kind, diagnostic.count);
  return counts;
}

Counts diagnostics_of(const std::vector<Atom>& atoms) {
  return counts_of(Molecule(atoms).diagnostics());
}

}  // namespace

TEST_CASE("sound atoms have no diagnostics", "[diagnostics]") {
  CHECK(diagnostics_of({{{0, 0, 0}, 1.7}}).empty());
  CHECK(diagnostics_of({{{0, 0, 0}, 1.7}, {{1.2, 0, 0}, 1.2}, {{0, 0.5, 0}, 1.7}}).empty());
  for (const std::string name : {"1ubq.xyzr", "1a0q.xyzr", "achbp.xyzr", "c60.xyzr", "mache.pqr"}) {
    INFO(name);
    CHECK(diagnostics_of(read_atom_list(std::string(ESES_DATA) + "/" + name)).empty());
  }
}

TEST_CASE("duplicates are counted once each, and name the first", "[diagnostics]") {
  const Molecule molecule({{{1, 2, 3}, 1.5}, {{9, 9, 9}, 1.5}, {{1, 2, 3}, 1.5}, {{1, 2, 3}, 1.5}});
  const std::span<const Diagnostic> found = molecule.diagnostics();
  REQUIRE(counts_of(found) == Counts{{Kind::duplicate, 2}});
  REQUIRE(found[0].examples.size() == 2);
  CHECK(found[0].examples[0].atom == 2);
  CHECK(found[0].examples[0].other == 0);
  CHECK(found[0].examples[1].atom == 3);
  CHECK(found[0].examples[1].other == 0);
}

TEST_CASE("zeros are equal, whatever their sign", "[diagnostics]") {
  CHECK(diagnostics_of({{{0, 1, 0}, 1.5}, {{-0.0, 1, -0.0}, 1.5}}) == Counts{{Kind::duplicate, 1}});
}

TEST_CASE("atoms are close below half an angstrom, not at exactly this distance", "[diagnostics]") {
  CHECK(diagnostics_of({{{0, 0, 0}, 1.5}, {{0.49, 0, 0}, 1.6}}) == Counts{{Kind::close, 1}});
  CHECK(diagnostics_of({{{0, 0, 0}, 1.5}, {{0, 0, 0}, 1.6}}) == Counts{{Kind::close, 1}});
  CHECK(diagnostics_of({{{0, 0, 0}, 1.5}, {{0.5, 0, 0}, 1.6}}).empty());
  // Water models have virtual sites without a radius there.
  CHECK(diagnostics_of({{{0, 0, 0}, 1.5}, {{0.15, 0, 0}, 0}}) == Counts{{Kind::zero_radius, 1}});
}

TEST_CASE("a nested atom is a warning, a nested hydrogen is a note", "[diagnostics]") {
  CHECK(diagnostics_of({{{0, 0, 0}, 3}, {{1, 0, 0}, 1.7}}) == Counts{{Kind::nested, 1}});
  CHECK(diagnostics_of({{{1, 0, 0}, 1.7}, {{0, 0, 0}, 3}}) == Counts{{Kind::nested, 1}});
  CHECK(diagnostics_of({{{0, 0, 0}, 3}, {{1, 0, 0}, 2}}) == Counts{{Kind::nested, 1}});
  CHECK(diagnostics_of({{{0, 0, 0}, 3}, {{1, 0, 0}, 2.01}}).empty());
  CHECK(diagnostics_of({{{0, 0, 0}, 1.85}, {{1, 0, 0}, 0.2245}}) ==
        Counts{{Kind::nested_usual, 1}});
  CHECK_FALSE(is_usual(Kind::nested));
  CHECK(is_usual(Kind::nested_usual));
  CHECK(is_usual(Kind::zero_radius));
}

TEST_CASE("unusually large radii, and radii in nanometres, are reported", "[diagnostics]") {
  CHECK(diagnostics_of({{{0, 0, 0}, 4}}).empty());
  CHECK(diagnostics_of({{{0, 0, 0}, 4.01}}) == Counts{{Kind::large_radius, 1}});
  CHECK(diagnostics_of({{{0, 0, 0}, 0.17}, {{1, 0, 0}, 0.39}}) == Counts{{Kind::small_radii, 2}});
  CHECK(diagnostics_of({{{0, 0, 0}, 0.17}, {{1, 0, 0}, 0.4}}).empty());
}

TEST_CASE("only the first five examples are listed", "[diagnostics]") {
  // There are so many atoms that comparing all pairs would take an hour.
  const Molecule molecule(std::vector<Atom>(1'000'000, {{0, 0, 0}, 1.5}));
  const std::span<const Diagnostic> found = molecule.diagnostics();
  REQUIRE(counts_of(found) == Counts{{Kind::duplicate, 999'999}});
  CHECK(found[0].examples.size() == 5);
  CHECK(found[0].examples.back().atom == 5);
}

TEST_CASE("the examples are the first atoms, wherever they are", "[diagnostics]") {
  std::vector<Atom> atoms;
  for (int k = 20; k > 0; --k)
    for (const double offset : {0.0, 0.47}) atoms.push_back({{0, 0, 9 * k + offset}, 1.5});
  const Molecule molecule(atoms);
  REQUIRE(counts_of(molecule.diagnostics()) == Counts{{Kind::close, 20}});
  std::vector<AtomIndex> examples;
  for (const Diagnostic::Example& example : molecule.diagnostics()[0].examples)
    examples.push_back(example.atom);
  CHECK(examples == std::vector<AtomIndex>{1, 3, 5, 7, 9});
}

TEST_CASE("atoms are read with the lines on which they stand", "[read_atoms][diagnostics]") {
  const AtomFile read =
      parse_atoms("# x\n\n0 0 0 1\r\n\r\n1 0 0 1\n#\n2 0 0 1", AtomFormat::xyzr, "t");
  CHECK(read.atoms.size() == 3);
  CHECK(read.lines == std::vector<std::uint64_t>{3, 5, 7});
}

}  // namespace eses::detail::test
