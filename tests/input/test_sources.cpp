/// Tests of the sources of atoms: files, gzip members, pipes and standard input.

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "support/atom_lists.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"
#include "system/gzip.hpp"

namespace {

namespace fs = std::filesystem;

using eses::Atom;
using eses::AtomFormat;
using eses::detail::Gzip;
using namespace eses::detail::test;
using std::string_literals::operator""s;

std::string file_error(const fs::path& path, AtomFormat format = AtomFormat::automatic) {
  return message_of([&] { read_atom_list(path, format); });
}

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

std::string gzip_member(const std::string& text) {
  Gzip gzip;
  const std::span<const char> bytes = gzip.member(text);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

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
