#include "cli/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cli/arguments.hpp"
#include "io/map_writer.hpp"
#include "simd/dispatch.hpp"

namespace eses::cli {
namespace {

// Far more threads than any one machine has; OpenMP ends the process if it cannot start them.
constexpr std::int64_t most_threads = 4096;
constexpr std::int64_t default_verify = 2000;
constexpr std::int64_t most_verify = 10'000'000;

constexpr char independent_flag[] = "--independent";

/// Which lengths are accepted, and how to say so.
struct LengthRange {
  double min, max;
  std::string_view words;
};
constexpr double least_positive = std::numeric_limits<double>::denorm_min();
constexpr double largest_finite = std::numeric_limits<double>::max();
constexpr LengthRange positive{least_positive, largest_finite,
                               "a finite number greater than 0, in angstrom"};
constexpr LengthRange non_negative{0, largest_finite, "a finite number of at least 0, in angstrom"};

constexpr char footer[] = R"(Files written:
  bounding_box.txt            lower corner, upper corner and number of points of the grid
  grid_info.txt               every grid point, 1 inside and -1 outside
  intersection_info.txt       every grid edge that the surface cuts: point, normal, atoms
  partition_area.txt          every atom's share of the area, in square angstrom
With --gzip each of these is NAME.gz. Only if asked for:
  residue_area.csv, chain_area.csv   areas of residues and chains of a PQR file
  the map of --inside                every grid point, 1 inside and 0 outside
  the mesh of --mesh                 the surface as triangles

Examples:
  eses-blocks 1crn.xyzr                                defaults, files in this directory
  eses-blocks 1crn.xyzr 1.4 0.25 0.8                   probe radius, spacing, margin as in ESES
  eses-blocks 1crn.pqr --spacing 0.25 -o out --json    files in out/, report as JSON
  eses-blocks 1crn.pqr --mesh 1crn.ply --color chain   the surface to look at, too
  eses-blocks diff out ESES                            compares the files in two directories
  eses-blocks 1crn.xyzr --spacing 0.1 --dry-run        points, memory and disk it would take
  eses-blocks 1crn.xyzr --inside map.dx --gzip         text files as NAME.gz, and a map for VMD
  eses-blocks 1crn.xyzr --region=-5,0,0,5,10,10        only the part in this box

Exit codes:
  0  done
  1  input, output or resource error, or --verify finds a fault
  2  error in the command line
  128 + N  ended by signal N, such as 130 (SIGINT) or 143 (SIGTERM)

Several processes (mpirun -n 4 eses-blocks ..., if built with MPI) share one run and write the
same files. Without MPI, or with --independent, each process is a run of its own.

Environment:
  OMP_NUM_THREADS             most threads, where --threads is not given
  ESES_INSTRUCTION_SET        baseline, sse4 or avx2: holds it back; results are the same

Files get their names when all of them are complete; a directory takes one run at a time.
)";

// --- the options that there are -----------------------------------------------------------------

void add_positionals(CLI::App& app) {
  add_value(app, "FILE", no_value_name, "atoms as xyzr or PQR file; - is standard input");
  add_value(app, "PROBE", no_value_name, "the same as --probe-radius");
  add_value(app, "SPACING", no_value_name, "the same as --spacing");
  add_value(app, "MARGIN", no_value_name, "the same as --margin");
}

void add_grid_options(CLI::App& app) {
  const Parameters defaults;
  const auto add = [&app](const char* name, const char* description, double value) {
    add_value(app, name, "ANGSTROM", fmt::format("{} [{}]", description, value))
        ->group("Surface and grid");
  };
  add("--probe-radius", "radius of the solvent probe, 0.01 to 1000", defaults.probe_radius);
  add("--spacing", "distance between grid points, > 0", defaults.spacing);
  add("--margin", "room between molecule and edge of the grid, >= 0", defaults.margin);
  const auto add_part = [&app](const char* name, const char* value_name, const char* description) {
    add_value(app, name, value_name, description)->group("Surface and grid");
  };
  add_part("--region", "X0,Y0,Z0,X1,Y1,Z1",
           "only the grid points in this box (angstrom), and\n"
           "the edges that start there; all else as in a full run");
  add_part("--blocks", "I0:I1,J0:J1,K0:K1",
           "only these blocks, from 0 and without the last-named,\n"
           "as --block-size cuts the whole grid");
}

void add_file_options(CLI::App& app) {
  const auto add = [&app](const char* name, const char* value_name, const char* description) {
    add_value(app, name, value_name, description)->group("Input and output");
  };
  add("--format", "NAME", "auto (by the file's suffix), xyzr or pqr [auto]");
  add("-o,--output-dir", "DIR", "where to write files, created if missing [.]");
  add("--write", "LIST",
      "files to write besides bounding_box.txt: some of\n"
      "grid,edges,areas,residues; all for the first three;\n"
      "or none [all]");
  add("--inside", "FILE",
      "map of the inside, in the output directory: FILE.dx\n"
      "(OpenDX) or FILE.vti (VTK image data)");
  app.add_flag("--gzip")
      ->description("text files compressed, as NAME.gz; diff reads both")
      ->group("Input and output");
  add("--mesh", "FILE", "also the surface as triangles: .ply, .obj or .off");
  app.add_flag("--resume")
      ->description(
          "keep what is done where a run is cut off, and go on\n"
          "from there the next time")
      ->group("Input and output");
  app.add_flag(independent_flag)
      ->description(
          "a run of its own, though srun or mpirun has started\n"
          "several processes; each needs its own --output-dir")
      ->group("Input and output");
  add("--color", "NAME", "colours in a .ply file: patch, atom or chain (PQR) [none]");
}

void add_computation_options(CLI::App& app) {
  const auto add = [&app](const char* name, const char* value_name,
                          const std::string& description) {
    add_value(app, name, value_name, description)
        ->group("Computation (results do not depend on it)");
  };
  add("-t,--threads", "N", "number of threads [all the process may use]");
  add("-b,--block-size", "N",
      fmt::format("grid points on a side of a block, {} to {} [{}]", least_block_size,
                  largest_block_size, default_block_size));
  add("--max-memory", "BYTES",
      "memory that the process may hold, also as 500M or 2G\n"
      "(K, M, G, T: powers of 1024); kept by smaller blocks\n"
      "and fewer threads where these are not given, or refused\n"
      "[what is available]");
}

void add_checks(CLI::App& app) {
  app.add_flag("--verify")
      ->option_text("[=N]")
      ->description(fmt::format("check N random points and N random edges by brute force;\n"
                                "a fault is an error, and no file appears [{}]",
                                default_verify))
      ->group("Checks");
}

void add_flags(CLI::App& app) {
  const auto add = [&app](const char* name, const char* description) {
    app.add_flag(name)->description(description)->group("Messages");
  };
  add("--dry-run", "print the plan and what is odd in the input, compute nothing");
  add("--strict", "what would be warned about is an error");
  add("-q,--quiet", "only area and volume (or JSON), no notes, warnings or progress");
  add("--json", "report as one JSON object in place of the text");
  add("--version", "show version and build, and exit");
  app.set_help_flag("-h,--help", "show this help, and exit")->group("Messages");
}

void add_options(CLI::App& app) {
  set_up(app,
         "eses-blocks [OPTIONS] FILE [PROBE [SPACING [MARGIN]]]\n"
         "  or:  eses-blocks diff [OPTIONS] DIR_A DIR_B");
  add_positionals(app);
  add_grid_options(app);
  add_file_options(app);
  add_computation_options(app);
  add_checks(app);
  add_flags(app);
}

// --- from text to values ------------------------------------------------------------------------

std::optional<double> length_of(const CLI::App& app, const std::string& name,
                                const LengthRange& range) {
  const std::optional<std::string> text = text_of(app, name);
  if (!text) return std::nullopt;
  const std::optional<double> value = whole_text<double>(*text);
  // Not a number is not in any range.
  const bool is_accepted = value && *value >= range.min && *value <= range.max;
  if (!is_accepted) refuse(name, *text, range.words);
  return value;
}

/// A length that may be given as positional or as flag. Twice the same does no harm.
double length_of(const CLI::App& app, const std::string& positional, const std::string& flag,
                 const LengthRange& range, double fallback) {
  const std::optional<double> first = length_of(app, positional, range);
  const std::optional<double> second = length_of(app, flag, range);
  if (first && second && *first != *second) {
    throw UsageError(fmt::format("{} is {} but {} is {}, give one of the two", positional, *first,
                                 flag, *second));
  }
  return first ? *first : second.value_or(fallback);
}

std::int64_t count_of(const CLI::App& app, const std::string& name, std::int64_t lowest,
                      std::int64_t highest, std::int64_t fallback) {
  const std::optional<std::string> text = text_of(app, name);
  if (!text) return fallback;
  const std::optional<std::int64_t> value = whole_text<std::int64_t>(*text);
  if (!value || *value < lowest || *value > highest) {
    refuse(name, *text, fmt::format("a whole number from {} to {}", lowest, highest));
  }
  return *value;
}

/// A whole number of bytes, or of 1024, 1024^2, ... of them.
std::optional<std::uint64_t> bytes_in(std::string_view text) {
  constexpr std::string_view suffixes = "KMGT";
  const std::size_t suffix = text.empty() ? suffixes.npos : suffixes.find(text.back());
  int shift = 0;
  if (suffix != suffixes.npos) {
    shift = 10 * (static_cast<int>(suffix) + 1);
    text.remove_suffix(1);
  }
  const std::optional<std::uint64_t> value = whole_text<std::uint64_t>(text);
  if (!value || *value == 0 || *value > std::numeric_limits<std::uint64_t>::max() >> shift)
    return std::nullopt;
  return *value << shift;
}

std::uint64_t max_memory_of(const CLI::App& app) {
  const std::optional<std::string> text = text_of(app, "--max-memory");
  if (!text) return Parameters{}.max_memory;
  const std::optional<std::uint64_t> bytes = bytes_in(*text);
  if (!bytes)
    refuse("--max-memory", *text, "a whole number of bytes above 0, or one with K, M, G or T");
  return *bytes;
}

/// The parts of a list, if it has as many as wanted.
template <std::size_t count>
std::optional<std::array<std::string, count>> parts_of(const std::string& list, char separator) {
  const std::vector<std::string> parts = CLI::detail::split(list, separator);
  if (parts.size() != count) return std::nullopt;
  std::array<std::string, count> result;
  std::copy(parts.begin(), parts.end(), result.begin());
  return result;
}

std::optional<RegionBox> box_in(const std::string& text) {
  const auto parts = parts_of<6>(text, ',');
  if (!parts) return std::nullopt;
  std::array<double, 6> values{};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::optional<double> value = whole_text<double>((*parts)[i]);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    values[i] = *value;
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (values[axis] > values[3 + axis]) return std::nullopt;
  return RegionBox{{values[0], values[1], values[2]}, {values[3], values[4], values[5]}};
}

std::optional<GridRegion> blocks_in(const std::string& text) {
  const auto axes = parts_of<3>(text, ',');
  if (!axes) return std::nullopt;
  GridRegion blocks;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto ends = parts_of<2>((*axes)[axis], ':');
    if (!ends) return std::nullopt;
    const auto begin = whole_text<std::int64_t>((*ends)[0]);
    const auto end = whole_text<std::int64_t>((*ends)[1]);
    if (!begin || !end || *begin < 0 || *begin >= *end) return std::nullopt;
    blocks.begin[axis] = *begin;
    blocks.end[axis] = *end;
  }
  return blocks;
}

void choose_part(const CLI::App& app, Parameters& parameters) {
  const std::optional<std::string> region = text_of(app, "--region");
  const std::optional<std::string> blocks = text_of(app, "--blocks");
  if (region && blocks) throw UsageError("--region and --blocks are given, choose one of the two");
  if (region) {
    parameters.region = box_in(*region);
    if (!parameters.region)
      refuse("--region", *region,
             "six finite numbers x0,y0,z0,x1,y1,z1 in angstrom, x0 <= x1 and so on");
  }
  if (blocks) {
    parameters.blocks = blocks_in(*blocks);
    if (!parameters.blocks)
      refuse("--blocks", *blocks, "i0:i1,j0:j1,k0:k1, whole numbers from 0, i0 < i1 and so on");
  }
}

Parameters parameters_of(const CLI::App& app) {
  Parameters result;
  const std::string probe_words =
      fmt::format("a number from {} to {}, in angstrom", least_probe_radius, largest_probe_radius);
  result.probe_radius =
      length_of(app, "PROBE", "--probe-radius",
                {least_probe_radius, largest_probe_radius, probe_words}, result.probe_radius);
  result.spacing = length_of(app, "SPACING", "--spacing", positive, result.spacing);
  result.margin = length_of(app, "MARGIN", "--margin", non_negative, result.margin);
  result.block_size =
      count_of(app, "--block-size", least_block_size, largest_block_size, result.block_size);
  result.threads =
      static_cast<int>(count_of(app, "--threads", 1, most_threads, Parameters{}.threads));
  result.max_memory = max_memory_of(app);
  choose_part(app, result);
  // A flag without a value reads "true".
  if (text_of(app, "--verify").value_or("") == "true") {
    result.verify = default_verify;
  } else {
    result.verify = count_of(app, "--verify", 1, most_verify, result.verify);
  }
  return result;
}

AtomFormat format_of(const CLI::App& app) {
  const std::string name = text_of(app, "--format").value_or("auto");
  if (name == "auto") return AtomFormat::automatic;
  if (name == "xyzr") return AtomFormat::xyzr;
  if (name == "pqr") return AtomFormat::pqr;
  refuse("--format", name, "auto, xyzr or pqr");
}

/// Of a map, which goes to the output directory like all files.
std::string map_name_of(const CLI::App& app, const std::filesystem::path& output_directory) {
  const std::optional<std::string> text = text_of(app, "--inside");
  if (!text) return "";
  const std::filesystem::path path = *text;
  std::string name = path.filename();
  if (!map_format(name) || path.stem().empty() || name.starts_with('.'))
    refuse("--inside", *text, "the name of a file that ends with .dx or .vti");
  if (path.has_parent_path() && !is_same_place(path.parent_path(), output_directory))
    throw UsageError(
        fmt::format("--inside is '{}', but files go to {}: give its name alone, or "
                    "--output-dir {}",
                    *text, output_directory.string(), path.parent_path().string()));
  return name;
}

OutputChoice text_files_of(const CLI::App& app) {
  const std::optional<std::string> text = text_of(app, "--write");
  if (!text) return {};
  OutputChoice result = OutputChoice::none();
  if (*text == "none") return result;
  result.box = true;
  for (const std::string& name : CLI::detail::split(*text, ',')) {
    if (name == "all") {
      result.grid = result.edges = result.areas = true;
    } else if (name == "grid") {
      result.grid = true;
    } else if (name == "edges") {
      result.edges = true;
    } else if (name == "areas") {
      result.areas = true;
    } else if (name == "residues") {
      result.residues = true;
    } else {
      refuse("--write", *text, "some of grid,edges,areas,residues, or all, or none");
    }
  }
  return result;
}

MeshColor color_of(const CLI::App& app) {
  const std::optional<std::string> name = text_of(app, "--color");
  if (!name) return MeshColor::none;
  if (*name == "patch") return MeshColor::patch;
  if (*name == "atom") return MeshColor::atom;
  if (*name == "chain") return MeshColor::chain;
  refuse("--color", *name, "patch, atom or chain");
}

std::optional<MeshChoice> mesh_of(const CLI::App& app) {
  const MeshColor color = color_of(app);
  const std::optional<std::string> file = text_of(app, "--mesh");
  const std::optional<MeshFormat> format = file ? mesh_format(*file) : std::nullopt;
  if (file && !format) refuse("--mesh", *file, "a file that ends in .ply, .obj or .off");
  if (color != MeshColor::none && format != MeshFormat::ply)
    throw UsageError("--color needs --mesh with a .ply file");
  if (!file) return std::nullopt;
  return MeshChoice{*file, color};
}

OutputChoice outputs_of(const CLI::App& app, const std::filesystem::path& output_directory) {
  OutputChoice result = text_files_of(app);
  result.gzip = is_set(app, "--gzip");
  result.inside_map = map_name_of(app, output_directory);
  result.mesh = mesh_of(app);
  return result;
}

void refuse_chains_of_xyzr(const Options& options) {
  const auto& mesh = options.outputs.mesh;
  if (mesh && mesh->color == MeshColor::chain &&
      eses::format_of(options.input, options.format) != AtomFormat::pqr)
    throw UsageError(
        fmt::format("--color chain needs a PQR file, which tells the chains; {} is read as xyzr "
                    "(--format pqr if it is PQR)",
                    options.input.string()));
}

Options options_of(const CLI::App& app) {
  Options options;
  options.parameters = parameters_of(app);
  options.format = format_of(app);
  options.output_directory = required_text(app, "--output-dir", ".");
  options.outputs = outputs_of(app, options.output_directory);
  options.resume = is_set(app, "--resume");
  options.independent = is_set(app, independent_flag);
  options.quiet = is_set(app, "--quiet");
  options.json = is_set(app, "--json");
  options.dry_run = is_set(app, "--dry-run");
  options.strict = is_set(app, "--strict");
  options.input = required_text(app, "FILE", "");
  refuse_chains_of_xyzr(options);
  return options;
}

// --- what does not fit --------------------------------------------------------------------------

// CLI11 knows `-1` as a number, but takes `-.5` and `-inf` for options.
void refuse_negative_numbers(const CLI::App& app) {
  for (const std::string& extra : app.remaining()) {
    if (extra.starts_with('-') && whole_text<double>(extra)) {
      throw UsageError(fmt::format("'{}' is negative; PROBE, SPACING and MARGIN never are", extra));
    }
  }
}

/// A name that is misspelt must not go unnoticed.
void require_known_instruction_set() {
  const char* const wish = std::getenv(instruction_set_variable);
  if (wish != nullptr && *wish != '\0' && !is_instruction_set(wish))
    refuse(instruction_set_variable, wish, "baseline, sse4, avx2 or avx512");
}

/// `--verify 100` would otherwise take 100 for the probe radius.
void refuse_separate_number(std::span<const std::string> arguments) {
  for (std::size_t i = 0; i + 1 < arguments.size() && arguments[i] != "--"; ++i)
    if (arguments[i] == "--verify" && whole_text<std::int64_t>(arguments[i + 1]))
      throw UsageError(
          fmt::format("the number of --verify goes behind =: --verify={0}; as it is, {0} "
                      "would be PROBE, SPACING or MARGIN",
                      arguments[i + 1]));
}

}  // namespace

bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto plain = [](const std::filesystem::path& path) {
    return (std::filesystem::absolute(path) / "").lexically_normal();
  };
  return plain(a) == plain(b);
}

bool asks_to_be_independent(int argc, const char* const* argv) {
  const std::span arguments(argv + std::min(argc, 1), argv + argc);
  const auto end = std::find(arguments.begin(), arguments.end(), std::string_view("--"));
  return std::find(arguments.begin(), end, std::string_view(independent_flag)) != end;
}

std::variant<Options, Notice> parse_command_line(int argc, const char* const* argv) {
  CLI::App app("Solvent excluded surface of a molecule on a grid, computed block by block.",
               "eses-blocks");
  add_options(app);
  require_known_instruction_set();
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  refuse_separate_number(arguments);
  try {
    parse(app, arguments);
  } catch (const CLI::CallForHelp&) {
    return Notice{app.help() + footer};
  }
  if (is_set(app, "--version")) return Notice{version_text()};
  refuse_negative_numbers(app);
  refuse_extras(app, "FILE, PROBE, SPACING and MARGIN");
  return options_of(app);
}

}  // namespace eses::cli
