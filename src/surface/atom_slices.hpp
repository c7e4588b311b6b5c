#pragma once
/// Slices of a set of atoms, which threads take one by one.

#include <cstddef>
#include <span>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail {

/// Atoms by where their centres are along one axis: slice k has those from `cuts[k - 1]` on that
/// are below `cuts[k]`, without limit at both ends. Those with the same centre are in the same one.
struct AtomSlices {
  std::size_t axis = 0;
  std::vector<double> cuts;                     ///< angstrom, ascending
  std::vector<std::vector<AtomIndex>> members;  ///< by slice, ascending in each
};

/// How many slices so many atoms are worth.
std::size_t slice_count(std::size_t atoms);

/// Slices of about as many atoms each, across the longest axis, at most 256. They are the same with
/// any number of threads.
AtomSlices cut_into_slices(std::span<const Atom> atoms, std::size_t slices, int threads);

}  // namespace eses::detail
