#pragma once
/// Areas by residue, by chain and by atom, as CSV (RFC 4180, but with LF as line end).
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

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "input/residue_runs.hpp"
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

}  // namespace eses::detail
