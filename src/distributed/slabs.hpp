#pragma once
/// How the planes of a grid are shared out: to each process a slab of consecutive ones that costs
/// as much time as those of the others.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "distributed/atom_share.hpp"
#include "distributed/processes.hpp"
#include "eses/molecule.hpp"
#include "eses/run.hpp"
#include "geometry/box.hpp"

namespace eses {

/// Grid planes [begin, end) across z.
struct PlaneRange {
  std::int64_t begin = 0, end = 0;

  bool is_empty() const { return begin >= end; }
  std::int64_t count() const { return end - begin; }
  friend bool operator==(const PlaneRange&, const PlaneRange&) = default;
};

/// Cuts `costs` into `parts` consecutive ones whose sums are nearly equal, some perhaps empty: the
/// first begins with the first cost, the last ends with the last. Returns where they begin, and the
/// number of costs.
std::vector<std::size_t> cut_evenly(std::span<const double> costs, int parts);

/// The planes of `planes` that no range in `done` (ascending, disjoint) holds.
std::vector<PlaneRange> remaining(const PlaneRange& planes, std::span<const PlaneRange> done);

/// What a process has of a molecule, and what it is to do with it.
struct SlabShare {
  PlaneRange planes;                       ///< perhaps empty; then there are no atoms either
  Molecule molecule{std::vector<Atom>()};  ///< what matters to them
  std::vector<AtomIndex> numbers;          ///< of its atoms in the file, ascending
  std::vector<GroupNumbers> groups;        ///< by atom, if the shares of the file have them
};

/// What is odd in a molecule, as `Molecule::oddities` tells it, by numbers in the file.
struct SharedOddities {
  std::vector<Oddity> oddities;
  std::map<AtomIndex, std::uint64_t> lines;  ///< of all atoms that are examples
};

struct SharedMolecule {
  SlabShare slab;
  SharedOddities odd;  ///< of all slabs
};

/// To be called by all processes, for a plan that has its grid and region: gives each a slab of the
/// region. Costs are estimated from a sample of the atoms' patches; planes in `done` (ascending,
/// disjoint) cost nothing. `threads` are those of this process.
SharedMolecule share_molecule(const AtomShare& share, const Plan& plan, const OutputChoice& outputs,
                              std::span<const PlaneRange> done, int threads,
                              const Processes& processes);

/// Where in space the planes are, with the one below them, which their points have for neighbours.
Box slab_box(const Plan& plan, const PlaneRange& planes);

}  // namespace eses
