#pragma once
/// The command line as plain data.

#include <filesystem>
#include <variant>

#include "cli/usage.hpp"
#include "eses/read_atoms.hpp"
#include "task/task.hpp"

namespace eses::detail::cli {

/// What the command line asks for.
struct Options {
  std::filesystem::path input;  ///< `-` is standard input
  AtomFormat format = AtomFormat::automatic;
  StructureOptions structure;  ///< what is read of a PDB or mmCIF file
  Parameters parameters;
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

/// Throws UsageError.
std::variant<Options, Notice> parse_command_line(int argc, const char* const* argv);

}  // namespace eses::detail::cli
