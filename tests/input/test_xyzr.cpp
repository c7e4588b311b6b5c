/// Tests of reading xyzr files and of what all text files have in common.

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "support/atom_lists.hpp"
#include "support/sandbox.hpp"

namespace {

using eses::Atom;
using eses::AtomFormat;
using namespace eses::detail::test;
using std::string_literals::operator""s;

std::string xyzr_error(std::string_view text) {
  return message_of([=] { xyzr(text); });
}

std::string pqr_error(std::string_view text) {
  return message_of([=] { pqr(text); });
}

std::string printed(double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.17g", value);
  return buffer;
}

/// Returns a number with a magnitude from 1e-300 almost to the largest that is accepted.
double random_number(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_real_distribution<double> exponent(-300, 6);
  const double magnitude = generator() % 2 == 0 ? 1e6 : std::pow(10, exponent(generator));
  return mantissa(generator) * magnitude;
}

}  // namespace

TEST_CASE("xyzr: each line is an atom, in the same order", "[read_atoms]") {
  const auto atoms = xyzr("1.5 -2.25 3 1.75\n-4e1 0.5 6.125 0\n");
  REQUIRE(atoms.size() == 2);
  CHECK(is_atom(atoms[0], 1.5, -2.25, 3, 1.75));
  CHECK(is_atom(atoms[1], -40, 0.5, 6.125, 0));
}

TEST_CASE("xyzr: blanks, tabs and further columns are accepted", "[read_atoms]") {
  CHECK(is_sole_atom(xyzr("1 2 3 4"), 1, 2, 3, 4));
  CHECK(is_sole_atom(xyzr("1\t2\t3\t4\n"), 1, 2, 3, 4));
  CHECK(is_sole_atom(xyzr(" \t 1 \t 2   3\t\t4 \t \n"), 1, 2, 3, 4));
  CHECK(is_sole_atom(xyzr("1 2 3 4 0 N CYS 701 D\n"), 1, 2, 3, 4));
  CHECK(is_sole_atom(xyzr("1 2 3 4\t# carbon\n"), 1, 2, 3, 4));
  CHECK(is_sole_atom(xyzr("1 2 3 4 \xce\xb1-carbon\n"), 1, 2, 3, 4));
  CHECK(is_sole_atom(xyzr("1 2 3 4 \xe5ngstr\xf6m\n"), 1, 2, 3, 4));
  CHECK(is_sole_atom(xyzr("\xef\xbb\xbf"
                          "1 2 3 4\n"),
                     1, 2, 3, 4));
  CHECK(is_sole_atom(xyzr("\xef\xbb\xbf# comment\n1 2 3 4\n"), 1, 2, 3, 4));
}

TEST_CASE("xyzr: blank lines and comments are skipped, but counted", "[read_atoms]") {
  const std::string text = "# x y z r\n\n  \t \n1 2 3 4\n  # indented\n\t#tab\n#\n5 6 7 8\n\n";
  const auto atoms = xyzr(text);
  REQUIRE(atoms.size() == 2);
  CHECK(is_atom(atoms[0], 1, 2, 3, 4));
  CHECK(is_atom(atoms[1], 5, 6, 7, 8));
  CHECK(contains(xyzr_error(text + "bad\n"), "t.xyzr:10: "));
}

TEST_CASE("xyzr: Unix and Windows line ends are accepted", "[read_atoms]") {
  for (const char* text :
       {"1 2 3 4\r\n\r\n# c\r\n5 6 7 8\r\n", "1 2 3 4\r\n5 6 7 8", "1 2 3 4\r\n5 6 7 8\r",
        "1 2 3 4\n5 6 7 8\r\n", "1 2 3 4\r\r\n5 6 7 8\r\r\n"}) {
    const auto atoms = xyzr(text);
    REQUIRE(atoms.size() == 2);
    CHECK(is_atom(atoms[0], 1, 2, 3, 4));
    CHECK(is_atom(atoms[1], 5, 6, 7, 8));
  }
}

TEST_CASE("xyzr: signs and exponents of C and Fortran are accepted", "[read_atoms]") {
  CHECK(is_sole_atom(xyzr("+1 +2.5 -3 +.5"), 1, 2.5, -3, 0.5));
  CHECK(is_sole_atom(xyzr("1. .25 -.5 007"), 1, 0.25, -0.5, 7));
  CHECK(is_sole_atom(xyzr("1e2 1E+2 -1.5e-1 25e-1"), 100, 100, -0.15, 2.5));
  CHECK(is_sole_atom(xyzr("1.0D+00 -2.5d+01 5D-1 1.7D0"), 1, -25, 0.5, 1.7));
  CHECK(is_sole_atom(xyzr("+1.D2 .5d1 -0.D0 0d0"), 100, 5, 0, 0));
  CHECK(is_sole_atom(xyzr("-0 0 0 -0.0"), 0, 0, 0, 0));
  CHECK(is_sole_atom(xyzr("1e6 -1000000 +1.0D+06 1e6"), 1e6, -1e6, 1e6, 1e6));
  CHECK(is_sole_atom(xyzr("4.9406564584124654e-324 2.2250738585072014e-308 0 1"), 0x1p-1074,
                     0x1p-1022, 0, 1));
  CHECK(is_sole_atom(xyzr("0.1000000000000000055511151231257827021181583404541015625 0 0 1"), 0.1,
                     0, 0, 1));
}

TEST_CASE("xyzr: numbers written with 17 digits come back exactly", "[read_atoms]") {
  std::mt19937_64 generator(20180901);
  std::vector<Atom> expected;
  std::string text;
  for (int i = 0; i < 1000; ++i) {
    const Atom atom{{random_number(generator), random_number(generator), random_number(generator)},
                    std::fabs(random_number(generator))};
    expected.push_back(atom);
    text += printed(atom.center.x) + ' ' + printed(atom.center.y) + ' ' + printed(atom.center.z) +
            ' ' + printed(atom.radius) + '\n';
  }
  const auto atoms = xyzr(text);
  REQUIRE(atoms.size() == expected.size());
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    REQUIRE(atoms[i].center == expected[i].center);
    REQUIRE(atoms[i].radius == expected[i].radius);
  }
}

TEST_CASE("xyzr: a field that is not a number is refused", "[read_atoms]") {
  CHECK(xyzr_error("1 2 3 4\n1 2 abc 4\n") ==
        "t.xyzr:2: field 3 (z): expected a number, found \"abc\"");
  CHECK(xyzr_error("  x 2 3 4") == "t.xyzr:1: field 1 (x): expected a number, found \"x\"");
  CHECK(xyzr_error("1 2,5 3 4") ==
        "t.xyzr:1: field 2 (y): expected a number, found \"2,5\"; separate the fields by blanks, "
        "and write numbers with a decimal point");
  CHECK(xyzr_error("1 2 3 # 4") == "t.xyzr:1: field 4 (radius): expected a number, found \"#\"");
  for (const char* junk : {"1.2.3",
                           "--1",
                           "+-1",
                           "++1",
                           "-+1",
                           "+",
                           "-",
                           ".",
                           "e5",
                           "D5",
                           "1e",
                           "1D",
                           "1D+",
                           "1e5x",
                           "1D5x",
                           "1DD5",
                           "1D5D5",
                           "0x10",
                           "1-2",
                           "********",
                           "1.0+100",
                           "1_000",
                           ("\xc2\xa0"
                            "1")}) {
    CAPTURE(junk);
    CHECK(contains(xyzr_error(junk + " 2 3 4\n"s), "t.xyzr:1: field 1 (x): expected a number, "));
  }
}

TEST_CASE("xyzr: a missing field is refused", "[read_atoms]") {
  CHECK(xyzr_error("1 2 3 4\n\n1 2 3\n") == "t.xyzr:3: field 4 (radius): missing");
  CHECK(xyzr_error("1 2 \t\r\n") == "t.xyzr:1: field 3 (z): missing");
  CHECK(contains(xyzr_error("327\n1 2 3 4\n"), "t.xyzr:1: field 2 (y): missing; is it"));
}

TEST_CASE("xyzr: numbers that are not finite are refused", "[read_atoms]") {
  CHECK(xyzr_error("1 nan 3 4") ==
        "t.xyzr:1: field 2 (y): expected a finite number, found \"nan\"");
  for (const char* text : {"NaN", "-nan", "inf", "-inf", "+Inf", "INFINITY"}) {
    CAPTURE(text);
    CHECK(contains(xyzr_error("1 2 3 "s + text), "field 4 (radius): expected a finite number, "));
  }
}

TEST_CASE("xyzr: numbers out of range are refused", "[read_atoms]") {
  CHECK(xyzr_error("1 2 1e999 4") ==
        "t.xyzr:1: field 3 (z): \"1e999\" is out of the range of double precision");
  for (const char* text : {"-1e309", "+1D+400", "1e-400", "1e99999999999999999999"}) {
    CAPTURE(text);
    CHECK(contains(xyzr_error(text + " 2 3 4"s), "field 1 (x): \""s + text + "\" is out of the"));
  }
}

TEST_CASE("xyzr: lengths beyond the limit are refused", "[read_atoms]") {
  CHECK(xyzr_error("1000000.1 2 3 4") ==
        "t.xyzr:1: field 1 (x): \"1000000.1\" is beyond the limit of 1000000 angstrom");
  CHECK(contains(xyzr_error("1 -2e6 3 4"), "field 2 (y): \"-2e6\" is beyond the limit"));
  CHECK(contains(xyzr_error("1 2 1e300 4"), "field 3 (z): \"1e300\" is beyond the limit"));
  CHECK(contains(xyzr_error("1 2 3 4e6"), "field 4 (radius): \"4e6\" is beyond the limit"));
}

TEST_CASE("xyzr: a negative radius is refused", "[read_atoms]") {
  CHECK(xyzr_error("1 2 3 -1.5") ==
        "t.xyzr:1: field 4 (radius): must not be negative, found \"-1.5\"");
  CHECK(contains(xyzr_error("1 2 3 -1e-300"), "must not be negative, found \"-1e-300\""));
}

TEST_CASE("xyzr: a file without atoms is refused", "[read_atoms]") {
  CHECK(xyzr_error("") == "t.xyzr: no atoms found; 0 lines read");
  CHECK(xyzr_error("\n") == "t.xyzr: no atoms found; 1 line read");
  CHECK(xyzr_error("# only\r\n\r\n  # comments") == "t.xyzr: no atoms found; 3 lines read");
  CHECK(xyzr_error("\xef\xbb\xbf") == "t.xyzr: no atoms found; 0 lines read");
}

TEST_CASE("xyzr: PQR and PDB records are recognised", "[read_atoms]") {
  const std::string start = "t.xyzr:1: field 1 (x): expected a number, found ";
  CHECK(xyzr_error("ATOM 1 N MET 1 1 2 3 0.5 1.5\n") ==
        start + "\"ATOM\"; this looks like a PQR file; read it with --format pqr");
  const std::string pdb =
      "ATOM      1  N   MET A   1      27.340  24.430   2.614  1.00  9.67           N\r\n";
  const std::string advice = "; this looks like a PDB file; read it with --format pdb";
  CHECK(xyzr_error(pdb) == start + "\"ATOM\"" + advice);
  CHECK(xyzr_error("REMARK a title\n" + pdb) == start + "\"REMARK\"" + advice);
  CHECK(xyzr_error("MODEL        1\n" + pdb) == start + "\"MODEL\"" + advice);
  // Neither format.
  CHECK(xyzr_error("ATOM 1 N\n") ==
        start +
            "\"ATOM\"; this looks like a PDB or PQR file; read it with --format pdb or "
            "--format pqr");
  CHECK(xyzr_error("some text\n") == start + "\"some\"");
}

TEST_CASE("xyzr: other separators and XYZ files are recognised", "[read_atoms]") {
  for (const char* line : {"0,0,0,1.5\n", "0;0;0;1.5\n", "0.5 1,5 0 2\n", "0, 0, 0, 1.5\n"})
    CHECK(contains(xyzr_error(line),
                   "; separate the fields by blanks, and write numbers with a decimal point"));
  CHECK(xyzr_error("2\na molecule\nC 0 0 0\n") ==
        "t.xyzr:1: field 2 (y): missing; is it the number of atoms of an XYZ file? These have no "
        "radii; convert it to a PDB file");
  CHECK(xyzr_error("0 1\n") == "t.xyzr:1: field 3 (z): missing");
}

TEST_CASE("control characters are refused", "[read_atoms]") {
  CHECK(xyzr_error("1 2 3 4\n1 2\0 3 4\n"s) ==
        "t.xyzr:2: control character \\x00; this looks like a binary file, not text");
  CHECK(contains(xyzr_error("1 2 3 4\n\n# \x1b[0m\n"), "t.xyzr:3: control character \\x1b"));
  CHECK(contains(xyzr_error("1 2 3 4 \x7f\n"), "t.xyzr:1: control character \\x7f"));
  CHECK(contains(xyzr_error("1 2 3 4\n\x0c\n"), "t.xyzr:2: control character \\x0c"));
  CHECK(contains(pqr_error("REMARK\nREMARK \x01\n"), "t.pqr:2: control character \\x01"));
}

TEST_CASE("files in UTF-16 and UTF-32 are refused by name", "[read_atoms]") {
  const std::string utf16 = "t.xyzr:1: UTF-16 text; convert the file to UTF-8 first";
  CHECK(xyzr_error("\xff\xfe"
                   "1\0 \0"s) == utf16);
  CHECK(xyzr_error("\xfe\xff\0"
                   "1\0 "s) == utf16);
  const std::string utf32 = "t.xyzr:1: UTF-32 text; convert the file to UTF-8 first";
  CHECK(xyzr_error("\xff\xfe\0\0"
                   "1\0\0\0"s) == utf32);
  CHECK(xyzr_error("\0\0\xfe\xff\0\0\0"
                   "1"s) == utf32);
}

TEST_CASE("a carriage return inside a line is refused", "[read_atoms]") {
  CHECK(xyzr_error("1 2 3 4 C\r5 6 7 8 N\r") ==
        "t.xyzr:1: carriage return inside the line; expected LF or CRLF line ends");
}

TEST_CASE("lines are limited to 4096 characters", "[read_atoms]") {
  const std::string start = "1 2 3 4 ";
  const std::string longest = start + std::string(4096 - start.size(), 'x');
  CHECK(is_sole_atom(xyzr(longest), 1, 2, 3, 4));
  CHECK(is_sole_atom(xyzr(longest + "\r\n"), 1, 2, 3, 4));
  CHECK(xyzr_error("1 2 3 4\n" + longest + "x\n") ==
        "t.xyzr:2: more than 4096 characters in the line");
}

TEST_CASE("quoted text is short, printable ASCII", "[read_atoms]") {
  CHECK(contains(xyzr_error("\xc3\xa9\"\\ 2 3 4"), "found \"\\xc3\\xa9\\\"\\\\\""));
  const std::string forty(40, 'a');
  CHECK(contains(xyzr_error(forty + " 2 3 4"), "found \"" + forty + "\""));
  const std::string message = xyzr_error(forty + "b 2 3 4");
  CHECK(contains(message, "found \"" + forty + "\"..."));
  CHECK_FALSE(contains(message, "b\""));
}

TEST_CASE("xyzr: atoms have neither names nor charges", "[read_atoms]") {
  const eses::AtomFile read =
      eses::parse_atoms("1 2 3 4 0 N CYS 701 D\n", AtomFormat::xyzr, "t.xyzr");
  CHECK(read.labels.empty());
  CHECK(read.charges.empty());
}
