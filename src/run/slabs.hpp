#pragma once
/// Division of the planes of a grid among processes. Each process gets a slab of consecutive
/// planes, and all slabs take about the same time.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "distributed/atom_part.hpp"
#include "distributed/checkpoint.hpp"
#include "distributed/file_diagnostics.hpp"
#include "distributed/processes.hpp"
#include "geometry/box.hpp"
#include "grid/plane_range.hpp"
#include "input/file_index.hpp"
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
  std::vector<FileIndex> atoms_in_file;
  std::vector<mesh::GroupNumbers> groups;  ///< by atom; empty if groups are not numbered
  /// Line of each atom in the file; only until the diagnostics are known.
  std::vector<std::uint64_t> lines;

  FileIndices file_indices() const { return FileIndices(atoms_in_file); }

  /// Calls `action(sum)` for each share that is not 0. `shares` has a share for each atom of the
  /// molecule.
  template <class Action>
  void for_each_sum(std::span<const AreaShare> shares, Action&& action) const {
    for (AtomIndex i = 0; i < shares.size(); ++i)
      if (shares[i] != 0) action(AtomSum{shares[i], file_indices()[i]});
  }
};

/// Makes the slab of each process in the region of `plan`, and finds the diagnostics of all atoms.
/// `part` is the part of the file that this process has read. All processes must call it. Costs are
/// estimated from a sample of the atoms' patches. The planes in `finished` (ascending, disjoint)
/// cost nothing. `threads` is the number of threads of this process.
std::pair<Slab, FileDiagnostics> make_slab(AtomPart part, const Plan& plan, const Outputs& outputs,
                                           std::span<const PlaneRange> finished, int threads,
                                           const Processes& processes);

/// Returns the number of planes in ranges that do not overlap.
std::int64_t plane_count(std::span<const PlaneRange> ranges);

/// Returns the planes of the region of `plan`.
PlaneRange region_planes(const Plan& plan);

/// Returns the box of the points of these planes, of the edges that start there, and of the plane
/// of the region below them.
Box slab_box(const Plan& plan, const PlaneRange& planes);

}  // namespace eses::detail
