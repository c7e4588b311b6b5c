#include "cli/diff_options.hpp"

#include <CLI/CLI.hpp>
#include <limits>
#include <utility>

#include "cli/arguments.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

constexpr char diff_footer[] =
    R"(Compared files, each as NAME or NAME.gz:
  bounding_box.txt            corners and number of points of the grid
  grid_info.txt               points: inside or outside
  intersection_info.txt       crossed edges: position, normal, atoms (as a set)
  partition_area.txt          area of every atom
The order of lines does not matter. A file in only one directory is a difference.

Sorting a large intersection_info.txt takes half its size in TMPDIR (or /tmp).
To compute the surface of a file called diff: eses-blocks ./diff

Exit codes:
  0  no differences
  1  differences found
  2  error in the command line, or in reading the files)";

void add_options(CLI::App& app, DiffOptions& options) {
  set_up(app, "eses-blocks diff [OPTIONS] DIR_A DIR_B", diff_footer);
  add_value(app, "DIR_A", "", "directory with output files of ESES or eses-blocks",
            options.directories[0], path_to("a directory"))
      ->required();
  add_value(app, "DIR_B", "", "directory to compare with", options.directories[1],
            path_to("a directory"))
      ->required();
  add_value(app, "--tolerance", "X",
            formatted("treat differences up to X as equal: coordinates\n"
                      "(angstrom), normals, areas (square angstrom) [{}]",
                      options.tolerance),
            options.tolerance,
            number_between(0, std::numeric_limits<double>::max(), "a finite number of at least 0"));
  add_flag(app, "--json", "print the report as one JSON object", options.json);
  add_notices(app);
}

}  // namespace

DiffOptions parse_diff_arguments(std::vector<std::string> arguments) {
  CLI::App app("Compares the output files of ESES or eses-blocks in two directories.",
               "eses-blocks diff");
  DiffOptions options;
  add_options(app, options);
  parse(app, std::move(arguments), "DIR_A and DIR_B");
  return options;
}

}  // namespace eses::detail::cli
