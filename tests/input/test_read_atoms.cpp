#include <fcntl.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "input/read_structure.hpp"
#include "support/atom_lists.hpp"
#include "system/gzip.hpp"

namespace {

namespace fs = std::filesystem;
using eses::Atom;
using eses::AtomFormat;
using eses::detail::Gzip;
using eses::detail::test::parse_atom_list;
using eses::detail::test::read_atom_list;
using std::string_literals::operator""s;

/// Returns the message of the error, or "" if nothing is thrown.
template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const eses::Error& error) {
    return error.what();
  }
  return {};
}

std::vector<Atom> xyzr(std::string_view text) {
  return parse_atom_list(text, AtomFormat::xyzr, "t.xyzr");
}

std::vector<Atom> pqr(std::string_view text) {
  return parse_atom_list(text, AtomFormat::pqr, "t.pqr");
}

std::string xyzr_error(std::string_view text) {
  return message_of([=] { xyzr(text); });
}

std::string pqr_error(std::string_view text) {
  return message_of([=] { pqr(text); });
}

std::string file_error(const fs::path& path, AtomFormat format = AtomFormat::automatic) {
  return message_of([&] { read_atom_list(path, format); });
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool is_atom(const Atom& atom, double x, double y, double z, double radius) {
  return atom.center == eses::Vec3{x, y, z} && atom.radius == radius;
}

bool is_sole_atom(const std::vector<Atom>& atoms, double x, double y, double z, double radius) {
  return atoms.size() == 1 && is_atom(atoms[0], x, y, z, radius);
}

/// A temporary directory for a test.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string pattern = (fs::temp_directory_path() / "eses_read_atoms_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
    path_ = pattern;
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

  fs::path write(const std::string& name, std::string_view text) const {
    fs::path file = path_ / name;
    std::FILE* stream = std::fopen(file.c_str(), "wb");
    if (stream == nullptr) throw std::runtime_error("fopen failed");
    const std::size_t written = std::fwrite(text.data(), 1, text.size(), stream);
    if (std::fclose(stream) != 0 || written != text.size()) throw std::runtime_error("disk full");
    return file;
  }

 private:
  fs::path path_;
};

/// Replaces standard input by another file during its lifetime.
class StandardInput {
 public:
  explicit StandardInput(int replacement) : saved_(::dup(STDIN_FILENO)) {
    ::dup2(replacement, STDIN_FILENO);
    ::close(replacement);
  }
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;
  ~StandardInput() {
    if (saved_ < 0) {
      ::close(STDIN_FILENO);
    } else {
      ::dup2(saved_, STDIN_FILENO);
      ::close(saved_);
    }
  }

 private:
  int saved_;
};

/// A child process that writes `pieces` into a pipe, with pauses in between.
class PipeWriter {
 public:
  PipeWriter(const std::vector<std::string>& pieces, unsigned pause_microseconds) {
    int ends[2] = {-1, -1};
    if (::pipe(ends) != 0) throw std::runtime_error("pipe failed");
    child_ = ::fork();
    if (child_ == 0) {
      ::close(ends[0]);
      for (const std::string& piece : pieces) {
        write_all(ends[1], piece);
        ::usleep(pause_microseconds);
      }
      ::_exit(0);
    }
    ::close(ends[1]);
    read_end_ = ends[0];
  }
  PipeWriter(const PipeWriter&) = delete;
  PipeWriter& operator=(const PipeWriter&) = delete;
  ~PipeWriter() {
    while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  int read_end() const { return read_end_; }

 private:
  static void write_all(int descriptor, std::string_view text) {
    while (!text.empty()) {
      const ssize_t count = ::write(descriptor, text.data(), text.size());
      if (count <= 0) ::_exit(1);
      text.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  pid_t child_ = -1;
  int read_end_ = -1;
};

volatile std::sig_atomic_t alarm_count = 0;

void count_alarm(int) { alarm_count = alarm_count + 1; }

/// Interrupts system calls every few milliseconds, because the handler is set without SA_RESTART.
class Interruptions {
 public:
  Interruptions() {
    alarm_count = 0;
    struct sigaction action {};
    action.sa_handler = count_alarm;
    ::sigaction(SIGALRM, &action, &saved_);
    const itimerval interval{{0, 3000}, {0, 3000}};
    ::setitimer(ITIMER_REAL, &interval, nullptr);
  }
  Interruptions(const Interruptions&) = delete;
  Interruptions& operator=(const Interruptions&) = delete;
  ~Interruptions() {
    const itimerval never{};
    ::setitimer(ITIMER_REAL, &never, nullptr);
    ::sigaction(SIGALRM, &saved_, nullptr);
  }

 private:
  struct sigaction saved_ {};
};

std::string printed(double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.17g", value);
  return buffer;
}

std::string gzip_member(const std::string& text) {
  Gzip gzip;
  const std::span<const char> bytes = gzip.member(text);
  return {bytes.begin(), bytes.end()};
}

/// Returns a number with a magnitude from 1e-300 almost to the largest that is accepted.
double random_number(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_real_distribution<double> exponent(-300, 6);
  const double magnitude = generator() % 2 == 0 ? 1e6 : std::pow(10, exponent(generator));
  return mantissa(generator) * magnitude;
}

}  // namespace

// ----------------------------------------------------------------------------------------- xyzr

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
  CHECK(xyzr_error("1 2,5 3 4") == "t.xyzr:1: field 2 (y): expected a number, found \"2,5\"");
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
  CHECK(xyzr_error("327\n1 2 3 4\n") == "t.xyzr:1: field 2 (y): missing");
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

// ----------------------------------------------------------------------- text that is not clean

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

// ------------------------------------------------------------------------------------------ PQR

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

TEST_CASE("xyzr: atoms have neither names nor charges", "[read_atoms]") {
  const eses::AtomFile read =
      eses::parse_atoms("1 2 3 4 0 N CYS 701 D\n", AtomFormat::xyzr, "t.xyzr");
  CHECK(read.labels.empty());
  CHECK(read.charges.empty());
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

// ---------------------------------------------------------------------------------------- files

TEST_CASE("the format follows from the suffix or the caller", "[read_atoms]") {
  const TemporaryDirectory directory;
  const std::string record = "ATOM 1 N MET 1 1 2 3 0.5 1.5\n";
  for (const char* name : {"a.pqr", "b.PQR", "c.d.Pqr"}) {
    const fs::path file = directory.write(name, record);
    CHECK(is_sole_atom(read_atom_list(file), 1, 2, 3, 1.5));
    CHECK(contains(file_error(file, AtomFormat::xyzr), "found \"ATOM\""));
  }
  for (const char* name : {"a.xyzr", "b.txt", "pqr", ".pqr", "c.pqrs", "d.pqr.old"}) {
    CHECK(is_sole_atom(read_atom_list(directory.write(name, "1 2 3 4")), 1, 2, 3, 4));
    const fs::path file = directory.write(name, record);
    CHECK(is_sole_atom(read_atom_list(file, AtomFormat::pqr), 1, 2, 3, 1.5));
  }
  CHECK(is_sole_atom(parse_atom_list("1 2 3 4", AtomFormat::automatic, "t.pqr"), 1, 2, 3, 4));
}

TEST_CASE("a file larger than one read is complete", "[read_atoms]") {
  const TemporaryDirectory directory;
  const std::size_t count = 300000;
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += std::to_string(i) + " 2 3 1.5\n";
  const auto atoms = read_atom_list(directory.write("large.xyzr", text));
  REQUIRE(atoms.size() == count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_atom(atoms[i], static_cast<double>(i), 2, 3, 1.5)) FAIL("atom " << i);
  }
}

TEST_CASE("gzip files with any number of members are read", "[read_atoms]") {
  const TemporaryDirectory directory;
  const std::string record = "ATOM 1 N MET 1 1 2 3 0.5 1.5\n";
  CHECK(
      is_sole_atom(read_atom_list(directory.write("a.pqr.gz", gzip_member(record))), 1, 2, 3, 1.5));
  // The content of the file decides whether it is compressed.
  CHECK(
      is_sole_atom(read_atom_list(directory.write("a.xyzr", gzip_member("1 2 3 4"))), 1, 2, 3, 4));
  CHECK(is_sole_atom(read_atom_list(directory.write("b.xyzr.gz", "1 2 3 4")), 1, 2, 3, 4));

  std::string lines, members;
  for (int i = 0; i < 50000; ++i) {
    lines += std::to_string(i) + " 2 3 4\n";
    if (i % 10000 == 9999) {
      members += gzip_member(lines);
      lines.clear();
    }
  }
  const std::vector<Atom> atoms = read_atom_list(directory.write("many.xyzr.gz", members));
  REQUIRE(atoms.size() == 50000);
  for (std::size_t i = 0; i < atoms.size(); ++i)
    REQUIRE(atoms[i].center.x == static_cast<double>(i));

  const std::string whole = gzip_member("1 2 3 4\n5 6 7 8\n");
  for (std::size_t size = 2; size < whole.size(); ++size)
    CHECK(contains(file_error(directory.write("cut.xyzr.gz", whole.substr(0, size))),
                   "cut.xyzr.gz: the compressed data ends too early"));
  std::string damaged = whole;
  damaged[whole.size() - 6] ^= 1;  // a bit of the check sum
  CHECK(contains(file_error(directory.write("bad.xyzr.gz", damaged)),
                 "bad.xyzr.gz: the compressed data is damaged"));
  CHECK(contains(file_error(directory.write("line.xyzr.gz", gzip_member("1 2 3 4\n1 2 x 4\n"))),
                 "line.xyzr.gz:2: field 3"));
}

TEST_CASE("only another member or zeros may follow a gzip member", "[read_atoms]") {
  const TemporaryDirectory directory;
  const std::string first = gzip_member("1 2 3 4\n"), second = gzip_member("5 6 7 8\n");
  const auto error_of = [&](const std::string& bytes) {
    return file_error(directory.write("a.xyzr.gz", bytes));
  };
  // The program reads what `gzip -t` accepts and refuses what it refuses.
  CHECK(error_of(first + second).empty());
  CHECK(error_of(first + second + std::string(1000000, '\0')).empty());
  const std::string damaged = "a.xyzr.gz: the compressed data is damaged near byte ";
  for (std::size_t byte = 0; byte < 4; ++byte) {  // a byte of the second member's header
    INFO(byte);
    std::string bytes = second;
    bytes[byte] = '\x7e';
    CHECK(contains(error_of(first + bytes), damaged));
    CHECK_FALSE(error_of(first + bytes.substr(0, byte + 1)).empty());
  }
  CHECK(contains(error_of(first + "\n"), damaged));
  CHECK(contains(error_of(first + std::string(10, '\0') + second), damaged));
  for (std::size_t size = 1; size < second.size(); ++size) {
    INFO(size);
    CHECK(contains(error_of(first + second.substr(0, size)),
                   "a.xyzr.gz: the compressed data ends too early, after " +
                       std::to_string(first.size() + size) + " bytes"));
  }
  // Boundaries of members meet boundaries of reads in every way.
  const std::string line = "1 2 3 4\n";
  std::string many;
  for (int i = 0; i < 20000; ++i) many += gzip_member(line);
  CHECK(read_atom_list(directory.write("b.xyzr.gz", many)).size() == 20000);
  CHECK(contains(error_of(many + "x"), damaged));
}

TEST_CASE("files that cannot be read are refused", "[read_atoms]") {
  const TemporaryDirectory directory;
  const fs::path missing = directory.path() / "missing.xyzr";
  CHECK(file_error(missing) == "cannot open " + missing.string() + ": No such file or directory");
  const fs::path below = directory.write("file", "1 2 3 4") / "below";
  CHECK(file_error(below) == "cannot open " + below.string() + ": Not a directory");
  CHECK(file_error(directory.path()) ==
        "cannot read " + directory.path().string() + ": Is a directory");

  const fs::path forbidden = directory.write("forbidden.xyzr", "1 2 3 4");
  fs::permissions(forbidden, fs::perms::none);
  const bool is_privileged = ::geteuid() == 0;
  CHECK(file_error(forbidden) ==
        (is_privileged ? "" : "cannot open " + forbidden.string() + ": Permission denied"));
}

TEST_CASE("messages name the file as it was given", "[read_atoms]") {
  const TemporaryDirectory directory;
  const fs::path file = directory.write("with blank.xyzr", "1 2 3\n");
  CHECK(file_error(file) == file.string() + ":1: field 4 (radius): missing");
  const fs::path empty = directory.write("empty.pqr", "");
  CHECK(file_error(empty) == empty.string() + ": no ATOM or HETATM records found; 0 lines read");
}

TEST_CASE("a named pipe is read", "[read_atoms]") {
  const TemporaryDirectory directory;
  const fs::path fifo = directory.path() / "fifo.pqr";
  REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string_view record = "ATOM 1 N MET 1 1 2 3 0.5 1.5\n";
    const int end = ::open(fifo.c_str(), O_WRONLY);
    ::_exit(::write(end, record.data(), record.size()) > 0 ? 0 : 1);
  }
  CHECK(is_sole_atom(read_atom_list(fifo), 1, 2, 3, 1.5));
  ::waitpid(child, nullptr, 0);
}

TEST_CASE("files whose size the system does not report are read", "[read_atoms]") {
  if (fs::exists("/proc/version")) {
    CHECK(file_error("/proc/version") ==
          "/proc/version:1: field 1 (x): expected a number, found \"Linux\"");
  }
  if (fs::exists("/dev/null"))
    CHECK(file_error("/dev/null") == "/dev/null: no atoms found; 0 lines read");
  if (fs::exists("/dev/zero")) {
    CHECK(file_error("/dev/zero") ==
          "/dev/zero:1: control character \\x00; this looks like a binary file, not text");
  }
}

// ------------------------------------------------------------------------------- standard input

TEST_CASE("standard input: a pipe is read", "[read_atoms]") {
  const PipeWriter writer({"1 2 3", ".5 4\n5 6 7 8"}, 20000);
  const StandardInput input(writer.read_end());
  const auto atoms = read_atom_list("-");
  REQUIRE(atoms.size() == 2);
  CHECK(is_atom(atoms[0], 1, 2, 3.5, 4));
  CHECK(is_atom(atoms[1], 5, 6, 7, 8));
}

TEST_CASE("standard input: more than the size of a pipe is read", "[read_atoms]") {
  const std::size_t count = 200000;
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += "1 2 3 " + std::to_string(i % 10) + '\n';
  const PipeWriter writer({text}, 0);
  const StandardInput input(writer.read_end());
  const auto atoms = read_atom_list("-");
  REQUIRE(atoms.size() == count);
  CHECK(is_atom(atoms.back(), 1, 2, 3, 9));
}

TEST_CASE("standard input: signals do not disturb reading", "[read_atoms]") {
  const Interruptions interruptions;
  const PipeWriter writer({"1 2 3 4\n", "5 6 7 8\n", "9 10 11 12\n"}, 30000);
  const StandardInput input(writer.read_end());
  CHECK(read_atom_list("-").size() == 3);
  CHECK(alarm_count > 0);
}

TEST_CASE("standard input: PQR is read if the caller chooses it", "[read_atoms]") {
  const std::string record = "ATOM 1 N MET 1 1 2 3 0.5 1.5\n";
  {
    const PipeWriter writer({record}, 0);
    const StandardInput input(writer.read_end());
    CHECK(is_sole_atom(read_atom_list("-", AtomFormat::pqr), 1, 2, 3, 1.5));
  }
  const PipeWriter writer({record}, 0);
  const StandardInput input(writer.read_end());
  CHECK(contains(file_error("-"), "<stdin>:1: field 1 (x): expected a number, found \"ATOM\""));
}

TEST_CASE("standard input: the name - reads a redirected file", "[read_atoms]") {
  const TemporaryDirectory directory;
  const fs::path file = directory.write("a.xyzr", "1 2 3 4\n");
  const StandardInput input(::open(file.c_str(), O_RDONLY));
  CHECK(is_sole_atom(read_atom_list("-"), 1, 2, 3, 4));
}

TEST_CASE("standard input: the name /dev/stdin reads a redirected file", "[read_atoms]") {
  if (!fs::exists("/dev/stdin")) SKIP("there is no /dev/stdin");
  const TemporaryDirectory directory;
  const fs::path file = directory.write("a.xyzr", "1 2 3 4\n");
  const StandardInput input(::open(file.c_str(), O_RDONLY));
  CHECK(is_sole_atom(read_atom_list("/dev/stdin"), 1, 2, 3, 4));
}

TEST_CASE("standard input: errors name standard input", "[read_atoms]") {
  const TemporaryDirectory directory;
  {
    const StandardInput input(::open(directory.path().c_str(), O_RDONLY));
    CHECK(file_error("-") == "cannot read <stdin>: Is a directory");
  }
  {
    const StandardInput input(::open("/dev/null", O_RDONLY));
    CHECK(file_error("-") == "<stdin>: no atoms found; 0 lines read");
  }
  const StandardInput input(::open("/dev/null", O_RDONLY));
  ::close(STDIN_FILENO);
  CHECK(file_error("-") == "cannot read <stdin>: Bad file descriptor");
}
