#pragma once
/// The input files of a command that takes many.

#include <filesystem>
#include <vector>

namespace eses::detail::cli {

/// Returns the paths with each folder replaced by the files in it whose names have a suffix of PDB,
/// mmCIF, PQR or xyzr, in the order of their names, also those in its folders if `recursively`.
/// Throws Error if a folder has no such file or cannot be read.
std::vector<std::filesystem::path> expand_folders(const std::vector<std::filesystem::path>& paths,
                                                  bool recursively);

/// Returns the paths in the lines of a file; `-` is standard input. Blank lines are ignored. Throws
/// Error if it cannot be read or has none.
std::vector<std::filesystem::path> read_list(const std::filesystem::path& file);

}  // namespace eses::detail::cli
