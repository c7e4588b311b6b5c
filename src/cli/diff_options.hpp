#pragma once
/// The command line of `eses-blocks diff` as plain data.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace eses::detail::cli {

struct DiffOptions {
  std::array<std::filesystem::path, 2> directories;  ///< A and B
  double tolerance = 1e-6;  ///< in angstrom, square angstrom or, for normals, no unit; >= 0
  bool json = false;
};

/// Parses the arguments of the command. Throws UsageError and Notice.
DiffOptions parse_diff_arguments(std::vector<std::string> arguments);

}  // namespace eses::detail::cli
