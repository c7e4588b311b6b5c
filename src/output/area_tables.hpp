#pragma once
/// Tables of areas by atom, residue and chain, and of derivatives by atom, as CSV (RFC 4180, but
/// with LF as line end).
///
/// The tables of a grid:
///
/// residue_area.csv: `chain,residue_number,residue,atoms,area`. One line for each run of atoms with
/// the same chain, number and name, in the order of the file.
///
/// chain_area.csv: `chain,residues,atoms,area`. One line for each chain identifier, in the order of
/// first occurrence. Waters and ligands that a file lists after the last chain are counted with the
/// chain that they name.
///
/// atoms.csv: `serial,name,residue,residue_number,chain,element,radius,area`. One line for each
/// atom, in the order of the file.
///
/// The tables of measures:
///
/// The tables of areas have the columns `sas_area,ses_area,convex_area,saddle_area,concave_area`.
/// The last three are the parts of `ses_area`. If the SES was not measured, only `sas_area` and
/// `buried_sas_area` are there. If parts of a complex were measured, the columns
/// `part,buried_sas_area,buried_ses_area` follow: the area in the part alone minus the area in the
/// complex.
///
/// Atoms: `serial,name,residue,residue_number,chain,element,x,y,z,radius,...`, a line for each
/// atom.
///
/// Residues: `chain,residue_number,residue,atoms,...,relative_sas_area,...`, a line for each run of
/// atoms with the same chain, number and name. `relative_sas_area` is empty for other residues than
/// the 20 amino acids of max_sas_area.
///
/// If MeasuredAtoms::chains is not empty, the last column of atoms and residues is `auth_chain`.
///
/// Chains: `chain,residues,atoms,...`, a line for each chain, in the order of first occurrence.
///
/// Derivatives: `serial`, and for each of SES area, SES volume, SAS area and SAS volume the
/// derivatives by the coordinates and the radius of the atom, such as
/// `ses_area_x,ses_area_y,ses_area_z,ses_area_radius`.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/cavities.hpp"
#include "eses/measure.hpp"
#include "eses/place.hpp"
#include "eses/pockets.hpp"
#include "eses/read_atoms.hpp"
#include "eses/residue_areas.hpp"
#include "input/atom_names.hpp"
#include "output/text_buffer.hpp"

namespace eses::detail {

/// Returns a field of a CSV file, in quotation marks if it contains commas, quotation marks or line
/// ends.
std::string csv_field(std::string_view text);

/// Returns the estimated memory in bytes of chain_area.csv for chains with names of this total
/// length.
double chain_table_memory(double chains, double name_bytes);

/// Appends residue_area.csv, and chain_area.csv, for runs of atoms with these areas (square
/// angstrom).
void append_residues(BufferedText& text, const ResidueRuns& runs, std::span<const double> areas);
void append_chains(BufferedText& text, const ResidueRuns& runs, std::span<const double> areas);

/// Appends the header line of atoms.csv.
void append_atom_header(BufferedText& text);

/// Appends a line of atoms.csv. `serial` is the number of the atom in the file, from 1. Radius and
/// area are in angstrom and square angstrom.
void append_atom(BufferedText& text, std::uint64_t serial, const AtomLabel& label, double radius,
                 double area);

/// Returns the expected length of atoms.csv for atoms whose names have this total length.
std::uint64_t typical_atom_table_bytes(std::uint64_t atoms, std::uint64_t name_bytes);

/// The atoms of a table, their areas and derivatives. All spans by atom have the same length, if
/// they are not empty.
struct MeasuredAtoms {
  std::span<const Atom> atoms;
  std::span<const AtomLabel> labels;  ///< empty if there are no names
  FileIndices file_indices;
  const eses::AtomAreas& areas;
  const Gradients& gradients;
  std::span<const Cavity> cavities;
  std::span<const Piece> pieces;
  std::span<const Pocket> pockets;
  /// The areas of the parts of a complex; null if there are no parts.
  const eses::AtomAreas* areas_alone = nullptr;
  std::span<const std::uint32_t> parts = {};  ///< index of the part of each atom
  std::span<const std::string> part_names = {};
  /// Maxima of relative areas; nothing if the probe is not theirs.
  std::optional<AreaReference> reference = AreaReference::tien;
  /// Both names of the chains, if the labels have those of label_asym_id; else empty.
  std::span<const ChainName> chains = {};
  /// Indices of the cavities to write, ascending; nothing for all.
  std::optional<std::span<const std::size_t>> chosen_cavities = {};
  /// The pockets with what concerns their place, if there is one.
  std::optional<std::span<const PlacedPocket>> placed_pockets = {};

  bool is_chosen(std::size_t cavity) const {
    return !chosen_cavities || std::ranges::binary_search(*chosen_cavities, cavity);
  }
};

/// Returns the chain of a label in auth_asym_id; empty if it is unknown, as of copies in an
/// assembly.
std::string_view auth_chain(const MeasuredAtoms& atoms, const AtomLabel& label);

/// Returns the maximum area of the residue of the atoms in [begin, end) by the reference of a
/// table; nothing if there is none.
std::optional<double> max_sas_area(const MeasuredAtoms& atoms, std::size_t begin, std::size_t end);

/// Append a whole table.
void append_measured_atoms(const MeasuredAtoms& atoms, BufferedText& text);
void append_measured_residues(const MeasuredAtoms& atoms, BufferedText& text);
void append_measured_chains(const MeasuredAtoms& atoms, BufferedText& text);
void append_derivatives(const MeasuredAtoms& atoms, BufferedText& text);

/// Returns the number of an atom in its file, from 1.
std::uint64_t serial_number(const MeasuredAtoms& atoms, AtomIndex i);

/// Returns the numbers of atoms in their file.
std::vector<std::uint64_t> serial_numbers(const MeasuredAtoms& atoms,
                                          std::span<const AtomIndex> of);

/// Returns the numbers of the cavities whose voids overlap that of a cavity, from 1. The outside is
/// 0.
std::vector<std::size_t> overlaps_of(const Cavity& cavity);

/// Returns the residues of atoms in the order of first occurrence, as `chain:residue number`, such
/// as A:LYS 12. Empty if there are no labels.
std::vector<std::string> residues_of(const MeasuredAtoms& atoms, std::span<const AtomIndex> of);

}  // namespace eses::detail
