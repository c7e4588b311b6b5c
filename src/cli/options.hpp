#pragma once
/// The command line as plain data.

#include <filesystem>
#include <optional>
#include <variant>

#include "cli/usage.hpp"
#include "eses/read_atoms.hpp"
#include "task/task.hpp"

namespace eses::detail::cli {

/// The grid that the command line asks for, if not that of ESES: from a file, or of so many points
/// around a point or from it on.
struct GridChoice {
  std::filesystem::path like;  ///< empty: none
  std::optional<Vec3> origin, center;
  std::optional<GridIndex> points;
  bool has_spacing = false;  ///< the spacing is given, not the default
};

/// What the command line asks for.
struct Options {
  std::filesystem::path input;  ///< `-` is standard input
  AtomFormat format = AtomFormat::automatic;
  StructureOptions structure;  ///< what is read of a PDB or mmCIF file
  Parameters parameters;
  GridChoice grid;
  Outputs outputs;
  std::filesystem::path output_directory = ".";
  bool resume = false;       ///< goes on from what a run that was cut off has done
  bool independent = false;  ///< shares nothing with processes that were started together with it
  bool quiet = false;
  bool json = false;
  bool dry_run = false;  ///< plan only
  bool strict = false;   ///< what would be warned about is an error
};

/// Whether two paths are those of one directory, as far as the names tell.
bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b);

/// Whether --independent is among the arguments. For the time before MPI has been started, which
/// may take arguments of its own from the command line.
bool asks_to_be_independent(int argc, const char* const* argv);

/// Returns the grid that is asked for, or none for that of ESES. Reads the file of --grid-like.
/// Throws Error if that cannot be read, or if its spacing is not the one that is given.
std::optional<Grid> chosen_grid(const Options& options);

/// Throws UsageError.
std::variant<Options, Notice> parse_command_line(int argc, const char* const* argv);

}  // namespace eses::detail::cli
