#pragma once
/// The input files of a command that takes many.

#include <filesystem>
#include <string>
#include <vector>

#include "cli/arguments.hpp"

namespace eses::detail::cli {

/// Where the names of the input files come from.
struct InputChoice {
  std::vector<std::filesystem::path> paths;  ///< files and folders; `-` is standard input
  std::filesystem::path list;                ///< file of --files-from; empty if it is not given
  bool looks_in_folders = false;             ///< whether folders of folders are searched, too

  /// Returns the files, with those in the lines of the list, and with each folder replaced by the
  /// files in it whose names have a suffix of PDB, mmCIF, PQR or xyzr, in the order of their names.
  /// Files of areas that `--write` has written are left out of folders, with a note unless
  /// `is_quiet`. Throws UsageError if there are none, or if standard input is one of several, and
  /// Error if a list or folder cannot be read or is empty.
  std::vector<std::filesystem::path> files(bool is_quiet) const;
};

/// Adds the argument FILE...
void add_input_files(CLI::App& app, const std::string& description, InputChoice& choice);

/// Adds --recursive and --files-from.
void add_input_lists(CLI::App& app, InputChoice& choice);

}  // namespace eses::detail::cli
