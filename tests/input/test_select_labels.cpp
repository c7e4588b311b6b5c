// Tests of selections of labelled atoms, which are those of the same file.

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "eses/select_atoms.hpp"
#include "input/advice.hpp"
#include "support/structures.hpp"

namespace eses::detail::test {
namespace {

const std::vector<AtomLabel> labels{
    {"A", "ALA", "10", "CA", "C"}, {"A", "SER", "10A", "CA", ""},  {"A", "SER", "-2", "OG", "O"},
    {"B", "STI", "1", "C1", "C"},  {"B", "STI", "1", "H1", "H"},   {"B", "STI", "1", "O1", "O"},
    {"B", "ZN", "2", "ZN", "Zn"},  {"B", "TIP3", "3", "OH2", "O"}, {"B", "TIP3", "3", "H1", "H"},
    {"B", "NH4", "4", "N", "N"},   {"B", "NH4", "4", "H1", "H"},   {"A", "GOL", "x", "C1", "C"},
    {"A", "GOL", "x", "C2", "C"}};

/// Returns the indices of the atoms of a selection.
std::vector<std::size_t> chosen(const std::vector<bool>& mask) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i]) indices.push_back(i);
  return indices;
}

std::string selection_error(const std::string& selection) {
  return error_of([&] { select_atoms(labels, selection); });
}

}  // namespace

TEST_CASE("select_atoms: selections have gemmi's syntax", "[structure][select]") {
  using Indices = std::vector<std::size_t>;
  const std::vector<std::pair<std::string, Indices>> cases{{"//A/10", {0}},
                                                           {"//A/10.A", {1}},
                                                           {"A//OG", {2}},
                                                           {"//*/*/CA", {0, 1}},
                                                           {"(STI,ZN)", {3, 4, 5, 6}},
                                                           {"B//[O]", {5, 7}},
                                                           {";polymer", {0, 1, 2}},
                                                           {"//A/9-11/*[C]", {0, 1}},
                                                           {"A", {0, 1, 2, 11, 12}},
                                                           {"ligand:ZN", {6}},
                                                           {"ligand:(ZN)", {6}},
                                                           {"ligand", {3, 4, 5, 11, 12}},
                                                           {"10", {0}},
                                                           {"-2", {2}},
                                                           {"//A/-2", {2}},
                                                           {"//A/-3--1", {2}},
                                                           {"//A/-2-9/OG", {2}}};
  for (const auto& [selection, expected] : cases) {
    INFO(selection);
    CHECK(chosen(select_atoms(labels, selection)) == expected);
  }
  CHECK(chosen(select_atoms(labels, "//A/10-")).size() == 2);
  CHECK(select_atoms({}, "//A").empty());
}

TEST_CASE("select_atoms: several chains, all of which exist", "[structure][select]") {
  CHECK(chosen(select_atoms(labels, "B + A")).size() == labels.size());
  CHECK(selection_error("A+C") == "selection: no atoms of chain C; its chains are A, B");
  CHECK(selection_error("ligand:HEM") ==
        "selection: no atoms of residue HEM; the residues are STI, ZN, TIP3, NH4, GOL, ALA, SER");
}

TEST_CASE("select_atoms: messages say what is wrong", "[structure][select]") {
  CHECK(selection_error("protein") ==
        "selection: invalid selection syntax, expected the name of a chain or a selection such as "
        "//A/10-20, found \"protein\"; its chains are A, B");
  CHECK(selection_error("//A/x[").starts_with("selection: invalid selection syntax"));
  CHECK(selection_error("/1/A") == "selection \"/1/A\": models cannot be selected here");
  CHECK(selection_error("//A//:B") ==
        "selection \"//A//:B\": alternate locations cannot be selected here");
  CHECK(selection_error(";q<1") ==
        "selection \";q<1\": occupancies and B-factors cannot be selected here");
}

TEST_CASE("find_ligand_atoms: polymers, waters and ions are none", "[structure][select]") {
  CHECK(chosen(find_ligand_atoms(labels)) == std::vector<std::size_t>{3, 4, 5, 11, 12});
}

TEST_CASE("find_ligand_atoms: modified residues of a chain are none, with many waters and ligands",
          "[structure][select]") {
  std::vector<AtomLabel> atoms;
  for (const char* residue : {"ALA", "CSO", "XYZ", "GLY", "XYZ"})
    for (const char* name : {"N", "CA", "C"})
      atoms.push_back({"A", residue, std::to_string(atoms.size() / 3 + 1), name, {name, 1}});
  const std::size_t polymer = atoms.size();
  const auto append = [&](const char* residue, int number, std::vector<const char*> names) {
    for (const char* name : names)
      atoms.push_back({"A", residue, std::to_string(number), name, {name, 1}});
  };
  for (int i = 0; i < 30; ++i) append("STI", 100 + i, {"C1", "O1"});
  for (int i = 0; i < 30; ++i) append("HOH", 200 + i, {"O"});
  append("GLU", 300, {"N", "CA", "C"});  // free
  for (const bool in_parts : {false, true}) {
    if (in_parts)  // another chain is between the polymer and the rest
      atoms.insert(atoms.begin() + static_cast<std::ptrdiff_t>(polymer),
                   {"B", "ALA", "1", "CA", "C"});
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < atoms.size(); ++i)
      if (atoms[i].residue == "STI") expected.push_back(i);
    CHECK(chosen(find_ligand_atoms(atoms)) == expected);
  }
}

TEST_CASE("closest_name: the name that was probably meant", "[select]") {
  const std::vector<std::string> names{"protor", "bondi", "oons"};
  CHECK(closest_name("prot", names) == "protor");
  CHECK(closest_name("bodni", names) == "bondi");
  CHECK(closest_name("onos", names) == "oons");
  CHECK(closest_name("b", names).empty());
  const std::vector<std::string> options{"-noh", "-if"};
  CHECK(closest_name("-foo", options).empty());
  CHECK(closest_name("-nohh", options) == "-noh");
  CHECK(closest_name("something", names).empty());
}

}  // namespace eses::detail::test
