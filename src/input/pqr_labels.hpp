#pragma once
/// Names in the ATOM and HETATM records of PQR files.

#include <string_view>

#include "eses/atoms.hpp"

namespace eses::detail {

/// Returns the label of a record in free format. `leading` has the fields before the coordinates:
/// record name, serial number, atom name, residue name, chain (optional) and residue number. The
/// chain may be joined with the residue number, and the record name with the serial number.
AtomLabel label_of_fields(std::string_view leading);

/// Returns the label of a record in the columns of PDB files. The record must have at least 27
/// characters. See https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html.
AtomLabel label_of_columns(std::string_view line);

}  // namespace eses::detail
