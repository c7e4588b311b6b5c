#pragma once
/// How the planes of a grid are divided among processes: each gets a slab of consecutive planes,
/// and all slabs cost about the same time.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "distributed/atom_share.hpp"
#include "distributed/processes.hpp"
#include "geometry/box.hpp"
#include "grid/plane_range.hpp"
#include "surface/molecule.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// Cuts `costs` into `parts` consecutive ones whose sums are nearly equal, some perhaps empty: the
/// first begins with the first cost, the last ends with the last. Returns where they begin, and the
/// number of costs.
std::vector<std::size_t> cut_evenly(std::span<const double> costs, int parts);

/// The planes that a process computes, and the atoms that influence them. A process that is alone
/// has all atoms.
struct Slab {
  PlaneRange planes;                       ///< may be empty
  Molecule molecule{std::vector<Atom>()};  ///< without labels
  /// Numbers of the molecule's atoms in the file, ascending; empty if they are the atoms' indices.
  std::vector<AtomIndex> numbers;
  std::vector<mesh::GroupNumbers> groups;  ///< by atom, if the shares of the file have them

  AtomIndex number_of(AtomIndex atom) const { return numbers.empty() ? atom : numbers[atom]; }
};

/// The diagnostics of the whole molecule, with atoms by their numbers in the file.
struct FileDiagnostics {
  std::vector<Diagnostic> diagnostics;
  std::map<AtomIndex, std::uint64_t> lines;  ///< of all atoms that are examples
};

struct SlabOfMolecule {
  Slab slab;
  FileDiagnostics diagnostics;
};

/// Gives each process its slab of the region of `plan`, which has its grid; to be called by all
/// processes. Costs are estimated from a sample of the atoms' patches; planes in `done` (ascending,
/// disjoint) cost nothing. `threads` are those of this process.
SlabOfMolecule make_slab(AtomShare share, const Plan& plan, const Outputs& outputs,
                         std::span<const PlaneRange> done, int threads, const Processes& processes);

/// The planes of the region of `plan`.
PlaneRange region_planes(const Plan& plan);

/// The box of the points of these planes and of the edges that start there; where the region goes
/// on below, with the plane below, whose points are their neighbours.
Box slab_box(const Plan& plan, const PlaneRange& planes);

}  // namespace eses::detail
