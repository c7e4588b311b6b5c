#pragma once
/// The command line of `eses-blocks measure` as plain data.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/table_options.hpp"
#include "eses/pockets.hpp"

namespace eses::detail::cli {

/// Requirements and contents of tables; see Table::traits.
enum MeasureTraits : unsigned {
  needs_names = 1,  ///< the atoms must have names
  needs_ses = 2,    ///< the SES must be measured
  has_areas = 4,    ///< areas of atoms, of which --report chooses some
  has_relative_areas = 8,
  has_derivatives = 16,
  has_cavities = 32,
  has_pieces = 64,  ///< of the molecule
  has_pockets = 128,
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

  bool names_atoms() const { return !point && !box; }
};

struct MeasureCommandOptions : TableOptions {
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
  bool need_cavities() const { return cavities || needs(has_cavities); }

  /// Whether the results are printed as the report on a single file, with its chains.
  bool has_report() const {
    return inputs.size() == 1 && !json && !prints_csv && printed_table == nullptr;
  }
};

/// Parses the arguments of the command. Throws UsageError and Notice.
MeasureCommandOptions parse_measure_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
