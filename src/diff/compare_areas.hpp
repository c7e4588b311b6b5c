#pragma once
/// Comparison of two files of atom areas.

#include <filesystem>

#include "diff/compare_edges.hpp"
#include "diff/differences.hpp"

namespace eses::detail {

/// Compares the areas of atoms. `shifts` is the result of compare_edges. Throws Error if a file
/// cannot be read or is malformed.
AreaDifference compare_areas(const Sides<std::filesystem::path>& paths, const AreaShifts& shifts,
                             double tolerance);

}  // namespace eses::detail
