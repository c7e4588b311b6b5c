#include "cli/diff_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <optional>

#include "cli/arguments.hpp"

namespace eses::detail::cli {
namespace {

constexpr char footer[] =
    R"(Compared are the files that both directories have, NAME or else NAME.gz:
  bounding_box.txt            corners and number of points of the grid
  grid_info.txt               whether the same points are inside
  intersection_info.txt       edges, in any order: position, normal, atoms (as a set)
  partition_area.txt          every atom's area
A file in one directory only is a difference; a file in neither is none.

Sorting a large intersection_info.txt takes half its size in TMPDIR (or /tmp).
To compute the surface of a file called diff: eses-blocks ./diff

Exit codes:
  0  the same
  1  different
  2  error in the command line; a file cannot be read or is malformed)";

void add_options(CLI::App& app, DiffOptions& options) {
  set_up(app, "eses-blocks diff [OPTIONS] DIR_A DIR_B", footer);
  add_value(app, "DIR_A", "", "directory with files of ESES or eses-blocks", options.directories[0],
            path_to("a directory"))
      ->required();
  add_value(app, "DIR_B", "", "the one to compare it with", options.directories[1],
            path_to("a directory"))
      ->required();
  add_value(app, "--tolerance", "X",
            fmt::format("differences up to X count as none: of coordinates\n"
                        "(angstrom), normals, areas (square angstrom) [{}]",
                        options.tolerance),
            options.tolerance,
            number_between(0, std::numeric_limits<double>::max(), "a finite number of at least 0"));
  add_flag(app, "--json", "report as one JSON object in place of the text", options.json);
  add_notices(app);
}

}  // namespace

std::variant<DiffOptions, Notice> parse_diff_command_line(int argc, const char* const* argv) {
  CLI::App app(
      "Compares two directories of ESES's files, whoever wrote them and in whatever order.",
      "eses-blocks diff");
  DiffOptions options;
  add_options(app, options);
  if (std::optional<Notice> notice =
          parse(app, {argv + std::min(argc, 1), argv + argc}, "DIR_A and DIR_B"))
    return *std::move(notice);
  return options;
}

}  // namespace eses::detail::cli
