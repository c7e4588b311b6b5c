#pragma once
/// ATOM and HETATM records of PQR files, and their distinction from records of PDB files.

#include <cstdint>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"
#include "input/atom_record.hpp"

namespace eses::detail {

/// Returns whether a line is an ATOM or HETATM record.
bool is_pqr_record(std::string_view line);

/// Parses a record, with its label. The element of the label is the symbol at the end of the line,
/// without its charge, or empty.
Problem parse_pqr(std::string_view line, Record& record);

/// Returns what is wrong with a record that parse_pqr refuses.
std::string describe_pqr(const Problem& problem, std::string_view line);

/// Returns whether a line has the coordinates of an atom, but the name of no record of PDB and PQR
/// files, such as ATAM.
bool is_unread_atom(std::string_view line);

/// Returns whether a record has the columns of PDBQT files of AutoDock, which have a charge and the
/// type of the atom behind those of PDB files.
bool is_pdbqt_record(std::string_view line);

/// The columns of charge and radius that the remarks of a PQR file name, from 1; 0 if unknown.
struct NamedColumns {
  int charge = 0, radius = 0;

  /// Reads a line that is not a record of an atom.
  void add(std::string_view line);
  bool are_known() const { return charge > 0 && radius > 0; }
  bool are_swapped() const { return are_known() && radius < charge; }
};

/// Counts of PQR records that look like records of a PDB file.
struct PdbLikeness {
  /// Number of records that have numbers in the columns and format of occupancy and B-factor.
  std::uint64_t layout = 0;
  /// Number of these records whose values are improbable as charge and radius.
  std::uint64_t values = 0;

  /// Updates the counts with a record.
  void add(std::string_view line);
};

/// Returns the format of the ATOM and HETATM records of a text, AtomFormat::pdb or AtomFormat::pqr,
/// or AtomFormat::automatic if it is unknown. A part of the records suffices.
AtomFormat format_of_records(std::string_view text);

/// Throws Error if most of the `atoms` records of a PQR file look like records of a PDB file.
void refuse_pdb_records(std::string_view name, std::uint64_t atoms, const PdbLikeness& likeness);

/// Throws Error if the records of a text, which should be a PDB file, are records of a PQR file or
/// of a PDBQT file.
void refuse_pqr_records(std::string_view text, std::string_view name);

}  // namespace eses::detail
