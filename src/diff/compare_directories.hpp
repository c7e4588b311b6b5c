#pragma once
/// Comparison of two directories of ESES files, written by any program and in any order of lines.

#include <filesystem>

#include "diff/differences.hpp"

namespace eses::detail {

/// Compares the files that both directories have, plain or gzipped. Positions and corners
/// (angstrom), normals, and areas (square angstrom) count as equal if they differ by at most
/// `tolerance`. Throws Error if there is nothing to compare, or if a file cannot be read or is
/// malformed.
Differences compare_directories(const Sides<std::filesystem::path>& directories, double tolerance);

}  // namespace eses::detail
