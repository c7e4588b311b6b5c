#pragma once
/// Cavities, pieces and pockets as JSON objects and as tables, which have the same members.
/// Indices are counted from 1.

#include "cli/json.hpp"
#include "output/area_tables.hpp"

namespace eses::detail::cli {

Json cavity_json(const MeasuredAtoms& atoms, const Cavity& cavity);
Json piece_json(const MeasuredAtoms& atoms, const Piece& piece);
Json pocket_json(const MeasuredAtoms& atoms, const Pocket& pocket);
Json place_json(const PlacedPocket& placed);

/// Append a whole table.
void append_cavities(const MeasuredAtoms& atoms, BufferedText& text);
void append_pieces(const MeasuredAtoms& atoms, BufferedText& text);
void append_pockets(const MeasuredAtoms& atoms, BufferedText& text);

}  // namespace eses::detail::cli
