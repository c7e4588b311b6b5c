#pragma once
/// The command line of `eses-blocks measure` as plain data.

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/measure_records.hpp"
#include "eses/pockets.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"
#include "output/area_formats.hpp"

namespace eses::detail::cli {

/// A table of `--write` or `--table`. The table of the file NAME.pdb has the name NAME and
/// `ending`.
struct Table {
  std::string_view name;
  std::string_view ending;
  bool TableChoice::*is_chosen;
  void (*append)(const MeasuredAtoms& atoms, BufferedText& text);
  bool needs_names = false;  ///< whether the atoms must have names
  bool needs_ses = false;    ///< whether the SES must be measured
  bool has_areas = false;    ///< whether it has areas of atoms, of which --report chooses some
};
inline constexpr std::array tables{
    Table{.name = "atoms",
          .ending = ".atoms.csv",
          .is_chosen = &TableChoice::atoms,
          .append = append_measured_atoms,
          .has_areas = true},
    Table{.name = "residues",
          .ending = ".residues.csv",
          .is_chosen = &TableChoice::residues,
          .append = append_measured_residues,
          .needs_names = true,
          .has_areas = true},
    Table{.name = "chains",
          .ending = ".chains.csv",
          .is_chosen = &TableChoice::chains,
          .append = append_measured_chains,
          .needs_names = true,
          .has_areas = true},
    Table{.name = "derivatives",
          .ending = ".derivatives.csv",
          .is_chosen = &TableChoice::derivatives,
          .append = append_derivatives,
          .needs_ses = true},
    Table{.name = "cavities",
          .ending = ".cavities.csv",
          .is_chosen = &TableChoice::cavities,
          .append = append_cavities,
          .needs_ses = true},
    Table{.name = "pieces",
          .ending = ".pieces.csv",
          .is_chosen = &TableChoice::pieces,
          .append = append_pieces,
          .needs_ses = true},
    Table{.name = "pockets",
          .ending = ".pockets.csv",
          .is_chosen = &TableChoice::pockets,
          .append = append_pockets,
          .needs_ses = true},
    Table{.name = "rsa",
          .ending = ".rsa",
          .is_chosen = &TableChoice::rsa,
          .append = append_rsa,
          .needs_names = true,
          .has_areas = true},
    Table{.name = "seq",
          .ending = ".seq",
          .is_chosen = &TableChoice::seq,
          .append = append_seq,
          .needs_names = true,
          .has_areas = true},
    Table{.name = "res",
          .ending = ".res",
          .is_chosen = &TableChoice::res,
          .append = append_res,
          .needs_names = true,
          .has_areas = true},
    Table{.name = "pdb",
          .ending = ".areas.pdb",
          .is_chosen = &TableChoice::pdb,
          .append = append_pdb,
          .needs_names = true,
          .has_areas = true},
    Table{.name = "cif",
          .ending = ".areas.cif",
          .is_chosen = &TableChoice::cif,
          .append = append_cif,
          .needs_names = true,
          .has_areas = true},
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

struct MeasureCommandOptions {
  std::vector<std::filesystem::path> inputs;  ///< without folders; `-` is standard input
  std::filesystem::path list;                 ///< file of --files-from; empty if it is not given
  bool all_models = false;                    ///< whether each model of a file is measured
  /// With `all_models`, the number of the model of each input. An input is in the list once for
  /// each of its models.
  std::vector<int> models;
  AtomFormat format = AtomFormat::automatic;
  StructureOptions structure;  ///< for PDB and mmCIF files
  double probe_radius = SurfaceOptions().probe_radius;
  SurfaceChoice surfaces{.all = true};
  PartChoice parts;
  std::vector<PartSelector> reports;      ///< atoms whose areas are reported
  std::optional<double> max_filled_void;  ///< see SurfaceOptions
  bool cavities = false;                  ///< whether cavities and pieces are reported
  bool pockets = false;                   ///< whether pockets are reported
  PocketOptions pocket_options;           ///< of the search for pockets
  std::optional<PlaceChoice> at;          ///< only pockets and cavities at this place are reported
  TableChoice tables;
  const Table* printed_table = nullptr;  ///< printed in place of the report; null if none is
  AreaReference reference = AreaReference::tien;  ///< of relative areas
  std::filesystem::path output_directory = ".";   ///< of the tables
  std::filesystem::path csv;                      ///< empty if it is not given
  int threads = 0;                                ///< 0 means all available processors
  bool json = false;
  bool quiet = false;
  bool strict = false;  ///< whether warnings are errors

  /// Returns the number of the model of an input; 0 for the first one.
  int model_of(std::size_t input) const { return models.empty() ? structure.model : models[input]; }

  bool need_pockets() const { return pockets || needed_tables().pockets; }

  /// The tables to write or to print.
  TableChoice needed_tables() const {
    TableChoice needed = tables;
    if (printed_table != nullptr) needed.*printed_table->is_chosen = true;
    return needed;
  }

  bool needs(const Table& table) const { return needed_tables().*table.is_chosen; }

  /// Returns the option that chooses a table, with its value, for messages.
  std::string option_of(const Table& table) const {
    return std::string(tables.*table.is_chosen ? "--write " : "--table ") + std::string(table.name);
  }

  /// Whether the results are printed as the report on a single file, with its chains.
  bool has_report() const { return inputs.size() == 1 && !json && printed_table == nullptr; }
};

/// Parses the arguments of the command. Throws UsageError and Notice.
MeasureCommandOptions parse_measure_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
