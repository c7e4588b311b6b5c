#include "cli/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "eses/version.hpp"

namespace eses::cli {
namespace {

constexpr std::int64_t largest_block_size = 4096;
// Far more threads than any one machine has; OpenMP ends the process if it cannot start them.
constexpr std::int64_t most_threads = 4096;
constexpr std::int64_t default_verify = 2000;
constexpr std::int64_t most_verify = 10'000'000;

/// Which lengths are accepted, and how to say so.
struct LengthRange {
  bool zero_allowed;
  std::string_view words;
};
constexpr LengthRange positive{false, "a finite number greater than 0, in angstrom"};
constexpr LengthRange non_negative{true, "a finite number of at least 0, in angstrom"};

constexpr char footer[] = R"(Files written:
  bounding_box.txt            lower corner, upper corner and number of points of the grid
  grid_info.txt               every grid point, 1 inside and -1 outside
  intersection_info.txt       every grid edge that the surface cuts: point, normal, atoms
  partition_area.txt          every atom's share of the area, in square angstrom

Examples:
  eses-blocks 1crn.xyzr                                defaults, files in this directory
  eses-blocks 1crn.xyzr 1.4 0.25 0.8                   probe radius, spacing, margin as in ESES
  eses-blocks 1crn.pqr --spacing 0.25 -o out --json    files in out/, report as JSON

Exit codes:
  0  done
  1  input, output or resource error, or --verify finds a fault
  2  error in the command line
)";

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    label("Positionals", "Arguments");
    column_width(28);
  }
  std::string make_usage(const CLI::App* /*app*/, std::string name) const override {
    return fmt::format("\nUsage: {} [OPTIONS] FILE [PROBE [SPACING [MARGIN]]]\n", name);
  }
  // The value of a flag follows without a blank.
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string text = option->get_option_text();
    return text.starts_with("[=") ? text : CLI::Formatter::make_option_opts(option);
  }
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    const std::string help = CLI::Formatter::make_help(app, std::move(name), mode);
    return CLI::detail::find_and_replace(help, "\n\n\n", "\n\n");
  }
};

/// CLI11 shows this as nothing, and the empty string as its own `TEXT`.
constexpr char no_value_name[] = " ";

// --- the options that there are -----------------------------------------------------------------

/// Values are taken as text and converted below, so that every message can name what is expected.
CLI::Option* add_value(CLI::App& app, const char* name, const char* value_name,
                       const std::string& description) {
  return app.add_option(name)
      ->option_text(value_name)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->description(description);
}

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
  add("--probe-radius", "radius of the solvent probe, > 0", defaults.probe_radius);
  add("--spacing", "distance between grid points, > 0", defaults.spacing);
  add("--margin", "room between molecule and edge of the grid, >= 0", defaults.margin);
}

void add_file_options(CLI::App& app) {
  const auto add = [&app](const char* name, const char* value_name, const char* description) {
    add_value(app, name, value_name, description)->group("Files");
  };
  add("--format", "NAME", "auto (by the file's suffix), xyzr or pqr [auto]");
  add("-o,--output-dir", "DIR", "where to write files, created if missing [.]");
  add("--write", "LIST",
      "files to write besides bounding_box.txt: some of\n"
      "grid,edges,areas; or none for no file at all [all]");
}

void add_computation_options(CLI::App& app) {
  const auto add = [&app](const char* name, const std::string& description) {
    add_value(app, name, "N", description)->group("Computation (results do not depend on it)");
  };
  add("-t,--threads", "number of threads [all the process may use]");
  add("-b,--block-size", fmt::format("grid points on a side of a block, 2 to {} [{}]",
                                     largest_block_size, Parameters{}.block_size));
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
  add("-q,--quiet", "only area and volume (or JSON), no notes, warnings or progress");
  add("--json", "report as one JSON object in place of the text");
  add("--version", "show version and build, and exit");
  app.set_help_flag("-h,--help", "show this help, and exit")->group("Messages");
}

void add_options(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormatter>());
  app.allow_extras();  // they are refused below, in our own words
  add_positionals(app);
  add_grid_options(app);
  add_file_options(app);
  add_computation_options(app);
  add_checks(app);
  add_flags(app);
}

// --- from text to values ------------------------------------------------------------------------

/// The text given for an option, if any.
std::optional<std::string> text_of(const CLI::App& app, const std::string& name) {
  const std::vector<std::string>& results = app.get_option(name)->results();
  if (results.size() > 1) throw UsageError(fmt::format("{} is given more than once", name));
  if (results.empty()) return std::nullopt;
  return results.front();
}

/// Whether a flag is given.
bool is_set(const CLI::App& app, const std::string& name) {
  const std::vector<std::string>& results = app.get_option(name)->results();
  for (const std::string& result : results) {
    if (result != "true") throw UsageError(fmt::format("{} takes no value", name));
  }
  return !results.empty();
}

[[noreturn]] void refuse(std::string_view name, std::string_view value, std::string_view expected) {
  throw UsageError(fmt::format("{} is '{}', expected {}", name, value, expected));
}

/// The number that `text` spells from its first to its last character.
template <typename Number>
std::optional<Number> whole_text(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

std::optional<double> length_of(const CLI::App& app, const std::string& name,
                                const LengthRange& range) {
  const std::optional<std::string> text = text_of(app, name);
  if (!text) return std::nullopt;
  const std::optional<double> value = whole_text<double>(*text);
  const bool accepted =
      value && std::isfinite(*value) && (*value > 0 || (*value == 0 && range.zero_allowed));
  if (!accepted) refuse(name, *text, range.words);
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

Parameters parameters_of(const CLI::App& app) {
  Parameters result;
  result.probe_radius = length_of(app, "PROBE", "--probe-radius", positive, result.probe_radius);
  result.spacing = length_of(app, "SPACING", "--spacing", positive, result.spacing);
  result.margin = length_of(app, "MARGIN", "--margin", non_negative, result.margin);
  result.block_size = count_of(app, "--block-size", 2, largest_block_size, result.block_size);
  result.threads =
      static_cast<int>(count_of(app, "--threads", 1, most_threads, Parameters{}.threads));
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

OutputChoice outputs_of(const CLI::App& app) {
  const std::optional<std::string> text = text_of(app, "--write");
  if (!text) return {};
  OutputChoice result{.box = false, .grid = false, .edges = false, .areas = false};
  if (*text == "none") return result;
  result.box = true;
  for (const std::string& name : CLI::detail::split(*text, ',')) {
    if (name == "grid") {
      result.grid = true;
    } else if (name == "edges") {
      result.edges = true;
    } else if (name == "areas") {
      result.areas = true;
    } else {
      refuse("--write", *text, "some of grid,edges,areas, or none");
    }
  }
  return result;
}

std::string required_text(const CLI::App& app, const std::string& name, std::string fallback) {
  std::string text = text_of(app, name).value_or(std::move(fallback));
  if (text.empty()) throw UsageError(fmt::format("{} is missing", name));
  return text;
}

Options options_of(const CLI::App& app) {
  Options options;
  options.parameters = parameters_of(app);
  options.format = format_of(app);
  options.outputs = outputs_of(app);
  options.output_directory = required_text(app, "--output-dir", ".");
  options.quiet = is_set(app, "--quiet");
  options.json = is_set(app, "--json");
  options.input = required_text(app, "FILE", "");
  return options;
}

// --- what does not fit --------------------------------------------------------------------------

/// CLI11 would take the next argument as the value of `--name=`.
void refuse_empty_values(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") return;
    if (argument.starts_with("--") && argument.ends_with('=')) {
      throw UsageError(fmt::format("{} needs a value", argument));
    }
  }
}

[[noreturn]] void refuse_extra(const std::string& extra) {
  if (!extra.starts_with('-')) {
    throw UsageError(
        fmt::format("unexpected argument '{}' after FILE, PROBE, SPACING and MARGIN", extra));
  }
  // CLI11 knows `-1` as a number, but takes `-.5` and `-inf` for options.
  if (whole_text<double>(extra)) {
    throw UsageError(fmt::format("'{}' is negative; PROBE, SPACING and MARGIN never are", extra));
  }
  std::error_code ignored;
  const bool is_file = std::filesystem::exists(extra, ignored);
  throw UsageError(fmt::format("unknown option '{}'{}", extra,
                               is_file ? "; the file of that name goes after --" : ""));
}

void refuse_extras(const CLI::App& app) {
  for (const std::string& extra : app.remaining()) {
    if (extra != "--") refuse_extra(extra);
  }
}

void parse(CLI::App& app, std::vector<std::string> arguments) {
  refuse_empty_values(arguments);
  const std::string last = arguments.empty() ? "" : arguments.back();
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::ArgumentMismatch&) {
    // Values are eaten whatever they look like, so only the last option can lack one.
    throw UsageError(fmt::format("{} needs a value", last));
  }
}

std::string version_text() {
  return fmt::format("eses-blocks {}\ncompiler: {}\nbuild type: {}\nflags: {}\n", version, compiler,
                     build_type, compiler_flags);
}

}  // namespace

std::variant<Options, Notice> parse_command_line(int argc, const char* const* argv) {
  CLI::App app("Solvent excluded surface of a molecule on a grid, computed block by block.",
               "eses-blocks");
  add_options(app);
  try {
    parse(app, {argv + std::min(argc, 1), argv + argc});
  } catch (const CLI::CallForHelp&) {
    return Notice{app.help() + footer};
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  if (is_set(app, "--version")) return Notice{version_text()};
  refuse_extras(app);
  return options_of(app);
}

}  // namespace eses::cli
