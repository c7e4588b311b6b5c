#pragma once
/// The data of an atom in a line of an xyzr or PQR file.

#include <limits>
#include <string>
#include <string_view>

#include "eses/atoms.hpp"
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

}  // namespace eses::detail
