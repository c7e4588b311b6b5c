/// Tests of reading the records of PQR files, and of elements.

#include <cmath>
#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "input/read_structure.hpp"
#include "support/atom_lists.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace {

using eses::AtomFormat;
using namespace eses::detail::test;
using std::string_literals::operator""s;

std::string pqr_error(std::string_view text) {
  return message_of([=] { pqr(text); });
}

}  // namespace

TEST_CASE("PQR: records separated by whitespace are read", "[read_atoms]") {
  const auto atoms =
      pqr("REMARK   1 PQR file 1 2 3 4 5\n"
          "ATOM  5 N      MET    1   -6.40600   5.46900  -3.25900 -0.30000 1.85000\n"
          "TER\n"
          "HETATM\t6\tC1 LIG A 2 1e1 +2.5 -3 0 .5\r\n"
          "ATOM      7  CA  MET A   3A     11.104   6.134  -6.504  0.0700 2.2750\n"
          "END");
  REQUIRE(atoms.size() == 3);
  CHECK(is_atom(atoms[0], -6.406, 5.469, -3.259, 1.85));
  CHECK(is_atom(atoms[1], 10, 2.5, -3, 0.5));
  CHECK(is_atom(atoms[2], 11.104, 6.134, -6.504, 2.275));
}

TEST_CASE("PQR: only ATOM and HETATM records are read", "[read_atoms]") {
  const std::string rest = " 1 N MET 1 1 2 3 0.5 1.5\n";
  for (const char* record :
       {"ATOM", "HETATM", "atom", "Hetatm", "  ATOM", "HETATM1234", "ATOM99"}) {
    CAPTURE(record);
    CHECK(is_sole_atom(pqr(record + rest), 1, 2, 3, 1.5));
  }
  for (const char* record : {"ANISOU", "ATOMS", "ATO", "HET", "#ATOM", "TER", "REMARK ATOM"}) {
    CAPTURE(record);
    CHECK(pqr_error(record + rest) == "t.pqr: no ATOM or HETATM records found; 1 line read");
  }
  CHECK(is_sole_atom(pqr("HETATM12345 N MET A1000 1.0 2.0 3.0 0.5 1.5"), 1, 2, 3, 1.5));
  CHECK(is_sole_atom(pqr("\xef\xbb\xbf"
                         "ATOM" +
                         rest),
                     1, 2, 3, 1.5));
}

TEST_CASE("PQR: coordinates that run together are read by columns", "[read_atoms]") {
  const auto atoms =
      pqr("ATOM      1  N   MET A   1     -10.123-200.456  30.000  0.1000 1.8500\n"
          "ATOM      2  N   MET A   1    -110.123-200.456-300.789 -0.3000 1.8500\r\n"
          "ATOM      3  N   MET A   1    1110.1231200.4561300.789 -0.3000 1.8500\n"
          "HETATM12345 HN11ALIG A1000      10.123-200.456-300.789-10.3000 1.8500\n"
          "ATOM      5  N   NAN   100    -110.123-200.456-300.789  0.3000 1.8500\n"
          "ATOM      6  N   MET A****      10.123  20.456  30.789  0.3000 1.8500\n");
  REQUIRE(atoms.size() == 6);
  CHECK(is_atom(atoms[0], -10.123, -200.456, 30, 1.85));
  CHECK(is_atom(atoms[1], -110.123, -200.456, -300.789, 1.85));
  CHECK(is_atom(atoms[2], 1110.123, 1200.456, 1300.789, 1.85));
  CHECK(is_atom(atoms[3], 10.123, -200.456, -300.789, 1.85));
  CHECK(is_atom(atoms[4], -110.123, -200.456, -300.789, 1.85));
  CHECK(is_atom(atoms[5], 10.123, 20.456, 30.789, 1.85));
}

TEST_CASE("PQR: free format is not cut at the columns", "[read_atoms]") {
  CHECK(is_sole_atom(pqr("ATOM  5 N      MET    1   -6.40612   5.46934  -3.25956 -0.30000 1.85"),
                     -6.40612, 5.46934, -3.25956, 1.85));
  // Columns 31 to 38 contain "4067" in the first record and ".4067" in the second.
  const std::string rest = "      5.4693  -3.259 -0.30000 1.85";
  CHECK(pqr_error("ATOM  5 N      MET    1   x-6.4067" + rest) ==
        "t.pqr:1: field 6 (x): expected a number, found \"x-6.4067\"");
  CHECK(pqr_error("ATOM  5 N      MET    1    x-6.4067" + rest.substr(1)) ==
        "t.pqr:1: field 6 (x): expected a number, found \"x-6.4067\"");
}

TEST_CASE("PQR: a number is not cut in two", "[read_atoms]") {
  const std::string start = "ATOM      1  N   MET A   1    ";
  const std::string rest = "   3.259  0.1000 1.8500\n";
  REQUIRE(start.size() == 30);
  CHECK(is_sole_atom(pqr(start + "-110.123" + "-220.456" + rest), -110.123, -220.456, 3.259, 1.85));
  CHECK(contains(pqr_error(start + "12345678" + "90.56789" + rest), "t.pqr:1: field 6 (x): \"1\""));
  CHECK(contains(pqr_error(start + "   1234." + "567.8901" + rest), "t.pqr:1: field 7 (y): "));
}

TEST_CASE("PQR: an element symbol after the radius is accepted", "[read_atoms]") {
  for (const char* element : {"N", "C", "ZN", "Zn", "N1+", "ZN2+", "O1-"}) {
    CAPTURE(element);
    const std::string end = std::string(" ") + element;
    CHECK(is_sole_atom(pqr("ATOM 1 N MET A 1 1.0 2.0 3.0 -0.5 1.5" + end), 1, 2, 3, 1.5));
    CHECK(is_sole_atom(pqr("ATOM 1 N MET 1 1.0 2.0 3.0 -0.5 1.5" + end + "  \r\n"), 1, 2, 3, 1.5));
  }
  // These are records of Open Babel, records with charge and radius as pdb2pqr writes them, and
  // records with both where PDB files have occupancy and B-factor. ESES finds the first radius in
  // columns 63 to 69.
  const auto atoms =
      pqr("ATOM      1  N   MET A   1      27.340  24.430   2.614 -0.30000000   1.550  N  \n"
          "ATOM      2  N   MET A   1     -10.123-200.456-300.789 -0.3000 1.8500       N\n"
          "HETATM    3 ZN    ZN A   2    -110.123-200.456-300.789  2.0000 1.3900      ZN2+\n"
          "ATOM      4  CA  MET A   1      26.266  25.413   2.842  0.10  1.70           C  \n");
  REQUIRE(atoms.size() == 4);
  CHECK(is_atom(atoms[0], 27.34, 24.43, 2.614, 1.55));
  CHECK(is_atom(atoms[1], -10.123, -200.456, -300.789, 1.85));
  CHECK(is_atom(atoms[2], -110.123, -200.456, -300.789, 1.39));
  CHECK(is_atom(atoms[3], 26.266, 25.413, 2.842, 1.7));

  // A number that is missing before the symbol gives the same error as without the symbol.
  CHECK(contains(pqr_error("ATOM 1 N MET 1 1.0 2.0 3.0 1.5 N"), "at least 10 fields"));
  CHECK(contains(pqr_error("ATOM 1 N MET A 1 1.0 2.0 3.0 1.5 N"), "the residue number"));
  CHECK(contains(pqr_error("ATOM      1  N   MET A   1     -10.123-200.456  30.000  0.1000   N"),
                 "(radius): missing"));
  for (const char* field : {"N2", "N+", "ZNC", "N12+", "1+"}) {
    CAPTURE(field);
    CHECK(contains(pqr_error("ATOM 1 N MET A 1 1.0 2.0 3.0 -0.5 1.5 " + std::string(field)),
                   "after the radius, expected x y z charge radius at the end; remove the text"));
  }
}

TEST_CASE("PQR: charge and radius that run together are read by columns", "[read_atoms]") {
  const std::string start = "ATOM      1  N   MET A   1     -10.123-200.456  30.000";
  CHECK(is_sole_atom(pqr(start + "  0.100010.5000"), -10.123, -200.456, 30, 10.5));
  CHECK(is_sole_atom(pqr(start + " -0.100010.5000       N"), -10.123, -200.456, 30, 10.5));
  CHECK(contains(pqr_error(start + "  0.100010.50001"), "(charge): expected a number"));
  CHECK(contains(pqr_error(start + "  1.00100.00"), "(charge): expected a number"));
}

TEST_CASE("PQR: a PDB file is refused with the reason", "[read_atoms]") {
  // The first atoms of 1UBQ, and text in the columns of segment and element.
  const std::vector<std::string> records{
      "ATOM      1  N   MET A   1      27.340  24.430   2.614  1.00  9.67",
      "ATOM      2  CA  MET A   1      26.266  25.413   2.842  1.00 10.38",
      "ATOM      3  C   MET A   1      26.913  26.639   3.531  0.50  9.62",
      "HETATM    4  O   HOH A   2     -26.913 -26.639  -3.531  1.00  2.00"};
  const std::string reason =
      "t.pqr: this is a PDB file: its columns 55 to 66 hold occupancy and B-factor, which are not "
      "charge and radius; read it with --format pdb, or with --format pqr if they are";
  for (const char* end : {"", "           N  ", "           N1+"}) {
    CAPTURE(end);
    std::string text = "HEADER\n";
    for (const std::string& record : records) {
      text += record + end + "\n";
      CHECK(pqr_error(text) == reason);
    }
  }
  const std::string hint =
      "; this looks like a PDB file, whose occupancy and B-factor are not charge and radius";
  CHECK(contains(pqr_error(records[0] + "      PROA N"), hint));
  CHECK(contains(pqr_error(records[0] + "      1UBQ  71"), hint));

  // Charges and radii in the same columns are accepted: not one record decides.
  const std::string negative =
      "ATOM      5  N   MET A   1      27.340  24.430   2.614 -0.30  1.85           N\n";
  const std::string small =
      "ATOM      6  N   MET A   1      27.340  24.430   2.614  0.30  1.85           N\n";
  CHECK(pqr(records[3] + "\n" + negative).size() == 2);
  CHECK(pqr(small + small + records[0] + "\n").size() == 3);
}

TEST_CASE("PQR: a PDB file without occupancies and B-factors is refused", "[read_atoms]") {
  const std::string record = "ATOM      1  N   ALA A   1       1.000   2.000   3.000  0.00  0.00\n";
  CHECK(contains(pqr_error(record + record), "this is a PDB file"));
}

TEST_CASE("PQR: chain, residue and name of the atoms are read", "[read_atoms]") {
  const std::string text =
      "ATOM  5 N      MET    1   -6.40600   5.46900  -3.25900 -0.30000 1.85000\n"
      "REMARK\n"
      "HETATM\t6\tC1 LIG BB 2 1e1 +2.5 -3 0 .5\r\n"
      "ATOM      7  CA  MET A   3A     11.104   6.134  -6.504  0.0700 2.2750\n"
      "HETATM12345 N' NTER A1000B 1.0 2.0 3.0 0.5 1.5\n"
      "ATOM 8 O HOH C-12 1.0 2.0 3.0 0.5 1.5\n"
      "ATOM 9 O HOH -12 1.0 2.0 3.0 0.5 1.5\n"
      "ATOM 9 O HOH ABC 1.0 2.0 3.0 0.5 1.5\n"
      "HETATM12345 HN11ALIG A1000      10.123-200.456-300.789-10.3000 1.8500\n"
      "ATOM      5  N   NAN   100B   -110.123-200.456-300.789  0.3000 1.8500\n"
      "ATOM      6  N   NTERA   1    -110.123-200.456-300.789  0.3000 1.8500\n";
  const eses::AtomFile read = eses::parse_atoms(text, AtomFormat::pqr, "t.pqr");
  const std::vector<eses::AtomLabel> expected{
      {"", "MET", "1", "N"},        {"BB", "LIG", "2", "C1"},     {"A", "MET", "3A", "CA"},
      {"A", "NTER", "1000B", "N'"}, {"C", "HOH", "-12", "O"},     {"", "HOH", "-12", "O"},
      {"", "HOH", "ABC", "O"},      {"A", "LIG", "1000", "HN11"}, {"", "NAN", "100B", "N"},
      {"A", "NTER", "1", "N"}};
  REQUIRE(read.labels.size() == expected.size());
  REQUIRE(read.atoms.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    INFO("record " << i);
    CHECK(read.labels[i].chain == expected[i].chain);
    CHECK(read.labels[i].residue == expected[i].residue);
    CHECK(read.labels[i].residue_number == expected[i].residue_number);
    CHECK(read.labels[i].atom_name == expected[i].atom_name);
  }
}

TEST_CASE("PQR: the charges of the atoms are read", "[read_atoms]") {
  const std::string text =
      "ATOM 1 N MET A 1 1 2 3 -0.3 1.5\n"
      "HETATM 2 ZN ZN A 2 1 2 3 2 1.4\n"
      "HETATM12345 HN11ALIG A1000      10.123-200.456-300.789-10.3000 1.8500\n"
      "ATOM 4 O1 LIG A 3 9 2 3 1e-2 1.5 O1-\n";
  CHECK(eses::parse_atoms(text, AtomFormat::pqr).charges ==
        std::vector<double>{-0.3, 2, -10.3, 0.01});
  const TemporaryDirectory directory;
  const auto path = directory.path() / "four.pqr";
  std::ofstream(path) << text;
  CHECK(eses::read_atoms(path).charges == std::vector<double>{-0.3, 2, -10.3, 0.01});
  CHECK(eses::read_atoms(path, {.with_labels = false}).charges.empty());
}

TEST_CASE("PQR: elements are those of the file, or follow from the names", "[read_atoms]") {
  struct Case {
    const char *name, *residue, *symbol, *element;
  };
  const std::vector<Case> cases{// the first letter would be wrong
                                {"CL1", "LIG", "", "Cl"},
                                {"BR2", "LIG", "", "Br"},
                                {"CL", "CL", "", "Cl"},
                                {"FE", "HEM", "", "Fe"},
                                {"ZN", "ZN", "", "Zn"},
                                {"CA", "CA", "", "Ca"},
                                {"SOD", "SOD", "", "Na"},
                                {"MG", "CLA", "", "Mg"},
                                {"SE", "MSE", "", "Se"},
                                {"Na+", "Na+", "", "Na"},
                                // the second letter does not belong to the element
                                {"CA", "ALA", "", "C"},
                                {"CA", "LIG", "", "C"},
                                {"CD1", "ILE", "", "C"},
                                {"HG21", "ILE", "", "H"},
                                {"1HB", "NALA", "", "H"},
                                {"NA", "HEM", "", "N"},
                                {"OW", "SOL", "", "O"},
                                {"P", "RU5", "", "P"},
                                {"K", "K", "", "K"},
                                // symbols at the end of the record
                                {"CA", "LIG", "CA", "Ca"},
                                {"X1", "LIG", "ZN", "Zn"},
                                {"O1", "LIG", "O1-", "O"},
                                {"C1", "LIG", "XX", "C"},
                                // dummy atoms
                                {"EP1", "WAT", "", ""},
                                {"X1", "XXX", "", ""}};
  std::string text;
  for (const Case& each : cases)
    text += std::string("ATOM 1 ") + each.name + " " + each.residue + " A 7 1.0 2.0 3.0 0.5 1.5 " +
            each.symbol + "\n";
  const eses::AtomFile read = eses::parse_atoms(text, AtomFormat::pqr, "t.pqr");
  REQUIRE(read.labels.size() == cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    INFO(cases[i].residue << " " << cases[i].name << " " << cases[i].symbol);
    CHECK(read.labels[i].element == cases[i].element);
  }
}

TEST_CASE("PDB: elements are those of the file, or follow from the names", "[read_atoms]") {
  if (eses::detail::gemmi_version().empty()) SKIP("this build has no gemmi");
  const std::string text =
      "HETATM    1 CL1  LIG A   1       1.000   2.000   3.000  1.00  0.00          CL\n"
      "HETATM    2 BR   LIG A   1       5.000   2.000   3.000  1.00  0.00\n"
      "HETATM    3  C1  LIG A   1       9.000   2.000   3.000  1.00  0.00           C\n"
      "HETATM    4  X   LIG A   1       9.000   9.000   3.000  1.00  0.00           X\n";
  eses::StructureOptions options;
  options.radii = "bondi";
  options.unknown_radius = 1;
  const eses::AtomFile read = eses::parse_atoms(text, AtomFormat::pdb, "t.pdb", options);
  REQUIRE(read.labels.size() == 4);
  CHECK(read.labels[0].element == "Cl");
  CHECK(read.labels[1].element == "Br");
  CHECK(read.labels[2].element == "C");
  CHECK(read.labels[3].element.empty());
  CHECK(read.charges.empty());
}

TEST_CASE("PQR: a record with neither fields nor columns is refused", "[read_atoms]") {
  const std::string too_few =
      "t.pqr:1: expected at least 10 fields, the last five being x y z charge radius, found ";
  CHECK(pqr_error("ATOM      1  N   MET A   1   8-110.123-200.456-300.789 -0.3000 1.85") ==
        too_few + "9");
  // A minus sign separates numbers that run together.
  CHECK(is_sole_atom(pqr("ATOM      1  N   MET A   1    -110.123-200.456-300.7891 -0.3000 1.85"),
                     -110.123, -200.456, -300.7891, 1.85));
  CHECK(pqr_error("ATOM      1  N   MET A   1     -10.123-200.4x6  30.000  0.1000 1.8500") ==
        "t.pqr:1: field 7 (y): expected a number, found \"-10.123-200.4x6\"");
}

TEST_CASE("PQR: wrong fields in free format are refused", "[read_atoms]") {
  const std::string start = "REMARK\nATOM 1 N MET A 1 ";
  CHECK(pqr_error(start + "1.0 2.0 zz 0.5 1.5\n") ==
        "t.pqr:2: field 9 (z): expected a number, found \"zz\"");
  CHECK(pqr_error(start + "1.0 2.0 3.0 q 1.5\n") ==
        "t.pqr:2: field 10 (charge): expected a number, found \"q\"");
  CHECK(pqr_error(start + "1.0 2.0 3.0 nan 1.5\n") ==
        "t.pqr:2: field 10 (charge): expected a finite number, found \"nan\"");
  CHECK(pqr_error(start + "1.0 2.0 3.0 0.5 -1.5\n") ==
        "t.pqr:2: field 11 (radius): must not be negative, found \"-1.5\"; charge and radius seem "
        "to be swapped; write the charge before the radius");
  CHECK(pqr_error(start + "1.0 2.0 3.0 0.5 1e999\n") ==
        "t.pqr:2: field 11 (radius): \"1e999\" is out of the range of double precision");
  CHECK(pqr_error(start + "1.0 2e7 3.0 0.5 1.5\n") ==
        "t.pqr:2: field 8 (y): \"2e7\" is beyond the limit of 1000000 angstrom");
  CHECK(pqr_error(start + "1.0 2.0 3.0 0.5 1.5 PROA\n") ==
        "t.pqr:2: text \"PROA\" after the radius, expected x y z charge radius at the end; remove "
        "the "
        "text");
}

TEST_CASE("PQR: wrong fields in columns are refused", "[read_atoms]") {
  const std::string start = "ATOM      1  N   MET A   1     -10.123-200.456  30.000";
  CHECK(pqr_error(start + "  0.1000    bad\n") ==
        "t.pqr:1: field 10 (radius): expected a number, found \"bad\"");
  CHECK(
      pqr_error(start + "  0.1000 -1.8500\n") ==
      "t.pqr:1: field 10 (radius): must not be negative, found \"-1.8500\"; charge and radius seem "
      "to be swapped; write the charge before the radius");
  CHECK(pqr_error(start + "  0.1000\n") == "t.pqr:1: field 10 (radius): missing");
  CHECK(pqr_error(start + "\n") == "t.pqr:1: field 9 (charge): missing");
}

TEST_CASE("PQR: a missing field is not replaced by another one", "[read_atoms]") {
  const std::string ten =
      "t.pqr:1: expected at least 10 fields, the last five being x y z charge "
      "radius, found ";
  CHECK(pqr_error("ATOM") == ten + "1");
  CHECK(pqr_error("ATOM 1 N MET 1") == ten + "5");
  CHECK(pqr_error("ATOM 1 N MET 1 1.0 2.0 3.0 1.5") == ten + "9");
  CHECK(pqr_error("ATOM 1 C1 LG1 1 1.0 2.0 3.0 1.5") == ten + "9");
  CHECK(pqr_error("ATOM 1 N MET A 1 1.0 2.0 3.0 1.5") ==
        "t.pqr:1: field 6 (x): \"1\" seems to be the residue number; expected x y z charge radius "
        "at the end");
  CHECK(contains(pqr_error("ATOM 1 N MET A 1 1.0 2.0 3.0 -0.5"), "the residue number"));
  CHECK(pqr_error("ATOM      1  N   MET A   1      10.123 200.456  30.000  1.50\n") ==
        "t.pqr:1: field 11 (radius): missing");
}

TEST_CASE("PQR: a file without atoms is refused", "[read_atoms]") {
  CHECK(pqr_error("") == "t.pqr: no ATOM or HETATM records found; 0 lines read");
  CHECK(pqr_error("1 2 3 4\n5 6 7 8\n") == "t.pqr: no ATOM or HETATM records found; 2 lines read");
}

TEST_CASE("PQR: lines are limited to 4096 characters", "[read_atoms]") {
  CHECK(pqr_error(std::string("REMARK").append(4091, '-')) ==
        "t.pqr:1: more than 4096 characters in the line");
}
