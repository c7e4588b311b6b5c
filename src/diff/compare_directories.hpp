#pragma once
/// Comparison of two directories of ESES files, written by any program and in any order of lines,
/// and of their large files.

#include <filesystem>
#include <optional>

#include "diff/differences.hpp"

namespace eses::detail {

/// Compares the files that both directories have, plain or gzipped. Positions and corners
/// (angstrom), normals, and areas (square angstrom) count as equal if they differ by at most
/// `tolerance`. Throws Error if there is nothing to compare, or if a file cannot be read or is
/// malformed.
Differences compare_directories(const Sides<std::filesystem::path>& directories, double tolerance);

/// Compares points of two grids of the same size. Files in ESES's order are compared line by line;
/// other files need four bits of memory for each point. Throws Error if memory is insufficient, or
/// if a file cannot be read or is malformed.
PointDifference compare_points(const Sides<std::filesystem::path>& paths, const GridIndex& size);

/// Returns the size of the smallest grid that contains all points of a file.
GridIndex extent_of_points(const std::filesystem::path& path);

/// Compares crossings. The bounding boxes, as far as they are known, give the sizes of the grids
/// and the spacing. Throws Error if a file cannot be read or is malformed.
EdgeDifference compare_edges(const Sides<std::filesystem::path>& paths,
                             const Sides<std::optional<BoundingBox>>& boxes, double tolerance);

}  // namespace eses::detail
