#pragma once
/// The names in an ATOM or HETATM record of a PQR file.

#include <string_view>

#include "eses/atoms.hpp"

namespace eses::detail {

/// Of a record in free format. `leading` is what stands before the coordinates: record, serial,
/// name, residue, residue number, with the chain before the number, apart from it or not. There is
/// no field for the serial if it follows the record's name without a blank.
AtomLabel label_of_fields(std::string_view leading);

/// Of a record in the columns of PDB files, of at least 27 characters,
/// https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html
AtomLabel label_of_columns(std::string_view line);

}  // namespace eses::detail
