#pragma once
/// Comparing two files of the atoms' areas.

#include <filesystem>

#include "diff/compare_edges.hpp"
#include "diff/differences.hpp"

namespace eses::detail {

AreaDifference compare_areas(const Sides<std::filesystem::path>& paths, const AreaShifts& shifts,
                             double tolerance);

}  // namespace eses::detail
