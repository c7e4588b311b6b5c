#pragma once
/// Comparison of two files of crossings.

#include <filesystem>
#include <optional>

#include "diff/differences.hpp"

namespace eses::detail {

/// Compares crossings. The bounding boxes, as far as they are known, give the sizes of the grids
/// and the spacing. Throws Error if a file cannot be read or is malformed.
EdgeDifference compare_edges(const Sides<std::filesystem::path>& paths,
                             const Sides<std::optional<BoundingBox>>& boxes, double tolerance);

}  // namespace eses::detail
