// Tests that numbers are written as by printf, and that files are complete or absent.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <limits>
#include <span>
#include <string>

#include "catch.hpp"
#include "eses/error.hpp"
#include "output/file.hpp"
#include "output/text_buffer.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"
#include "system/parallel.hpp"

namespace eses::detail::test {
namespace {

std::string ours(double value) {
  std::array<char, max_number_length> text{};
  return {text.data(), write_scientific(text.data(), value)};
}

std::string printf_text(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.12e", value);
  return text.data();
}

void require_same_text(double value) {
  if (ours(value) != printf_text(value)) REQUIRE(ours(value) == printf_text(value));
}

void require_same_index(std::uint64_t value) {
  std::array<char, max_number_length> text{};
  const std::string written(text.data(), write_index(text.data(), value));
  if (written != std::to_string(value)) REQUIRE(written == std::to_string(value));
}

std::vector<std::string> names_in(const std::filesystem::path& directory) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    names.push_back(entry.path().filename().string());
  return names;
}

Summary run_chain(const std::filesystem::path& directory, const Outputs& outputs = {}) {
  const std::vector<Atom> atoms = make_chain(60, 5);
  Parameters parameters;
  parameters.threads = 2;
  return run(atoms, parameters, outputs, directory);
}

}  // namespace

TEST_CASE("numbers have the digits of printf's %.12e") {
  Random random(11);
  for (int i = 0; i < 300000; ++i) {
    const double exponent = random.uniform(-14, 14);
    require_same_text(random.uniform(-1, 1) * std::pow(10, exponent));
  }
  for (int exponent = -25; exponent < 25; ++exponent) {
    double below = std::pow(10, exponent), above = below;
    for (int i = 0; i < 40; ++i) {
      require_same_text(below);
      require_same_text(-above);
      below = std::nextafter(below, 0);
      above = std::nextafter(above, 1e300);
    }
  }
  for (int i = -200000; i < 200000; ++i) {
    require_same_text(i * 0.001);
    require_same_text(i * 0.4 - 5.251);
    // Ties in the last digit: odd multiples of half a unit that are exact in binary.
    require_same_text(std::ldexp(2 * i + 1, -9) + 4096);
  }
  using Limits = std::numeric_limits<double>;
  for (const double value : {0.0, -0.0, 1.0, Limits::min(), Limits::max(), Limits::denorm_min(),
                             Limits::infinity(), -Limits::infinity()})
    require_same_text(value);
}

TEST_CASE("indices are written as plain decimals") {
  for (const std::uint64_t value : {std::uint64_t{0}, std::uint64_t{9}, std::uint64_t{10},
                                    std::uint64_t{4294967295}, ~std::uint64_t{0}})
    require_same_index(value);
  for (std::uint64_t value = 0; value < 20000; ++value) require_same_index(value);
  for (std::uint64_t power = 1; power < 10000000000; power *= 10)
    for (const std::uint64_t value : {power - 1, power, power + 1, 7 * power, 7 * power + 12})
      require_same_index(value);
}

TEST_CASE("a file has its name only once it is committed") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "file.txt";
  {
    const OutputDirectory place(directory.path());
    OutputFile file(place, "file.txt");
    file.write_at(std::string("world"), 6);
    file.write_at(std::string("hello "), 0);
    CHECK_FALSE(std::filesystem::exists(path));
    file.close();
    CHECK_FALSE(std::filesystem::exists(path));
    file.commit();
  }
  CHECK(read_bytes(path) == "hello world");
  CHECK(names_in(directory.path()).size() == 1);
}

TEST_CASE("an abandoned file leaves the older one unchanged") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "file.txt";
  std::ofstream(path) << "older";
  {
    const OutputDirectory place(directory.path());
    OutputFile file(place, "file.txt");
    file.write_at(std::string("newer"), 0);
  }
  CHECK(read_bytes(path) == "older");
  CHECK(names_in(directory.path()).size() == 1);
}

TEST_CASE("a run into a place that cannot be written to fails and names it") {
  const TemporaryDirectory directory;
  std::ofstream(directory.path() / "file") << "no directory";
  for (const std::filesystem::path& place :
       {directory.path() / "file", directory.path() / "file" / "below",
        std::filesystem::path("/dev/full"), std::filesystem::path("/proc/eses-blocks")}) {
    INFO(place);
    try {
      run_chain(place);
      FAIL("the run did not fail");
    } catch (const Error& error) {
      CHECK(std::string(error.what()).find(place.string()) != std::string::npos);
    }
  }
}

TEST_CASE("a library's run does not replace a device, FIFO or socket") {
  const TemporaryDirectory directory;
  const SpecialFiles special(directory.path());
  for (const auto& [file, kind] : special.kinds) {
    INFO(kind);
    const std::filesystem::path out = directory.path() / "out", link = directory.path() / "a.ply";
    std::filesystem::create_directory(out);
    std::filesystem::create_symlink(file, out / "grid_info.txt");
    CHECK_THROWS_AS(run_chain(out), Error);
    CHECK(names_in(out).size() == 1);
    std::filesystem::remove_all(out);
    std::filesystem::create_symlink(file, link);
    Outputs outputs = Outputs::none();
    outputs.mesh = MeshOptions{link};
    const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
    CHECK_THROWS_AS(run(atoms, {}, outputs, out), Error);
    CHECK_FALSE(std::filesystem::is_regular_file(link));
    CHECK(std::filesystem::is_symlink(link));
    std::filesystem::remove(link);
  }
}

TEST_CASE("a read-only directory is refused and left empty") {
  if (geteuid() == 0) SKIP("the super-user may write anywhere");
  const TemporaryDirectory directory;
  std::filesystem::permissions(
      directory.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  CHECK_THROWS_AS(run_chain(directory.path()), Error);
  std::filesystem::permissions(directory.path(), std::filesystem::perms::owner_all);
  CHECK(names_in(directory.path()).empty());
}

TEST_CASE("without space for the files a run fails and leaves nothing") {
  // A limit on the size of files replaces a full disk: writing fails in the same way.
  for (const rlim_t limit : {rlim_t{0}, rlim_t{1000}, rlim_t{100000}}) {
    const TemporaryDirectory directory;
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGXFSZ, SIG_IGN);
      available_threads();  // some OpenMP runtimes write a file of their own when they start
      const rlimit file_size{limit, limit};
      setrlimit(RLIMIT_FSIZE, &file_size);
      try {
        const std::vector<Atom> atoms = make_chain(60, 5);
        Parameters parameters;
        parameters.threads = 1;  // OpenMP's threads do not survive a fork
        run(atoms, parameters, {}, directory.path());
      } catch (const Error&) {
        _exit(42);
      } catch (...) {
        _exit(43);
      }
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    CHECK(WEXITSTATUS(status) == 42);
    CHECK(names_in(directory.path()).empty());
  }
}

TEST_CASE("only the chosen files are written, with the bytes of a full run") {
  const TemporaryDirectory everything;
  const Summary summary = run_chain(everything.path());
  std::uint64_t bytes = 0;
  for (const char* name : eses_file_names)
    bytes += std::filesystem::file_size(everything.path() / name);
  CHECK(summary.bytes_written == bytes);
  for (int choice = 0; choice < 16; ++choice) {
    const TemporaryDirectory some;
    const std::array<bool, 4> chosen{(choice & 1) != 0, (choice & 2) != 0, (choice & 4) != 0,
                                     (choice & 8) != 0};
    const Summary part = run_chain(some.path(), {chosen[0], chosen[1], chosen[2], chosen[3]});
    CHECK(part.area == summary.area);
    CHECK(part.volume == summary.volume);
    for (std::size_t q = 0; q < 4; ++q) {
      const auto path = some.path() / eses_file_names[q];
      CHECK(std::filesystem::exists(path) == chosen[q]);
      if (chosen[q]) CHECK(read_bytes(path) == read_bytes(everything.path() / eses_file_names[q]));
    }
  }
}

}  // namespace eses::detail::test
