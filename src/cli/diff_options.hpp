#pragma once
/// The command line of `eses-blocks diff` as plain data.

#include <array>
#include <filesystem>
#include <variant>

#include "cli/usage.hpp"

namespace eses::detail::cli {

struct DiffOptions {
  std::array<std::filesystem::path, 2> directories;  ///< A and B
  double tolerance = 1e-6;  ///< in angstrom, square angstrom or, for normals, no unit; >= 0
  bool json = false;
};

/// Parses the arguments of the command; `argv[0]` is `diff`. Throws UsageError.
std::variant<DiffOptions, Notice> parse_diff_command_line(int argc, const char* const* argv);

}  // namespace eses::detail::cli
