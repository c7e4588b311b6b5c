#pragma once
/// The command line of `eses-blocks measure` as plain data.

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/measure_records.hpp"
#include "cli/table_options.hpp"
#include "eses/pockets.hpp"
#include "eses/surface.hpp"
#include "output/area_formats.hpp"

namespace eses::detail::cli {

/// Requirements and contents of tables, as bits.
enum TableTraits : unsigned {
  needs_names = 1,   ///< the atoms must have names
  has_areas = 2,     ///< areas of atoms, of which --report chooses some
  has_cavities = 4,  ///< cavities, or pieces of the molecule
  has_derivatives = 8,
  has_pockets = 16,
  needs_ses = 32,  ///< the SES must be measured
  has_relative_areas = 64,
};

/// A table of `--write` or `--table`. The table of the file NAME.pdb has the name NAME and
/// `ending`.
struct Table {
  std::string_view name;
  std::string_view ending;
  void (*append)(const MeasuredAtoms& atoms, BufferedText& text);
  unsigned traits;

  bool has(TableTraits trait) const { return (traits & trait) != 0; }
};
inline constexpr std::array measure_tables{
    Table{"atoms", ".atoms.csv", append_measured_atoms, has_areas},
    Table{"residues", ".residues.csv", append_measured_residues,
          needs_names | has_areas | has_relative_areas},
    Table{"chains", ".chains.csv", append_measured_chains, needs_names | has_areas},
    Table{"derivatives", ".derivatives.csv", append_derivatives, needs_ses | has_derivatives},
    Table{"cavities", ".cavities.csv", append_cavities, needs_ses | has_cavities},
    Table{"pieces", ".pieces.csv", append_pieces, needs_ses | has_cavities},
    Table{"pockets", ".pockets.csv", append_pockets, needs_ses | has_pockets},
    Table{"rsa", ".rsa", append_rsa, needs_names | has_areas | has_relative_areas},
    Table{"seq", ".seq", append_seq, needs_names | has_areas},
    Table{"res", ".res", append_res, needs_names | has_areas},
    Table{"pdb", ".areas.pdb", append_pdb, needs_names | has_areas},
    Table{"cif", ".areas.cif", append_cif, needs_names | has_areas},
};

/// The surfaces to measure.
struct SurfaceChoice {
  bool ses = false, sas = false, vdw = false, all = false;

  bool has_ses() const { return ses || all; }
  bool has_sas() const { return sas || all; }
  bool has_vdw() const { return vdw || all; }
};

/// A place of --at: atoms, a point, or a box.
struct PlaceChoice {
  std::string text;  ///< as it was given
  PartSelector part;
  std::optional<Vec3> point;
  std::optional<std::array<Vec3, 2>> box;
};

struct MeasureCommandOptions : OptionsOfTables<Table> {
  SurfaceChoice surfaces{.all = true};
  PartChoice parts;
  std::vector<PartSelector> reports;      ///< atoms whose areas are reported
  std::optional<double> max_filled_void;  ///< see SurfaceOptions
  bool cavities = false;                  ///< whether cavities and pieces are reported
  bool pockets = false;                   ///< whether pockets are reported
  bool allow_far_atoms = false;           ///< see Parameters::allow_far_atoms
  PocketOptions pocket_options;           ///< of the search for pockets
  std::optional<PlaceChoice> at;          ///< only pockets and cavities at this place are reported
  AreaReference reference = AreaReference::tien;  ///< of relative areas

  bool need_pockets() const { return pockets || needs(has_pockets); }

  /// Whether cavities are written or printed.
  bool need_cavities() const {
    return cavities || std::ranges::count(needed_tables(), "cavities", &Table::name) > 0;
  }

  /// Whether some table has a trait.
  bool needs(TableTraits trait) const {
    return std::ranges::any_of(needed_tables(),
                               [&](const Table* table) { return table->has(trait); });
  }

  /// Returns the option that chooses a table, with its value, for messages.
  std::string option_of(const Table& table) const {
    const bool is_written = std::ranges::count(written_tables, &table) > 0;
    return (is_written ? "--write " : "--table ") + std::string(table.name);
  }

  /// Whether the results are printed as the report on a single file, with its chains.
  bool has_report() const {
    return inputs.size() == 1 && !json && !prints_csv && printed_table == nullptr;
  }
};

/// Parses the arguments of the command. Throws UsageError and Notice.
MeasureCommandOptions parse_measure_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
