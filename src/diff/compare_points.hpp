#pragma once
/// Comparing two files of grid points.

#include <filesystem>

#include "diff/differences.hpp"

namespace eses::detail {

/// Both grids have the same size. Files in ESES's order are compared in lock step; for others,
/// memory takes four bits a point. Throws Error if there is no room for them.
PointDifference compare_points(const Sides<std::filesystem::path>& paths, const GridIndex& size);

/// The size of the grid that a file of points is for, where nothing else tells it.
GridIndex extent_of_points(const std::filesystem::path& path);

}  // namespace eses::detail
