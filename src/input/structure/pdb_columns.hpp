#pragma once
/// Columns of the records of atoms in PDB files, and the columns at the end of a record, whose
/// layout differs between programs.

#include <array>
#include <cstddef>
#include <string_view>

#include "input/text_fields.hpp"

namespace eses::detail {

/// Columns of a record, from 0.
struct Columns {
  std::size_t first, width;
};

// https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html
inline constexpr Columns serial_columns{6, 5}, name_columns{12, 4}, residue_columns{17, 3},
    chain_columns{20, 2}, sequence_columns{22, 5};
inline constexpr std::size_t altloc_column = 16;
inline constexpr std::array<Columns, 3> coordinate_columns{{{30, 8}, {38, 8}, {46, 8}}};
inline constexpr Columns occupancy_columns{54, 6}, b_factor_columns{60, 6}, segment_columns{72, 4};
inline constexpr Columns element_columns{76, 2};
// The charges in the last two columns are not used: old files have line numbers there.
inline constexpr std::size_t end_of_fields = 78, record_width = 80;

/// Returns the text of a field without blanks around it. The record may be too short.
inline std::string_view field_of(std::string_view record, const Columns& columns) {
  return column_text(record, columns.first, columns.width);
}

/// Returns the symbol in the columns of the element or, if these have none, one or two columns
/// beside them, as some programs write it. Empty if the record has none.
std::string_view element_of_columns(std::string_view record);

/// Returns the symbol in the columns of the segment, if it may be the element of the atom.
std::string_view element_in_segment(std::string_view record);

/// Returns the identifier of the segment; empty if there is none. Old files have the entry and the
/// number of the line in the last eight columns.
std::string_view segment_of(std::string_view record);

}  // namespace eses::detail
