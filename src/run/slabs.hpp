#pragma once
/// Division of the planes of a grid among processes. Each process reads all atoms. It gets a slab
/// of consecutive planes and keeps the atoms that influence it. All slabs take about the same time.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box.hpp"
#include "grid/plane_range.hpp"
#include "input/file_index.hpp"
#include "run/input_atoms.hpp"
#include "run/plan.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// The planes of a process, and the atoms that influence them. A single process has all atoms.
struct Slab {
  PlaneRange planes;                       ///< may be empty
  Molecule molecule{std::vector<Atom>()};  ///< without labels
  /// Index in the file of each atom of the molecule, ascending; empty if the molecule has all
  /// atoms.
  std::vector<FileIndex> atoms_in_file;
  std::vector<GroupNumbers> groups;  ///< by atom; empty if groups are not numbered

  FileIndices file_indices() const { return FileIndices(atoms_in_file); }
};

/// Cuts `costs` into `parts` consecutive ranges with nearly equal sums; ranges may be empty.
/// Returns the begin of each range, and the number of costs.
std::vector<std::size_t> cut_evenly(std::span<const double> costs, int parts);

/// Returns the slabs of `count` processes in the region of `plan`. The planes in `finished`
/// (ascending, disjoint) cost nothing and are at no end of a slab. Slabs without unfinished planes
/// are empty.
std::vector<PlaneRange> cut_into_slabs(std::span<const Atom> atoms, const Plan& plan,
                                       std::span<const PlaneRange> finished, int count);

/// Makes a slab of these planes from all atoms and their groups.
Slab make_slab(std::span<const Atom> atoms, std::span<const GroupNumbers> groups,
               const Request& request, const Plan& plan, const PlaneRange& planes);

/// Returns the planes from the first to the last one of these ranges.
PlaneRange range_around(std::span<const PlaneRange> ranges);

/// Returns the number of planes in ranges that do not overlap.
std::int64_t plane_count(std::span<const PlaneRange> ranges);

/// Returns the box of the points of these planes, of the edges that start there, and of the plane
/// of the region below them.
Box slab_box(const Plan& plan, const PlaneRange& planes);

}  // namespace eses::detail
