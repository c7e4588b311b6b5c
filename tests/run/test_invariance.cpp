/// Tests that the bytes of every file depend only on the atoms, probe radius, spacing and margin,
/// and that no block misses an atom that it needs, however large the atom.

#include <array>
#include <string>
#include <vector>

#include "catch.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

using FileBytes = std::array<std::string, 4>;

struct Outcome {
  FileBytes files;
  Summary summary;
};

Outcome outcome_of(const std::vector<Atom>& atoms, const Parameters& parameters) {
  const TemporaryDirectory directory;
  const Outputs all;
  Outcome outcome;
  outcome.summary = run(atoms, parameters, all, directory.path());
  for (std::size_t f = 0; f < outcome.files.size(); ++f)
    outcome.files[f] = read_bytes(directory.path() / eses_file_names[f]);
  return outcome;
}

/// Sums are compared to the last bit, because the files have only twelve digits.
void check_same(const Outcome& outcome, const Outcome& reference) {
  for (std::size_t f = 0; f < reference.files.size(); ++f) {
    INFO(eses_file_names[f]);
    const bool same = outcome.files[f] == reference.files[f];
    CHECK(same);
  }
  CHECK(outcome.summary.inside_points == reference.summary.inside_points);
  CHECK(outcome.summary.convex == reference.summary.convex);
  CHECK(outcome.summary.saddle == reference.summary.saddle);
  CHECK(outcome.summary.concave == reference.summary.concave);
  CHECK(outcome.summary.volume == reference.summary.volume);
  CHECK(outcome.summary.area == reference.summary.area);
}

void check_invariance(const std::vector<Atom>& atoms, Parameters parameters) {
  parameters.threads = 1;
  parameters.block_size = 64;
  const Outcome reference = outcome_of(atoms, parameters);
  REQUIRE(reference.summary.edges() > 0);
  for (const int threads : {1, 2, 3, 8})
    for (const std::int64_t block_size : {8, 33, 64, 128, 1000}) {
      INFO(threads << " threads, block size " << block_size);
      parameters.threads = threads;
      parameters.block_size = block_size;
      check_same(outcome_of(atoms, parameters), reference);
    }
}

}  // namespace

TEST_CASE("files do not depend on threads and block size: chain") {
  check_invariance(make_chain(150, 20180101), {});
}

TEST_CASE("files do not depend on threads and block size: lattice") {
  // Probes touch four atoms at once, on the faces of the cells.
  check_invariance(make_cube(5, 2.4, 1.5), {});
}

TEST_CASE("files do not depend on threads and block size: grid points on the surface") {
  Parameters parameters;
  grid_options(parameters).spacing = 0.5;
  grid_options(parameters).margin = 1;
  check_invariance(make_atom_set(Kind::snapped, 2), parameters);
}

TEST_CASE("files do not depend on the block size where the last bit decides") {
  // The atoms are on a lattice of twice the probe radius, the grid points on a fraction of it.
  // Probes are exactly at a probe radius from corners of blocks.
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Random random(seed);
    std::vector<Atom> atoms(14);
    const auto place = [&] { return 2.8 * static_cast<double>(random.integer(0, 3)); };
    for (Atom& atom : atoms) atom = {{place(), place(), place()}, 1.4};
    Parameters parameters;
    grid_options(parameters).spacing = 0.7;
    grid_options(parameters).margin = 0.7;
    const Outcome expected = outcome_of(atoms, parameters);
    for (const std::int64_t block_size : {2, 3, 7}) {
      parameters.block_size = block_size;
      INFO("seed " << seed << ", block size " << block_size);
      check_same(outcome_of(atoms, parameters), expected);
    }
  }
}

TEST_CASE("grid points near axes of spindle tori, and atoms of radius 0, verify") {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Random random(seed + 500);
    std::vector<Atom> atoms(25);
    for (Atom& atom : atoms) {
      for (std::size_t q = 0; q < 3; ++q)
        atom.center[q] = static_cast<double>(random.integer(0, 6));
      atom.radius = 0.5 * static_cast<double>(random.integer(0, 4));
    }
    Parameters parameters;
    parameters.probe_radius = seed % 2 == 0 ? 1.5 : 1.4;
    grid_options(parameters).spacing = seed % 2 == 0 ? 0.5 : 0.7;
    grid_options(parameters).margin = 1;
    INFO("seed " << seed);
    const RunResult result = run_and_read(atoms, parameters);
    const auto faults = find_faults(atoms, parameters, result.files, result.summary);
    INFO(faults.size() << " faults, the first: " << (faults.empty() ? "" : faults.front()));
    CHECK(faults.empty());
  }
}

namespace {

/// A gas of atoms larger than the 2 angstrom that ESES assumes.
std::vector<Atom> large_atoms(std::uint64_t seed) {
  Random random(seed);
  std::vector<Atom> atoms(random.integer(8, 20));
  for (Atom& atom : atoms) {
    for (std::size_t q = 0; q < 3; ++q) atom.center[q] = random.uniform(0, 14);
    atom.radius = random.uniform(2.5, 4);
  }
  // There are small atoms as well, which must be found at smaller distances.
  for (int small = 0; small < 8; ++small) {
    const Vec3 center{random.uniform(-2, 16), random.uniform(-2, 16), random.uniform(-2, 16)};
    atoms.push_back({center, random.uniform(0, 1)});
  }
  return atoms;
}

}  // namespace

TEST_CASE("atoms larger than 2 angstrom reach all blocks that need them") {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Parameters parameters;
    parameters.probe_radius = designed_probe_radius(seed);
    grid_options(parameters).spacing = 0.5;
    parameters.block_size = seed % 2 == 0 ? 4 : 9;
    INFO("seed " << seed << ", probe radius " << parameters.probe_radius);
    const std::vector<Atom> atoms = large_atoms(seed);
    const RunResult result = run_and_read(atoms, parameters);
    const auto faults = find_faults(atoms, parameters, result.files, result.summary);
    INFO(faults.size() << " faults, the first: " << (faults.empty() ? "" : faults.front()));
    CHECK(faults.empty());

    const Outcome blocks = outcome_of(atoms, parameters);
    parameters.block_size = 1000;
    check_same(blocks, outcome_of(atoms, parameters));
  }
}

}  // namespace eses::detail::test
