#include "cli/measure_report.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "cli/filling_report.hpp"
#include "cli/json.hpp"
#include "cli/messages.hpp"
#include "cli/structure_report.hpp"
#include "input/text_source.hpp"
#include "output/area_table_writer.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

std::string surface_line(std::string_view name, double area, double volume) {
  return formatted("{:<16} {:>16.4f} {:>16.4f}\n", name, area, volume);
}

std::string kinds_line(const PatchAreas& areas) {
  return formatted("SES patches: {:.4f} convex, {:.4f} saddle, {:.4f} concave\n", areas.convex,
                   areas.saddle, areas.concave);
}

std::string parts_text(const MeasuredFile& file) {
  if (file.parts.empty()) return "";
  std::string text;
  for (const MeasuredPart& part : file.parts)
    text += formatted("part {} alone: {}, SES area {:.4f}, SAS area {:.4f}\n", one_line(part.name),
                      counted(part.atoms, "atom"), part.measures.ses_area, part.measures.sas_area);
  if (file.other_atoms > 0)
    text += formatted("left out: {} of other chains\n", counted(file.other_atoms, "atom"));
  return text + formatted("buried area (parts alone minus complex): SES {:.4f}, SAS {:.4f}\n",
                          file.buried(&Measures::ses_area), file.buried(&Measures::sas_area));
}

/// Returns the numbers of an overlap list, with a word for the outside.
std::string overlaps_text(const Cavity& cavity) {
  std::string text;
  for (const std::size_t number : overlaps_of(cavity))
    text += number == 0 ? " outside" : formatted(" {}", number);
  return text;
}

std::string cavities_text(const MeasuredFile& file) {
  const Measures& measures = file.measures;
  std::string text =
      formatted("{}, {}\n", counted(measures.pieces.size(), "piece"),
                measures.cavities.size() == 1 ? std::string("1 cavity")
                                              : formatted("{} cavities", measures.cavities.size()));
  if (measures.cavities.empty()) return text;
  text += "cavity  void (A^3)  centers (A^3)  SES area (A^2)  largest probe (A)  atoms  overlaps\n";
  for (std::size_t k = 0; k < measures.cavities.size(); ++k) {
    const Cavity& cavity = measures.cavities[k];
    text += formatted("{:>6} {:>11.4f} {:>14.4f} {:>15.4f} {:>18.4f} {:>6} {}\n", k + 1,
                      cavity.void_volume, cavity.probe_center_volume, cavity.ses_area,
                      cavity.largest_probe, cavity.atoms.size(), overlaps_text(cavity));
  }
  return text;
}

json::Value point_json(Vec3 point) { return {point.x, point.y, point.z}; }

json::Value cavity_json(const MeasuredAtoms& atoms, const Cavity& cavity) {
  json::Value item{{"void_volume", cavity.void_volume},
                   {"probe_center_volume", cavity.probe_center_volume},
                   {"ses_area", cavity.ses_area},
                   {"sas_area", cavity.sas_area},
                   {"euler_number", cavity.euler_number},
                   {"centroid", point_json(cavity.centroid)},
                   {"low", point_json(cavity.low)},
                   {"high", point_json(cavity.high)},
                   {"largest_probe", cavity.largest_probe},
                   {"largest_probe_center", point_json(cavity.largest_probe_center)},
                   {"walls", cavity.wall_count},
                   {"piece", cavity.piece + 1}};
  item["inner_pieces"] =
      json::array_of(cavity.inner, [](std::size_t piece) -> json::Value { return piece + 1; });
  item["overlaps"] = overlaps_of(cavity);
  item["atoms"] = serial_numbers(atoms, cavity.atoms);
  if (!atoms.labels.empty()) item["residues"] = residues_of(atoms, cavity.atoms);
  return item;
}

json::Value piece_json(const MeasuredAtoms& atoms, const Piece& piece) {
  return {{"ses_area", piece.ses_area},
          {"ses_volume", piece.ses_volume},
          {"sas_area", piece.sas_area},
          {"sas_volume", piece.sas_volume},
          {"euler_number", piece.euler_number},
          {"cavities", piece.cavity_count},
          {"cavity", piece.cavity ? *piece.cavity + 1 : 0},
          {"atoms", piece.atoms.size()},
          {"first_atom", serial_number(atoms, piece.atoms.front())}};
}

void add_cavities(json::Value& object, const MeasuredFile& file) {
  const MeasuredAtoms atoms = file.table();
  object["cavities"] = json::array_of(
      atoms.cavities, [&](const Cavity& cavity) { return cavity_json(atoms, cavity); });
  object["pieces"] =
      json::array_of(atoms.pieces, [&](const Piece& piece) { return piece_json(atoms, piece); });
}

std::string pockets_text(const MeasureCommandOptions& options, const Pockets& pockets) {
  const PocketOptions& search = options.pocket_options;
  std::string text = formatted(
      "{} for a large probe of {} angstrom on a grid of {} angstrom\n"
      "reached by the small probe only: {:.2f} A^3, of these {:.2f} A^3 in no pocket\n",
      counted(pockets.pockets.size(), "pocket"), search.large_probe_radius, search.spacing,
      pockets.difference_volume, pockets.shallow_volume);
  if (pockets.pockets.empty()) return text;
  text += "pocket  volume (A^3)  centers (A^3)  mouth area (A^2)  mouths  atoms\n";
  for (std::size_t k = 0; k < pockets.pockets.size(); ++k) {
    const Pocket& pocket = pockets.pockets[k];
    text += formatted("{:>6} {:>13.2f} {:>14.2f} {:>17.2f} {:>7} {:>6}\n", k + 1, pocket.volume,
                      pocket.probe_center_volume, pocket.mouth_area, pocket.mouth_count,
                      pocket.atoms.size());
  }
  return text;
}

json::Value pocket_json(const MeasuredAtoms& atoms, const Pocket& pocket) {
  json::Value item{{"volume", pocket.volume},
                   {"probe_center_volume", pocket.probe_center_volume},
                   {"mouth_area", pocket.mouth_area},
                   {"mouths", pocket.mouth_count},
                   {"centroid", point_json(pocket.centroid)},
                   {"atoms", serial_numbers(atoms, pocket.atoms)}};
  if (!atoms.labels.empty()) item["residues"] = residues_of(atoms, pocket.atoms);
  return item;
}

void add_pockets(json::Value& object, const PocketOptions& search, const MeasuredFile& file) {
  const MeasuredAtoms atoms = file.table();
  object["pockets"] = json::array_of(
      atoms.pockets, [&](const Pocket& pocket) { return pocket_json(atoms, pocket); });
  object["pocket_search"] = {{"large_probe_radius", search.large_probe_radius},
                             {"spacing", search.spacing},
                             {"difference_volume", file.pockets.difference_volume},
                             {"shallow_volume", file.pockets.shallow_volume}};
}

/// A value, and its name in tables and JSON.
struct NamedValue {
  const char* name;
  double Measures::*member;
};

constexpr std::array areas_and_volumes{
    NamedValue{"ses_area", &Measures::ses_area}, NamedValue{"ses_volume", &Measures::ses_volume},
    NamedValue{"sas_area", &Measures::sas_area}, NamedValue{"sas_volume", &Measures::sas_volume},
    NamedValue{"vdw_area", &Measures::vdw_area}, NamedValue{"vdw_volume", &Measures::vdw_volume}};

/// The areas that the parts of a complex bury. See MeasuredFile::buried.
constexpr std::array buried_areas{NamedValue{"buried_ses_area", &Measures::ses_area},
                                  NamedValue{"buried_sas_area", &Measures::sas_area}};

json::Value kinds_json(const PatchAreas& areas) {
  return {{"convex", areas.convex}, {"saddle", areas.saddle}, {"concave", areas.concave}};
}

void add_measures(json::Value& object, const Measures& measures) {
  for (const auto& [name, member] : areas_and_volumes) object[name] = measures.*member;
  object["euler_number"] = measures.euler_number;
  object["ses_area_by_kind"] = kinds_json(measures.ses_areas);
}

/// Adds what concerns all atoms of the derivatives, if they were computed.
void add_derivatives(json::Value& object, const Gradients& gradients) {
  if (gradients.ses_area.radii.empty()) return;
  object["derivatives_by_probe_radius"] = {{"ses_area", gradients.ses_area.probe},
                                           {"ses_volume", gradients.ses_volume.probe},
                                           {"sas_area", gradients.sas_area.probe},
                                           {"sas_volume", gradients.sas_volume.probe}};
  object["derivatives_are_smooth"] = gradients.are_smooth;
}

}  // namespace

std::string measure_text(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string text;
  if (!options.quiet) {
    text = formatted("{}: {}, probe radius {} angstrom\n", one_line(input_name(file.path)),
                     counted(file.surface.atoms().size(), "atom"), options.probe_radius);
    if (file.structure) text += structure_text(*file.structure);
    text += formatted("{:<16} {:>16} {:>16}\n", "surface", "area (A^2)", "volume (A^3)");
  }
  const Measures& measures = file.measures;
  text += surface_line("SES", measures.ses_area, measures.ses_volume);
  text += surface_line("SAS", measures.sas_area, measures.sas_volume);
  text += surface_line("van der Waals", measures.vdw_area, measures.vdw_volume);
  text += kinds_line(measures.ses_areas);
  text += formatted("Euler number of the SAS: {}\n", measures.euler_number);
  if (file.surface.max_filled_void()) text += filling_text(measures.filled_cavities);
  if (options.cavities) text += cavities_text(file);
  if (options.pockets) text += pockets_text(options, file.pockets);
  return text + parts_text(file);
}

std::string measure_heading(const MeasureCommandOptions& options) {
  std::string text;
  for (const auto& [name, member] : areas_and_volumes) text += formatted("{:>14} ", name);
  text += formatted("{:>12} ", "euler_number");
  if (options.cavities) text += formatted("{:>8} {:>8} ", "cavities", "pieces");
  if (options.pockets) text += formatted("{:>7} ", "pockets");
  if (options.parts.is_chosen())
    for (const auto& [name, area] : buried_areas) text += formatted("{:>15} ", name);
  return text + "file\n";
}

std::string measure_line(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string text;
  for (const auto& [name, member] : areas_and_volumes)
    text += formatted("{:>14.4f} ", file.measures.*member);
  text += formatted("{:>12} ", file.measures.euler_number);
  if (options.cavities)
    text += formatted("{:>8} {:>8} ", file.measures.cavities.size(), file.measures.pieces.size());
  if (options.pockets) text += formatted("{:>7} ", file.pockets.pockets.size());
  if (!file.parts.empty())
    for (const auto& [name, area] : buried_areas)
      text += formatted("{:>15.4f} ", file.buried(area));
  return text + one_line(file.path.string()) + "\n";
}

std::string measure_json(const MeasureCommandOptions& options, const MeasuredFile& file) {
  json::Value object{{"file", file.path.string()},
                     {"atoms", file.surface.atoms().size()},
                     {"probe_radius", options.probe_radius}};
  add_measures(object, file.measures);
  add_derivatives(object, file.measures.gradients);
  if (options.cavities) add_cavities(object, file);
  if (options.pockets) add_pockets(object, options.pocket_options, file);
  if (file.surface.max_filled_void())
    object["filled_cavities"] =
        filled_json(file.surface.max_filled_void(), file.measures.filled_cavities);
  if (!file.parts.empty()) {
    object["parts"] = json::array_of(file.parts, [](const MeasuredPart& part) {
      json::Value item{{"name", part.name}, {"atoms", part.atoms}};
      add_measures(item, part.measures);
      return item;
    });
    object["other_atoms"] = file.other_atoms;
    for (const auto& [name, area] : buried_areas) object[name] = file.buried(area);
  }
  if (file.structure) object["structure"] = structure_json(*file.structure);
  return json::text_of(object) + "\n";
}

std::string measure_csv_heading(const MeasureCommandOptions& options) {
  std::string text = "file,atoms,probe_radius";
  for (const auto& [name, member] : areas_and_volumes) text += formatted(",{}", name);
  text += ",euler_number,convex_area,saddle_area,concave_area";
  if (options.cavities) text += ",cavities,pieces";
  if (options.pockets) text += ",pockets";
  if (options.parts.is_chosen())
    for (const auto& [name, area] : buried_areas) text += formatted(",{}", name);
  return text + "\n";
}

std::string measure_csv_line(const MeasureCommandOptions& options, const MeasuredFile& file) {
  std::string text = formatted("{},{},{}", csv_field(file.path.string()),
                               file.surface.atoms().size(), options.probe_radius);
  for (const auto& [name, member] : areas_and_volumes)
    text += formatted(",{:.6f}", file.measures.*member);
  const PatchAreas& kinds = file.measures.ses_areas;
  text += formatted(",{},{:.6f},{:.6f},{:.6f}", file.measures.euler_number, kinds.convex,
                    kinds.saddle, kinds.concave);
  if (options.cavities)
    text += formatted(",{},{}", file.measures.cavities.size(), file.measures.pieces.size());
  if (options.pockets) text += formatted(",{}", file.pockets.pockets.size());
  if (!file.parts.empty())
    for (const auto& [name, area] : buried_areas) text += formatted(",{:.6f}", file.buried(area));
  return text + "\n";
}

}  // namespace eses::detail::cli
