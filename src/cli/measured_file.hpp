#pragma once
/// The measures of the atoms of a file, and of the parts of a complex.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/diagnostics.hpp"
#include "cli/measure_options.hpp"
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
  std::filesystem::path path;
  int model = 0;                  ///< number of the model; 0 unless each model is measured
  Surface surface;                ///< of all parts together, or of all atoms
  std::uint64_t other_atoms = 0;  ///< number of atoms of the file that belong to no part
  Measures measures = {};
  Pockets pockets = {};  ///< empty unless they were chosen
  std::optional<MeasuredPlace> place = {};
  std::vector<MeasuredPart> parts = {};  ///< empty if no parts were chosen
  std::vector<ReportedAtoms> reports = {};
  std::vector<DiagnosticText> diagnostics = {};
  std::optional<StructureReport> structure = {};  ///< only for PDB and mmCIF files

  // For tables.
  std::optional<AreaReference> reference = {};
  std::vector<FileIndex> file_indices = {};  ///< by atom; empty if the surface has all atoms
  eses::AtomAreas areas_alone = {};          ///< areas of each atom in its part alone
  std::vector<std::uint32_t> part_of_atom = {};
  std::vector<std::string> part_names = {};

  /// Sum of an area of the parts minus the area of the complex, in square angstrom.
  double buried(double Measures::*area) const;

  /// Both names of the chains, if the labels have those of label_asym_id.
  std::span<const ChainName> label_chains() const;

  MeasuredAtoms table() const;
};

/// Returns a file with its reported atoms alone, and their areas in the whole file. Its cavities,
/// pockets and derivatives are those of all atoms.
MeasuredFile only_reported(MeasuredFile file);

/// Reads and measures an input. Throws Error if it cannot be read, or if it lacks a chain of a
/// part.
MeasuredFile measure_file(const MeasureCommandOptions& options, std::size_t input, int threads,
                          const CheckCallback& check);

}  // namespace eses::detail::cli
