// Tests that the bytes of all files are the same on every instruction set.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "catch.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/temporary_directory.hpp"
#include "system/dispatch.hpp"

namespace eses::detail::test {
namespace {

constexpr std::array names{"baseline", "sse4", "avx2", "avx512"};

// Returns the output of a program when the environment names the set, or none.
std::string output_of(const std::optional<std::string>& set, const std::string& program,
                      const std::filesystem::path& directory) {
  const std::string environment =
      set ? "ESES_INSTRUCTION_SET='" + *set + "'" : "-u ESES_INSTRUCTION_SET";
  const std::string command =
      "cd '" + directory.string() + "' && env " + environment + " " + program + " >stdout 2>stderr";
  const int status = std::system(command.c_str());
  INFO(command << ": " << read_bytes(directory / "stderr"));
  REQUIRE(status == 0);
  return read_bytes(directory / "stdout");
}

InstructionSet chosen(const std::optional<std::string>& set) {
  const TemporaryDirectory directory;
  const std::string printed = output_of(set, "'" ESES_PRINT_INSTRUCTION_SET "'", directory.path());
  return static_cast<InstructionSet>(std::stoi(printed));
}

std::vector<std::string> files_of(std::span<const Atom> atoms, const std::string& set,
                                  int block_size) {
  const TemporaryDirectory directory;
  std::ofstream input(directory.path() / "atoms.xyzr");
  input << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (const Atom& atom : atoms)
    input << atom.center.x << ' ' << atom.center.y << ' ' << atom.center.z << ' ' << atom.radius
          << '\n';
  input.close();
  output_of(
      set,
      "'" ESES_BINARY "' atoms.xyzr 1.4 0.4 1.6 --quiet --block-size " + std::to_string(block_size),
      directory.path());
  std::vector<std::string> bytes;
  for (const char* name : eses_file_names) bytes.push_back(read_bytes(directory.path() / name));
  return bytes;
}

}  // namespace

TEST_CASE("the environment restricts the instruction set") {
  const InstructionSet widest = chosen({});
  for (std::size_t i = 0; i < names.size(); ++i) {
    INFO(names[i]);
    CHECK(chosen(names[i]) == std::min(static_cast<InstructionSet>(i), widest));
  }
  for (const char* const unknown : {"", "AVX2", "sse4 ", "avx1024", "0"}) {
    INFO(unknown);
    CHECK(chosen(unknown) == widest);
  }
}

TEST_CASE("the files do not depend on the instruction set") {
  const std::vector<std::vector<Atom>> molecules{make_chain(300, 9), make_cube(4, 3.0, 1.5),
                                                 make_icosahedron(4, 1.7)};
  for (const auto& atoms : molecules)
    for (const int block_size : {64, 100}) {
      const std::vector<std::string> expected = files_of(atoms, "baseline", block_size);
      for (const char* const set : {"sse4", "avx2", "avx512", ""}) {
        INFO(set << ", block size " << block_size);
        CHECK((files_of(atoms, set, block_size) == expected));
      }
    }
}

}  // namespace eses::detail::test
