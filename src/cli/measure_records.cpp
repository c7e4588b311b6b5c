#include "cli/measure_records.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/shared_report.hpp"

namespace eses::detail::cli {
namespace {

std::vector<std::size_t> numbers_of(std::vector<std::size_t> indices) {
  for (std::size_t& index : indices) ++index;
  return indices;
}

/// Returns the chains of atoms in the order of first occurrence, with blanks between them.
std::string chains_of(const MeasuredAtoms& atoms, const Piece& piece) {
  std::vector<std::string_view> chains;
  if (!atoms.labels.empty())
    for (const AtomIndex i : piece.atoms)
      if (std::ranges::find(chains, atoms.labels[i].chain) == chains.end())
        chains.push_back(atoms.labels[i].chain);
  return formatted("{}", fmt::join(chains, " "));
}

/// Appends a row for each item that `is_chosen` accepts, after its number. `make` returns the
/// record of an item.
template <class Item, class Make>
void append_records(
    std::string_view number, std::span<const Item> items, const Make& make, BufferedText& text,
    const std::function<bool(std::size_t index)>& is_chosen = [](std::size_t) { return true; }) {
  text.append("{},{}\n", number, csv_heading(make(Item())));
  for (std::size_t k = 0; k < items.size(); ++k)
    if (is_chosen(k)) text.append("{},{}\n", k + 1, csv_row(make(items[k])));
}

}  // namespace

Json cavity_json(const MeasuredAtoms& atoms, const Cavity& cavity) {
  Json item{{"void_volume", cavity.void_volume},
            {"probe_center_volume", cavity.probe_center_volume},
            {"ses_area", cavity.ses_area},
            {"sas_area", cavity.sas_area},
            {"euler_number", cavity.euler_number},
            {"centroid", cavity.centroid},
            {"low", cavity.low},
            {"high", cavity.high},
            {"largest_probe", cavity.largest_probe},
            {"largest_probe_center", cavity.largest_probe_center},
            {"walls", cavity.wall_count},
            {"piece", cavity.piece + 1},
            {"inner_pieces", numbers_of(cavity.inner)},
            {"overlaps", overlaps_of(cavity)},
            {"atoms", serial_numbers(atoms, cavity.atoms)}};
  if (!atoms.labels.empty()) item["residues"] = residues_of(atoms, cavity.atoms);
  return item;
}

Json piece_json(const MeasuredAtoms& atoms, const Piece& piece) {
  return {{"ses_area", piece.ses_area},
          {"ses_volume", piece.ses_volume},
          {"sas_area", piece.sas_area},
          {"sas_volume", piece.sas_volume},
          {"euler_number", piece.euler_number},
          {"cavities", piece.cavity_count},
          {"cavity", piece.cavity ? *piece.cavity + 1 : 0},
          {"atoms", piece.atoms.size()},
          {"first_atom", piece.atoms.empty() ? 0 : serial_number(atoms, piece.atoms.front())}};
}

/// Returns the members of a pocket that concern its place.
Json place_json(const PlacedPocket& placed) {
  return {{"low", placed.low},
          {"high", placed.high},
          {"depth", placed.depth},
          {"volume_at_place", placed.volume_at_place}};
}

Json pocket_json(const MeasuredAtoms& atoms, const Pocket& pocket) {
  Json item{{"volume", pocket.volume},         {"probe_center_volume", pocket.probe_center_volume},
            {"mouth_area", pocket.mouth_area}, {"mouths", pocket.mouth_count},
            {"centroid", pocket.centroid},     {"atoms", serial_numbers(atoms, pocket.atoms)}};
  if (!atoms.labels.empty()) item["residues"] = residues_of(atoms, pocket.atoms);
  return item;
}

void append_cavities(const MeasuredAtoms& atoms, BufferedText& text) {
  const auto row = [&](const Cavity& cavity) {
    Json record = cavity_json(atoms, cavity);
    record["largest_probe"] = formatted("{:.9f}", cavity.largest_probe);
    record.erase("largest_probe_center");
    record["residues"] = residues_of(atoms, cavity.atoms);
    return record;
  };
  append_records("cavity", atoms.cavities, row, text,
                 [&](std::size_t cavity) { return atoms.is_chosen(cavity); });
}

void append_pieces(const MeasuredAtoms& atoms, BufferedText& text) {
  const auto row = [&](const Piece& piece) {
    Json record = piece_json(atoms, piece);
    record["chains"] = chains_of(atoms, piece);
    return record;
  };
  append_records("piece", atoms.pieces, row, text);
}

void append_pockets(const MeasuredAtoms& atoms, BufferedText& text) {
  const auto row = [&](const Pocket& pocket) {
    Json record = pocket_json(atoms, pocket);
    record["residues"] = residues_of(atoms, pocket.atoms);
    return record;
  };
  const auto placed_row = [&](const PlacedPocket& placed) {
    Json record = row(placed.pocket);
    record.update(place_json(placed));
    return record;
  };
  if (atoms.placed_pockets)
    append_records("pocket", *atoms.placed_pockets, placed_row, text);
  else
    append_records("pocket", atoms.pockets, row, text);
}

}  // namespace eses::detail::cli
