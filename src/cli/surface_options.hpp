#pragma once
/// Options of the command line.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "cli/command.hpp"
#include "run/request.hpp"

namespace eses::detail::cli {

/// A custom grid: the grid of a file, or a number of points with a given centre or origin.
struct GridChoice {
  std::filesystem::path like;  ///< empty if none
  std::optional<Vec3> origin, center;
  std::optional<GridIndex> points;
  bool has_spacing = false;  ///< whether the spacing is given
};

/// The values of all options: the request of a run, the choice of its grid, and what is printed.
struct Options {
  Request request;
  GridChoice grid;
  SurfaceKind surface = SurfaceKind::ses;
  bool independent = false;  ///< whether not to share the run with other processes
  bool quiet = false;
  bool json = false;
  bool strict = false;  ///< whether warnings are errors

  /// The radius of the probe, as given; 0 for the van der Waals surface (angstrom).
  double probe_radius() const { return request.parameters.probe_radius + input().added_radius; }

  /// The input file. The path `-` is standard input.
  const InputFile& input() const { return std::get<InputFile>(request.atoms); }
  InputFile& input() { return std::get<InputFile>(request.atoms); }
};

/// Returns whether --independent or --part is among the arguments. Used before MPI is initialized,
/// which may remove its own arguments from the command line.
bool asks_to_be_independent(std::span<const std::string> arguments);

/// Returns the custom grid, or nothing for the default grid. Reads the file of --grid-like. Throws
/// Error if the file cannot be read, or if its spacing differs from a given one.
std::optional<Grid> chosen_grid(const Options& options);

/// Parses the arguments of the program. Throws UsageError and Notice.
Options parse_surface_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
