#pragma once
/// The results of `eses-blocks measure` for a file, and their texts.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/measure_options.hpp"
#include "cli/shared_report.hpp"
#include "eses/measure.hpp"
#include "eses/place.hpp"
#include "eses/pockets.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"
#include "output/area_tables.hpp"

namespace eses::detail::cli {

/// A part of a complex without the other parts.
struct MeasuredPart {
  std::string name;         ///< its chains, such as A,B
  std::uint64_t atoms = 0;  ///< number of atoms
  Measures measures;        ///< without areas by atom
};

/// A residue of reported atoms, and the SAS area of these atoms in square angstrom.
struct ReportedResidue {
  std::string name;
  double sas = 0;
  std::optional<double> relative_sas;  ///< only for residues with a maximum area
};

/// Atoms of a file, and their areas in it, in square angstrom.
struct ReportedAtoms {
  std::string name;
  std::vector<AtomIndex> atoms;  ///< ascending
  double ses = 0, sas = 0;
  double polar_sas = 0;                   ///< SAS area of the polar atoms
  std::optional<double> relative_sas;     ///< only for one residue with a maximum area
  std::vector<ReportedResidue> residues;  ///< if there are several, but not many
};

/// The pockets and cavities at the place of --at.
struct MeasuredPlace {
  Place place;
  std::uint64_t left_out = 0;         ///< number of the atoms of a ligand, which are left out
  PlacedPockets pockets;              ///< empty unless they were chosen
  std::vector<std::size_t> cavities;  ///< indices; empty unless they were chosen
};

struct MeasuredFile {
  ReportedInput input;
  Surface surface;                ///< of all parts together, or of all atoms
  std::uint64_t other_atoms = 0;  ///< number of atoms of the file that belong to no part
  Measures measures = {};
  Pockets pockets = {};  ///< empty unless they were chosen
  std::optional<MeasuredPlace> place = {};
  std::vector<MeasuredPart> parts = {};  ///< empty if no parts were chosen
  std::vector<ReportedAtoms> reports = {};

  // For tables.
  std::optional<AreaReference> reference = {};
  std::vector<FileIndex> file_indices = {};  ///< by atom; empty if the surface has all atoms
  eses::AtomAreas areas_alone = {};          ///< areas of each atom in its part alone
  std::vector<std::uint32_t> part_of_atom = {};
  std::vector<std::string> part_names = {};

  /// Sum of an area of the parts minus the area of the complex, in square angstrom.
  double buried(double Measures::*area) const;

  MeasuredAtoms table() const;
};

/// Returns the report on a single file.
std::string measure_text(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Returns the reasons why tables of cavities and pockets have no rows, and amino acids no relative
/// areas. `reported` has the atoms of the tables of areas.
std::vector<std::string> table_notes(const MeasureCommandOptions& options, const MeasuredFile& file,
                                     const MeasuredFile& reported);

/// Returns the heading of the lines of several files.
std::string measure_heading(const MeasureCommandOptions& options);

/// Returns the line of one of several files.
std::string measure_line(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Returns the results as one JSON object in a line.
std::string measure_json(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Returns the names of the columns of the table of `--csv`.
std::vector<std::string> measure_csv_columns(const MeasureCommandOptions& options);

/// Returns the line of a file in the table of `--csv`.
std::string measure_csv_line(const MeasureCommandOptions& options, const MeasuredFile& file);

/// Append a whole table: a row for each item.
void append_cavities(const MeasuredAtoms& atoms, BufferedText& text);
void append_pieces(const MeasuredAtoms& atoms, BufferedText& text);
void append_pockets(const MeasuredAtoms& atoms, BufferedText& text);

}  // namespace eses::detail::cli
