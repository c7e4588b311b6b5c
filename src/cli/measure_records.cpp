#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "cli/json.hpp"
#include "cli/measure_report.hpp"
#include "cli/messages.hpp"
#include "cli/shared_report.hpp"
#include "output/area_tables.hpp"
#include "system/formatted.hpp"

// The results of a file as JSON, as a line of several files, and as rows of tables. Indices are
// counted from 1.

namespace eses {

static void to_json(detail::Json& json, const PatchAreas& areas) {
  json = {{"convex", areas.convex}, {"saddle", areas.saddle}, {"concave", areas.concave}};
}

}  // namespace eses

namespace eses::detail::cli {
namespace {

// --- items ---------------------------------------------------------------------------------------

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

// --- JSON ----------------------------------------------------------------------------------------

/// Returns the array of `make(item)` for the items of a list.
template <class Items, class Make>
Json array_of(const Items& items, const Make& make) {
  Json array = Json::array();
  for (const auto& item : items) array.push_back(make(item));
  return array;
}

void add_cavities(Json& object, const MeasuredFile& file) {
  const MeasuredAtoms atoms = file.table();
  object["cavities"] = Json::array();
  for (std::size_t k = 0; k < atoms.cavities.size(); ++k)
    if (atoms.is_chosen(k)) object["cavities"].push_back(cavity_json(atoms, atoms.cavities[k]));
  object["pieces"] =
      array_of(atoms.pieces, [&](const Piece& piece) { return piece_json(atoms, piece); });
}

void add_pockets(Json& object, const PocketOptions& search, const MeasuredFile& file) {
  const MeasuredAtoms atoms = file.table();
  Json pockets =
      array_of(atoms.pockets, [&](const Pocket& pocket) { return pocket_json(atoms, pocket); });
  Json search_json{{"large_probe_radius", search.large_probe_radius}, {"spacing", search.spacing}};
  if (file.place)
    for (std::size_t k = 0; k < pockets.size(); ++k)
      pockets[k].update(place_json(file.place->pockets.pockets[k]));
  else
    search_json.update({{"difference_volume", file.pockets.difference_volume},
                        {"shallow_volume", file.pockets.shallow_volume}});
  object.update({{"pockets", pockets}, {"pocket_search", search_json}});
}

/// Adds what concerns the place of --at.
void add_place(Json& object, const MeasureCommandOptions& options, const MeasuredPlace& place) {
  Json item{{"place", options.at->text}, {"left_out_atoms", place.left_out}};
  if (options.pockets)
    item.update({{"inside_volume", place.pockets.inside_volume},
                 {"outside_volume", place.pockets.outside_volume},
                 {"shallow_volume", place.pockets.shallow_volume},
                 {"small_pocket_volume", place.pockets.small_pocket_volume}});
  if (options.cavities) item["cavities"] = numbers_of(place.cavities);
  object["at"] = item;
}

/// Areas and volumes with their names in tables and JSON.
using NamedMeasure = std::pair<const char*, double Measures::*>;

/// Returns the areas and volumes of the chosen surfaces.
std::vector<NamedMeasure> areas_and_volumes(const SurfaceChoice& surfaces) {
  std::vector<NamedMeasure> chosen;
  const auto add = [&](bool is_chosen, NamedMeasure area, NamedMeasure volume) {
    if (is_chosen) chosen.insert(chosen.end(), {area, volume});
  };
  add(surfaces.has_ses(), {"ses_area", &Measures::ses_area}, {"ses_volume", &Measures::ses_volume});
  add(surfaces.has_sas(), {"sas_area", &Measures::sas_area}, {"sas_volume", &Measures::sas_volume});
  add(surfaces.has_vdw(), {"vdw_area", &Measures::vdw_area}, {"vdw_volume", &Measures::vdw_volume});
  return chosen;
}

/// Returns the areas that the parts of a complex bury. See MeasuredFile::buried.
std::vector<NamedMeasure> buried_areas(const SurfaceChoice& surfaces) {
  std::vector<NamedMeasure> chosen;
  if (surfaces.has_ses()) chosen.emplace_back("buried_ses_area", &Measures::ses_area);
  if (surfaces.has_sas()) chosen.emplace_back("buried_sas_area", &Measures::sas_area);
  return chosen;
}

void add_measures(Json& object, const SurfaceChoice& surfaces, const Measures& measures) {
  for (const auto& [name, member] : areas_and_volumes(surfaces)) object[name] = measures.*member;
  if (!surfaces.has_ses()) return;
  object["euler_number"] = measures.euler_number;
  object["ses_area_by_kind"] = measures.ses_areas;
}

/// Adds what concerns all atoms of the derivatives, if they were computed.
void add_derivatives(Json& object, const Gradients& gradients) {
  if (gradients.ses_area.radii.empty()) return;
  object["derivatives_by_probe_radius"] = {{"ses_area", gradients.ses_area.probe},
                                           {"ses_volume", gradients.ses_volume.probe},
                                           {"sas_area", gradients.sas_area.probe},
                                           {"sas_volume", gradients.sas_volume.probe}};
  object["derivatives_are_smooth"] = gradients.are_smooth;
}

Json report_json(const MeasureCommandOptions& options, const MeasuredFile& file,
                 const ReportedAtoms& report) {
  Json item{{"name", report.name}, {"atoms", report.atoms.size()}};
  if (options.surfaces.has_ses()) item["ses_area"] = report.ses;
  if (options.surfaces.has_sas()) {
    item["sas_area"] = report.sas;
    item["polar_sas_area"] = report.polar_sas;
    item["apolar_sas_area"] = report.sas - report.polar_sas;
    item["relative_sas_area"] = report.relative_sas ? Json(*report.relative_sas) : Json();
  }
  item["residues"] = residues_of(file.table(), report.atoms);
  return item;
}

/// Returns the sum of a member over items.
double sum_of(const auto& items, auto member) {
  double sum = 0;
  for (const auto& item : items) sum += item.*member;
  return sum;
}

/// A value of a file in the lines of several files and in the table of `--csv`.
struct Column {
  std::string name;
  int width;  ///< in the lines; 0 for a value that is only in the table
  std::function<std::string(const MeasuredFile& file, int decimals)> text;
};

std::vector<Column> columns_of(const MeasureCommandOptions& options) {
  std::vector<Column> columns;
  const auto add = [&](std::string name, int width, const auto& value_of) {
    columns.push_back({std::move(name), width, [value_of](const MeasuredFile& file, int decimals) {
                         const auto value = value_of(file);
                         if constexpr (std::is_integral_v<decltype(value)>)
                           return formatted("{}", value);
                         else
                           return formatted("{:.{}f}", value, decimals);
                       }});
  };
  const bool has_ses = options.surfaces.has_ses(), has_sas = options.surfaces.has_sas();
  for (const auto& [name, member] : areas_and_volumes(options.surfaces))
    add(name, 14, [of = member](const MeasuredFile& file) { return file.measures.*of; });
  if (has_ses) {
    add("euler_number", 12, [](const auto& file) { return file.measures.euler_number; });
    add("convex_area", 0, [](const auto& file) { return file.measures.ses_areas.convex; });
    add("saddle_area", 0, [](const auto& file) { return file.measures.ses_areas.saddle; });
    add("concave_area", 0, [](const auto& file) { return file.measures.ses_areas.concave; });
  }
  if (options.cavities) {
    add("cavities", 8, [](const auto& file) {
      return file.place ? file.place->cavities.size() : file.measures.cavities.size();
    });
    add("pieces", 8, [](const auto& file) { return file.measures.pieces.size(); });
  }
  if (options.pockets) {
    add("pockets", 7, [](const auto& file) { return file.pockets.pockets.size(); });
    add("pocket_volume", 13,
        [](const auto& file) { return sum_of(file.pockets.pockets, &Pocket::volume); });
    if (options.at)
      add("volume_at_place", 15, [](const auto& file) {
        return sum_of(file.place->pockets.pockets, &PlacedPocket::volume_at_place);
      });
  }
  if (options.parts.is_chosen())
    for (const auto& [name, area] : buried_areas(options.surfaces))
      add(name, 15, [of = area](const MeasuredFile& file) { return file.buried(of); });
  for (std::size_t k = 0; k < options.reports.size(); ++k) {
    const auto add_area = [&](std::string_view area, double ReportedAtoms::*member) {
      const std::string name = formatted("{} of {}", area, options.reports[k].text);
      add(name, static_cast<int>(std::max<std::size_t>(name.size(), 14)),
          [k, member](const MeasuredFile& file) { return file.reports[k].*member; });
    };
    if (has_ses) add_area("ses_area", &ReportedAtoms::ses);
    if (has_sas) add_area("sas_area", &ReportedAtoms::sas);
  }
  return columns;
}

}  // namespace

std::string measure_heading(const MeasureCommandOptions& options) {
  std::string text;
  for (const Column& column : columns_of(options))
    if (column.width > 0) text += formatted("{:>{}} ", one_line(column.name), column.width);
  return text + (options.all_models ? "file, model\n" : "file\n");
}

std::string measure_line(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string text;
  for (const Column& column : columns_of(options))
    if (column.width > 0) text += formatted("{:>{}} ", column.text(file, 4), column.width);
  return text + one_line(file.input.path.string()) +
         (file.input.model ? formatted(", {}\n", *file.input.model) : "\n");
}

std::string measure_json(const MeasureCommandOptions& options, const MeasuredFile& file) {
  Json object = first_members(file.input, file.surface.atoms().size(), options.probe_radius);
  add_measures(object, options.surfaces, file.measures);
  add_derivatives(object, file.measures.gradients);
  if (options.cavities) add_cavities(object, file);
  if (options.pockets) add_pockets(object, options.pocket_options, file);
  if (file.place) add_place(object, options, *file.place);
  if (file.surface.max_filled_void()) object["filled_cavities"] = file.measures.filled_cavities;
  if (!file.reports.empty())
    object["reports"] = array_of(file.reports, [&](const ReportedAtoms& report) {
      return report_json(options, file, report);
    });
  if (!file.parts.empty()) {
    object["parts"] = array_of(file.parts, [&](const MeasuredPart& part) {
      Json item{{"name", part.name}, {"atoms", part.atoms}};
      add_measures(item, options.surfaces, part.measures);
      return item;
    });
    object["other_atoms"] = file.other_atoms;
    for (const auto& [name, area] : buried_areas(options.surfaces))
      object[name] = file.buried(area);
  }
  add_last_members(object, file.input);
  return text_of(object) + "\n";
}

std::vector<std::string> measure_csv_columns(const MeasureCommandOptions& options) {
  std::vector<std::string> names{"file", "atoms", "probe_radius"};
  for (const Column& column : columns_of(options)) names.push_back(column.name);
  names.insert(names.end(), {"model", "radii", "left_out", "error"});
  return names;
}

std::string measure_csv_line(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string text = formatted("{},{},{}", csv_field(file.input.path.string()),
                               file.surface.atoms().size(), options.probe_radius);
  for (const Column& column : columns_of(options)) text += "," + column.text(file, 6);
  const std::optional<StructureReport>& structure = file.input.structure;
  if (!structure) return text + ",,,,\n";
  return text + formatted(",{},{},{},\n", csv_field(structure->model), csv_field(structure->radii),
                          left_out_atoms(*structure));
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
