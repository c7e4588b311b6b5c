#pragma once
/// The data of an atom in a line of an xyzr or PQR file, ATOM and HETATM records of PQR files, and
/// their distinction from records of PDB files.

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "eses/atoms.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"

namespace eses::detail {

/// The data of one line.
struct Record {
  Atom atom;
  // only for PQR:
  double charge = 0;
  AtomLabel label;
};

/// The fault of a line. Its message is made only when the line is rejected, because the PQR reader
/// tries two layouts.
struct Problem {
  /// Message of the fault, with {} for the field; empty if there is no fault.
  std::string_view pattern;
  std::string_view quantity;  ///< name of the quantity; empty if the whole line is wrong
  std::string_view text;      ///< the field, a view of the line even if empty

  explicit operator bool() const { return !pattern.empty(); }
};

inline constexpr std::string_view not_a_number = "expected a number, found {}";

/// A quantity of an atom and its bounds. A coordinate or radius beyond them comes from misread
/// columns or a wrong unit, and would give a grid that exceeds any memory.
struct AtomQuantity {
  std::string_view name;
  double lowest;
  double highest;
};

inline constexpr double max_double = std::numeric_limits<double>::max();
inline constexpr AtomQuantity quantity_x{"x", -max_coordinate, max_coordinate};
inline constexpr AtomQuantity quantity_y{"y", -max_coordinate, max_coordinate};
inline constexpr AtomQuantity quantity_z{"z", -max_coordinate, max_coordinate};
inline constexpr AtomQuantity quantity_charge{"charge", -max_double, max_double};
inline constexpr AtomQuantity quantity_radius{"radius", 0, max_coordinate};

/// Parses a field and checks its value.
Problem read_value(std::string_view text, const AtomQuantity& quantity, double& value);

/// Returns what is wrong with a field of `line`, with its position and its quantity, or with the
/// whole line.
std::string describe(const Problem& problem, std::string_view line);

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
