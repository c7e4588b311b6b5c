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

enum class Fault {
  none,
  missing,
  not_a_number,
  not_finite,
  out_of_range,
  negative,
  too_large,
  too_few_fields,
  extra_number,
  residue_number,
};

/// The fault of a line. Its message is made only when the line is rejected, because the PQR reader
/// tries two layouts.
struct Problem {
  Fault fault = Fault::none;
  std::string_view quantity;  ///< name of the quantity
  std::string_view text;      ///< the field, a view of the line even if empty

  explicit operator bool() const { return fault != Fault::none; }
};

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

std::size_t count_fields(std::string_view text);

/// Returns what is wrong with a field of `line`: its position, its quantity and the cause.
std::string describe_field(const Problem& problem, std::string_view line);

}  // namespace eses::detail
