/// Fuzzes the whole geometry: compares every point, edge and sum of a run on a small, degenerate
/// molecule with the brute-force oracle.

#include <fmt/ranges.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "expect.hpp"
#include "molecule.hpp"
#include "support/brute_force.hpp"
#include "support/eses_files.hpp"

namespace eses::detail::fuzz {
namespace {

std::vector<std::string> faults_of(const Molecule& molecule) {
  try {
    const auto& [atoms, parameters] = molecule;
    const test::RunResult result = test::run_and_read(atoms, parameters);
    return test::find_faults(atoms, parameters, result.files, result.summary);
  } catch (const std::exception& error) {
    return {error.what()};
  }
}

void check(std::span<const std::uint8_t> bytes) {
  const Molecule molecule = make_molecule(bytes);
  const std::vector<std::string> faults = faults_of(molecule);
  if (faults.empty()) return;
  fail(fmt::format("{} faults\n{}\n{}", faults.size(), fmt::join(faults, "\n"), text_of(molecule)));
}

}  // namespace
}  // namespace eses::detail::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eses::detail::fuzz::check({data, size});
  return 0;
}
