#pragma once
/// Slices of a set of atoms, for parallel processing.

#include <cstddef>
#include <span>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail {

/// A division of atoms by the coordinate of their centres along one axis. Slice k has the atoms in
/// [cuts[k - 1], cuts[k]); the first and the last slice are unbounded. Atoms with the same centre
/// are in the same slice.
struct AtomSlices {
  std::size_t axis = 0;
  std::vector<double> cuts;                     ///< coordinates in angstrom, ascending
  std::vector<std::vector<AtomIndex>> members;  ///< atoms of each slice, ascending
};

/// Returns a suitable number of slices for this number of atoms.
std::size_t slice_count(std::size_t atoms);

/// Cuts atoms across the longest axis into `count` slices of similar size, 1 to 256. The result
/// does not depend on the number of threads.
AtomSlices cut_into_slices(std::span<const Atom> atoms, std::size_t count, int threads);

}  // namespace eses::detail
