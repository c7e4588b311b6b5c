#include "cli/diff_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "cli/arguments.hpp"

namespace eses::cli {
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
  2  error in the command line; a file cannot be read or is malformed
)";

void add_options(CLI::App& app) {
  set_up(app, "eses-blocks diff [OPTIONS] DIR_A DIR_B");
  add_value(app, "DIR_A", no_value_name, "directory with files of ESES or eses-blocks");
  add_value(app, "DIR_B", no_value_name, "the one to compare it with");
  add_value(app, "--tolerance", "X",
            fmt::format("differences up to X count as none: of coordinates\n"
                        "(angstrom), normals, areas (square angstrom) [{}]",
                        DiffOptions{}.tolerance));
  app.add_flag("--json")->description("report as one JSON object in place of the text");
  app.add_flag("--version")->description("show version and build, and exit");
  app.set_help_flag("-h,--help", "show this help, and exit");
}

double tolerance_of(const CLI::App& app) {
  const std::optional<std::string> text = text_of(app, "--tolerance");
  if (!text) return DiffOptions{}.tolerance;
  const std::optional<double> value = whole_text<double>(*text);
  if (!value || !std::isfinite(*value) || *value < 0) {
    refuse("--tolerance", *text, "a finite number of at least 0");
  }
  return *value;
}

}  // namespace

std::variant<DiffOptions, Notice> parse_diff_command_line(int argc, const char* const* argv) {
  CLI::App app(
      "Compares two directories of ESES's files, whoever wrote them and in whatever order.",
      "eses-blocks diff");
  add_options(app);
  try {
    parse(app, {argv + std::min(argc, 1), argv + argc});
  } catch (const CLI::CallForHelp&) {
    return Notice{app.help() + footer};
  }
  if (is_set(app, "--version")) return Notice{version_text()};
  refuse_extras(app, "DIR_A and DIR_B");
  DiffOptions options;
  options.directories = {required_text(app, "DIR_A", ""), required_text(app, "DIR_B", "")};
  options.tolerance = tolerance_of(app);
  options.json = is_set(app, "--json");
  return options;
}

}  // namespace eses::cli
