#pragma once
/// Comparing two directories of ESES's files, whoever wrote them and in whatever order.

#include <filesystem>

#include "diff/differences.hpp"

namespace eses::detail {

/// Compares the files that both directories have, plain or gzipped. Differences of positions and
/// corners (angstrom), normals and areas (square angstrom) up to `tolerance` count as none. Throws
/// Error if there is nothing to compare or a file cannot be read or is malformed.
Differences compare_directories(const Sides<std::filesystem::path>& directories, double tolerance);

}  // namespace eses::detail
