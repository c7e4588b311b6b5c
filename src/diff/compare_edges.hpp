#pragma once
/// Comparison of two files of crossings.

#include <filesystem>
#include <optional>
#include <unordered_map>

#include "diff/differences.hpp"

namespace eses::detail {

/// The grids of both sides, as far as they are known.
struct ComparedGrids {
  Sides<GridIndex> sizes{unknown_size, unknown_size};
  std::optional<double> spacing;  ///< angstrom
};

/// Differences of the areas of atoms (A - B, square angstrom) that are due to edges with different
/// atoms of the same contact.
using AreaShifts = std::unordered_map<AtomIndex, double>;

/// Compares crossings, and adds to `shifts` if the spacing is known. Throws Error if a file cannot
/// be read or is malformed.
EdgeDifference compare_edges(const Sides<std::filesystem::path>& paths, const ComparedGrids& grids,
                             double tolerance, AreaShifts& shifts);

}  // namespace eses::detail
