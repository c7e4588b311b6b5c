#pragma once
/// Comparing two files of intersections.

#include <filesystem>
#include <optional>
#include <unordered_map>

#include "diff/differences.hpp"

namespace eses::detail {

/// What is to be known of the grids of both sides.
struct ComparedGrids {
  Sides<GridIndex> sizes{unknown_size, unknown_size};
  std::optional<double> spacing;  ///< angstrom
};

/// By how much the areas of atoms differ (A - B, square angstrom) because edges name other atoms of
/// the same contact.
using AreaShifts = std::unordered_map<AtomIndex, double>;

/// Shifts are left out if the spacing is not known.
EdgeDifference compare_edges(const Sides<std::filesystem::path>& paths, const ComparedGrids& grids,
                             double tolerance, AreaShifts& shifts);

}  // namespace eses::detail
