#pragma once
/// Measured areas in the formats of other programs.
///
/// The relative areas of `.rsa` are in per cent of max_sas_area. There is no reference for parts of
/// residues, whose relative areas are -99.9, as NACCESS marks missing values.

#include <string_view>

#include "output/area_tables.hpp"
#include "output/text_buffer.hpp"

namespace eses::detail {

/// First lines of the files of append_pdb, which begin alike, and append_cif.
inline constexpr std::string_view pdb_heading_start = "REMARK 999 B-FACTORS ARE ";
inline constexpr std::string_view pdb_heading =
    "REMARK 999 B-FACTORS ARE AREAS ON THE SOLVENT ACCESSIBLE SURFACE (A^2), OCCUPANCIES ARE RADII";
inline constexpr std::string_view pdb_heading_of_interface =
    "REMARK 999 B-FACTORS ARE BURIED SOLVENT ACCESSIBLE AREAS (A^2), OCCUPANCIES ARE RADII";
inline constexpr std::string_view cif_heading = "data_areas";

/// Append a whole file. Atoms have labels. Throws Error if a name or a number is too wide for its
/// columns.

/// The table of residues of NACCESS (Hubbard and Thornton 1993) and FreeSASA: SAS areas of all
/// atoms, side chain, main chain, apolar and polar atoms.
void append_rsa(const MeasuredAtoms& atoms, BufferedText& text);
/// The SAS areas of residues, as FreeSASA prints them with `--format seq`.
void append_seq(const MeasuredAtoms& atoms, BufferedText& text);
/// The SAS areas of kinds of residues, as FreeSASA prints them with `--format res`.
void append_res(const MeasuredAtoms& atoms, BufferedText& text);
/// The atoms as a PDB file with SAS areas as B-factors and radii as occupancies, as FreeSASA prints
/// them.
void append_pdb(const MeasuredAtoms& atoms, BufferedText& text);
/// The PDB file of append_pdb(atoms, text) with `heading` as its first line.
void append_pdb(std::string_view heading, const MeasuredAtoms& atoms, BufferedText& text);
/// The atoms as an mmCIF file with SAS areas as B-factors.
void append_cif(const MeasuredAtoms& atoms, BufferedText& text);

}  // namespace eses::detail
