#pragma once
/// Comparison of two files of grid points.

#include <filesystem>

#include "diff/differences.hpp"

namespace eses::detail {

/// Compares points of two grids of the same size. Files in ESES's order are compared line by line;
/// other files need four bits of memory for each point. Throws Error if memory is insufficient, or
/// if a file cannot be read or is malformed.
PointDifference compare_points(const Sides<std::filesystem::path>& paths, const GridIndex& size);

/// Returns the size of the smallest grid that contains all points of a file.
GridIndex extent_of_points(const std::filesystem::path& path);

}  // namespace eses::detail
