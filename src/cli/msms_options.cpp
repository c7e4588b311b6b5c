#include <algorithm>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "cli/arguments.hpp"
#include "cli/msms.hpp"
#include "eses/surface.hpp"
#include "input/advice.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

constexpr char help[] = R"(Molecular surfaces with the options, files and messages of MSMS.

Usage: eses-blocks msms -if FILE [OPTIONS]
       eses-msms -if FILE [OPTIONS]

Examples:
  eses-msms -if 1crn.xyzr -of 1crn                    1crn.vert and 1crn.face
  eses-msms -if 1crn.xyzrn -of 1crn -af 1crn          and the areas of the atoms
  eses-msms -if 1crn.xyzr -of 1crn -density 3.0 -probe_radius 1.4

Options may be abbreviated. If an abbreviation fits several options, the first one of this list
is used.

Options:
  -probe_radius ANGSTROM    radius of the probe, 0.01 to 1000 [1.5]
  -density NUMBER           vertices in a square angstrom [1.0]
  -hdensity NUMBER          accepted without effect: the density is the same everywhere [3.0]
  -surface tses|ases        write and measure triangles, or measure only the analytical
                            surface [tses]
  -no_area                  no analytical areas
  -noh                      ignore spheres of radius 1.2, which are hydrogens
  -no_rest_on_pbr, -no_rest, -free_vertices
                            accepted without effect: no surface needs a restart, and that of
                            isolated spheres is always computed
  -if FILE                  spheres: x y z r, or with names x y z r 1 NAME; - is standard input
  -of NAME                  write the triangles to NAME.vert and NAME.face
  -af NAME                  write the areas of the atoms to NAME.area
  -no_header                no header lines in NAME.vert and NAME.face
  -all_components           all components of the surface: the first one in NAME.vert, component
                            N in NAME_N.vert
  -one_cavity COUNT ATOM... only the component that touches these atoms, one to three, from 0
  --allow-far-atoms         also compute a grid of more than 1e10 points if less than 1 % of them
                            are near atoms
  -h, --help, --help-all    print this help
  --version                 print version and build information

-socketName, -socketPort, -xdr and -sinetd are refused: there is no server.

Components are the connected parts of the triangles: outer surfaces from the largest to the
smallest, then walls of cavities. Spheres of radius 0 are ignored.

To compute the surface of a file called msms: eses-blocks ./msms

Exit codes:
  0  done
  1  input, output or resource error
  2  error in the command line
)";

/// An option, and the arguments that follow it and are not read yet.
struct Values {
  std::string_view option;
  std::span<const std::string> rest;

  /// Reads the next argument.
  template <class Value>
  Value read(const Format<Value>& format) {
    if (rest.empty()) throw UsageError(formatted("{} needs a value", option));
    const std::string& text = rest.front();
    rest = rest.subspan(1);
    const std::optional<Value> value = format.read(text);
    if (!value) refuse(option, text, format.expected);
    return *value;
  }
};

/// An option, and what it does with its values.
struct Option {
  std::string_view name;
  void (*apply)(Values& values, MsmsOptions& options);
};

template <bool MsmsOptions::*member, bool value>
void set(Values&, MsmsOptions& options) {
  options.*member = value;
}

template <std::filesystem::path MsmsOptions::*member>
void read_path(Values& values, MsmsOptions& options) {
  options.*member = values.read(any_text("a file"));
}

bool is_output_name(const std::string& text) { return !text.empty() && text != "-"; }

template <std::filesystem::path MsmsOptions::*member>
void read_output(Values& values, MsmsOptions& options) {
  options.*member = values.read(text_if(is_output_name, "the name of a file, not standard output"));
}

template <double MsmsOptions::*member>
void read_density(Values& values, MsmsOptions& options) {
  options.*member = values.read(number_between(1e-6, 1e6, "a number from 1e-6 to 1e6"));
}

void read_probe_radius(Values& values, MsmsOptions& options) {
  options.probe_radius = values.read(length_between(min_probe_radius, max_probe_radius));
}

void read_surface(Values& values, MsmsOptions& options) {
  options.has_triangles = values.read(one_of<bool>({{"tses", true}, {"ases", false}}));
}

void read_cavity_atoms(Values& values, MsmsOptions& options) {
  const std::int64_t count = values.read(whole_number_between(1, 3));
  options.cavity_atoms.clear();
  for (std::int64_t i = 0; i < count; ++i)
    options.cavity_atoms.push_back(static_cast<std::uint64_t>(
        values.read(whole_number_between(0, std::numeric_limits<std::uint32_t>::max()))));
}

void ignore(Values&, MsmsOptions&) {}

void refuse_server(Values& values, MsmsOptions&) {
  throw UsageError(
      formatted("{} is refused, because there is no server; read a file with -if", values.option));
}

/// The options in the order in which MSMS looks for the first one that an abbreviation fits.
constexpr Option known_options[] = {
    {"-probe_radius", read_probe_radius},
    {"-density", read_density<&MsmsOptions::density>},
    {"-hdensity", read_density<&MsmsOptions::high_density>},
    {"-surface", read_surface},
    {"-no_area", set<&MsmsOptions::has_areas, false>},
    {"-socketName", refuse_server},
    {"-socketPort", refuse_server},
    {"-xdr", refuse_server},
    {"-sinetd", refuse_server},
    {"-noh", set<&MsmsOptions::has_hydrogens, false>},
    {"-no_rest_on_pbr", ignore},
    {"-no_rest", ignore},
    {"-if", read_path<&MsmsOptions::input>},
    {"-of", read_output<&MsmsOptions::surface>},
    {"-af", read_output<&MsmsOptions::areas>},
    {"-no_header", set<&MsmsOptions::has_header, false>},
    {"-free_vertices", ignore},
    {"-all_components", set<&MsmsOptions::has_all_components, true>},
    {"-one_cavity", read_cavity_atoms},
    {"--allow-far-atoms", set<&MsmsOptions::allow_far_atoms, true>},
};

/// Throws UsageError if a file has the name of an option, perhaps shortened, because its own name
/// is missing.
void refuse_missing_file(const Option& option, std::span<const std::string> values) {
  const bool takes_file = option.name == "-if" || option.name == "-of" || option.name == "-af";
  if (takes_file && !values.empty() && values.front().size() > 1 &&
      std::any_of(std::begin(known_options), std::end(known_options),
                  [&](const Option& other) { return other.name.starts_with(values.front()); }))
    throw UsageError(formatted("{0} needs a value before {1}; for a file of this name, write ./{1}",
                               option.name, values.front()));
}

/// Returns the option of this name or, without one, the first option that begins with it.
const Option& option_named(std::string_view name) {
  const auto begin = std::begin(known_options), end = std::end(known_options);
  const auto exact =
      std::find_if(begin, end, [&](const Option& option) { return option.name == name; });
  if (exact != end) return *exact;
  const auto first = std::find_if(begin, end, [&](const Option& option) {
    return name.size() > 1 && option.name.starts_with(name);
  });
  if (first != end) return *first;
  if (!name.starts_with('-')) throw UsageError(formatted("unexpected argument '{}'", name));
  std::vector<std::string> names;
  for (const Option& option : known_options) names.emplace_back(option.name);
  const std::string_view meant = closest_name(name, names);
  throw UsageError(formatted("unknown option '{}'{}", name,
                             meant.empty() ? "" : formatted("; did you mean {}?", meant)));
}

}  // namespace

MsmsOptions parse_msms_arguments(const Arguments& arguments) {
  MsmsOptions options;
  for (std::span<const std::string> rest = arguments; !rest.empty();) {
    const std::string_view name = rest.front();
    if (name == "-h" || name == "--help" || name == "--help-all") throw Notice{help};
    if (name == "--version") throw Notice{version_text()};
    const Option& option = option_named(name);
    refuse_missing_file(option, rest.subspan(1));
    Values values{option.name, rest.subspan(1)};
    option.apply(values, options);
    rest = values.rest;
  }
  if (options.input.empty()) throw UsageError("no input file; give it with -if");
  for (const auto& [name, path] :
       {std::pair("-of", options.surface), std::pair("-af", options.areas)})
    if (const std::filesystem::path file = path.filename();
        !path.empty() && (file.empty() || file == "." || file == ".."))
      throw UsageError(formatted("{} needs the name of a file, and '{}' is a directory; use {}",
                                 name, path.string(), (path / "NAME").lexically_normal().string()));
  if (options.has_all_components && !options.cavity_atoms.empty())
    throw UsageError("-all_components and -one_cavity exclude each other; use only one of them");
  if (!options.areas.empty() && !options.has_areas)
    throw UsageError("-af needs the analytical areas, which -no_area leaves out");
  return options;
}

}  // namespace eses::detail::cli
