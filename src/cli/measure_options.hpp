#pragma once
/// The command line of `eses-blocks measure` as plain data.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "eses/pockets.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"
#include "output/measure_tables.hpp"

namespace eses::detail::cli {

/// A table of `--write`. The table of the file NAME.pdb is NAME, a point, the name of the table and
/// `.csv`.
struct Table {
  std::string_view name;
  bool TableChoice::*is_chosen;
  void (*append)(const MeasuredAtoms& atoms, BufferedText& text);
};
inline constexpr std::array tables{
    Table{"atoms", &TableChoice::atoms, append_measured_atoms},
    Table{"residues", &TableChoice::residues, append_measured_residues},
    Table{"chains", &TableChoice::chains, append_measured_chains},
    Table{"derivatives", &TableChoice::derivatives, append_derivatives},
    Table{"cavities", &TableChoice::cavities, append_cavities},
    Table{"pieces", &TableChoice::pieces, append_pieces},
    Table{"pockets", &TableChoice::pockets, append_pockets},
};

/// The surfaces to measure.
struct SurfaceChoice {
  bool ses = false, sas = false, vdw = false, all = false;

  bool has_ses() const { return ses || all; }
  bool has_sas() const { return sas || all; }
  bool has_vdw() const { return vdw || all; }
};

struct MeasureCommandOptions {
  std::vector<std::filesystem::path> inputs;  ///< `-` is standard input
  AtomFormat format = AtomFormat::automatic;
  StructureOptions structure;  ///< for PDB and mmCIF files
  double probe_radius = SurfaceOptions().probe_radius;
  SurfaceChoice surfaces{.all = true};
  PartChoice parts;
  std::optional<double> max_filled_void;  ///< see SurfaceOptions
  bool cavities = false;                  ///< whether cavities and pieces are reported
  bool pockets = false;                   ///< whether pockets are reported
  PocketOptions pocket_options;           ///< of the search for pockets
  TableChoice tables;
  std::filesystem::path output_directory = ".";  ///< of the tables
  std::filesystem::path csv;                     ///< empty if it is not given
  int threads = 0;                               ///< 0 means all available processors
  bool json = false;
  bool quiet = false;
  bool strict = false;  ///< whether warnings are errors

  bool need_pockets() const { return pockets || tables.pockets; }

  /// Whether the results are printed as the report on a single file, with its chains.
  bool has_report() const { return inputs.size() == 1 && !json; }
};

/// Parses the arguments of the command. Throws UsageError and Notice.
MeasureCommandOptions parse_measure_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
