#pragma once
/// Division of the planes of a grid among processes. Each process gets a slab of consecutive
/// planes, and all slabs take about the same time.

#include <cstdint>
#include <span>
#include <vector>

#include "distributed/atom_share.hpp"
#include "distributed/file_diagnostics.hpp"
#include "distributed/processes.hpp"
#include "geometry/box.hpp"
#include "grid/plane_range.hpp"
#include "run/plan.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// Cuts `costs` into `parts` consecutive ranges with nearly equal sums; ranges may be empty.
/// Returns the begin of each range, and the number of costs.
std::vector<std::size_t> cut_evenly(std::span<const double> costs, int parts);

/// The planes that a process computes, and the atoms that influence them. A single process has all
/// atoms.
struct Slab {
  PlaneRange planes;                       ///< may be empty
  Molecule molecule{std::vector<Atom>()};  ///< without labels
  /// Index in the file of each atom of the molecule, ascending; empty if the molecule has all
  /// atoms.
  std::vector<AtomIndex> numbers;
  std::vector<mesh::GroupNumbers> groups;  ///< by atom; empty if groups are not numbered

  /// Returns the index in the file of an atom of the molecule.
  AtomIndex number_of(AtomIndex atom) const { return numbers.empty() ? atom : numbers[atom]; }
};

/// The slab of this process, and the diagnostics of the whole molecule.
struct SlabOfMolecule {
  Slab slab;
  FileDiagnostics diagnostics;
};

/// Makes the slab of each process in the region of `plan`, which must have its grid. All processes
/// must call it. Costs are estimated from a sample of the atoms' patches. Planes in `done`
/// (ascending, disjoint) cost nothing. `threads` is the number of threads of this process.
SlabOfMolecule make_slab(AtomShare share, const Plan& plan, const Outputs& outputs,
                         std::span<const PlaneRange> done, int threads, const Processes& processes);

/// Returns the planes of the region of `plan`.
PlaneRange region_planes(const Plan& plan);

/// Returns the box of the points of these planes, of the edges that start there, and of the plane
/// of the region below them.
Box slab_box(const Plan& plan, const PlaneRange& planes);

}  // namespace eses::detail
